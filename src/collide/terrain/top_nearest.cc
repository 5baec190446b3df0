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

// The point of the triangle that is nearest to p. (The same book, 5.1.5.)
Vector3d NearestTo(const Triangle& top, const Vector3d& p) {
  const Vector3d ab = top[1] - top[0], ac = top[2] - top[0];
  const Vector3d from_a = p - top[0], from_b = p - top[1], from_c = p - top[2];
  const double b_a = ab.dot(from_a), c_a = ac.dot(from_a);
  if (b_a <= 0.0 && c_a <= 0.0) return top[0];
  const double b_b = ab.dot(from_b), c_b = ac.dot(from_b);
  if (b_b >= 0.0 && c_b <= b_b) return top[1];
  const double of_c = b_a * c_b - b_b * c_a;
  if (of_c <= 0.0 && b_a >= 0.0 && b_b <= 0.0) return top[0] + b_a / (b_a - b_b) * ab;
  const double b_c = ab.dot(from_c), c_c = ac.dot(from_c);
  if (c_c >= 0.0 && b_c <= c_c) return top[2];
  const double of_b = b_c * c_a - b_a * c_c;
  if (of_b <= 0.0 && c_a >= 0.0 && c_c <= 0.0) return top[0] + c_a / (c_a - c_c) * ac;
  const double of_a = b_b * c_c - b_c * c_b, to_c = c_b - b_b, to_b = b_c - c_c;
  if (of_a <= 0.0 && to_c >= 0.0 && to_b >= 0.0) {
    return top[1] + to_c / (to_c + to_b) * (top[2] - top[1]);
  }
  const double whole = of_a + of_b + of_c;
  return top[0] + of_b / whole * ab + of_c / whole * ac;
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
  const bool a_is_lower = above_a < above_b;
  const Vector3d &lower = a_is_lower ? a : b, &upper = a_is_lower ? b : a;
  // Of most, the lower end is the nearest point: the rest of the segment is beyond the plane there.
  if (std::min(above_a, above_b) > 0.0) {
    nearest = {NearestTo(top, lower), lower};
    if ((upper - lower).dot(lower - nearest.p1) >= 0.0) return true;
  }
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
