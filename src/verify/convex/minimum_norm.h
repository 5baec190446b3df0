// The point of a convex set that is nearest to the origin (minimum-norm point), by Wolfe's
// algorithm. The set is the Minkowski difference of two cores, translated by `shift`.
//
// Source: Wolfe 1976, "Finding the nearest point in a polytope". Its corral is a set of affinely
// independent points whose convex hull contains the nearest point so far. Differs from it:
//   1. The set need not be a polytope: each step asks the support functions for one more point.
//   2. The corral has at most four points, and their affine minimizer is found by triple products
//      instead of a triangular factor.
#ifndef MJCF_PDG_SRC_VERIFY_CONVEX_MINIMUM_NORM_H_
#define MJCF_PDG_SRC_VERIFY_CONVEX_MINIMUM_NORM_H_

#include <array>
#include <limits>

#include "verify/convex/convex_shape.h"

namespace mjcf_pdg::verify {

struct MinimumNorm {
  // The best supporting plane found: n is a unit vector with n · (p + shift) >= lower [m] for every
  // point p of the difference.
  Vector3d n = Vector3d::UnitX();
  double lower = -std::numeric_limits<double>::infinity();
  // The nearest point found: x = Σ weight (p + shift) over the corral, with weights >= 0 that add
  // up to 1.
  Vector3d x = Vector3d::Zero();
  std::array<DifferencePoint, 4> corral = {};  // points of the difference, not translated
  std::array<double, 4> weight = {};
  int count = 0;              // points of the corral
  bool holds_origin = false;  // the corral is a tetrahedron that contains the origin: x is 0

  // Upper bound of the set's distance from the origin [m]; `lower` is a lower bound of it.
  double upper() const { return x.norm(); }
  // The points of the first and of the second core with x = b - a + shift.
  Vector3d a() const;
  Vector3d b() const;
};

struct MinimumNormQuestion {
  Vector3d shift = Vector3d::Zero();
  Vector3d start = Vector3d::UnitX();  // any but zero; the nearer to the final n, the fewer steps
  // The search ends when lower >= enough, or upper < near, or upper - lower <= accuracy [m], or
  // when rounding allows no further progress.
  double enough = std::numeric_limits<double>::infinity();
  double near = -1.0;
  double accuracy = 0.0;
};

// In the frame of the pair's first shape.
MinimumNorm FindMinimumNorm(const ConvexPair& pair, const MinimumNormQuestion& question);

// Returns the radius [m] of the largest ball about the origin inside the corral's tetrahedron, and
// sets `n` to the inward unit normal of the facet that limits it. Returns 0 if the corral does not
// hold the origin. For searches without shift.
double BallInCorral(const MinimumNorm& found, Vector3d& n);

}  // namespace mjcf_pdg::verify

#endif  // MJCF_PDG_SRC_VERIFY_CONVEX_MINIMUM_NORM_H_
