#include "collide/terrain/on_terrain.h"

#include <algorithm>
#include <limits>

namespace mjcf_pdg {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// A core nearer to a prism than this counts as overlapping it [scene's size].
constexpr double kTooThin = 1e-6;
// Planes whose normals are nearly across a way bound its length by nothing useful.
constexpr double kGrazing = 0.05;
// A round geom overlaps a prism if it does by more than this, rounding apart [scene's size].
constexpr double kRounding = 1e-10;

}  // namespace

Vector3d Prism::Support(const Vector3d& n) const {
  double farthest = -kInfinity;
  Vector3d p = top[0];
  for (const Vector3d& corner : top) {
    const double across = n.x() * corner.x() + n.y() * corner.y();
    const double z = n.z() * corner.z() >= n.z() * base ? corner.z() : base;
    if (across + n.z() * z <= farthest) continue;
    farthest = across + n.z() * z;
    p = {corner.x(), corner.y(), z};
  }
  return p;
}

Vector3d Prism::Cross() const { return (top[1] - top[0]).cross(top[2] - top[0]); }

OnTerrain::OnTerrain(const SceneTables& tables, const PosedModel& posed, const KeptPair& pair)
    : support_(*tables.support),
      field_(*posed.model(), pair.geom1),
      geom_(pair.geom2),
      radius_(CoreRadius(*posed.model(), pair.geom2)),
      size_(tables.size) {
  const mjModel& m = *posed.model();
  const mjData& d = *posed.data();
  R_field_W_ = AsMatrix(d.geom_xmat + 9 * pair.geom1);
  field_x_W_ = AsVector(d.geom_xpos + 3 * pair.geom1);
  R_ = R_field_W_.transpose() * AsMatrix(d.geom_xmat + 9 * geom_);
  origin_ = R_field_W_.transpose() * (AsVector(d.geom_xpos + 3 * geom_) - field_x_W_);
  center_ = R_ * AsVector(m.geom_aabb + 6 * geom_);
  const Vector3d half = (AsVector(m.geom_aabb + 6 * geom_ + 3).array() - radius_).cwiseMax(0.0);
  half_edges_ = R_ * half.asDiagonal();
  const Vector3d reach = half_edges_.cwiseAbs().rowwise().sum();
  core_box_ = {center_ - reach, center_ + reach};
}

CellRange OnTerrain::CellsNear(const Vector3d& shift, double reach) const {
  const Vector3d at = origin_ + shift, around = Vector3d::Constant(reach);
  const Vector3d low = core_box_.min() + at - around, high = core_box_.max() + at + around;
  return field_.CellsUnder({low.head<2>(), high.head<2>()});
}

void OnTerrain::CollectPrisms(const CellRange& cells, const Vector3d& shift, double reach,
                              std::vector<NearPrism>& near) const {
  near.clear();
  const double lowest = core_box_.min().z() + shift.z() + origin_.z() - reach;
  NearPrism added;
  added.prism.base = field_.base() - origin_.z();
  for (added.row = cells.row_begin; added.row < cells.row_end; ++added.row) {
    for (added.col = cells.col_begin; added.col < cells.col_end; ++added.col) {
      if (field_.Top(added.row, added.col) < lowest) continue;
      for (int triangle = 0; triangle < 2; ++triangle) {
        added.prism.top = field_.Triangle(added.row, added.col, triangle);
        for (Vector3d& corner : added.prism.top) corner -= origin_;
        added.at_least = AtLeast(added.prism, shift, reach);
        if (added.at_least <= reach) near.push_back(added);
      }
    }
  }
}

// By the boxes of the two in the axes of the field; if those are within `reach`, also by the planes
// of the prism's top and of the faces of the core's own box.
double OnTerrain::AtLeast(const Prism& prism, const Vector3d& shift, double reach) const {
  const auto& [a, b, c] = prism.top;
  Vector3d low = a.cwiseMin(b).cwiseMin(c);
  low.z() = std::min(low.z(), prism.base);
  const Vector3d high = a.cwiseMax(b).cwiseMax(c);
  const Vector3d below = low - (core_box_.max() + shift), above = core_box_.min() + shift - high;
  const Vector3d gap = below.cwiseMax(above);
  const double by_boxes = std::min(gap.maxCoeff(), 0.0) + gap.cwiseMax(0.0).norm();
  if (by_boxes > reach) return by_boxes;
  const Vector3d n = prism.Normal();
  const double by_plane =
      n.dot(center_ + shift - a) - (n.transpose() * half_edges_).cwiseAbs().sum();
  double at_least = std::max(by_boxes, by_plane);
  const Vector3d from = center_ + shift;
  for (int axis = 0; axis < 3; ++axis) {
    Vector3d face = R_.col(axis);
    if (face.dot(a - from) < 0.0) face = -face;
    const double half = std::abs(face.dot(half_edges_.col(axis)));
    at_least = std::max(at_least, -prism.Farthest(-face) - face.dot(from) - half);
  }
  return at_least;
}

double OnTerrain::ExitBound(const Prism& prism, const Vector3d& u) const {
  // The plane of unit normal n, through the prism's farthest point: along u, the geom's ball
  // included.
  double exit = kInfinity;
  const auto consider = [&](const Vector3d& n, double farthest) {
    const double along = n.dot(u);
    if (!(along > kGrazing)) return;
    const double nearest = n.dot(center_) - (n.transpose() * half_edges_).cwiseAbs().sum();
    exit = std::min(exit, (farthest - nearest + radius_) / along);
  };
  consider(u, prism.Farthest(u));
  const Vector3d n = prism.Normal();
  consider(n, n.dot(prism.top[0]));
  for (int axis = 0; axis < 3; ++axis) {
    Vector3d face = R_.col(axis);
    if (face.dot(u) < 0.0) face = -face;
    consider(face, prism.Farthest(face));
  }
  return exit;
}

Prism OnTerrain::InField(Prism prism) const {
  for (Vector3d& corner : prism.top) corner += origin_;
  prism.base += origin_.z();
  return prism;
}

GjkEnding OnTerrain::Ask(const Prism& prism, const Vector3d& shift, double cutoff,
                         const GjkAccuracy& accuracy, GjkNearest& found) const {
  ++asked_;
  const auto support = [&](const Vector3d& n) {
    const Vector3d p1 = prism.Support(n), p2 = Support(-n) + shift;
    return Simplex::Corner{p1 - p2, p1, p2};
  };
  Simplex simplex;
  simplex.Add(support(prism.Cross()));
  return Gjk(support, kTooThin * size_, cutoff, accuracy, simplex, found);
}

bool OnTerrain::Overlap(const Prism& prism, const Vector3d& shift) const {
  return Nearer(prism, shift, std::max(radius_ - kRounding * size_, kTooThin * size_));
}

bool OnTerrain::CoreOverlaps(const Prism& prism, const Vector3d& shift) const {
  return Nearer(prism, shift, kTooThin * size_);
}

bool OnTerrain::Nearer(const Prism& prism, const Vector3d& shift, double apart) const {
  GjkNearest found;
  // The two bounds of the distance need only be on the same side of `apart`.
  const GjkAccuracy accuracy{.gap = kRounding * size_, .share = 0.9, .zero = apart, .last = 1.0};
  switch (Ask(prism, shift, apart, accuracy, found)) {
    case GjkEnding::kApart:
      return found.distance < apart;
    case GjkEnding::kBeyond:
      return false;
    default:
      return true;
  }
}

}  // namespace mjcf_pdg
