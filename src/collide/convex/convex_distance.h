// The narrow phase for convex geoms: signed distance, witness points and normal of one kept pair.
// ContactFinder (collide/contacts.h) asks it.
//
// The search is the GJK algorithm on the Minkowski difference of the two cores (support_points.h):
// geom 1 minus geom 2, in the frame of geom 1. Each search starts from the simplex that the last
// search of the same pair ended with. Between close configurations that simplex hardly changes, so
// one or two support points are enough to confirm it, while mj_geomDistance starts anew each time
// (measured in bench/README.md). If the cores overlap, the penetration depth comes from the
// expanding polytope algorithm. If the cores nearly touch, their nearest points are too close to
// define a normal; the normal is then the one found with geom 2 shifted a little.
//
// Source: see gjk.h; for overlaps, expanding_polytope.h.
#ifndef MJCF_PDG_SRC_COLLIDE_CONVEX_CONVEX_DISTANCE_H_
#define MJCF_PDG_SRC_COLLIDE_CONVEX_CONVEX_DISTANCE_H_

#include <vector>

#include "base/relative_pose.h"
#include "base/signed_gap.h"
#include "collide/convex/expanding_polytope.h"
#include "collide/convex/gjk.h"
#include "collide/convex/simplex.h"
#include "collide/convex/support_points.h"
#include "model/kinematics.h"

namespace mjcf_pdg {

// Not thread-safe, since it remembers a simplex per pair: use one object per thread.
class ConvexDistance {
 public:
  // `tables` must outlive this object.
  explicit ConvexDistance(const SceneTables& tables);

  // Drops the remembered simplices, so that later answers do not depend on earlier questions.
  void Forget();

  // kNear: `gap` holds the answer. kBeyond: the distance is `cutoff` or more. kUnknown: one of the
  // geoms is of a type without support points (SDF, height field) or the search did not converge.
  enum class Answer { kNear, kBeyond, kUnknown };
  // Measures the signed distance of SceneTables::pairs[pair] at the pose in `posed`: the geoms'
  // Euclidean distance if they are apart, minus their penetration depth if they overlap. Meshes
  // count as their convex hulls; geom 1 may be a plane. `cutoff` is in m. `gap` (in the world frame
  // W) is valid only after kNear.
  Answer Ask(const PosedModel& posed, int pair, double cutoff, SignedGap& gap);

 private:
  using Corner = Simplex::Corner;
  // A point of core 1 in the frame of geom 1 and a point of core 2 in the frame of geom 2. They
  // stay points of the cores when the geoms move.
  struct Points {
    Vector3d p1_G, p2_G;
  };
  // The simplex with which the last search of a pair ended.
  struct Memory {
    int pair = 0, size = 0;
    Points corners[4];
  };
  // Poses are those of geom 2's frame in the frame of geom 1, which corners are in.
  static Corner CornerOf(const RelativePose& pose, const Points& points);
  static Points PointsOf(const RelativePose& pose, const Corner& corner);

  // As Ask, for a pair whose geom 1 is a plane: one support point of geom 2 gives the distance.
  Answer AskPlane(const PosedModel& posed, const KeptPair& pair, double cutoff,
                  SignedGap& gap) const;
  // The signed distance of two cores, in the frame of geom 1; negative: minus their penetration
  // depth.
  using Found = GjkNearest;
  // How a search ended. kFound: `found` holds the answer. kBeyond: the cores' distance is the
  // cutoff or more. kTouching: the cores are too close for a normal, and no polytope around the
  // origin was found. kUnknown: it did not converge.
  enum class Ending { kFound, kBeyond, kTouching, kUnknown };

  // GJK from the corners in simplex_, or from a first support point if it is empty. Leaves the last
  // simplex there. `cutoff` applies to the distance of the cores [m].
  Ending Search(const RelativePose& pose, const KeptPair& pair, double cutoff,
                const GjkAccuracy& accuracy, Found& found);
  // If the origin lies on a simplex of fewer than four corners, adds support points until simplex_
  // is a tetrahedron. Whether the origin is inside is for ExpandingPolytope::Start to tell. Returns
  // false if the Minkowski difference is too flat for a tetrahedron (two parallel segments, say).
  bool Enclose(const RelativePose& pose, const KeptPair& pair);
  // The second attempt, after Search ended with kTouching or kUnknown: takes the normal from a pose
  // with geom 2 shifted a little, and the distance along that normal at the real pose. Returns
  // kFound or kUnknown; overwrites simplex_.
  Ending SearchTouching(const RelativePose& pose, const KeptPair& pair, Found& found);
  // A unit direction, in the frame of geom 1, in which to shift geom 2 off geom 1.
  Vector3d Aside(const RelativePose& pose) const;
  // The support point of the cores' Minkowski difference: the corner farthest along n.
  Corner Support(const KeptPair& pair, const RelativePose& pose, const Vector3d& n) const;
  void RecallSimplex(const RelativePose& pose, int pair);
  void RememberSimplex(const RelativePose& pose, int pair);
  // The penetration depth of overlapping cores, by a polytope that grows from the tetrahedron in
  // simplex_. The depth is the polytope's lower bound: no shorter translation separates the cores.
  // The normal is the direction of the shortest separating translation found. The lengths of the
  // two agree to kMeet and kMeetShare where the search converges; for deeply overlapping round
  // geoms they may differ by 1e-4 of the depth. Returns false if the tetrahedron is too flat or
  // does not contain the origin.
  bool Overlap(const RelativePose& pose, const KeptPair& pair, Found& found);

  const SceneTables& tables_;
  std::vector<char> knows_;       // per kept pair: Ask can measure geoms of these types
  std::vector<int> memory_of_;    // per kept pair: index into memories_; -1: none
  std::vector<Memory> memories_;  // of the pairs that were searched since Forget
  Simplex simplex_;               // of the search under way, in the frame of geom 1
  ExpandingPolytope polytope_;    // scratch of Overlap
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_COLLIDE_CONVEX_CONVEX_DISTANCE_H_
