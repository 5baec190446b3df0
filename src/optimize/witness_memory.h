// Witness points of earlier steps, which give a pair of convex geoms extra rows. Not in the paper.
//
// A query finds one pair of witness points. When two faces meet, these jump from corner to corner
// from step to step, and a descent that knows only the present corner zigzags. The points of a few
// earlier steps, kept in the frames of their geoms, bound the motion at the other corners too.
#ifndef MJCF_PDG_SRC_OPTIMIZE_WITNESS_MEMORY_H_
#define MJCF_PDG_SRC_OPTIMIZE_WITNESS_MEMORY_H_

#include <array>
#include <vector>

#include "collide/contacts.h"

namespace mjcf_pdg {

class WitnessMemory {
 public:
  static constexpr int kPerPair = 4;

  struct Points {
    Vector3d p1_W, p2_W;
  };

  // Forgets everything; `pairs` is the number of kept pairs.
  void Clear(std::size_t pairs);
  // Remembers the witness points of a near pair unless a remembered one is within `merge` [m].
  void Add(const SceneTables& tables, const PosedModel& posed, const NearPair& near, double merge);
  // Calls visit(p1_W, p2_W) for each remembered pair of points other than the pair's current ones.
  template <typename Visit>
  void ForEach(const SceneTables& tables, const PosedModel& posed, const NearPair& near,
               double merge, Visit visit) const {
    const int slot = slot_[near.pair];
    if (slot < 0) return;
    const Entry& entry = entries_[slot];
    for (int k = 0; k < entry.count; ++k) {
      const Points points = InWorld(tables, posed, near.pair, entry.points_G[k]);
      if (SamePoints(points, near, merge)) continue;
      visit(points.p1_W, points.p2_W);
    }
  }

 private:
  struct Entry {
    int pair = 0, count = 0, next = 0;
    std::array<Points, kPerPair> points_G;  // in the frames of geom 1 and geom 2
  };

  static bool SamePoints(const Points& points, const NearPair& near, double merge) {
    return (points.p1_W - near.p1_W).squaredNorm() < merge * merge &&
           (points.p2_W - near.p2_W).squaredNorm() < merge * merge;
  }
  static Points InWorld(const SceneTables& tables, const PosedModel& posed, int pair,
                        const Points& points_G);

  std::vector<int> slot_;  // per kept pair, -1: nothing remembered
  std::vector<Entry> entries_;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_OPTIMIZE_WITNESS_MEMORY_H_
