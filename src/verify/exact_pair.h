// The independent check's word on pairs in which a mesh collides as its triangles.
//
// Shares no code of ours with the solver's queries. Meshes, boxes and convex hulls: FCL's own
// collide (its triangle intersection) and distance. Planes and round primitives: every triangle in
// turn, with signed distances of their own. What is inside a mesh, and whether it is closed: its
// own triangles, rays through FCL's tree, by winding.
//
// Shared are FCL's fitting of trees and its distance of two triangles. Overlaps are found without
// the latter; that two meshes are as far apart as a clearance asks for rests on it on both sides.
//
// Triangles that intersect may only touch. How deep: the least move that parts two of them, the
// largest over the pairs of triangles, or the depth of a vertex inside, the shortest way out along
// some directions. None of these is sure to be the whole depth, so an overlap is permitted only if
// a move by what is permitted is found that parts the two meshes.
#ifndef MJCF_PDG_SRC_VERIFY_EXACT_PAIR_H_
#define MJCF_PDG_SRC_VERIFY_EXACT_PAIR_H_

#include <mujoco/mujoco.h>

#include <vector>

#include "verify/verifier_model.h"

namespace mjcf_pdg::verify {

// What is asked of an exact pair: its distance or depth and where, which is slow, or only whether
// it overlaps by more than is permitted.
enum class Depths { kMeasured, kSkipped };

class ExactPairs {
 public:
  // `rest`: how much deeper than is permitted depths are of interest [m].
  ExactPairs(const VerifierModel& model, double rest) : model_(model), rest_(rest) {}

  // Signed distance of an exact pair [m] at the pose, below `cutoff`; infinite if it is not.
  // `permitted`: an overlap that counts as free [m]. One that is deeper by `rest` ends the search
  // for deeper places. With skipped depths, two meshes that overlap get what some crossing
  // triangles tell, and two that are apart are infinitely so. `fromto`: the points on geom 1 and
  // geom 2.
  double Distance(const mjData& posed, const CheckedPair& pair, double cutoff, double permitted,
                  Depths depths, double fromto[6]) const;

 private:
  struct Asked;
  struct Side;
  double BvhDistance(const Asked& asked, double cutoff) const;
  double BvhOverlap(const Asked& asked) const;
  bool PartedByAMove(const Asked& asked, const std::vector<Vector3d>& ways_W) const;
  double RoundDistance(const Asked& asked, double cutoff) const;
  double Deepest(const Asked& asked, int triangles) const;
  double CommonPoint(const Asked& asked) const;

  const VerifierModel& model_;
  double rest_;
};

}  // namespace mjcf_pdg::verify

#endif  // MJCF_PDG_SRC_VERIFY_EXACT_PAIR_H_
