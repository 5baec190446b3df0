#include "track/follower.h"

#include <cmath>

#include "base/tuning.h"

namespace mjcf_pdg {

namespace tune = tuning::track;

const LocalResult& Follower::Follow(const VectorXd& q, bool free, double reach) {
  LocalOptions options = LocalOptions::Polishing();
  options.trust_radius = LocalOptions{}.trust_radius;
  options.max_iterations = free ? tune::kFollowSteps : tune::kRepairSteps;
  if (free) options.largest_step = reach / tune::kFollowSteps;
  if (free) options.margin = tune::kMargin;
  return local_.Run(q, options);
}

const LocalResult& Follower::Retreat(const VectorXd& q) {
  LocalOptions options = LocalOptions::Retreating();
  options.max_iterations = tune::kRetreatSteps;
  return local_.Run(q, options);
}

double Follower::Apart(const VectorXd& from, const VectorXd& to) {
  apart_.SetReference(from, work_.problem().mocap);
  return std::sqrt(apart_.Sigma(to));
}

}  // namespace mjcf_pdg
