// The features of exact pairs where they were last apart, carried along as planes.
//
// Where two triangle meshes overlap, how deep and which way out is slow to tell and often says
// little. A step from a configuration where they were apart has its planes: every feature's points
// stay fixed to their geoms, its normal to geom 1, and n · (p2 - p1) is its distance to first
// order.
#ifndef MJCF_PDG_SRC_OPTIMIZE_FEATURE_MEMORY_H_
#define MJCF_PDG_SRC_OPTIMIZE_FEATURE_MEMORY_H_

#include <vector>

#include "collide/contacts.h"

namespace mjcf_pdg {

class FeatureMemory {
 public:
  // Forgets everything; `pairs` is the number of kept pairs.
  void Clear(std::size_t pairs);

  // Replaces what is known of each exact pair in `near` that is apart at the pose.
  void Keep(const SceneTables& tables, const PosedModel& posed, const std::vector<NearPair>& near);

  // Some pair was apart.
  bool learning() const { return !pairs_.empty(); }

  // Where a pair that was apart overlaps.
  void Learn(const SceneTables& tables, const PosedModel& posed, const NearPair& crossing);

  // Appends the pair's features as they stand at the pose; none if it was never apart.
  void Append(const SceneTables& tables, const PosedModel& posed, int pair,
              std::vector<NearPair>& out) const;
  // Appends what was learnt of all pairs that are apart at the pose, if its points are nearer to
  // each other than `margin`.
  void AppendLearnt(const SceneTables& tables, const PosedModel& posed, double margin,
                    std::vector<NearPair>& out);

 private:
  static constexpr std::size_t kLearnt = 8;  // the last ones of each pair
  struct Plane {
    Vector3d p1_G, p2_G, n_G;  // in the frames of geom 1, geom 2 and geom 1
  };
  struct Known {
    std::vector<Plane> planes, learnt;
  };
  static Plane Fixed(const SceneTables& tables, const PosedModel& posed, const NearPair& near);
  static NearPair InWorld(const SceneTables& tables, const PosedModel& posed, int pair,
                          const Plane& plane);

  std::vector<Known> known_;  // per kept pair
  std::vector<int> pairs_;    // those with planes
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_OPTIMIZE_FEATURE_MEMORY_H_
