// The point of a convex set that is nearest to the origin, by Wolfe's algorithm.
//
// Source: Wolfe 1976, "Finding the nearest point in a polytope". The set is the Minkowski
// difference of two cores, moved by `shift`; its points come from support functions, one a step.
// Differs from it: the set need not be a polytope; the corral has at most four points, and their
// affine minimizer is found by triple products instead of a triangular factor.
#ifndef MJCF_PDG_SRC_VERIFY_MINIMUM_NORM_H_
#define MJCF_PDG_SRC_VERIFY_MINIMUM_NORM_H_

#include <array>
#include <limits>

#include "verify/convex_shape.h"

namespace mjcf_pdg::verify {

struct MinimumNorm {
  // The best plane seen: n · (p + shift) >= lower for every point p of the difference.
  Vector3d n = Vector3d::UnitX();
  double lower = -std::numeric_limits<double>::infinity();
  // The nearest point found: x = Σ weight (p + shift) over the corral, weights >= 0, Σ = 1.
  Vector3d x = Vector3d::Zero();
  std::array<DifferencePoint, 4> corral = {};  // without shift
  std::array<double, 4> weight = {};
  int count = 0;
  bool holds_origin = false;  // the corral is a tetrahedron about the origin

  double upper() const { return x.norm(); }
  Vector3d a() const;  // the points of the cores that x is the difference of
  Vector3d b() const;
};

struct MinimumNormQuestion {
  Vector3d shift = Vector3d::Zero();
  Vector3d start = Vector3d::UnitX();  // any direction; the nearer to n, the fewer steps
  double enough = std::numeric_limits<double>::infinity();  // stop once lower is that ...
  double near = -1.0;                                       // ... or upper below this ...
  double accuracy = 0.0;  // ... or both are as near each other; 0: as rounding allows
};

MinimumNorm FindMinimumNorm(const ConvexPair& pair, const MinimumNormQuestion& question);

// The radius of the largest ball about the origin in the corral's tetrahedron; 0 where the corral
// does not hold the origin. Of the facet that limits it, `n` is the normal, pointing inwards.
double BallInCorral(const MinimumNorm& found, Vector3d& n);

}  // namespace mjcf_pdg::verify

#endif  // MJCF_PDG_SRC_VERIFY_MINIMUM_NORM_H_
