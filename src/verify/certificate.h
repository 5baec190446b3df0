// Is the signed distance of two convex geoms at least so much? Answers that prove themselves.
//
// "Yes" comes with a plane: a unit vector n from geom 1 to geom 2 along which they are that far
// apart, or overlap by no more. "No" comes with points: two of the cores nearer than that, or, of
// an overlap that is permitted, for every direction a point of the Minkowski difference that shows
// more. Planes and points come from support functions, and dot products check them; how they are
// found (minimum-norm points, branch and bound over the sphere of directions) is no part of the
// proof. Where neither is found, the answer is "unproven".
#ifndef MJCF_PDG_SRC_VERIFY_CERTIFICATE_H_
#define MJCF_PDG_SRC_VERIFY_CERTIFICATE_H_

#include "verify/minimum_norm.h"

namespace mjcf_pdg::verify {

enum class Proof { kPlane, kPoints, kUnproven };

// Frame of the first shape; lengths in m.
struct Certificate {
  Proof proof = Proof::kUnproven;
  // The best plane found: the signed distance is at least `gap`, n · (p2 - p1) >= gap for all
  // points p1 of geom 1 and p2 of geom 2.
  Vector3d n = Vector3d::UnitX();
  double gap = 0.0;
  // Points of geom 1 and geom 2. Where they are apart, the nearest; where they overlap and proof is
  // by points, a common point as each shape has it, the same but for rounding.
  Vector3d p1 = Vector3d::Zero(), p2 = Vector3d::Zero();
};

// Is the pair's signed distance at least `required` (negative: an overlap that is permitted)?
// `gap` is no measure of how deep an overlap is. `start`: a direction to try first.
Certificate Decide(const ConvexPair& pair, double required, const Vector3d& start);

enum class Search { kLocal, kGlobal };

// The signed distance itself: `gap` is it, or the best that several ascents found where the shapes
// overlap. Globally: searched until no direction is better by more than 1e-4 of the depth, or the
// budget is used up. p1 and p2 are the witness points. Shapes farther apart than `cutoff` may get
// a gap between that and their distance.
Certificate Measure(const ConvexPair& pair, double cutoff, Search search);

// Lengths that are rounding for the pair [m]; `away`: how far from the world's origin it is [m].
double Rounding(const ConvexPair& pair, double away);

}  // namespace mjcf_pdg::verify

#endif  // MJCF_PDG_SRC_VERIFY_CERTIFICATE_H_
