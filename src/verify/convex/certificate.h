// Decides whether the signed distance of two convex geoms is at least a required value, and proves
// the answer.
//
// "Yes" is proven by a plane: a unit normal n from geom 1 to geom 2 along which the geoms are that
// far apart, or overlap by no more than is permitted. "No" is proven by points. Where the cores
// must be apart, they are a point of each core, nearer to each other than required. Where the cores
// may overlap, they are points of the Minkowski difference that show, for every direction, a larger
// overlap. Both proofs are values of support functions and are checked by dot products; how they
// are found (minimum-norm points, branch and bound over the sphere of directions) is no part of the
// proof. Where neither is found, the answer is "unproven".
#ifndef MJCF_PDG_SRC_VERIFY_CONVEX_CERTIFICATE_H_
#define MJCF_PDG_SRC_VERIFY_CONVEX_CERTIFICATE_H_

#include "verify/convex/minimum_norm.h"

namespace mjcf_pdg::verify {

enum class Proof {
  kPlane,    // the distance is at least the required one
  kPoints,   // it is less
  kUnproven  // neither could be shown
};

// In the frame of the first shape; lengths in m.
struct Certificate {
  Proof proof = Proof::kUnproven;
  // The best plane found: n · (p2 - p1) >= gap for all points p1 of geom 1 and p2 of geom 2, so
  // that `gap` is a lower bound of the signed distance.
  Vector3d n = Vector3d::UnitX();
  double gap = 0.0;
  // Witness points of geom 1 and geom 2: the nearest points found if the geoms are apart. If they
  // overlap and `proof` is kPoints, both are a common point, equal but for rounding.
  Vector3d p1 = Vector3d::Zero(), p2 = Vector3d::Zero();
};

// Decides whether the pair's signed distance is at least `required` [m]; a negative value permits
// an overlap. `start` is the direction to try first, in the frame of the first shape; it must not
// be zero. The search ends when the question is decided, so `gap` says little about the distance.
Certificate Decide(const ConvexPair& pair, double required, const Vector3d& start);

// How Measure searches for the depth of an overlap. kLocal takes the best of a few local minima of
// the overlap, so the depth may come out too large. kGlobal goes on until no direction is better by
// more than 1e-4 of the depth, or its budget is used up.
enum class Search { kLocal, kGlobal };

// Measures the signed distance of the pair: `gap` is the distance, p1 and p2 are the witness
// points, `proof` is kPlane. If the shapes are farther apart than `cutoff` [m], `gap` may be any
// number between `cutoff` and their distance.
Certificate Measure(const ConvexPair& pair, double cutoff, Search search);

// The length below which distances of the pair are rounding errors [m]. `away` is the distance of
// the pair from the world's origin [m].
double Rounding(const ConvexPair& pair, double away);

}  // namespace mjcf_pdg::verify

#endif  // MJCF_PDG_SRC_VERIFY_CONVEX_CERTIFICATE_H_
