// The GJK search: the distance of two convex shapes from the support points of their Minkowski
// difference.
//
// The points found so far give an upper bound of the distance, and the plane through the last
// support point, normal to the nearest point, gives a lower one. The search ends when the two
// agree.
//
// Source: Gilbert, Johnson, Keerthi: A fast procedure for computing the distance between complex
// objects in three-dimensional space, 1988.
#ifndef MJCF_PDG_SRC_COLLIDE_CONVEX_GJK_H_
#define MJCF_PDG_SRC_COLLIDE_CONVEX_GJK_H_

#include <cmath>

#include "collide/convex/simplex.h"

namespace mjcf_pdg {

// When the upper bound d of the distance counts as found: its excess over the lower bound is at
// most gap + share · |d - zero| or, in the last step that a search may make, last · d. `gap` and
// `zero` are in m. With `zero` the sum of two core radii, |d - zero| is the magnitude of the signed
// distance of the round shapes around the cores.
struct GjkAccuracy {
  double gap = 0.0, share = 0.0, zero = 0.0, last = 0.0;
};

enum class GjkEnding {
  kApart,     // `found` holds the answer
  kBeyond,    // the distance is the cutoff or more, and found.n shows it
  kTouching,  // the shapes are nearer than `too_thin`; at most three corners are left
  kEnclosed,  // the shapes overlap; the simplex is a tetrahedron around the origin
  kUnknown    // did not converge
};

struct GjkNearest {
  Simplex::Corner corner;  // p1 and p2: the witness points
  Eigen::Vector3d n;       // unit normal, from shape 1 to shape 2
  double distance = 0.0;   // [m]
};

// The most steps of one search. Ellipsoids need the most: of 23,000 random pairs with an ellipsoid,
// one does not converge in this many.
inline constexpr int kMaxGjkSteps = 100;

// Searches from the corners in `simplex`, which must not be empty, and leaves the last simplex
// there. `support(n)` is the corner of the Minkowski difference that is farthest along n.
template <typename Support>
GjkEnding Gjk(const Support& support, double too_thin, double cutoff, const GjkAccuracy& accuracy,
              Simplex& simplex, GjkNearest& found) {
  for (int step = 0; step < kMaxGjkSteps; ++step) {
    simplex.KeepClosestSubSimplex();
    if (simplex.size() == 4) return GjkEnding::kEnclosed;
    const Simplex::Corner nearest = simplex.Nearest();
    const double between = nearest.x.norm();
    if (between < too_thin) return GjkEnding::kTouching;
    simplex.Add(support(-nearest.x));
    // The plane normal to nearest.x through the new corner separates the shapes: a lower bound.
    const double at_least = simplex.Last().dot(nearest.x) / between;
    const bool last = step + 1 == kMaxGjkSteps;
    const double wanted = last ? accuracy.last * between
                               : accuracy.gap + accuracy.share * std::abs(between - accuracy.zero);
    const bool beyond = at_least >= cutoff;
    if (!beyond && between - at_least > wanted) continue;
    simplex.DropLast();
    found = {nearest, -nearest.x / between, between};
    return beyond ? GjkEnding::kBeyond : GjkEnding::kApart;
  }
  return GjkEnding::kUnknown;
}

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_COLLIDE_CONVEX_GJK_H_
