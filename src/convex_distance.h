// Distances of convex geoms that are apart, starting from what was nearest when last asked.
//
// From one configuration to the next the nearest features hardly change: a farthest point or two
// prove that, where mj_geomDistance starts anew (measured in bench/README.md). Of the points found
// so far the distance is an upper bound, a plane between the geoms gives a lower one; where these
// do not meet, or the geoms overlap, there is no answer.
//
// Source: Gilbert, Johnson, Keerthi: A fast procedure for computing the distance between complex
// objects in three-dimensional space, 1988.
#ifndef MJCF_PDG_SRC_CONVEX_DISTANCE_H_
#define MJCF_PDG_SRC_CONVEX_DISTANCE_H_

#include <vector>

#include "kinematics.h"
#include "signed_gap.h"
#include "simplex.h"
#include "support_points.h"

namespace mjcf_pdg {

// One per thread.
class ConvexDistance {
 public:
  explicit ConvexDistance(const SceneTables& tables);

  // What follows does not depend on the questions before.
  void Forget();

  enum class Answer { kNear, kBeyond, kUnknown };
  // The distance of a kept pair [m], in world axes: negative only of planes, and where spheres and
  // capsules overlap by less than their radii. kBeyond: it is not below `cutoff`.
  Answer Ask(const PosedModel& posed, int pair, double cutoff, SignedGap& gap);

 private:
  // The last simplex, its corners in the frames of geom 1 and geom 2: points of them wherever they
  // are.
  struct Memory {
    int size = 0;
    Vector3d p1_G[4], p2_G[4];
  };
  // Geom 2 in the frame of geom 1.
  struct RelativePose {
    Matrix3d R;
    Vector3d t;
  };

  Answer AskPlane(const PosedModel& posed, const KeptPair& pair, double cutoff,
                  SignedGap& gap) const;
  void AddFarthest(const KeptPair& pair, const RelativePose& pose, const Vector3d& n);
  bool Recall(const RelativePose& pose, const Memory& memory);
  void Remember(const RelativePose& pose, int pair);

  const SceneTables& tables_;
  std::vector<char> knows_;       // per kept pair
  std::vector<Memory> memories_;  // per kept pair
  std::vector<int> remembered_;   // those that are not empty
  Simplex simplex_;               // in the frame of geom 1
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_CONVEX_DISTANCE_H_
