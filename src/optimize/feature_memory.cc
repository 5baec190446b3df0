#include "optimize/feature_memory.h"

#include <algorithm>

namespace mjcf_pdg {

void FeatureMemory::Clear(std::size_t pairs) {
  known_.resize(pairs);
  for (const int pair : pairs_) {
    known_[pair].planes.clear();
    known_[pair].learnt.clear();
  }
  pairs_.clear();
}

FeatureMemory::Plane FeatureMemory::Fixed(const SceneTables& tables, const PosedModel& posed,
                                          const NearPair& near) {
  const mjData& d = *posed.data();
  const int g1 = tables.pairs[near.pair].geom1, g2 = tables.pairs[near.pair].geom2;
  const Matrix3d R1 = AsMatrix(d.geom_xmat + 9 * g1), R2 = AsMatrix(d.geom_xmat + 9 * g2);
  return {R1.transpose() * (near.p1_W - AsVector(d.geom_xpos + 3 * g1)),
          R2.transpose() * (near.p2_W - AsVector(d.geom_xpos + 3 * g2)), R1.transpose() * near.n_W};
}

NearPair FeatureMemory::InWorld(const SceneTables& tables, const PosedModel& posed, int pair,
                                const Plane& plane) {
  const mjData& d = *posed.data();
  const int g1 = tables.pairs[pair].geom1, g2 = tables.pairs[pair].geom2;
  const Matrix3d R1 = AsMatrix(d.geom_xmat + 9 * g1), R2 = AsMatrix(d.geom_xmat + 9 * g2);
  NearPair near;
  near.pair = pair;
  near.kind = tables.pairs[pair].kind;
  near.p1_W = AsVector(d.geom_xpos + 3 * g1) + R1 * plane.p1_G;
  near.p2_W = AsVector(d.geom_xpos + 3 * g2) + R2 * plane.p2_G;
  near.n_W = R1 * plane.n_G;
  near.distance = near.n_W.dot(near.p2_W - near.p1_W);
  return near;
}

void FeatureMemory::Keep(const SceneTables& tables, const PosedModel& posed,
                         const std::vector<NearPair>& near) {
  // The entries of a pair follow each other, the nearest or deepest first.
  for (std::size_t k = 0; k < near.size();) {
    const int pair = near[k].pair;
    const bool apart = NeedsGap(near[k].kind) && near[k].distance > 0.0;
    std::vector<Plane>& planes = known_[pair].planes;
    if (apart && planes.empty()) pairs_.push_back(pair);
    if (apart) planes.clear();
    for (; k < near.size() && near[k].pair == pair; ++k) {
      if (apart) planes.push_back(Fixed(tables, posed, near[k]));
    }
  }
}

void FeatureMemory::Learn(const SceneTables& tables, const PosedModel& posed,
                          const NearPair& crossing) {
  std::vector<Plane>& learnt = known_[crossing.pair].learnt;
  if (learnt.size() == kLearnt) learnt.erase(learnt.begin());
  learnt.push_back(Fixed(tables, posed, crossing));
}

void FeatureMemory::Append(const SceneTables& tables, const PosedModel& posed, int pair,
                           std::vector<NearPair>& out) const {
  for (const auto* planes : {&known_[pair].planes, &known_[pair].learnt}) {
    for (const Plane& plane : *planes) out.push_back(InWorld(tables, posed, pair, plane));
  }
}

void FeatureMemory::AppendLearnt(const SceneTables& tables, const PosedModel& posed, double margin,
                                 std::vector<NearPair>& out) {
  for (const int pair : pairs_) {
    const auto overlaps = [pair](const NearPair& near) {
      return near.pair == pair && near.distance < 0.0;
    };
    if (std::any_of(out.begin(), out.end(), overlaps)) continue;
    std::erase_if(known_[pair].learnt, [&](const Plane& plane) {
      const NearPair near = InWorld(tables, posed, pair, plane);
      // Far apart, the points have slid along the plane, which need not hold there.
      const bool here = (near.p2_W - near.p1_W).norm() < margin;
      if (near.distance >= 0.0 && here) out.push_back(near);
      return near.distance < 0.0;
    });
  }
}

}  // namespace mjcf_pdg
