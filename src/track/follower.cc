#include "track/follower.h"

#include <cmath>

#include "base/tuning.h"
#include "norm/change.h"

namespace mjcf_pdg {

namespace tune = tuning::track;

// What the last tick's descent knows of where it ended, the pairs nearby, is not asked again.
const LocalResult& Follower::Follow(const Start& start) {
  LocalOptions options = LocalOptions::Polishing();
  options.trust_radius = LocalOptions{}.trust_radius;
  options.max_iterations = start.free ? pace_.steps : tune::kRepairSteps;
  if (start.free) {
    options.largest_step = start.reach / pace_.steps;
    options.margin = options.least_margin = tune::kMargin;
    options.enough = pace_.enough;
    options.corrections = tune::kCorrections;
  }
  const bool resumes =
      resumable_ && start.free && start.obstacles == obstacles_ && local_.at() == start.q;
  resumable_ = true;
  obstacles_ = start.obstacles;
  options.renewed = true;
  const LocalResult* result = &(resumes ? local_.Resume(options) : local_.Run(start.q, options));
  if (!start.free) return *result;
  const double before = work_.norm.Sigma(start.q);
  options.renewed = false;
  for (int k = 0; k < pace_.more && !result->ended && !(result->sigma < before); ++k) {
    result = &local_.Resume(options);
  }
  return *result;
}

const LocalResult& Follower::Retreat(const VectorXd& q) {
  LocalOptions options = LocalOptions::Retreating();
  options.max_iterations = tune::kRetreatSteps;
  resumable_ = false;
  return local_.Run(q, options);
}

double Follower::Apart(const VectorXd& from, const VectorXd& to) {
  apart_.SetReference(from, work_.problem().mocap);
  return std::sqrt(apart_.Sigma(to));
}

// A length by the linearized norm at the workspace's q_in, which is ready, decides where it is much
// less than the limit: inertias seldom differ by the square of this. (The steps' own lengths do not
// know: a hinge that is half a turn from q_in turns for nothing there.)
bool Follower::Farther(const VectorXd& from, const VectorXd& to, double limit) {
  constexpr double kMuchLess = 0.25;  // [1]
  work_.norm.Linearize(work_.problem().q_in, r_, J_);
  Change(work_.problem().tables, from, to, X_, nullptr);
  r_.noalias() = J_ * X_;
  return r_.norm() > kMuchLess * limit && Apart(from, to) > limit;
}

}  // namespace mjcf_pdg
