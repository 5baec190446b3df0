// The penetration depth of two cores that overlap: the direction along which the shortest
// translation separates them.
//
// Along a unit vector n the cores keep the gap(n) = min n · p over the points p of their Minkowski
// difference; the greatest gap is their signed distance. It has several local maxima. Climb finds
// one by the proximal point method: each step is a minimum-norm problem of shapes moved apart,
// which is convex. DirectionSearch finds the greatest one, or proves that all are below a bound, by
// branch and bound over spherical triangles. The bound of a triangle: if a point p of the
// difference has d · p <= -t for the three corners d, then n · p <= -t for every unit vector n of
// their cone, since n = Σ c d with c >= 0 and Σ c >= |Σ c d| = 1. Neither GJK nor an expanding
// polytope is used.
#ifndef MJCF_PDG_SRC_VERIFY_CONVEX_DIRECTION_SEARCH_H_
#define MJCF_PDG_SRC_VERIFY_CONVEX_DIRECTION_SEARCH_H_

#include <array>

#include "verify/convex/minimum_norm.h"

namespace mjcf_pdg::verify {

// A plane of two cores, in the frame of the first shape.
struct CoreGap {
  Vector3d n = Vector3d::UnitX();  // unit normal, from the first core to the second
  double gap = 0.0;                // distance of the cores along n, negative: an overlap [m]
  // The points of the first and of the second core that touch last when the second is moved by -gap
  // n.
  Vector3d a = Vector3d::Zero(), b = Vector3d::Zero();
};

// The finest accuracy of Climb that is above rounding, as a share of the pair's size.
inline constexpr double kRoundingOfSize = 1e-14;

// Returns a local maximum of gap(n), sought from the unit vector `n`. `accuracy` is that of the
// gap, as a share of the pair's size. The result's gap is not below that of `n`.
CoreGap Climb(const ConvexPair& pair, const Vector3d& n, double accuracy);

// A global search over all directions. The pair must outlive it.
class DirectionSearch {
 public:
  // `best` is the best plane known so far. The corral of `known`, which may be empty, has points of
  // the difference that help to bound.
  DirectionSearch(const ConvexPair& pair, const CoreGap& best, const MinimumNorm& known);

  // Returns true if every direction is proven to have a gap below `bound` [m], which must not be
  // positive. If false, either best() has reached the bound, or the search has used up its budget.
  bool AllBelow(double bound);
  // Improves best() until no direction is better by more than `share` of its depth. Returns false
  // if the budget is used up before.
  bool Maximize(double share);

  const CoreGap& best() const { return best_; }

 private:
  struct Triangle {
    std::array<Vector3d, 3> d;  // corners: unit vectors
    std::array<Vector3d, 3> p;  // the support points there
    int level = 0;              // how many divisions made it
  };
  static constexpr int kLevels = 40, kPool = 8;  // deepest level; points in the pool

  template <typename Bound>
  bool Run(const Bound& bound, double enough);
  double UpperBound(const Triangle& triangle) const;
  void Split(const Triangle& triangle);
  bool LookAtMiddle(const Triangle& triangle);
  void Remember(const Vector3d& p);
  void Push(const Vector3d& d0, const Vector3d& d1, const Vector3d& d2, int level);

  const ConvexPair& pair_;
  CoreGap best_;
  std::array<Vector3d, kPool> pool_;  // points of the difference that every triangle is tried with
  int pooled_ = 0, next_ = 0;         // how many there are, and the one to be replaced next
  std::array<Triangle, 8 + 3 * kLevels> stack_;  // triangles that are still to be bounded
  int size_ = 0;                                 // of the stack
};

}  // namespace mjcf_pdg::verify

#endif  // MJCF_PDG_SRC_VERIFY_CONVEX_DIRECTION_SEARCH_H_
