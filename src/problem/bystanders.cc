#include "problem/bystanders.h"

#include <algorithm>

#include "model/kinematics.h"

namespace mjcf_pdg {

bool Bystanders::PutBack(const Problem& problem, const std::vector<NearPair>& overlaps,
                         const std::vector<double>& q_in, std::vector<double>& q) {
  if (trees_.count() < 2) return false;
  std::fill(wrong_.begin(), wrong_.end(), 0);
  for (const NearPair& near : overlaps) {
    const KeptPair& pair = problem.tables.pairs[near.pair];
    for (const int geom : {pair.geom1, pair.geom2}) {
      if (trees_.OfGeom(geom) >= 0) wrong_[trees_.OfGeom(geom)] = 1;
    }
  }
  for (const JointEntry& joint : problem.tables.joints) {
    if (LimitExcess(joint, problem.q_in) > 0.0) wrong_[trees_.OfJoint(joint)] = 1;
  }
  bool changed = false;
  for (const JointEntry& joint : problem.tables.joints) {
    if (wrong_[trees_.OfJoint(joint)]) continue;
    const auto from = q_in.begin() + joint.qadr, to = from + QposEntries(joint);
    if (std::equal(from, to, q.begin() + joint.qadr)) continue;
    std::copy(from, to, q.begin() + joint.qadr);
    changed = true;
  }
  return changed;
}

}  // namespace mjcf_pdg
