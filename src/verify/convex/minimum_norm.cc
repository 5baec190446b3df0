#include "verify/convex/minimum_norm.h"

#include <algorithm>
#include <cmath>

namespace mjcf_pdg::verify {
namespace {

// The search has converged when lower and upper bound differ by this share of the pair's size.
// Rounding of doubles alone makes about 1e-16, and the products of lengths below a few times that.
// A weight below this number counts as zero.
constexpr double kConverged = 1e-14;
// Most steps of a search. Polytopes need 4 to 15, round shapes 10 to 40, ellipsoids of aspect 1000
// about 150.
constexpr int kSteps = 300;

// Sets `w` to the weights of the affine minimizer: the point nearest to the origin of the affine
// hull of the first `count` points. Returns false if these are affinely dependent.
bool AffineMinimizer(const std::array<Vector3d, 4>& p, int count, std::array<double, 4>& w) {
  if (count == 1) {
    w[0] = 1.0;
    return true;
  }
  // Products of edges from p[0] are accurate where products of the points themselves would cancel:
  // near the end the points are much closer to each other than to the origin.
  const Vector3d e1 = p[1] - p[0];
  w = {1.0, 0.0, 0.0, 0.0};
  if (count == 2) {
    w[1] = -e1.dot(p[0]) / e1.squaredNorm();
  } else if (count == 3) {
    const Vector3d e2 = p[2] - p[0], N = e1.cross(e2);
    const double area2 = N.squaredNorm();
    w[1] = N.dot(e2.cross(p[0])) / area2;
    w[2] = N.dot(p[0].cross(e1)) / area2;
  } else {
    const Vector3d e2 = p[2] - p[0], e3 = p[3] - p[0];
    const double volume = e1.cross(e2).dot(e3);
    w[1] = -p[0].dot(e2.cross(e3)) / volume;
    w[2] = -p[0].dot(e3.cross(e1)) / volume;
    w[3] = -p[0].dot(e1.cross(e2)) / volume;
  }
  w[0] = 1.0 - w[1] - w[2] - w[3];
  return std::all_of(w.begin(), w.end(), [](double v) { return std::isfinite(v); });
}

class Wolfe {
 public:
  Wolfe(const ConvexPair& pair, const MinimumNormQuestion& question)
      : pair_(pair),
        question_(question),
        rounding_(std::max(kConverged * pair.size(), question.accuracy)) {}

  MinimumNorm Run() {
    Ask(question_.start.normalized());
    Add(candidate_);
    found_.weight[0] = 1.0;
    found_.x = moved_[0];
    for (int step = 0; step < kSteps && !Ends(); ++step) {
      const double before = found_.upper();
      Ask(found_.x / before);
      if (found_.lower >= question_.enough || found_.lower >= before - rounding_) break;
      if (Known()) break;
      Add(candidate_);
      if (!MinorCycles() || !(found_.upper() < before)) break;
    }
    return found_;
  }

 private:
  bool Ends() const {
    return found_.holds_origin || found_.lower >= question_.enough ||
           found_.upper() < question_.near || !(found_.upper() > rounding_);
  }

  // Makes candidate_ the support point along n, and keeps its plane if that is the best so far.
  void Ask(const Vector3d& n) {
    candidate_ = pair_.Support(n);
    const double lower = n.dot(candidate_.p + question_.shift);
    if (lower <= found_.lower) return;
    found_.lower = lower;
    found_.n = n;
  }

  // True if the corral has the candidate already: no step makes progress.
  bool Known() const {
    return std::any_of(found_.corral.begin(), found_.corral.begin() + found_.count,
                       [&](const DifferencePoint& known) { return known.p == candidate_.p; });
  }

  void Add(const DifferencePoint& point) {
    found_.corral[found_.count] = point;
    found_.weight[found_.count] = 0.0;
    moved_[found_.count++] = point.p + question_.shift;
  }

  void Drop(int k) {
    const int last = --found_.count;
    found_.corral[k] = found_.corral[last];
    found_.weight[k] = found_.weight[last];
    moved_[k] = moved_[last];
  }

  // Wolfe's minor cycles: moves x towards the affine minimizer of the corral and drops the points
  // whose weights reach zero, until the affine minimizer lies in the corral's convex hull. Returns
  // false if the corral is degenerate.
  bool MinorCycles() {
    for (;;) {
      const int count = found_.count;
      std::array<double, 4> w = {};
      if (!AffineMinimizer(moved_, count, w)) break;
      double stay = 1.0;  // largest share of the way to w that keeps all weights >= 0
      for (int k = 0; k < count; ++k) {
        if (w[k] < 0.0) stay = std::min(stay, found_.weight[k] / (found_.weight[k] - w[k]));
      }
      for (int k = 0; k < count; ++k) found_.weight[k] += stay * (w[k] - found_.weight[k]);
      if (stay == 1.0) {
        found_.holds_origin = count == 4;
        Place();
        return true;
      }
      int dropped = 0;
      for (int k = count - 1; k >= 0; --k) {
        if (w[k] >= 0.0 || found_.weight[k] > kConverged) continue;
        Drop(k);
        ++dropped;
      }
      if (dropped == 0 || found_.count == 0) break;
    }
    if (found_.count > 0) Place();
    return false;
  }

  // Makes the weights add up to 1, and x their point.
  void Place() {
    double sum = 0.0;
    for (int k = 0; k < found_.count; ++k) sum += found_.weight[k];
    found_.x.setZero();
    for (int k = 0; k < found_.count; ++k) {
      found_.weight[k] /= sum;
      found_.x += found_.weight[k] * moved_[k];
    }
  }

  const ConvexPair& pair_;
  const MinimumNormQuestion& question_;
  const double rounding_;
  std::array<Vector3d, 4> moved_;  // the points of the corral, translated by the shift
  DifferencePoint candidate_;
  MinimumNorm found_;
};

}  // namespace

Vector3d MinimumNorm::a() const {
  Vector3d sum = Vector3d::Zero();
  for (int k = 0; k < count; ++k) sum += weight[k] * corral[k].a;
  return sum;
}

Vector3d MinimumNorm::b() const {
  Vector3d sum = Vector3d::Zero();
  for (int k = 0; k < count; ++k) sum += weight[k] * corral[k].b;
  return sum;
}

MinimumNorm FindMinimumNorm(const ConvexPair& pair, const MinimumNormQuestion& question) {
  return Wolfe(pair, question).Run();
}

double BallInCorral(const MinimumNorm& found, Vector3d& n) {
  if (!found.holds_origin) return 0.0;
  double radius = std::numeric_limits<double>::infinity();
  for (int apex = 0; apex < 4; ++apex) {
    const Vector3d& p = found.corral[(apex + 1) % 4].p;
    const Vector3d& q = found.corral[(apex + 2) % 4].p;
    const Vector3d& r = found.corral[(apex + 3) % 4].p;
    Vector3d inwards = (q - p).cross(r - p);
    if (!(inwards.norm() > 0.0)) return 0.0;
    inwards.normalize();
    if (inwards.dot(found.corral[apex].p - p) < 0.0) inwards = -inwards;
    const double offset = -inwards.dot(p);
    if (offset >= radius) continue;
    radius = offset;
    n = inwards;
  }
  return std::max(radius, 0.0);
}

}  // namespace mjcf_pdg::verify
