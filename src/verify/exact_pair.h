// The verifier's signed distances of exact pairs: pairs in which a mesh collides as its triangles.
//
// No code of the project is shared with the solver's queries. Two bodies of triangles (meshes,
// boxes, convex hulls) are asked of FCL: its collide, which intersects triangles, and its distance.
// A plane or a round primitive is compared with the mesh's triangles one after the other, by signed
// distances written for this purpose (primitive_distance.h). Whether a mesh is closed, and whether
// a point is inside it, follows from its own triangles, by rays through FCL's tree and winding
// numbers (mesh_solid.h).
//
// Both sides use FCL's trees and its distance of two triangles. Overlaps are found without the
// latter; but that two meshes are as far apart as a clearance requires rests on it on both sides.
//
// Triangles that intersect may only touch, so the depth of an overlap has to be measured. It is
// taken to be the largest of two kinds of numbers: the least translation that separates a pair of
// crossing triangles, and the depth of a point of one body inside the other, which is its shortest
// way out along some directions. Neither is sure to be the whole depth. An overlap is therefore
// permitted only if a translation by what is permitted is found that separates the two bodies.
#ifndef MJCF_PDG_SRC_VERIFY_EXACT_PAIR_H_
#define MJCF_PDG_SRC_VERIFY_EXACT_PAIR_H_

#include <mujoco/mujoco.h>

#include <vector>

#include "verify/verifier_model.h"

namespace mjcf_pdg::verify {

// What is asked of pairs that overlap: the depth with witness points, which is slow. kRough: of
// convex pairs that of a few local searches, in a fraction of the time, which may be too large; of
// exact pairs as kMeasured. kSkipped: of exact pairs only whether they overlap by more than is
// permitted, of convex pairs as kRough.
enum class Depths { kMeasured, kRough, kSkipped };

class ExactPairs {
 public:
  // Overlaps are measured up to a depth of `rest` [m] beyond what is permitted. The model must
  // outlive this object.
  ExactPairs(const VerifierModel& model, double rest) : model_(model), rest_(rest) {}

  // Returns the signed distance [m] of an exact pair at the poses in `posed`, or infinity if it is
  // not below `cutoff` [m]. `permitted` [m] is the overlap that counts as free; an overlap deeper
  // than that by `rest` may come out too shallow. With kSkipped, the depth of two bodies of
  // triangles may be that of a few crossing triangles, and their distance is infinite if they do
  // not overlap. Unless the distance is infinite, `fromto` gets the witness points of geom 1 and
  // geom 2, world axes.
  double Distance(const mjData& posed, const CheckedPair& pair, double cutoff, double permitted,
                  Depths depths, double fromto[6]) const;

 private:
  struct Asked;  // one call of Distance
  struct Side;   // one body of the pair, whose points are looked for inside the other
  double BvhDistance(const Asked& asked, double cutoff) const;
  double BvhOverlap(const Asked& asked) const;
  bool PartedByAMove(const Asked& asked, const std::vector<Vector3d>& ways_W) const;
  double RoundDistance(const Asked& asked, double cutoff) const;
  double Deepest(const Asked& asked, int triangles) const;
  double CommonPoint(const Asked& asked) const;

  const VerifierModel& model_;
  double rest_;  // [m]
};

}  // namespace mjcf_pdg::verify

#endif  // MJCF_PDG_SRC_VERIFY_EXACT_PAIR_H_
