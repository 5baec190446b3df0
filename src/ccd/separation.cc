#include "ccd/separation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "collide/terrain/on_terrain.h"

namespace mjcf_pdg {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// A height field counts as the hull of at most so many prisms: of more it would prove little.
constexpr int kMostPrisms = 256;
constexpr int kMostTries = 16;  // of the length of a step; two or three are usual
// A step is so much shorter than up to where the plane is expected, that the next try proves it.
// With 0.95 the motions of planners take up to a fifth more poses, with 0.9999 as many, with twice
// as many steps of Newton's method as many, too, and 5 % more time (bench/README.md, ccdg_bench).
constexpr double kShorter = 0.999;
constexpr int kNewtonSteps = 3;

// How far a point is from a plane [m]: c - g s - b s² - j s³, with c, b and j not negative.
struct Gap {
  double c, g, b, j;

  double At(double s) const { return c - s * (g + s * (b + s * j)); }
  // Where it vanishes, or later, but not beyond `s`, where it is negative: a root without j, and
  // what Newton's method makes of that. The function is concave, so that it comes from above.
  double UpToZero(double s) const {
    const double root = std::sqrt(g * g + 4.0 * b * c);
    if (g > 0.0) s = std::min(s, 2.0 * c / (g + root));
    if (g <= 0.0 && b > 0.0) s = std::min(s, (root - g) / (2.0 * b));
    for (int k = 0; k < kNewtonSteps; ++k) {
      const double slope = g + s * (2.0 * b + 3.0 * s * j);
      if (slope > 0.0) s = std::min(s, s + At(s) / slope);
    }
    return std::max(s, 0.0);
  }
};

// A geom, or its core if it is round, that moves towards a plane at rest.
struct Approach {
  Vector3d n_W;        // the plane's normal, away from the geom
  double plane;        // where the geom must not come along n_W: n_W · x [m]
  double distance;     // of the geom from there, now [m], not negative
  const Twist& twist;  // of the geom
  double jerk;         // |x'''| of its points, at most [m]
};

// The largest s <= horizon found so that the geom does not meet the plane on [0, s]. The least Gap
// of its points counts, which is concave in s: that of the support point in the direction n + s
// n×ω. Where it is negative, what is left of the Gap of that one point says what to try next. n·x''
// is linear in x, so that its maximum is a support, too; it counts for all points.
template <typename SupportPoint>
double StepTowardsPlane(const PosedModel& posed, int geom, const Approach& approach,
                        const SupportPoint& support_point, double horizon) {
  const Vector3d &n_W = approach.n_W, &w = approach.twist.omega_W, &v = approach.twist.v_W;
  const Vector3d tilt_W = n_W.cross(w);
  const Vector3d bend_W =
      n_W.cross(approach.twist.omega_rate_W) + n_W.dot(w) * w - w.squaredNorm() * n_W;
  const auto p_W = AsVector(posed.data()->geom_xpos + 3 * geom);
  const Matrix3d R_GW = AsMatrix(posed.data()->geom_xmat + 9 * geom).transpose();
  const Vector3d n = R_GW * n_W, tilt = R_GW * tilt_W, bend = R_GW * bend_W;

  const double origin = approach.plane - n_W.dot(p_W), speed = n_W.dot(v) + tilt_W.dot(p_W);
  const double acceleration = n_W.dot(approach.twist.v_rate_W + w.cross(v)) + bend_W.dot(p_W) +
                              bend.dot(support_point(bend));
  Gap gap{0.0, 0.0, 0.5 * std::max(0.0, acceleration), approach.jerk / 6.0};
  double s = horizon;
  for (int k = 0; k < kMostTries; ++k) {
    const Vector3d x = support_point(n + s * tilt);
    gap.c = std::max(approach.distance, origin - n.dot(x));
    gap.g = speed + tilt.dot(x);
    if (gap.At(s) >= 0.0) return s;
    s = kShorter * gap.UpToZero(s);
  }
  return 0.0;
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

// The corner of prisms_ that is farthest along a direction in the frame of the field.
Vector3d Separation::FarthestOfPrisms(const Vector3d& u_F) const {
  Vector3d farthest = prisms_.front().prism.Support(u_F);
  for (const NearPrism& near : prisms_) {
    const Vector3d x = near.prism.Support(u_F);
    if (u_F.dot(x) > u_F.dot(farthest)) farthest = x;
  }
  return farthest;
}

double Separation::TerrainSupport(const PosedModel& posed, int field, const Vector3d& n_W) const {
  const Vector3d n_F = AsMatrix(posed.data()->geom_xmat + 9 * field).transpose() * n_W;
  return n_W.dot(AsVector(posed.data()->geom_xpos + 3 * field)) + n_F.dot(FarthestOfPrisms(n_F));
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
  const auto point1 = [&](const Vector3d& u) -> Vector3d {
    return terrain ? FarthestOfPrisms(u) : support_.Support(pair.geom1, u);
  };
  const auto point2 = [&](const Vector3d& u) { return support_.Support(pair.geom2, u); };
  const double support1 =
      terrain ? TerrainSupport(posed, pair.geom1, n_W) : CoreSupport(posed, pair.geom1, n_W);
  const double support2 = CoreSupport(posed, pair.geom2, -n_W);
  const double required =
      floor + CoreRadius(*posed.model(), pair.geom1) + CoreRadius(*posed.model(), pair.geom2);
  const double distance = -support1 - support2 - required;
  if (!(distance >= 0.0)) return 0.0;
  double step = 0.0;
  // Geom 1 moves, geom 2 and the plane rest; where geom 1 is a plane, it is the one to rest.
  if (std::isfinite(motion.jerk1) && (terrain || support_.Knows(pair.geom1))) {
    step = StepTowardsPlane(posed, pair.geom1,
                            {n_W, -support2 - required, distance, motion.twist, motion.jerk1},
                            point1, horizon);
  }
  if (step < horizon && std::isfinite(motion.jerk2)) {  // the other way round
    step = std::max(
        step, StepTowardsPlane(posed, pair.geom2,
                               {-n_W, -support1 - required, distance, -motion.twist, motion.jerk2},
                               point2, horizon));
  }
  return step;
}

}  // namespace mjcf_pdg
