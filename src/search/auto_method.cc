#include "search/auto_method.h"

#include <cstdint>

#include "problem/effort.h"

namespace mjcf_pdg {

AutoMethod::AutoMethod(Workspace& work) : problem_(work.problem()), work_(work), search_(work) {
  const bool few = problem_.tables.n <= PlanFor(problem_.options.effort).box_dofs;
  if (few && problem_.Uses(Component::kBoxes)) boxes_.emplace(work);
}

Outcome& AutoMethod::Run(const StrategyInput& given) {
  StrategyInput input = given;
  Component hint_start = Component::kUserPose;
  const bool coherent = problem_.options.trajectory && problem_.Uses(Component::kMotionCoherence);
  if (!input.hint && coherent && !coherence_.empty()) {
    hint_start = Component::kMotionCoherence;
    recalled_ = coherence_.NearestFree(work_, 1).front();
    input.hint = &recalled_;
  }
  const bool follows = search_.Begin(input, hint_start);
  if (follows) return search_.trials().outcome();
  const SceneTables& tables = problem_.tables;
  if (problem_.Uses(Component::kHulls) && MeshesOverlap(input.overlaps) &&
      !AllRigid(tables, input.overlaps)) {
    const std::int64_t before = hulls_.queries();
    const VectorXd* const q = hulls_.Run(work_);
    work_.budget.Charge(hulls_.queries() - before);
    if (q) search_.Try(*q, Component::kHulls);
  }
  const bool early = search_.trials().HasFree();
  if (early) SearchBoxes(input);
  search_.Finish(input);
  if (!early) SearchBoxes(input);
  search_.FrameSearched();
  return search_.trials().outcome();
}

// Descends from what boxes of joint space show to be free and nearer than the answer, until there
// is no such thing, or the search is over.
void AutoMethod::SearchBoxes(const StrategyInput& input) {
  Trials& trials = search_.trials();
  if (!boxes_ || !trials.HasFree()) return;
  if (trials.BestSigma() <= JointBoxes::kClosed * input.sigma_lower_bound) return;
  const int boxes = PlanFor(problem_.options.effort).boxes;
  if (!boxes_->Begin(input.overlaps, trials.BestSigma(), boxes)) return;
  while (boxes_->Search(trials.BestSigma())) search_.Try(boxes_->nearer(), Component::kBoxes);
  trials.Prove(boxes_->sigma_lower_bound());
  trials.RenewQueries();  // those of the boxes do not count against the starts
}

// A search that ends with its first answer does not.
bool AutoMethod::UsesLowerBound() const { return PlanFor(problem_.options.effort).agree > 1; }

bool AutoMethod::Polish(Candidate& candidate) {
  return search_.WorthPolishing() && search_.trials().Polish(candidate);
}

bool AutoMethod::Retreat(const Candidate& candidate, VectorXd& q) {
  return search_.trials().Retreat(candidate, q);
}

void AutoMethod::Remember(const VectorXd& q, bool free) {
  if (free) coherence_.AddFree(q);
}

void AutoMethod::Forget() {
  coherence_.Clear();
  search_.Forget();
}

}  // namespace mjcf_pdg
