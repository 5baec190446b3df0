#include "search/search.h"

#include <algorithm>

namespace mjcf_pdg {

Search::Search(Workspace& work)
    : problem_(work.problem()),
      work_(work),
      trials_(work),
      varied_(work, trials_),
      meshes_(work, trials_),
      plan_(PlanFor(work.problem().options.effort)) {}

bool Search::Begin(const StrategyInput& input, Component hint_start) {
  center_ = problem_.q_in;
  TurnInsideLimits(problem_.tables, center_);
  depth_ = 0.0;
  for (const NearPair& near : input.overlaps) {
    depth_ = std::max(depth_, problem_.clearance - near.distance);
  }
  meshes_overlap_ = MeshesOverlap(input.overlaps);
  trials_.Begin(plan_, input, depth_, meshes_overlap_);
  varied_.Begin(plan_, center_, meshes_overlap_);
  if (input.hint && hint_start == Component::kUserPose) trials_.NeedNoStart();
  if (meshes_overlap_) {
    if (input.hint) trials_.Try(*input.hint, hint_start, ExactMeshStarts::FromHint());
    meshes_.Begin();
    return meshes_.Follows(plan_);
  }
  if (input.of_fewer) trials_.Try(*input.of_fewer, Component::kDirect, LocalOptions{});
  if (problem_.Uses(Component::kDirect)) trials_.Try(center_, Component::kDirect, LocalOptions{});
  if (input.hint) trials_.Try(*input.hint, hint_start, LocalOptions{});
  return false;
}

void Search::Finish(const StrategyInput& input) {
  if (meshes_overlap_) {
    meshes_.Try(input, center_, depth_, varied_.random());
    trials_.RenewQueries();  // those so far do not count against the varied starts
  }
  if (trials_.HasFree() && !trials_.Done() && problem_.Uses(Component::kMirror)) {
    varied_.TryMirror();
  }
  varied_.TryUntilDone();
  if (!trials_.HasFree()) {
    if (problem_.Uses(Component::kConstrainedTranslation)) varied_.TryTranslations(input.overlaps);
    if (!trials_.HasFree() && problem_.Uses(Component::kAnywhere)) varied_.TryAnywhere();
    trials_.RenewQueries();  // the search for a nearer answer begins here
    if (trials_.HasFree()) varied_.TryUntilDone();
  }
}

bool Search::WorthPolishing() const {
  const bool in_haste = meshes_overlap_ && (!plan_.polishes_meshes || meshes_.following());
  return problem_.Uses(Component::kPolish) && !in_haste;
}

}  // namespace mjcf_pdg
