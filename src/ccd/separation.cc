#include "ccd/separation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "collide/terrain/on_terrain.h"

namespace mjcf_pdg {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kMaxRootSteps = 10;
// A height field counts as the hull of at most so many prisms: of more it would prove little.
constexpr int kMostPrisms = 256;
constexpr double kRootRatio = 0.8;  // a step this close to the largest one is good enough

// The largest h in [0, horizon] found with f(h) >= 0, for a concave f. A chord of a concave
// function lies below it, so a chord's zero is always on the safe side.
template <typename Function>
double ConcaveRoot(const Function& f, double horizon) {
  double low = 0.0, f_low = f(0.0);
  if (!(f_low >= 0.0)) return 0.0;
  double high = horizon, f_high = f(horizon);
  if (f_high >= 0.0) return horizon;
  for (int i = 0; i < kMaxRootSteps && low < kRootRatio * high; ++i) {
    if (!(f_high > -kInfinity)) return 0.0;
    const double chord = low + (high - low) * f_low / (f_low - f_high);
    const double middle = low > 0.0 ? std::sqrt(low * high) : std::sqrt(chord * high);
    const double h = i % 2 == 0 ? chord : middle;
    if (!(h > low && h < high)) break;
    const double value = f(h);
    if (value >= 0.0) {
      low = h;
      f_low = value;
    } else {
      high = h;
      f_high = value;
    }
  }
  return low;
}

}  // namespace

double Separation::Support(const PosedModel& posed, int geom, const Vector3d& direction_W) const {
  return CoreSupport(posed, geom, direction_W) +
         CoreRadius(*posed.model(), geom) * direction_W.norm();
}

double Separation::CoreSupport(const PosedModel& posed, int geom,
                               const Vector3d& direction_W) const {
  const double at_center = direction_W.dot(AsVector(posed.data()->geom_xpos + 3 * geom));
  const Vector3d u = AsMatrix(posed.data()->geom_xmat + 9 * geom).transpose() * direction_W;
  if (support_.Knows(geom)) return at_center + u.dot(support_.Support(geom, u));
  // A plane is a half space, bounded only along its own normal; others are not convex.
  const bool plane = posed.model()->geom_type[geom] == mjGEOM_PLANE;
  const bool bounded = plane && u.z() > 0.0 && u.head<2>().norm() <= 1e-14 * u.z();
  return bounded ? at_center : kInfinity;
}

double Separation::Distance(const PosedModel& posed, int geom1, int geom2,
                            const Vector3d& n_W) const {
  return -Support(posed, geom2, -n_W) - Support(posed, geom1, n_W);
}

// Whether there are few enough prisms within `reach` [m] of the pair's geom 2; prisms_ are these.
bool Separation::CollectTerrain(const PosedModel& posed, const KeptPair& pair, double reach) {
  const OnTerrain on(tables_, posed, pair);
  const double beyond = reach + on.radius();
  const CellRange cells = on.CellsNear(Vector3d::Zero(), beyond);
  if (cells.rows() > kMostPrisms || cells.cols() > kMostPrisms / std::max(1, cells.rows())) {
    return false;
  }
  on.CollectPrisms(cells, Vector3d::Zero(), beyond, prisms_);
  for (NearPrism& near : prisms_) near.prism = on.InField(near.prism);
  return true;
}

double Separation::TerrainSupport(const PosedModel& posed, int field,
                                  const Vector3d& direction_W) const {
  const Vector3d u = AsMatrix(posed.data()->geom_xmat + 9 * field).transpose() * direction_W;
  double farthest = -kInfinity;
  for (const NearPrism& near : prisms_) farthest = std::max(farthest, u.dot(near.prism.Support(u)));
  return direction_W.dot(AsVector(posed.data()->geom_xpos + 3 * field)) + farthest;
}

double Separation::SafeStep(const PosedModel& posed, const KeptPair& pair, const Vector3d& n_W,
                            const RelativeMotion& motion, double floor, double horizon) {
  const bool terrain = pair.kind == PairKind::kTerrain;
  if (terrain) {
    // Prisms beyond that are out of reach on the whole horizon, even for the geom moved by a
    // permitted overlap.
    if (!CollectTerrain(posed, pair, std::abs(floor) + motion.closing * horizon)) return 0.0;
    if (prisms_.empty()) return horizon;
  }
  const auto support1 = [&](const Vector3d& direction_W) {
    return terrain ? TerrainSupport(posed, pair.geom1, direction_W)
                   : CoreSupport(posed, pair.geom1, direction_W);
  };
  const double speed = n_W.dot(motion.v_W);
  const Vector3d tilt = n_W.cross(motion.omega_W);
  const double radii =
      CoreRadius(*posed.model(), pair.geom1) + CoreRadius(*posed.model(), pair.geom2);
  double best = 0.0;
  if (std::isfinite(motion.acceleration1)) {  // geom 1 moves, geom 2 and the plane rest
    const double other = -CoreSupport(posed, pair.geom2, -n_W) - radii - floor;
    best = ConcaveRoot(
        [&](double h) {
          return other - support1(n_W + h * tilt) - h * speed - 0.5 * h * h * motion.acceleration1;
        },
        horizon);
  }
  if (best < horizon && std::isfinite(motion.acceleration2)) {  // the other way round
    const double other = -support1(n_W) - radii - floor;
    const double step = ConcaveRoot(
        [&](double h) {
          return other - CoreSupport(posed, pair.geom2, -n_W + h * tilt) - h * speed -
                 0.5 * h * h * motion.acceleration2;
        },
        horizon);
    best = std::max(best, step);
  }
  return best;
}

}  // namespace mjcf_pdg
