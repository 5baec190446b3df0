#include "verify/exact/primitive_distance.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace mjcf_pdg::verify {
namespace {

using Eigen::Vector3d;

// With semi-axes a_i, Σ (a_i x_i / (a_i² - min a² + s))² = 1 has one root s > 0, from which the
// nearest point follows. The sum is convex and falls with s, so Newton's method that starts where
// one of the terms is 1, which is below the root, increases towards the root.
double EllipsoidDistance(const Vector3d& size, Vector3d x) {
  x = x.cwiseAbs() + 1e-13 * size;  // on a plane of symmetry a term would vanish
  const double least = size.minCoeff();
  const Eigen::Array3d above = (size.array() - least) * (size.array() + least);
  const Eigen::Array3d scaled = size.array() * x.array();
  double s = (scaled - above).maxCoeff();
  for (int i = 0; i < 100; ++i) {
    const Eigen::Array3d root = scaled / (above + s);
    const double excess = root.square().sum() - 1.0;
    const double next = s + 0.5 * excess / (root.square() / (above + s)).sum();
    if (!(next > s)) break;
    s = next;
  }
  const Vector3d nearest = (size.array() * scaled / (above + s)).matrix();
  const double distance = (x - nearest).norm();
  return x.cwiseQuotient(size).squaredNorm() < 1.0 ? -distance : distance;
}

// Returns the least value of a convex function on [0, 1] and sets `at` to where it is.
template <typename Function>
double GoldenSection(const Function& f, double& at) {
  constexpr double kGolden = 0.6180339887498949;
  constexpr int kSteps = 52;
  double low = 0.0, high = 1.0;
  double left = 1.0 - kGolden, right = kGolden;
  double f_left = f(left), f_right = f(right);
  for (int i = 0; i < kSteps; ++i) {
    const bool keep_left = f_left <= f_right;
    (keep_left ? high : low) = keep_left ? right : left;
    (keep_left ? right : left) = keep_left ? left : right;
    (keep_left ? f_right : f_left) = keep_left ? f_left : f_right;
    double& moved = keep_left ? left : right;
    moved = keep_left ? high - kGolden * (high - low) : low + kGolden * (high - low);
    (keep_left ? f_left : f_right) = f(moved);
  }
  const double candidates[] = {0.0, 1.0, 0.5 * (low + high)};
  double best = INFINITY;
  for (const double t : candidates) {
    const double value = f(t);
    if (value >= best) continue;
    best = value;
    at = t;
  }
  return best;
}

}  // namespace

double RoundDistanceAt(int type, const Vector3d& size, const Vector3d& x) {
  switch (type) {
    case mjGEOM_PLANE:
      return x.z();
    case mjGEOM_SPHERE:
      return x.norm() - size[0];
    case mjGEOM_CAPSULE:
      return std::hypot(x.x(), x.y(), std::max(std::abs(x.z()) - size[1], 0.0)) - size[0];
    case mjGEOM_CYLINDER: {
      const double side = std::hypot(x.x(), x.y()) - size[0], cap = std::abs(x.z()) - size[1];
      return std::min(std::max(side, cap), 0.0) +
             std::hypot(std::max(side, 0.0), std::max(cap, 0.0));
    }
    case mjGEOM_ELLIPSOID:
      return EllipsoidDistance(size, x);
    default:
      throw std::logic_error("a geom of this type is neither a plane nor round");
  }
}

double RoundDistanceOnTriangle(int type, const Vector3d& size, const Vector3d corners[3],
                               Vector3d& x) {
  // x = c0 + u (c1 - c0) + v (1 - u) (c2 - c0): the least over v is convex in u.
  double u = 0.0, v = 0.0;
  auto point = [&](double along, double up) -> Vector3d {
    return corners[0] + along * (corners[1] - corners[0]) +
           up * (1.0 - along) * (corners[2] - corners[0]);
  };
  auto column = [&](double along) {
    return GoldenSection([&](double up) { return RoundDistanceAt(type, size, point(along, up)); },
                         v);
  };
  const double least = GoldenSection(column, u);
  column(u);
  x = point(u, v);
  return least;
}

Vector3d RoundNormalAt(int type, const Vector3d& size, const Vector3d& x) {
  const double h = 1e-7 * (size.norm() + x.norm());
  Vector3d gradient;
  for (int i = 0; i < 3; ++i) {
    const Vector3d step = h * Vector3d::Unit(i);
    gradient[i] = RoundDistanceAt(type, size, x + step) - RoundDistanceAt(type, size, x - step);
  }
  return gradient.norm() > 0.0 ? Vector3d(gradient.normalized()) : Vector3d(Vector3d::UnitZ());
}

}  // namespace mjcf_pdg::verify
