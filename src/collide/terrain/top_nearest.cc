#include "collide/terrain/top_nearest.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mjcf_pdg {
namespace {

using Eigen::Vector3d;

// Whether p, projected along the triangle's normal n (of any length), falls into the triangle.
bool IsOver(const Triangle& top, const Vector3d& n, const Vector3d& p) {
  for (int k = 0; k < 3; ++k) {
    const Vector3d& from = top[k];
    if (n.dot((top[(k + 1) % 3] - from).cross(p - from)) < 0.0) return false;
  }
  return true;
}

// Of the edge from c to d and the segment from a to b. (Ericson, Real-Time Collision Detection,
// 5.1.9.)
NearestPoints NearestOfEdge(const Vector3d& c, const Vector3d& d, const Vector3d& a,
                            const Vector3d& b) {
  const Vector3d along = b - a, edge = d - c, between = a - c;
  const double aa = along.squaredNorm(), ee = edge.squaredNorm(), ae = along.dot(edge);
  const double a_at = along.dot(between), e_at = edge.dot(between);
  const double determinant = aa * ee - ae * ae;
  const auto share = [](double part, double whole) {
    return whole > 0.0 ? std::clamp(part / whole, 0.0, 1.0) : 0.0;
  };
  double s = share(ae * e_at - a_at * ee, determinant);
  double t = (ae * s + e_at) / ee;
  if (t < 0.0) {
    t = 0.0;
    s = share(-a_at, aa);
  } else if (t > 1.0) {
    t = 1.0;
    s = share(ae - a_at, aa);
  }
  return {c + t * edge, a + s * along};
}

NearestPoints OnFace(const Triangle& top, const Vector3d& n, const Vector3d& p) {
  return {p - n * (n.dot(p - top[0]) / n.squaredNorm()), p};
}

Vector3d Cross(const Triangle& top) { return (top[1] - top[0]).cross(top[2] - top[0]); }

}  // namespace

bool NearestOfSegment(const Triangle& top, const Vector3d& a, const Vector3d& b,
                      NearestPoints& nearest) {
  const Vector3d n = Cross(top);
  const double above_a = n.dot(a - top[0]), above_b = n.dot(b - top[0]);
  if (std::max(above_a, above_b) <= 0.0) return false;
  const Vector3d& lower = above_a < above_b ? a : b;
  // If all of the segment is above the plane, an edge that the lower end is not beyond is as far as
  // another one, at least.
  const bool all_above = std::min(above_a, above_b) > 0.0;
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    const Vector3d &from = top[k], &to = top[(k + 1) % 3];
    if (all_above && n.dot((to - from).cross(lower - from)) >= 0.0) continue;
    const NearestPoints of_edge = NearestOfEdge(from, to, a, b);
    const double squared = (of_edge.p2 - of_edge.p1).squaredNorm();
    if (squared >= least) continue;
    least = squared;
    nearest = of_edge;
  }
  if (std::isinf(least)) nearest = OnFace(top, n, lower);
  return true;
}

bool NearestOfFace(const Triangle& top, const Vector3d& lowest, NearestPoints& nearest) {
  const Vector3d n = Cross(top);
  if (!(n.dot(lowest - top[0]) > 0.0 && IsOver(top, n, lowest))) return false;
  nearest = OnFace(top, n, lowest);
  return true;
}

bool NearestOfCorner(const Triangle& top, const Vector3d& center, const Eigen::Matrix3d& axes,
                     const Vector3d& half, NearestPoints& nearest) {
  double least = std::numeric_limits<double>::infinity();
  for (const Vector3d& corner : top) {
    const Vector3d inside = axes.transpose() * (corner - center);
    const Vector3d clamped = inside.cwiseMax(-half).cwiseMin(half);
    const double squared = (inside - clamped).squaredNorm();
    if (squared >= least) continue;
    least = squared;
    nearest = {corner, center + axes * clamped};
  }
  return least > 0.0;
}

}  // namespace mjcf_pdg
