#include "verify/convex/direction_search.h"

#include <algorithm>
#include <cmath>

namespace mjcf_pdg::verify {
namespace {

// In a step of Climb the cores are moved apart by their overlap, this share of the overlap, and
// this share of the pair's size. With smaller shares Climb takes fewer steps; with larger ones the
// minimum-norm point is better conditioned.
constexpr double kBeyondDepth = 0.05, kBeyondSize = 1e-4;
constexpr int kClimbs = 30;  // most steps of Climb; deep overlaps of round shapes take the most
// Accuracy of the minimum-norm point of Climb's first step, as a share of the pair's size; and that
// of each later step, as a share of the last accuracy and of the last gain, whichever is less.
constexpr double kFirstAccuracy = 1e-4, kFiner = 0.01;
constexpr int kBudget = 4000;  // triangles that a search may bound

// An upper bound of the value of the matrix game M: the least, over convex combinations of the
// columns, of the largest entry. Tried are single columns, two columns where two rows are equal,
// and all three where all rows are equal.
double GameValue(const Matrix3d& M) {
  double value = M.colwise().maxCoeff().minCoeff();
  for (int i = 0; i < 3; ++i) {
    const Vector3d a = M.col(i), b = M.col((i + 1) % 3);
    for (int k = 0; k < 3; ++k) {  // where two rows are equal
      const int l = (k + 1) % 3;
      const double slope = (a[k] - b[k]) - (a[l] - b[l]);
      const double share = (a[k] - a[l]) / slope;  // of b
      if (!(share > 0.0 && share < 1.0)) continue;
      value = std::min(value, (a + share * (b - a)).maxCoeff());
    }
  }
  const Vector3d all(M.col(1).cross(M.col(2)).sum(), M.col(2).cross(M.col(0)).sum(),
                     M.col(0).cross(M.col(1)).sum());
  const Vector3d weights = all / all.sum();  // of the columns, where all rows are equal
  if (weights.minCoeff() > 0.0) value = std::min(value, (M * weights).maxCoeff());
  return value;
}

}  // namespace

CoreGap Climb(const ConvexPair& pair, const Vector3d& n, double accuracy) {
  const DifferencePoint support = pair.Support(n);
  CoreGap best{n, n.dot(support.p), support.a, support.b};
  const double finest = accuracy * pair.size();
  double fine = kFirstAccuracy * pair.size();  // accuracy of the minimum-norm point [m]
  for (int k = 0; k < kClimbs; ++k) {
    const double depth = std::max(-best.gap, 0.0);
    const double apart = depth + kBeyondDepth * depth + kBeyondSize * pair.size();
    MinimumNormQuestion question;
    question.shift = apart * best.n;
    question.start = best.n;
    question.accuracy = fine;
    const MinimumNorm found = FindMinimumNorm(pair, question);
    if (found.holds_origin) break;
    const double gap = found.lower - apart * found.n.dot(best.n);
    const double rise = gap - best.gap;
    // Nearest along found.n where the cores were moved apart along best.n: that the two are one is
    // seen in the last step, which raises nothing.
    best.a = found.a();
    best.b = found.b();
    if (rise > 0.0) {
      best.n = found.n;
      best.gap = gap;
    }
    const double inaccuracy = found.upper() - found.lower;
    if (rise <= finest && (inaccuracy <= finest || fine <= finest)) break;
    fine = std::max(finest, std::min(kFiner * fine, kFiner * std::max(rise, 0.0)));
  }
  return best;
}

DirectionSearch::DirectionSearch(const ConvexPair& pair, const CoreGap& best,
                                 const MinimumNorm& known)
    : pair_(pair), best_(best) {
  for (int k = 0; k < known.count; ++k) Remember(known.corral[k].p);
  Remember(best.b - best.a);
}

void DirectionSearch::Remember(const Vector3d& p) {
  pool_[next_] = p;
  next_ = (next_ + 1) % kPool;
  pooled_ = std::min(pooled_ + 1, kPool);
}

void DirectionSearch::Push(const Vector3d& d0, const Vector3d& d1, const Vector3d& d2, int level) {
  Triangle& triangle = stack_[size_++];
  triangle.d = {d0, d1, d2};
  for (int k = 0; k < 3; ++k) triangle.p[k] = pair_.Support(triangle.d[k]).p;
  triangle.level = level;
}

// If the number returned is negative, no direction of the triangle has a greater gap than it.
double DirectionSearch::UpperBound(const Triangle& triangle) const {
  Matrix3d D, P;
  for (int k = 0; k < 3; ++k) {
    D.row(k) = triangle.d[k];
    P.col(k) = triangle.p[k];
  }
  double bound = GameValue(D * P);
  for (int k = 0; k < pooled_; ++k) bound = std::min(bound, (D * pool_[k]).maxCoeff());
  return bound;
}

// If the triangle's middle is better than best_, climbs from there and returns true.
bool DirectionSearch::LookAtMiddle(const Triangle& triangle) {
  const Vector3d middle = (triangle.d[0] + triangle.d[1] + triangle.d[2]).normalized();
  if (pair_.CoreGap(middle) <= best_.gap) return false;
  best_ = Climb(pair_, middle, kRoundingOfSize);
  Remember(best_.b - best_.a);
  return true;
}

void DirectionSearch::Split(const Triangle& whole) {
  const Triangle t = whole;  // a copy, because Push writes to the stack
  const Vector3d m01 = (t.d[0] + t.d[1]).normalized(), m12 = (t.d[1] + t.d[2]).normalized(),
                 m20 = (t.d[2] + t.d[0]).normalized();
  Push(t.d[0], m01, m20, t.level + 1);
  Push(m01, t.d[1], m12, t.level + 1);
  Push(m20, m12, t.d[2], t.level + 1);
  Push(m01, m12, m20, t.level + 1);
}

// Divides triangles until none can have a direction with a gap of bound() or more. Returns false if
// best_ has reached `enough` [m] or the budget is used up.
template <typename Bound>
bool DirectionSearch::Run(const Bound& bound, double enough) {
  size_ = 0;
  for (int octant = 0; octant < 8; ++octant) {
    const auto axis = [octant](int k) {
      return Vector3d((octant >> k & 1 ? -1.0 : 1.0) * Vector3d::Unit(k));
    };
    Push(axis(0), axis(1), axis(2), 0);
  }
  for (int asked = 0; size_ > 0; ++asked) {
    if (best_.gap >= enough || asked >= kBudget) return false;
    const Triangle triangle = stack_[--size_];
    if (UpperBound(triangle) < bound()) continue;
    if (LookAtMiddle(triangle) && UpperBound(triangle) < bound()) continue;
    if (triangle.level >= kLevels) return false;
    Split(triangle);
  }
  return true;
}

bool DirectionSearch::AllBelow(double bound) {
  return Run([bound] { return bound; }, bound);
}

bool DirectionSearch::Maximize(double share) {
  return Run([this, share] { return std::min(best_.gap - share * best_.gap, 0.0); }, 0.0);
}

}  // namespace mjcf_pdg::verify
