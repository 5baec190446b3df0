// Signed distances of convex geoms, starting from what was nearest when last asked.
//
// From one configuration to the next the nearest features hardly change: a farthest point or two
// prove that, where mj_geomDistance starts anew (measured in bench/README.md). Apart, the distance
// of the points found so far is an upper bound and a plane between the geoms gives a lower one;
// overlapping, see expanding_polytope.h. Where the two bounds do not meet there is no answer.
//
// Source: Gilbert, Johnson, Keerthi: A fast procedure for computing the distance between complex
// objects in three-dimensional space, 1988.
#ifndef MJCF_PDG_SRC_COLLIDE_CONVEX_CONVEX_DISTANCE_H_
#define MJCF_PDG_SRC_COLLIDE_CONVEX_CONVEX_DISTANCE_H_

#include <optional>
#include <vector>

#include "base/signed_gap.h"
#include "collide/convex/expanding_polytope.h"
#include "collide/convex/simplex.h"
#include "collide/convex/support_points.h"
#include "model/kinematics.h"

namespace mjcf_pdg {

// One per thread.
class ConvexDistance {
 public:
  explicit ConvexDistance(const SceneTables& tables);

  // What follows does not depend on the questions before.
  void Forget();

  enum class Answer { kNear, kBeyond, kUnknown };
  // The signed distance of a kept pair [m], in world axes. kBeyond: it is not below `cutoff`.
  Answer Ask(const PosedModel& posed, int pair, double cutoff, SignedGap& gap);

 private:
  using Corner = Simplex::Corner;
  // Points of geom 1 and geom 2 in their own frames: of the geoms wherever these are.
  struct Points {
    Vector3d p1_G, p2_G;
  };
  struct Memory {  // the last simplex
    int size = 0;
    Points corners[4];
  };
  // Geom 2 in the frame of geom 1.
  struct RelativePose {
    Matrix3d R;
    Vector3d t;

    Corner CornerOf(const Points& points) const;  // in the frame of geom 1
    Points PointsOf(const Corner& corner) const;
  };

  Answer AskPlane(const PosedModel& posed, const KeptPair& pair, double cutoff,
                  SignedGap& gap) const;
  // The corner of the geoms' Minkowski difference that is farthest along n.
  Corner Farthest(const KeptPair& pair, const RelativePose& pose, const Vector3d& n) const;
  void RecallSimplex(const RelativePose& pose, const Memory& memory);
  void RememberSimplex(const RelativePose& pose, int pair);
  // How deep the cores overlap, and where; none if the two bounds do not meet.
  std::optional<ExpandingPolytope::Face> Overlap(const RelativePose& pose, const KeptPair& pair);

  const SceneTables& tables_;
  std::vector<char> knows_;       // per kept pair
  std::vector<Memory> memories_;  // per kept pair
  std::vector<int> remembered_;   // those that are not empty
  Simplex simplex_;               // in the frame of geom 1
  ExpandingPolytope polytope_;    // ... around the origin, if that is in the simplex
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_COLLIDE_CONVEX_CONVEX_DISTANCE_H_
