#include "collide/convex/capsule_box.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace mjcf_pdg {
namespace {

// The segment counts as parallel to a face if the sine of the angle between them is smaller.
constexpr double kParallel = 1e-11;
// A segment nearer to the box than this counts as meeting it [half the box's diagonal].
constexpr double kPierces = 1e-8;

using Eigen::Vector3d;

Vector3d NearestInBox(const Vector3d& p, const Vector3d& half) {
  return p.cwiseMax(-half).cwiseMin(half);
}

// ½ d/dt of the squared distance from a + t v to the box: piecewise linear and non-decreasing in t.
double Slope(const Vector3d& a, const Vector3d& v, const Vector3d& half, double t) {
  const Vector3d p = a + t * v;
  return v.dot(p - NearestInBox(p, half));
}

// The t in [0, 1] at which a + t v is nearest to the box; exact, since Slope is linear between
// breakpoints.
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

// A direction n along which the box can leave the segment, and the length of that translation.
struct Exit {
  double depth = std::numeric_limits<double>::infinity();
  Vector3d n = Vector3d::UnitX();
  int edge = -1;  // n = edge direction × segment; -1: n is a face normal
};

// Replaces `best` if a shorter translation along n than best.depth separates the box from the
// segment.
void Consider(const Vector3d& n, int edge, const Vector3d& a, const Vector3d& b,
              const Vector3d& half, Exit& best) {
  const double reach = std::max(n.dot(a), n.dot(b)) + n.cwiseAbs().dot(half);
  if (reach < best.depth) best = {reach, n, edge};
}

// The parameter at which, seen along n, the segment a + t v crosses the edge of the box that faces
// it. There the common perpendicular of segment and edge meets the segment.
double CrossingParameter(const Vector3d& a, const Vector3d& v, const Vector3d& half,
                         const Exit& out) {
  const Vector3d corner = (out.n.array() > 0.0).select(-half, half);
  const Vector3d across = Vector3d::Unit(out.edge).cross(out.n);
  return std::clamp(across.dot(corner - a) / across.dot(v), 0.0, 1.0);
}

// The gap of a segment that meets the box: the shortest translation of the box that separates them.
SignedGap PiercingGap(const Vector3d& a, const Vector3d& b, const Vector3d& half) {
  Exit out;
  for (int i = 0; i < 3; ++i) {
    for (const double sign : {-1.0, 1.0}) {
      Consider(sign * Vector3d::Unit(i), -1, a, b, half, out);
      const Vector3d cross = Vector3d::Unit(i).cross(b - a);
      if (cross.norm() > 1e-9 * (b - a).norm()) {
        Consider(sign * cross.normalized(), i, a, b, half, out);
      }
    }
  }
  // The witness point on the segment: if n is a face's normal, the segment's deepest point, or, if
  // parallel, the point nearest to the box's centre; if n belongs to an edge, the crossing, since
  // only there n · (v_2 - v_1) is the rate of change of the signed distance.
  const double lean = out.n.dot(b) - out.n.dot(a);
  double t = lean > 0.0 ? 1.0 : 0.0;
  if (out.edge >= 0) {
    t = CrossingParameter(a, b - a, half, out);
  } else if (std::abs(lean) < kParallel * (b - a).norm()) {
    t = NearestParameter(a, b - a, Vector3d::Zero());
  }
  SignedGap gap;
  gap.n = out.n;
  gap.distance = -out.depth;
  gap.p1 = a + t * (b - a);
  gap.p2 = gap.p1 - out.depth * out.n;
  return gap;
}

}  // namespace

SignedGap CapsuleBoxGap(const Vector3d& a, const Vector3d& b, double radius, const Vector3d& half) {
  SignedGap gap;
  const double t = NearestParameter(a, b - a, half);
  const Vector3d on_segment = a + t * (b - a);
  const Vector3d on_box = NearestInBox(on_segment, half);
  const double distance = (on_box - on_segment).norm();
  if (distance > kPierces * half.norm()) {
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
