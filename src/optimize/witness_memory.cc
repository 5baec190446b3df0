#include "optimize/witness_memory.h"

namespace mjcf_pdg {

void WitnessMemory::Clear(std::size_t pairs) {
  if (slot_.size() != pairs) slot_.assign(pairs, -1);
  entries_.reserve(pairs);
  for (const Entry& entry : entries_) slot_[entry.pair] = -1;
  entries_.clear();
}

WitnessMemory::Points WitnessMemory::InWorld(const SceneTables& tables, const PosedModel& posed,
                                             int pair, const Points& points_G) {
  const mjData& d = *posed.data();
  const int g1 = tables.pairs[pair].geom1, g2 = tables.pairs[pair].geom2;
  return {AsVector(d.geom_xpos + 3 * g1) + AsMatrix(d.geom_xmat + 9 * g1) * points_G.p1_W,
          AsVector(d.geom_xpos + 3 * g2) + AsMatrix(d.geom_xmat + 9 * g2) * points_G.p2_W};
}

void WitnessMemory::Add(const SceneTables& tables, const PosedModel& posed, const NearPair& near,
                        double merge) {
  int& slot = slot_[near.pair];
  if (slot < 0) {
    slot = static_cast<int>(entries_.size());
    entries_.push_back({});
    entries_.back().pair = near.pair;
  }
  Entry& entry = entries_[slot];
  for (int k = 0; k < entry.count; ++k) {
    if (SamePoints(InWorld(tables, posed, near.pair, entry.points_G[k]), near, merge)) return;
  }
  const mjData& d = *posed.data();
  const int g1 = tables.pairs[near.pair].geom1, g2 = tables.pairs[near.pair].geom2;
  Points& points = entry.points_G[entry.next];
  points.p1_W =
      AsMatrix(d.geom_xmat + 9 * g1).transpose() * (near.p1_W - AsVector(d.geom_xpos + 3 * g1));
  points.p2_W =
      AsMatrix(d.geom_xmat + 9 * g2).transpose() * (near.p2_W - AsVector(d.geom_xpos + 3 * g2));
  entry.next = (entry.next + 1) % kPerPair;
  entry.count = std::min(entry.count + 1, kPerPair);
}

}  // namespace mjcf_pdg
