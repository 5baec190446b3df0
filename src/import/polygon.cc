#include "import/polygon.h"

#include <algorithm>
#include <numeric>

namespace mjcf_pdg {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kFlat = 1e-6;  // sine of an angle that counts as 0 or 180 degrees
// Least sine of an ear's angle, tried in this order: a clear ear, any ear, a flat one, and for
// polygons that are not simple any corner.
constexpr double kSlacks[] = {kFlat, 0.0, -kFlat, -2.0};

// The corners in the plane with the polygon's mean normal (2 × n), counter-clockwise.
Eigen::Matrix2Xd Flattened(const Eigen::Matrix3Xd& corners) {
  const Eigen::Index n = corners.cols();
  const Eigen::Matrix3Xd p = corners.colwise() - corners.col(0);
  Vector3d normal = Vector3d::Zero();
  for (Eigen::Index i = 0; i < n; ++i) {
    normal += Vector3d(p.col(i)).cross(Vector3d(p.col((i + 1) % n)));
  }
  const Vector3d x = normal.unitOrthogonal(), y = normal.normalized().cross(x);
  Eigen::Matrix2Xd flat(2, n);
  flat << x.transpose() * p, y.transpose() * p;
  return flat;
}

// Sine of the angle from a to b; 0 if one of them is zero.
double Sine(const Vector2d& a, const Vector2d& b) {
  const double lengths = a.norm() * b.norm();
  return lengths > 0.0 ? (a.x() * b.y() - a.y() * b.x()) / lengths : 0.0;
}

class EarCutter {
 public:
  explicit EarCutter(const Eigen::Matrix3Xd& corners)
      : p_(Flattened(corners)), next_(p_.cols()), previous_(p_.cols()) {
    const int n = static_cast<int>(p_.cols());
    for (int i = 0; i < n; ++i) {
      next_[i] = (i + 1) % n;
      previous_[next_[i]] = i;
    }
    for (int i = 0; i < n; ++i) {
      if (Turn(i) <= kFlat) not_convex_.push_back(i);
    }
  }

  std::vector<std::array<int, 3>> Cut() {
    std::vector<std::array<int, 3>> triangles;
    int i = 1;
    for (int left = static_cast<int>(p_.cols()); left >= 3; --left) {
      i = FindEar(i, left);
      triangles.push_back({previous_[i], i, next_[i]});
      next_[previous_[i]] = next_[i];
      previous_[next_[i]] = previous_[i];
      std::erase(not_convex_, i);
      i = next_[next_[i]];  // not always from the same corner: no fan of needles
    }
    return triangles;
  }

 private:
  double Turn(int i) const {
    return Sine(p_.col(i) - p_.col(previous_[i]), p_.col(next_[i]) - p_.col(i));
  }

  int FindEar(int begin, int left) const {
    for (const double slack : kSlacks) {
      int i = begin;
      for (int tried = 0; tried < left; ++tried, i = next_[i]) {
        if (IsEar(i, slack)) return i;
      }
    }
    return begin;
  }

  // True if the corner's triangle can be cut off. Only corners that are not convex need to be
  // looked at: if any corner is inside the triangle, so is one of these.
  bool IsEar(int i, double slack) const {
    if (Turn(i) <= slack) return false;
    Eigen::AlignedBox2d box(Vector2d(p_.col(i)));
    box.extend(Vector2d(p_.col(previous_[i]))).extend(Vector2d(p_.col(next_[i])));
    const Vector2d margin = Vector2d::Constant(kFlat * box.sizes().maxCoeff());
    const Eigen::AlignedBox2d near(box.min() - margin, box.max() + margin);
    return std::none_of(not_convex_.begin(), not_convex_.end(), [&](int other) {
      const Vector2d x = p_.col(other);
      return near.contains(x) && Covers(i, x, slack);
    });
  }

  // True if x is inside the ear i. A point at one of the ear's corners is not: a bridge to a hole
  // has two sides with equal ends.
  bool Covers(int i, const Vector2d& x, double slack) const {
    const Vector2d ear[3] = {p_.col(previous_[i]), p_.col(i), p_.col(next_[i])};
    for (int k = 0; k < 3; ++k) {
      if (x == ear[k] || Sine(ear[(k + 1) % 3] - ear[k], x - ear[k]) < -slack) return false;
    }
    return true;
  }

  Eigen::Matrix2Xd p_;
  std::vector<int> next_, previous_;
  std::vector<int> not_convex_;
};

}  // namespace

std::vector<std::array<int, 3>> CutPolygon(const Eigen::Matrix3Xd& corners) {
  if (corners.cols() == 3) return {{0, 1, 2}};
  return EarCutter(corners).Cut();
}

}  // namespace mjcf_pdg
