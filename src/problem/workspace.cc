#include "problem/workspace.h"

#include <algorithm>
#include <memory>
#include <vector>

#include "base/tuning.h"

namespace mjcf_pdg {

namespace tune = tuning::accuracy;

Tolerances::Tolerances(double tolerance, double scene_size)
    : user(tolerance),
      aim(std::max(0.0, tolerance - std::max(tune::kAimInside * tolerance,
                                             tune::kDistanceJitter * scene_size))),
      accept(0.5 * (user + aim)),
      mesh_gap(tune::kMeshGap * scene_size) {}

Workspace::Workspace(const SceneTables& tables, const Options& options,
                     const std::shared_ptr<mjData>& data)
    : norm(tables, options.metric),
      finder(tables, std::max(options.clearance, tables.largest_kept), data),
      equality(tables),
      problem_{.tables = tables,
               .options = options,
               .clearance = std::max(options.clearance, tables.largest_kept),
               .size = tables.size,
               .tolerances = Tolerances(options.tolerance, tables.size),
               .without = ComponentsNamed(options.without, options.method)} {
  usual_ = problem_.required = RequiredDistances();
  farthest_ = usual_.size() > 0 ? std::max(problem_.clearance, usual_.maxCoeff()) : 0.0;
  overlaps_.reserve(tables.pairs.size());
  const Eigen::Map<const VectorXd> qpos0(tables.model->qpos0, tables.model->nq);
  if (!data) finder.Pose(qpos0);
  norm.SetReference(qpos0, {}, finder.posed());
}

void Workspace::Begin(const Eigen::Ref<const VectorXd>& q_in, const MocapPoses& mocap,
                      const VectorXd* rest) {
  BeginWithoutNorm(q_in, mocap, rest);
  ReferNorm();
}

void Workspace::ReferNorm() {
  if (norm_refers_) return;
  finder.Pose(problem_.q_in);
  norm.SetReference(problem_.q_in, problem_.mocap, finder.posed());
  norm_refers_ = true;
}

void Workspace::BeginWithoutNorm(const Eigen::Ref<const VectorXd>& q_in, const MocapPoses& mocap,
                                 const VectorXd* rest) {
  if (!remembers_distances) finder.Forget();
  finder.SetMocap(mocap);
  equality.SetMocap(mocap);
  problem_.mocap = mocap;
  problem_.q_in = q_in;
  SetMovable(problem_.tables, problem_.q_in, problem_.q_in);  // normalizes quaternions
  norm_refers_ = false;
  if (rest) {
    problem_.required = usual_.cwiseMin(*rest);
  } else if (rested_) {
    problem_.required = usual_;
  }
  rested_ = rest != nullptr;
}

void Workspace::Begin(const Workspace& other) {
  const Problem& same = other.problem();
  finder.Forget();
  finder.SetMocap(same.mocap);
  equality.SetMocap(same.mocap);
  equality.SetActive(other.equality.active());
  problem_.mocap = same.mocap;
  problem_.q_in = same.q_in;
  problem_.required = same.required;
  norm_refers_ = false;
  ReferNorm();
  budget = other.budget.For(finder.queries(), other.finder.queries());
}

VectorXd Workspace::RequiredDistances() const {
  const SceneTables& tables = problem_.tables;
  VectorXd required(static_cast<Eigen::Index>(tables.pairs.size()));
  for (std::size_t k = 0; k < tables.pairs.size(); ++k) {
    const KeptPair& pair = tables.pairs[k];
    required[static_cast<Eigen::Index>(k)] = pair.Required(problem_.options.clearance);
    if (pair.moves && NeedsGap(pair.kind)) {
      required[static_cast<Eigen::Index>(k)] +=
          problem_.tolerances.aim + problem_.tolerances.mesh_gap;
    }
  }
  return required;
}

bool Workspace::Free(const VectorXd& q) {
  finder.Pose(q);
  const std::vector<NearPair>& near = finder.Find(farthest_, Depths::kSkipped);
  const bool apart = std::none_of(near.begin(), near.end(), [this](const NearPair& n) {
    return problem_.Overlaps(n, problem_.tolerances.accept);
  });
  return apart && equality.Violation(q) <= kEqualityTolerance;
}

const std::vector<NearPair>& Workspace::OverlapsAtInput() {
  overlaps_.clear();
  finder.Pose(problem_.q_in);
  for (const NearPair& near : finder.Find(farthest_ + problem_.options.tolerance)) {
    // What cannot be mended counts only if it cannot be accepted either.
    const double accepted =
        problem_.tables.pairs[near.pair].moves ? 0.0 : problem_.options.tolerance;
    if (near.distance < problem_.required[near.pair] - accepted) overlaps_.push_back(near);
  }
  return overlaps_;
}

void Workspace::Unwound(const VectorXd& q, VectorXd& unwound) {
  unwound = q;
  Unwind(problem_.tables, problem_.q_in, unwound);
  if (equality.Violation(unwound) > kEqualityTolerance) unwound = q;
}

}  // namespace mjcf_pdg
