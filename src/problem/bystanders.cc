#include "problem/bystanders.h"

#include <algorithm>

#include "model/kinematics.h"

namespace mjcf_pdg {

Bystanders::Bystanders(const SceneTables& scene)
    : trees_(scene), joined_(trees_.count(), 0), concerned_(trees_.count()) {
  for (const std::vector<int>& trees : trees_.OfHeld(scene)) {
    for (const int tree : trees) joined_[tree] = 1;
  }
}

bool Bystanders::PutBack(const Problem& problem, const std::vector<NearPair>& overlaps,
                         const std::vector<double>& q_in, std::vector<double>& q) {
  if (trees_.count() < 2) return false;
  concerned_ = joined_;
  for (const NearPair& near : overlaps) {
    const KeptPair& pair = problem.tables.pairs[near.pair];
    for (const int geom : {pair.geom1, pair.geom2}) {
      if (trees_.OfGeom(geom) >= 0) concerned_[trees_.OfGeom(geom)] = 1;
    }
  }
  for (const JointEntry& joint : problem.tables.joints) {
    if (LimitExcess(joint, problem.q_in) > 0.0) concerned_[trees_.OfJoint(joint)] = 1;
  }
  bool changed = false;
  for (const JointEntry& joint : problem.tables.joints) {
    if (concerned_[trees_.OfJoint(joint)]) continue;
    const auto from = q_in.begin() + joint.qadr, to = from + QposEntries(joint);
    if (std::equal(from, to, q.begin() + joint.qadr)) continue;
    std::copy(from, to, q.begin() + joint.qadr);
    changed = true;
  }
  return changed;
}

}  // namespace mjcf_pdg
