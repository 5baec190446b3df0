// Exact meshes: the features of a pair where its meshes were last apart, carried along as planes.
//
// Where two triangle meshes overlap, the depth and the way out are slow to find and often of little
// use. Where they were apart one step before, their near features have witness points and normals.
// These are kept: the points fixed to their geoms, the normal to geom 1, so that n · (p2 - p1) is
// the feature's distance to first order at any later pose.
#ifndef MJCF_PDG_SRC_OPTIMIZE_FEATURE_MEMORY_H_
#define MJCF_PDG_SRC_OPTIMIZE_FEATURE_MEMORY_H_

#include <vector>

#include "collide/contacts.h"

namespace mjcf_pdg {

class FeatureMemory {
 public:
  // Forgets everything; `pairs` is the number of kept pairs.
  void Clear(std::size_t pairs);

  // Keeps the features in `near` of every exact pair that is apart at the pose, instead of those
  // that were kept of it.
  void Keep(const SceneTables& tables, const PosedModel& posed, const std::vector<NearPair>& near);

  // Whether something is kept, so that steps can be bounded by planes.
  bool learning() const { return !pairs_.empty(); }

  // Adds to what is kept of a pair the plane through triangles of it that cross at the pose.
  void Learn(const SceneTables& tables, const PosedModel& posed, const NearPair& crossing);

  // Appends what is kept of the pair, as it stands at the pose; nothing if the pair was never
  // apart.
  void Append(const SceneTables& tables, const PosedModel& posed, int pair,
              std::vector<NearPair>& out) const;
  // For all pairs that are apart at the pose: appends the planes added by Learn whose two points
  // are within `margin` [m] of each other, and forgets those that the pair's present pose
  // contradicts.
  void AppendLearnt(const SceneTables& tables, const PosedModel& posed, double margin,
                    std::vector<NearPair>& out);

 private:
  static constexpr std::size_t kLearnt = 8;  // planes added by Learn that are kept of a pair
  struct Plane {
    Vector3d p1_G, p2_G, n_G;  // in the frames of geom 1, geom 2 and geom 1
  };
  struct Known {
    std::vector<Plane> planes, learnt;  // by Keep, by Learn
  };
  static Plane Fixed(const SceneTables& tables, const PosedModel& posed, const NearPair& near);
  static NearPair InWorld(const SceneTables& tables, const PosedModel& posed, int pair,
                          const Plane& plane);

  std::vector<Known> known_;  // per kept pair
  std::vector<int> pairs_;    // the pairs of which `planes` are kept
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_OPTIMIZE_FEATURE_MEMORY_H_
