// Signed distances of convex geoms, starting from what was nearest when last asked.
//
// From one configuration to the next the nearest features hardly change: a farthest point or two
// prove that, where mj_geomDistance starts anew (measured in bench/README.md). Apart, the distance
// of the points found so far is an upper bound and a plane between the geoms gives a lower one;
// overlapping, see expanding_polytope.h. Cores that all but touch have no nearest points to tell a
// normal: it is that of a pose a little aside. Where two bounds do not meet there is no answer.
//
// Source: Gilbert, Johnson, Keerthi: A fast procedure for computing the distance between complex
// objects in three-dimensional space, 1988.
#ifndef MJCF_PDG_SRC_COLLIDE_CONVEX_CONVEX_DISTANCE_H_
#define MJCF_PDG_SRC_COLLIDE_CONVEX_CONVEX_DISTANCE_H_

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
  // What is nearest of two cores, or the foot of their depth, in the frame of geom 1.
  struct Found {
    Corner nearest;
    Vector3d n;       // unit, from geom 1 to geom 2
    double distance;  // signed [m]
  };
  // How near the upper and the lower bound of a distance must come: `gap` and `share` of how far
  // the distance is from `zero`; in the last step `last` of the distance. Lengths in m.
  struct Accuracy {
    double gap, share, zero, last;
  };
  enum class Ending { kFound, kBeyond, kTouching, kUnknown };

  // Continues from simplex_. kBeyond: not below `cutoff` [m]; kTouching: the cores are too near for
  // a direction.
  Ending Search(const RelativePose& pose, const KeptPair& pair, double cutoff,
                const Accuracy& accuracy, Found& found);
  // Where the origin is on the simplex: adds corners until there are four. False where the cores'
  // difference is flat there.
  bool Enclose(const RelativePose& pose, const KeptPair& pair);
  // Of cores whose difference is flat or that are apart by hardly anything.
  Ending SearchTouching(const RelativePose& pose, const KeptPair& pair, Found& found);
  Vector3d WayOut(const RelativePose& pose) const;
  // The corner of the geoms' Minkowski difference that is farthest along n.
  Corner Support(const KeptPair& pair, const RelativePose& pose, const Vector3d& n) const;
  void RecallSimplex(const RelativePose& pose, const Memory& memory);
  void RememberSimplex(const RelativePose& pose, int pair);
  // The depth that no move can undercut, along the normal along which the shortest known move parts
  // the cores. Where the two do not meet, as for deep round bodies, they differ by up to 1e-4 of
  // it. False where the simplex is too flat to begin.
  bool Overlap(const RelativePose& pose, const KeptPair& pair, Found& found);

  const SceneTables& tables_;
  std::vector<char> knows_;       // per kept pair
  std::vector<Memory> memories_;  // per kept pair
  std::vector<int> remembered_;   // those that are not empty
  Simplex simplex_;               // in the frame of geom 1
  ExpandingPolytope polytope_;    // ... around the origin, if that is in the simplex
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_COLLIDE_CONVEX_CONVEX_DISTANCE_H_
