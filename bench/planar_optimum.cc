#include "planar_optimum.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mjcf_pdg::bench {
namespace {

constexpr int kSamples = 300;      // samples of the angle, and of the direction, as in the paper
constexpr int kAlong = 24;         // steps along a shift in which the first free pose is sought
constexpr int kBisections = 30;    // most bisections between the last colliding and that pose
constexpr int kRefinements = 8;    // most finer grids, each with a fifth of the step before
constexpr int kRefined = 20;       // steps of a finer grid in each of its two dimensions
constexpr double kSettled = 1e-3;  // relative fall of σ at which the grids are fine enough

// The least σ of a free pose as a function of the angle and of the direction of the shift.
class Shifts {
 public:
  explicit Shifts(Workspace& work) : work_(work) {}

  // The least σ < `best` of a free pose with this angle and direction; infinite if there is none.
  double Least(double angle, double direction, double best) {
    angle_ = angle;
    const double turned = SigmaAt(direction, 0.0);
    if (turned >= best) return std::numeric_limits<double>::infinity();
    const double farthest = std::sqrt(best - turned);  // σ of a shift is its square [m]
    double low = 0.0, high = -1.0;
    for (int k = 0; k <= kAlong && high < 0.0; ++k) {
      const double shift = farthest * k / kAlong;
      (Free(direction, shift) ? high : low) = shift;
    }
    if (high < 0.0) return std::numeric_limits<double>::infinity();
    for (int k = 0; k < kBisections && high - low > 1e-7; ++k) {
      const double middle = 0.5 * (low + high);
      (Free(direction, middle) ? high : low) = middle;
    }
    return SigmaAt(direction, high);
  }

  int queries() const { return queries_; }

 private:
  VectorXd At(double direction, double shift) const {
    return work_.problem().q_in +
           Vector3d(shift * std::cos(direction), shift * std::sin(direction), angle_);
  }
  double SigmaAt(double direction, double shift) { return work_.norm.Sigma(At(direction, shift)); }
  bool Free(double direction, double shift) {
    ++queries_;
    return work_.Free(At(direction, shift));
  }

  Workspace& work_;
  double angle_ = 0.0;
  int queries_ = 0;
};

}  // namespace

PlanarOptimum BruteForcePlanar(Workspace& work) {
  Shifts shifts(work);
  PlanarOptimum best;
  best.sigma = std::numeric_limits<double>::infinity();
  double angle = 0.0, direction = 0.0;
  auto ask = [&](double a, double d) {
    const double start = std::isfinite(best.sigma) ? best.sigma : 4.0;
    const double sigma = shifts.Least(a, d, start);
    if (sigma >= best.sigma) return;
    best.sigma = sigma;
    angle = a;
    direction = d;
  };
  // Small angles come first, because most large angles alone cost more than the best σ then known.
  for (int i = 0; i < kSamples; ++i) {
    const double a = (i % 2 ? 1 : -1) * ((i + 1) / 2) * 2.0 * mjPI / kSamples;
    for (int k = 0; k < kSamples; ++k) ask(a, 2.0 * mjPI * k / kSamples);
  }
  double step = 2.0 * mjPI / kSamples;
  for (int level = 0; level < kRefinements; ++level) {
    const double before = best.sigma, a = angle, d = direction;
    for (int i = -kRefined / 2; i <= kRefined / 2; ++i) {
      for (int k = -kRefined / 2; k <= kRefined / 2; ++k) {
        ask(a + i * 0.2 * step, d + k * 0.2 * step);
      }
    }
    best.error = 1.0 - best.sigma / before;
    if (level > 0 && best.error < kSettled) break;
    step *= 0.2;
  }
  best.queries = shifts.queries();
  return best;
}

}  // namespace mjcf_pdg::bench
