#include "search/exact_mesh_starts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "base/tuning.h"

namespace mjcf_pdg {

namespace tune = tuning::exact_meshes;

namespace {

bool MovedByFreeJointsOnly(const SceneTables& tables, int pair) {
  const mjModel& m = *tables.model;
  for (const int geom : {tables.pairs[pair].geom1, tables.pairs[pair].geom2}) {
    for (int body = m.geom_bodyid[geom]; body > 0; body = m.body_parentid[body]) {
      for (int k = 0; k < m.body_jntnum[body]; ++k) {
        if (m.jnt_type[m.body_jntadr[body] + k] != mjJNT_FREE) return false;
      }
    }
  }
  return true;
}

}  // namespace

bool MeshesOverlap(const std::vector<NearPair>& overlaps) {
  return std::any_of(overlaps.begin(), overlaps.end(),
                     [](const NearPair& near) { return near.kind == PairKind::kExact; });
}

bool AllRigid(const SceneTables& tables, const std::vector<NearPair>& overlaps) {
  return std::all_of(overlaps.begin(), overlaps.end(), [&](const NearPair& near) {
    return MovedByFreeJointsOnly(tables, near.pair);
  });
}

LocalOptions ExactMeshStarts::FromHint() {
  LocalOptions near = Coarse();
  near.last_chances = tune::kHintChances;
  return near;
}

// These are tried whether or not there was a hint.
void ExactMeshStarts::Try(const StrategyInput& input, const VectorXd& center, double depth,
                          Random& random) {
  const bool rigid = AllRigid(problem_.tables, input.overlaps);
  if (!rigid && problem_.Uses(Component::kPairByPair)) {
    const std::optional<VectorXd> q = parting_.Start(center);
    if (q) trials_.Try(*q, Component::kPairByPair, Coarse());
  }
  if (problem_.Uses(Component::kConstrainedTranslation)) TryRays(input.overlaps, center);
  const bool found = trials_.outcome().free.size() > hinted_;
  if (!problem_.Uses(Component::kDirect) || (found && trials_.Done())) return;
  if (trials_.Exceeds(tune::kFar)) {
    TryFromWithin(center, depth, random);
  } else if (!found || !rigid) {
    trials_.Try(center, Component::kDirect, Coarse());
  }
}

// Starts where the straight ways of Eq. 20's translations first become free.
void ExactMeshStarts::TryRays(const std::vector<NearPair>& overlaps, const VectorXd& center) {
  const std::span<const VectorXd> far = starts_.ConstrainedTranslation(overlaps, center);
  const double any_sigma = std::numeric_limits<double>::infinity();
  for (const FreeOnRay& free : starts_.FirstFree(center, far, any_sigma)) {
    trials_.Try(free.q, Component::kConstrainedTranslation, Coarse());
  }
}

// From q_in itself: a nut leaves its bolt only along the axis, and no straight line of a sample
// finds that. Its own contacts lead it out if all of them are measured and no step is longer than
// the overlap. Stops at the first try that leads to nothing better than what is known.
void ExactMeshStarts::TryFromWithin(const VectorXd& center, double depth, Random& random) {
  LocalOptions patient = Coarse();
  patient.max_iterations = tune::kPatientSteps;
  patient.depths = Depths::kSearched;
  patient.largest_step = depth;
  for (int k = 0; k < tune::kWaysOut && trials_.Exceeds(k == 0 ? tune::kFar : tune::kVeryFar);
       ++k) {
    if (work_.Spent()) return;
    start_ = center;
    if (k > 0) starts_.Gaussian(center, depth * depth, tune::kNudge, random, start_);
    if (!trials_.Try(start_, Component::kDirect, patient)) return;
  }
}

// Following frame after frame drags an answer along, in the end far from the nearest one. Where
// only free bodies move and no obstacle has moved, √σ is a metric, and by its triangle inequality
// the nearest answer's √σ is at least that of the last searched frame less what q_in has moved
// since.
bool ExactMeshStarts::Follows(const EffortPlan& plan) {
  const SceneTables& tables = problem_.tables;
  bool near = plan.follows && problem_.options.trajectory && searched_ && trials_.HasFree() &&
              frames_followed_ < tune::kFramesFollowed && searched_->mocap == problem_.mocap &&
              WithMovable(tables, searched_->q_in, problem_.q_in) == problem_.q_in &&
              std::all_of(
                  tables.joints.begin(), tables.joints.end(),
                  [](const JointEntry& joint) { return joint.type == mjJNT_FREE; });
  if (near) {
    const double least = searched_->rms - std::sqrt(work_.norm.Sigma(searched_->q_in));
    near = std::sqrt(trials_.BestSigma()) < tune::kFollowed * least;
  }
  if (near) ++frames_followed_;
  return near;
}

void ExactMeshStarts::FrameSearched(double best_sigma) {
  searched_.reset();
  frames_followed_ = 0;
  if (!problem_.options.trajectory || !std::isfinite(best_sigma)) return;
  searched_ = {problem_.q_in, problem_.mocap, std::sqrt(best_sigma)};
}

}  // namespace mjcf_pdg
