#include "collide/exact/primitive_sdf.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace mjcf_pdg {
namespace {

using Eigen::Vector3d;

// A point nearer than this to the ellipsoid's plane of symmetry across its shortest axis counts as
// on it [half size along that axis].
constexpr double kOnPlane = 1e-14;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr char kNoPrimitive[] = "a geom of this type has no signed distance field of its own";
constexpr int kMaxCuts = 120;  // the most cuts that MinimumOnTriangle makes

// The convex polygon that is left of a triangle after cuts.
class Remainder {
 public:
  explicit Remainder(const Vector3d corners[3]) { std::copy_n(corners, 3, corners_.begin()); }

  bool empty() const { return count_ == 0; }

  // The area's centroid, by a fan of triangles about the first corner; if the area is 0, the mean
  // of the corners.
  Vector3d Centroid() const {
    Vector3d centroid = Vector3d::Zero(), mean = Vector3d::Zero();
    double area = 0.0;
    for (int k = 1; k + 1 < count_; ++k) {
      const Vector3d a = corners_[k] - corners_[0], b = corners_[k + 1] - corners_[0];
      const double part = a.cross(b).norm();
      centroid += part * (corners_[0] + corners_[k] + corners_[k + 1]) / 3.0;
      area += part;
    }
    if (area > 0.0) return centroid / area;
    for (int k = 0; k < count_; ++k) mean += corners_[k] / count_;
    return mean;
  }

  // The minimum of direction · (x - origin) over the points x of the polygon.
  double Least(const Vector3d& direction, const Vector3d& origin) const {
    double least = kInfinity;
    for (int k = 0; k < count_; ++k) {
      least = std::min(least, direction.dot(corners_[k] - origin));
    }
    return least;
  }

  // Keeps the part where normal · (x - origin) <= 0.
  void Cut(const Vector3d& normal, const Vector3d& origin) {
    std::array<Vector3d, 3 + kMaxCuts> kept;
    int count = 0;
    for (int k = 0; k < count_; ++k) {
      const Vector3d& p = corners_[k];
      const Vector3d& q = corners_[(k + 1) % count_];
      const double at_p = normal.dot(p - origin), at_q = normal.dot(q - origin);
      if (at_p <= 0.0) kept[count++] = p;
      if ((at_p < 0.0 && at_q > 0.0) || (at_p > 0.0 && at_q < 0.0)) {
        kept[count++] = p + at_p / (at_p - at_q) * (q - p);
      }
    }
    std::copy_n(kept.begin(), count, corners_.begin());
    count_ = count;
  }

 private:
  std::array<Vector3d, 3 + kMaxCuts> corners_;  // each cut adds one at most
  int count_ = 3;
};

// For a ball of `radius` swept along a core; `away` leads from the core's nearest point to x.
SdfValue FromCore(const Vector3d& away, double radius) {
  const double length = away.norm();
  return {length - radius, length > 0.0 ? Vector3d(away / length) : Vector3d(Vector3d::UnitX())};
}

SdfValue CylinderAt(const Vector3d& x, double radius, double half) {
  const double rho = std::hypot(x.x(), x.y());
  const Vector3d side = rho > 0.0 ? Vector3d(x.x() / rho, x.y() / rho, 0.0) : Vector3d::UnitX();
  const Vector3d cap(0.0, 0.0, x.z() < 0.0 ? -1.0 : 1.0);
  const double a = rho - radius, b = std::abs(x.z()) - half;
  if (a > 0.0 && b > 0.0) {
    const double f = std::hypot(a, b);
    return {f, (a * side + b * cap) / f};
  }
  return a > b ? SdfValue{a, side} : SdfValue{b, cap};
}

// The surface point nearest to y, for descending half sizes e and y in the first octant.
Vector3d NearestOnEllipsoid(const Vector3d& e, const Vector3d& y) {
  constexpr int kMaxSteps = 100;
  const Vector3d z = y.cwiseQuotient(e);
  if (y.z() > 0.0) {
    // s is the root of Σ (r_i z_i / (s + r_i))² = 1, where lengths are per smallest half size.
    const Vector3d r(std::pow(e.x() / e.z(), 2), std::pow(e.y() / e.z(), 2), 1.0);
    // The function is convex and falling, so Newton steps that start left of the root, where one
    // term alone is 1, never pass it.
    double s = (r.cwiseProduct(z) - r).maxCoeff();
    for (int i = 0; i < kMaxSteps; ++i) {
      const Eigen::Array3d quotient = r.cwiseProduct(z).array() / (s + r.array());
      const double value = quotient.square().sum() - 1.0;
      const double slope = -2.0 * (quotient.square() / (s + r.array())).sum();
      const double next = s - value / slope;
      if (!(next > s)) break;
      s = next;
    }
    return (r.cwiseProduct(y).array() / (s + r.array())).matrix();
  }
  // y is on the plane of symmetry across the shortest axis; its nearest point need not be.
  auto ratio_of = [](double numerator, double denominator) {
    if (numerator == 0.0) return 0.0;
    return numerator < denominator ? numerator / denominator : 2.0;
  };
  const double ratio_x = ratio_of(e.x() * y.x(), e.x() * e.x() - e.z() * e.z());
  const double ratio_y = ratio_of(e.y() * y.y(), e.y() * e.y() - e.z() * e.z());
  const double rest = 1.0 - ratio_x * ratio_x - ratio_y * ratio_y;
  if (rest > 0.0) return {e.x() * ratio_x, e.y() * ratio_y, e.z() * std::sqrt(rest)};
  if (y.y() == 0.0) return {e.x(), 0.0, 0.0};
  return NearestOnEllipsoid(e, {y.x(), y.y(), std::numeric_limits<double>::min()});
}

SdfValue EllipsoidAt(const Vector3d& x, const Vector3d& size) {
  std::array<int, 3> order = {0, 1, 2};
  std::stable_sort(order.begin(), order.end(), [&](int i, int j) { return size[i] > size[j]; });
  Vector3d e, y;
  for (int k = 0; k < 3; ++k) {
    e[k] = size[order[k]];
    y[k] = std::abs(x[order[k]]);
  }
  if (y[2] < kOnPlane * e[2]) y[2] = 0.0;
  const Vector3d nearest = NearestOnEllipsoid(e, y);
  Vector3d p;
  for (int k = 0; k < 3; ++k) p[order[k]] = std::copysign(nearest[k], x[order[k]]);
  const double sign = x.cwiseQuotient(size).squaredNorm() < 1.0 ? -1.0 : 1.0;
  const Vector3d normal = p.cwiseQuotient(size.cwiseProduct(size)).normalized();
  return {sign * (x - p).norm(), normal};
}

}  // namespace

SdfValue PrimitiveSdf::At(const Vector3d& x) const {
  switch (type) {
    case mjGEOM_PLANE:
      return {x.z(), Vector3d::UnitZ()};
    case mjGEOM_SPHERE:
      return FromCore(x, size[0]);
    case mjGEOM_CAPSULE:
      return FromCore(x - Vector3d(0.0, 0.0, std::clamp(x.z(), -size[1], size[1])), size[0]);
    case mjGEOM_CYLINDER:
      return CylinderAt(x, size[0], size[1]);
    case mjGEOM_ELLIPSOID:
      return EllipsoidAt(x, size);
    default:
      throw std::logic_error(kNoPrimitive);
  }
}

Vector3d PrimitiveSdf::Support(const Vector3d& n) const {
  const double up = n.z() < 0.0 ? -1.0 : 1.0;
  switch (type) {
    case mjGEOM_SPHERE:
      return size[0] * n;
    case mjGEOM_CAPSULE:
      return size[0] * n + Vector3d(0.0, 0.0, up * size[1]);
    case mjGEOM_CYLINDER: {
      const double rho = std::hypot(n.x(), n.y());
      const double scale = rho > 0.0 ? size[0] / rho : 0.0;
      return {scale * n.x(), scale * n.y(), up * size[1]};
    }
    case mjGEOM_ELLIPSOID: {
      const Vector3d scaled = n.cwiseProduct(size);
      return scaled.cwiseProduct(size) / scaled.norm();
    }
    default:
      throw std::logic_error(kNoPrimitive);
  }
}

double PrimitiveSdf::OuterRadius() const {
  switch (type) {
    case mjGEOM_PLANE:
      return kInfinity;
    case mjGEOM_SPHERE:
      return size[0];
    case mjGEOM_CAPSULE:
      return size[0] + size[1];
    case mjGEOM_CYLINDER:
      return std::hypot(size[0], size[1]);
    case mjGEOM_ELLIPSOID:
      return size.maxCoeff();
    default:
      throw std::logic_error(kNoPrimitive);
  }
}

// The centre of gravity method of convex optimization: where ∇f · (x - centroid) > 0, f is larger
// than at the centroid, so that part is cut off. Each cut leaves at most 1 - 1/e of the area. The
// gradient inequality at the centroid gives a lower bound of f on what is left.
SdfMinimum MinimumOnTriangle(const PrimitiveSdf& field, const Vector3d corners[3], double cutoff,
                             double accuracy) {
  SdfMinimum best{kInfinity, corners[0]};
  auto ask = [&](const Vector3d& x) {
    const SdfValue value = field.At(x);
    if (value.f < best.f) best = {value.f, x};
    return value;
  };
  for (int k = 0; k < 3; ++k) ask(corners[k]);
  Remainder rest(corners);
  // Lower bounds of f: `proven` on the whole triangle, `lowest` on the parts cut off so far.
  double proven = -kInfinity, lowest = kInfinity;
  for (int cut = 0; cut < kMaxCuts && !rest.empty(); ++cut) {
    const Vector3d centroid = rest.Centroid();
    const SdfValue value = ask(centroid);
    const double least = value.f + rest.Least(value.gradient, centroid);
    proven = std::max(proven, std::min(least, lowest));
    if (proven >= cutoff) return {cutoff, best.x};
    if (best.f - proven <= accuracy) break;
    lowest = std::min(lowest, value.f);
    rest.Cut(value.gradient, centroid);
  }
  if (best.f >= cutoff) return {cutoff, best.x};
  return best;
}

}  // namespace mjcf_pdg
