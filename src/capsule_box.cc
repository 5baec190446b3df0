#include "capsule_box.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace mjcf_pdg {
namespace {

using Eigen::Vector3d;

Vector3d NearestInBox(const Vector3d& p, const Vector3d& half) {
  return p.cwiseMax(-half).cwiseMin(half);
}

// ½ d/dt of the squared distance from a + t v to the box: piecewise linear and non-decreasing in t.
double Slope(const Vector3d& a, const Vector3d& v, const Vector3d& half, double t) {
  const Vector3d p = a + t * v;
  return v.dot(p - NearestInBox(p, half));
}

// The parameter in [0, 1] nearest to the box; exact, since Slope is linear between breakpoints.
double NearestParameter(const Vector3d& a, const Vector3d& v, const Vector3d& half) {
  std::array<double, 8> breaks;
  breaks.fill(1.0);
  breaks[0] = 0.0;
  int n = 1;
  for (int i = 0; i < 3; ++i) {
    for (const double side : {-half[i], half[i]}) {
      const double t = (side - a[i]) / v[i];
      if (t > 0.0 && t < 1.0) breaks[n++] = t;  // false for NaN and infinity
    }
  }
  std::sort(breaks.begin(), breaks.end());
  double low = breaks[0], slope_low = Slope(a, v, half, low);
  if (slope_low >= 0.0) return low;
  for (const double high : breaks) {
    const double slope_high = Slope(a, v, half, high);
    if (slope_high >= 0.0) {
      return slope_high > slope_low ? low - slope_low * (high - low) / (slope_high - slope_low)
                                    : low;
    }
    low = high;
    slope_low = slope_high;
  }
  return 1.0;
}

// Keeps the shallowest way out: the box moved along n by `depth` just touches the segment.
void Consider(const Vector3d& n, const Vector3d& a, const Vector3d& b, const Vector3d& half,
              double& depth, Vector3d& best) {
  const double reach = std::max(n.dot(a), n.dot(b)) + n.cwiseAbs().dot(half);
  if (reach < depth) {
    depth = reach;
    best = n;
  }
}

// The segment meets the box: how far, and along which n, the box must move to leave it.
SignedGap PiercingGap(const Vector3d& a, const Vector3d& b, const Vector3d& half) {
  double depth = std::numeric_limits<double>::infinity();
  Vector3d n = Vector3d::UnitX();
  for (int i = 0; i < 3; ++i) {
    for (const double sign : {-1.0, 1.0}) {
      Consider(sign * Vector3d::Unit(i), a, b, half, depth, n);
      const Vector3d cross = Vector3d::Unit(i).cross(b - a);
      if (cross.norm() > 1e-9 * (b - a).norm()) {
        Consider(sign * cross.normalized(), a, b, half, depth, n);
      }
    }
  }
  // Witnesses: the segment's deepest point (its middle if parallel) and its shadow on the face.
  SignedGap gap;
  const double lean = n.dot(b) - n.dot(a);
  const double t = std::abs(lean) < 1e-12 ? NearestParameter(a, b - a, Vector3d::Zero())
                                          : (lean > 0.0 ? 1.0 : 0.0);
  gap.n = n;
  gap.distance = -depth;
  gap.p1 = a + t * (b - a);
  gap.p2 = gap.p1 - depth * n;
  return gap;
}

}  // namespace

SignedGap CapsuleBoxGap(const Vector3d& a, const Vector3d& b, double radius,
                        const Vector3d& half) {
  SignedGap gap;
  const double t = NearestParameter(a, b - a, half);
  const Vector3d on_segment = a + t * (b - a);
  const Vector3d on_box = NearestInBox(on_segment, half);
  const double distance = (on_box - on_segment).norm();
  if (distance > 1e-9) {
    gap.n = (on_box - on_segment) / distance;
    gap.distance = distance;
    gap.p1 = on_segment;
    gap.p2 = on_box;
  } else {
    gap = PiercingGap(a, b, half);
  }
  gap.distance -= radius;
  gap.p1 += radius * gap.n;
  return gap;
}

}  // namespace mjcf_pdg
