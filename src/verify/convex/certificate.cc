#include "verify/convex/certificate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "verify/convex/direction_search.h"

namespace mjcf_pdg::verify {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Cores that overlap, or are nearer than this share of the pair's size, get their normal from
// Climb: that of the minimum-norm point would be rounding.
constexpr double kNoNormal = 1e-9;
// A global search ends when no direction can reduce the depth by more than this share of it.
constexpr double kShare = 1e-4;
// Accuracy of measured depths, as a share of the pair's size.
constexpr double kMeasured = 1e-10;
// Measure climbs again only from a start whose cosine with the best normal so far is at most the
// first number and whose overlap is at most the second number times the best one. Of random pairs,
// 0.6 % have a depth that is larger by more than 1e-4 of itself for that.
constexpr double kSameBasin = 0.9, kHopeless = 2.0;
// Rounding error of a distance, as a share of the coordinates it is computed from: each is known to
// about 2e-16 of itself, and a few dozen of them enter.
constexpr double kRounding = 1e-14;

// The certificate of two shapes whose cores have this plane: their balls reduce the gap.
Certificate Make(const ConvexPair& pair, const CoreGap& core, Proof proof) {
  Certificate certificate{proof, core.n, core.gap - pair.radii()};
  certificate.p1 = core.a + pair.first.radius * core.n;
  certificate.p2 = core.b - pair.second.radius * core.n;
  return certificate;
}

CoreGap ToCoreGap(const MinimumNorm& found) { return {found.n, found.lower, found.a(), found.b()}; }

// Makes p1 and p2 the shapes' points on the line between the nearest points of the cores; if the
// shapes overlap, one point that both contain, which divides it in the ratio of the balls' radii.
void MarkPoints(const ConvexPair& pair, const MinimumNorm& found, Certificate& certificate) {
  const double share = pair.radii() > 0.0 ? pair.first.radius / pair.radii() : 0.0;
  const Vector3d a = found.a(), b = found.b();
  const double apart = (b - a).norm();
  if (apart > pair.radii() + kNoNormal * pair.size()) {  // the shapes do not overlap
    certificate.p1 = a + pair.first.radius / apart * (b - a);
    certificate.p2 = b - pair.second.radius / apart * (b - a);
    return;
  }
  certificate.p1 = a + share * (b - a);
  certificate.p2 = pair.radii() > 0.0 ? certificate.p1 : b;
}

// Start directions of Climb for cores that overlap: of up to 23 candidates (normals of the
// minimum-norm search, the line of centres, the axes of both frames, the diagonals of a cube),
// those with the greatest gap, best first.
class Starts {
 public:
  Starts(const ConvexPair& pair, const MinimumNorm& found) : pair_(pair) {
    Vector3d n = found.n;
    Consider(found.n);
    if (BallInCorral(found, n) > 0.0) Consider(n);
    if (pair.between.norm() > 0.0) Consider(pair.between.normalized());
    for (int i = 0; i < 3; ++i) {
      for (const double sign : {-1.0, 1.0}) {
        Consider(sign * Vector3d::Unit(i));
        Consider(sign * pair.turn.col(i));
      }
    }
    for (int k = 0; k < 8; ++k) {
      Consider(Vector3d(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1) / std::sqrt(3.0));
    }
  }

  static constexpr int kKept = 3;
  const Vector3d& operator[](int k) const { return best_[k].n; }
  double gap(int k) const { return best_[k].gap; }

 private:
  struct Start {
    Vector3d n = Vector3d::UnitX();
    double gap = -kInfinity;
  };
  void Consider(const Vector3d& n) {
    Start start{n, pair_.CoreGap(n)};
    for (Start& kept : best_) {
      if (start.gap > kept.gap) std::swap(start, kept);
    }
  }
  const ConvexPair& pair_;
  std::array<Start, kKept> best_;
};

}  // namespace

double Rounding(const ConvexPair& pair, double away) { return kRounding * (pair.size() + away); }

Certificate Decide(const ConvexPair& pair, double required, const Vector3d& start) {
  const double bound = required + pair.radii();  // the distance that the cores must keep [m]
  MinimumNormQuestion question;
  question.start = start;
  question.enough = bound;
  question.near = bound;
  const MinimumNorm found = FindMinimumNorm(pair, question);
  if (found.lower >= bound) return Make(pair, ToCoreGap(found), Proof::kPlane);
  Certificate certificate = Make(pair, ToCoreGap(found), Proof::kPoints);
  MarkPoints(pair, found, certificate);
  if (bound > 0.0) {
    if (found.upper() < bound || found.holds_origin) return certificate;
    certificate.proof = Proof::kUnproven;  // within rounding
    return certificate;
  }
  Vector3d n = found.n;
  // A ball about the origin inside the difference shows at least its radius as overlap, whatever
  // the direction.
  if (BallInCorral(found, n) > -bound) return certificate;
  const Starts starts(pair, found);
  CoreGap best{found.n, found.lower, found.a(), found.b()};
  for (int k = 0; k < Starts::kKept; ++k) {
    const CoreGap top = Climb(pair, starts[k], kRoundingOfSize);
    if (k == 0 || top.gap > best.gap) best = top;
    if (best.gap >= bound) return Make(pair, best, Proof::kPlane);
  }
  DirectionSearch search(pair, best, found);
  const bool none = search.AllBelow(bound);
  if (search.best().gap >= bound) return Make(pair, search.best(), Proof::kPlane);
  certificate = Make(pair, search.best(), none ? Proof::kPoints : Proof::kUnproven);
  MarkPoints(pair, found, certificate);
  return certificate;
}

Certificate Measure(const ConvexPair& pair, double cutoff, Search search) {
  MinimumNormQuestion question;
  if (pair.between.norm() > 0.0) question.start = pair.between;
  question.enough = cutoff + pair.radii();
  const MinimumNorm found = FindMinimumNorm(pair, question);
  if (found.upper() > kNoNormal * pair.size()) {
    return Make(pair, ToCoreGap(found), Proof::kPlane);
  }
  const Starts starts(pair, found);
  CoreGap best = Climb(pair, starts[0], kMeasured);
  for (int k = 1; k < Starts::kKept; ++k) {
    if (starts[k].dot(best.n) > kSameBasin || starts.gap(k) < kHopeless * best.gap) continue;
    const CoreGap top = Climb(pair, starts[k], kMeasured);
    if (top.gap > best.gap) best = top;
  }
  if (search == Search::kGlobal) {
    DirectionSearch directions(pair, best, found);
    directions.Maximize(kShare);
    best = directions.best();
  }
  return Make(pair, best, Proof::kPlane);
}

}  // namespace mjcf_pdg::verify
