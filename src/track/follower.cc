#include "track/follower.h"

#include "base/tuning.h"
#include "norm/change.h"

namespace mjcf_pdg {

namespace tune = tuning::track;

// What the last tick's descent knows of where it ended, the pairs nearby, is not asked again.
const LocalResult& Follower::Follow(const Start& start) {
  LocalOptions options = LocalOptions::Polishing();
  options.trust_radius = LocalOptions{}.trust_radius;
  options.max_iterations = start.free ? steps_ : tune::kRepairSteps;
  if (start.free) {
    options.largest_step = start.reach / steps_;
    options.margin = options.least_margin = tune::kMargin;
  }
  const bool resumes =
      resumable_ && start.free && start.obstacles == obstacles_ && local_.at() == start.q;
  resumable_ = true;
  obstacles_ = start.obstacles;
  options.renewed = true;
  return resumes ? local_.Resume(options) : local_.Run(start.q, options);
}

const LocalResult& Follower::Retreat(const VectorXd& q) {
  LocalOptions options = LocalOptions::Retreating();
  options.max_iterations = tune::kRetreatSteps;
  resumable_ = false;
  return local_.Run(q, options);
}

double Follower::Apart(const VectorXd& from, const VectorXd& to) {
  work_.norm.Linearize(work_.problem().q_in, r_, J_);
  Change(work_.problem().tables, from, to, X_, nullptr);
  r_.noalias() = J_ * X_;
  return r_.norm();
}

}  // namespace mjcf_pdg
