// The direction along which two cores that overlap are parted by the shortest move.
//
// gap(n) = min n · p over the points p of the Minkowski difference has local maxima on the sphere.
// Climb finds one: the proximal point method, each step a minimum-norm problem of shapes moved
// apart, which is convex. DirectionSearch finds the greatest, or proves that none is as great as a
// bound: branch and bound over spherical triangles. A point p that has d · p <= -t for the three
// corners d of a triangle has n · p <= -t for every unit vector n of its cone, since n = Σ c d with
// c >= 0 and Σ c >= |Σ c d| = 1. Nothing of GJK or of an expanding polytope.
#ifndef MJCF_PDG_SRC_VERIFY_DIRECTION_SEARCH_H_
#define MJCF_PDG_SRC_VERIFY_DIRECTION_SEARCH_H_

#include <array>

#include "verify/minimum_norm.h"

namespace mjcf_pdg::verify {

// A plane along which cores keep `gap` [m], and the points at which they would touch last.
struct CoreGap {
  Vector3d n = Vector3d::UnitX();
  double gap = 0.0;
  Vector3d a = Vector3d::Zero(), b = Vector3d::Zero();
};

// As near as a plane can be found, as a share of the pair's size.
inline constexpr double kRoundingOfSize = 1e-14;

// A local maximum of gap(n), from n (unit), to `accuracy` of the pair's size; never below gap(n).
CoreGap Climb(const ConvexPair& pair, const Vector3d& n, double accuracy);

class DirectionSearch {
 public:
  // `best`: what is known; `known`: points of the difference, if some are.
  DirectionSearch(const ConvexPair& pair, const CoreGap& best, const MinimumNorm& known);

  // True where every direction is shown to have a gap below `bound` (<= 0). If false, best() may
  // have reached the bound; else the budget is used up.
  bool AllBelow(double bound);
  // Improves best() until no direction is better by more than `share` of its depth; false where the
  // budget is used up before.
  bool Maximize(double share);

  const CoreGap& best() const { return best_; }

 private:
  struct Triangle {
    std::array<Vector3d, 3> d;  // corners: unit vectors
    std::array<Vector3d, 3> p;  // the support points there
    int level = 0;
  };
  static constexpr int kLevels = 40, kPool = 8;

  template <typename Bound>
  bool Run(const Bound& bound, double enough);
  double UpperBound(const Triangle& triangle) const;
  void Split(const Triangle& triangle);
  bool LookAtMiddle(const Triangle& triangle);
  void Remember(const Vector3d& p);
  void Push(const Vector3d& d0, const Vector3d& d1, const Vector3d& d2, int level);

  const ConvexPair& pair_;
  CoreGap best_;
  std::array<Vector3d, kPool> pool_;  // points that often bound
  int pooled_ = 0, next_ = 0;
  std::array<Triangle, 8 + 3 * kLevels> stack_;
  int size_ = 0;
};

}  // namespace mjcf_pdg::verify

#endif  // MJCF_PDG_SRC_VERIFY_DIRECTION_SEARCH_H_
