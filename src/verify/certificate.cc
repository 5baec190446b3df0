#include "verify/certificate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "verify/direction_search.h"

namespace mjcf_pdg::verify {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Cores nearer than this share of the pair's size, or overlapping, have their normal from Climb.
constexpr double kTouching = 1e-9;
constexpr double kShare = 1e-4;  // of a depth: how much better another direction may be
// Depths are measured to that, as a share of the pair's size.
constexpr double kMeasured = 1e-10;
// A second climb is not worth its time from a start that near the first one's end (cosine), or with
// that many times its overlap: of random pairs, 0.6 % of the depths get worse by more than 1e-4.
constexpr double kSameBasin = 0.9, kHopeless = 2.0;
// Coordinates are known to about 2e-16 of themselves; a distance is made of a few dozen of them.
constexpr double kRounding = 1e-14;

Certificate Make(const ConvexPair& pair, const CoreGap& core, Proof proof) {
  Certificate certificate{proof, core.n, core.gap - pair.radii()};
  certificate.p1 = core.a + pair.first.radius * core.n;
  certificate.p2 = core.b - pair.second.radius * core.n;
  return certificate;
}

CoreGap ToCoreGap(const MinimumNorm& found) { return {found.n, found.lower, found.a(), found.b()}; }

// Cores overlap, or the rolling balls do: the point between the cores' nearest ones, in both shapes
// as the balls there tell.
void MarkCommonPoint(const ConvexPair& pair, const MinimumNorm& found, Certificate& certificate) {
  const double share = pair.radii() > 0.0 ? pair.first.radius / pair.radii() : 0.0;
  const Vector3d a = found.a(), b = found.b();
  const double apart = (b - a).norm();
  if (apart > pair.radii() + kTouching * pair.size()) return;  // the shapes do not overlap
  certificate.p1 = a + share * (b - a);
  certificate.p2 = pair.radii() > 0.0 ? certificate.p1 : b;
}

// Directions worth a climb where cores overlap: those in which the least overlap is likely.
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
  const double bound = required + pair.radii();  // what the cores must keep
  MinimumNormQuestion question;
  question.start = start;
  question.enough = bound;
  question.near = bound;
  const MinimumNorm found = FindMinimumNorm(pair, question);
  if (found.lower >= bound) return Make(pair, ToCoreGap(found), Proof::kPlane);
  Certificate certificate = Make(pair, ToCoreGap(found), Proof::kPoints);
  MarkCommonPoint(pair, found, certificate);
  if (bound > 0.0) {
    if (found.upper() < bound || found.holds_origin) return certificate;
    certificate.proof = Proof::kUnproven;  // within rounding
    return certificate;
  }
  Vector3d n = found.n;
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
  MarkCommonPoint(pair, found, certificate);
  return certificate;
}

Certificate Measure(const ConvexPair& pair, double cutoff, Search search) {
  MinimumNormQuestion question;
  if (pair.between.norm() > 0.0) question.start = pair.between;
  question.enough = cutoff + pair.radii();
  const MinimumNorm found = FindMinimumNorm(pair, question);
  if (found.upper() > kTouching * pair.size()) {
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
