#include "verify/verify_capsule_box.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "model/kinematics.h"

namespace mjcf_pdg {
namespace {

double DistanceToBox(const Vector3d& p, const Vector3d& half) {
  return (p.cwiseAbs() - half).cwiseMax(0.0).norm();
}

// Capsule against box, apart: the distance from the box is convex along the segment center ± arm
// (box frame), so a golden-section search finds its minimum. Returns the parameter in [-1, 1].
double NearestOnSegment(const Vector3d& center, const Vector3d& arm, const Vector3d& half) {
  constexpr double kGolden = 0.6180339887498949;
  double low = -1.0, high = 1.0;
  double left = high - kGolden * (high - low), right = low + kGolden * (high - low);
  auto distance = [&](double t) { return DistanceToBox(center + t * arm, half); };
  double at_left = distance(left), at_right = distance(right);
  for (int i = 0; i < 80; ++i) {
    if (at_left <= at_right) {
      high = right;
      right = left;
      at_right = at_left;
      left = high - kGolden * (high - low);
      at_left = distance(left);
    } else {
      low = left;
      left = right;
      at_left = at_right;
      right = low + kGolden * (high - low);
      at_right = distance(right);
    }
  }
  return 0.5 * (low + high);
}

// How deep the segment center ± arm lies in the box: the least overlap of the two projections over
// the directions that can bound it. Also the direction, from segment to box.
double SegmentDepth(const Vector3d& center, const Vector3d& arm, const Vector3d& half,
                    Vector3d& direction) {
  double depth = std::numeric_limits<double>::infinity();
  auto consider = [&](const Vector3d& n) {
    const double overlap = n.cwiseAbs().dot(half) + std::abs(n.dot(arm)) - std::abs(n.dot(center));
    if (overlap >= depth) return;
    depth = overlap;
    direction = n.dot(center) > 0.0 ? Vector3d(-n) : n;
  };
  for (int i = 0; i < 3; ++i) {
    consider(Vector3d::Unit(i));
    const Vector3d across = Vector3d::Unit(i).cross(arm);
    if (across.norm() > 1e-9 * arm.norm()) consider(across.normalized());
  }
  return std::max(depth, 0.0);
}

}  // namespace

double CapsuleBoxDistance(const mjModel& m, const mjData& d, int capsule, int box,
                          double fromto[6]) {
  const Matrix3d R = AsMatrix(d.geom_xmat + 9 * box);
  const Vector3d origin = AsVector(d.geom_xpos + 3 * box);
  const Vector3d half = AsVector(m.geom_size + 3 * box);
  const double radius = m.geom_size[3 * capsule];
  const Vector3d center = R.transpose() * (AsVector(d.geom_xpos + 3 * capsule) - origin);
  const Vector3d arm =
      R.transpose() * AsMatrix(d.geom_xmat + 9 * capsule).col(2) * m.geom_size[3 * capsule + 1];
  Vector3d on_segment = center + NearestOnSegment(center, arm, half) * arm;
  const Vector3d shadow = on_segment.cwiseMax(-half).cwiseMin(half);
  double apart = (shadow - on_segment).norm();
  Vector3d n = apart > 0.0 ? Vector3d((shadow - on_segment) / apart) : Vector3d(Vector3d::UnitX());
  if (apart <= 1e-9) {
    apart = -SegmentDepth(center, arm, half, n);
    const double lean = n.dot(arm);
    on_segment = center + (lean > 1e-12 ? 1.0 : lean < -1e-12 ? -1.0 : 0.0) * arm;
  }
  const double distance = apart - radius;
  Eigen::Map<Vector3d> from(fromto), to(fromto + 3);
  from = origin + R * (on_segment + radius * n);
  to = origin + R * (on_segment + (radius + distance) * n);
  return distance;
}

}  // namespace mjcf_pdg
