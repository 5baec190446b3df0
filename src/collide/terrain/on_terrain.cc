#include "collide/terrain/on_terrain.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mjcf_pdg {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// A core nearer to a prism than this counts as overlapping it [scene's size].
constexpr double kTooThin = 1e-6;
// Planes whose normals are nearly across a way bound its length by nothing useful.
constexpr double kGrazing = 0.05;
// Those with a smaller cosine than this are across it; so are directions with a smaller sine along
// each other.
constexpr double kNotAcross = 1e-6;
// An axis is upright, so that all others around it are level, if its sine is below this.
constexpr double kUpright = 1e-6;
// A round geom overlaps a prism if it does by more than this, rounding apart [scene's size].
constexpr double kRounding = 1e-10;

// Axes of a body of revolution around the third column of R, the first of them horizontal: then its
// box reaches least far down.
Matrix3d OneLevelAxis(const Matrix3d& R) {
  const Vector3d along = R.col(2), level = Vector3d::UnitZ().cross(along);
  const double length = level.norm();
  if (!(length > kUpright)) return R;
  Matrix3d axes;
  axes << level / length, along.cross(level / length), along;
  return axes;
}

// A lower bound of the distance of a box from what is below the height `top` in a cell of the grid,
// whose faces are parallel to the field's axes: by the two boxes, and by the planes below the faces
// of the box's own axes. A cell is told by its corner of least x and y, relative to the geom's
// origin like all else.
class CellBound {
 public:
  // `low` and `high` bound the box in the axes of the field.
  CellBound(const HeightField& field, const Vector3d& low, const Vector3d& high,
            const Matrix3d& axes, const Vector3d& center, const Vector3d& half)
      : dx_(field.dx()), dy_(field.dy()), low_(low), high_(high) {
    for (int k = 0; k < 3; ++k) {
      up_[k] = std::copysign(1.0, axes(2, k)) * axes.col(k);
      below_[k] = up_[k].dot(center) - half[k] - std::max(up_[k].x(), 0.0) * dx_ -
                  std::max(up_[k].y(), 0.0) * dy_;
    }
  }

  void SetRow(double y) {
    beside_y_ = std::max({low_.y() - (y + dy_), y - high_.y(), 0.0});
    for (int k = 0; k < 3; ++k) below_row_[k] = below_[k] - up_[k].y() * y;
  }
  // Whether the bound is no more than `reach`; then it is filled in.
  bool Within(double x, double top, double reach, double& at_least) const {
    const double beside_x = std::max({low_.x() - (x + dx_), x - high_.x(), 0.0});
    const double above = low_.z() - top, outside = std::max(above, 0.0);
    const double squared = beside_x * beside_x + beside_y_ * beside_y_ + outside * outside;
    if (squared > reach * reach) return false;
    at_least = squared > 0.0 ? std::sqrt(squared) : above;
    for (int k = 0; k < 3; ++k) {
      at_least = std::max(at_least, below_row_[k] - up_[k].x() * x - up_[k].z() * top);
    }
    return at_least <= reach;
  }

 private:
  double dx_, dy_;
  Vector3d low_, high_;
  Vector3d up_[3];
  double below_[3], below_row_[3] = {};
  double beside_y_ = 0.0;
};

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

Vector3d OnTerrain::Support(const Vector3d& n) const {
  if (core_ == Core::kOther) return R_ * support_.Support(geom_, R_.transpose() * n);
  Vector3d p = center_;
  for (int axis = core_ == Core::kBox ? 0 : 2; axis < 3; ++axis) {
    const Vector3d half = half_edges_.col(axis);
    p += half.dot(n) < 0.0 ? Vector3d(-half) : half;
  }
  return p;
}

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
  half_ = (AsVector(m.geom_aabb + 6 * geom_ + 3).array() - radius_).cwiseMax(0.0);
  const int type = m.geom_type[geom_];
  core_ = type == mjGEOM_CAPSULE || type == mjGEOM_SPHERE ? Core::kSegment
          : type == mjGEOM_BOX                            ? Core::kBox
                                                          : Core::kOther;
  axes_ = type == mjGEOM_CAPSULE || type == mjGEOM_CYLINDER ? OneLevelAxis(R_) : R_;
  half_edges_ = axes_ * half_.asDiagonal();
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
  if (cells.empty()) return;
  const Vector3d center = center_ + shift, low = core_box_.min() + shift;
  if (low.z() + origin_.z() - field_.Highest(cells) > reach) return;
  CellBound bound(field_, low, core_box_.max() + shift, axes_, center, half_);
  const double base = field_.base() - origin_.z();
  const int first_edge = core_ == Core::kSegment ? 2 : 0;  // those before have no length
  // The triangle whose normal is along (-x_slope, -y_slope, 1).
  const auto add = [&](double of_cell, double x_slope, double y_slope, const Vector3d& a,
                       const Vector3d& b, const Vector3d& c, int row, int col) {
    const Vector3d n(-x_slope, -y_slope, 1.0);
    double above = n.dot(center - a);
    for (int k = first_edge; k < 3; ++k) above -= std::abs(n.dot(half_edges_.col(k)));
    const double squared = n.squaredNorm();
    if (above > 0.0 && above * above > reach * reach * squared) return;
    NearPrism& added = near.emplace_back();
    added.at_least = std::max(of_cell, above / std::sqrt(squared));
    added.prism.top = {a, b, c};
    added.prism.base = base;
    added.row = row;
    added.col = col;
  };
  const auto height = [&](int row, int col) { return field_.Height(row, col) - origin_.z(); };
  const double per_dx = 1.0 / field_.dx(), per_dy = 1.0 / field_.dy();
  for (int row = cells.row_begin; row < cells.row_end; ++row) {
    const double y0 = field_.Y(row) - origin_.y(), y1 = field_.Y(row + 1) - origin_.y();
    double x0 = field_.X(cells.col_begin) - origin_.x();
    double z00 = height(row, cells.col_begin), z10 = height(row + 1, cells.col_begin);
    bound.SetRow(y0);
    for (int col = cells.col_begin; col < cells.col_end; ++col) {
      const double z01 = height(row, col + 1), z11 = height(row + 1, col + 1);
      const double x1 = field_.X(col + 1) - origin_.x();
      double of_cell = 0.0;
      if (bound.Within(x0, std::max(std::max(z00, z10), std::max(z01, z11)), reach, of_cell)) {
        const Vector3d p00(x0, y0, z00), p01(x1, y0, z01), p10(x0, y1, z10), p11(x1, y1, z11);
        add(of_cell, (z01 - z00) * per_dx, (z11 - z01) * per_dy, p00, p01, p11, row, col);
        add(of_cell, (z11 - z10) * per_dx, (z10 - z00) * per_dy, p00, p11, p10, row, col);
      }
      x0 = x1;
      z00 = z01;
      z10 = z11;
    }
  }
}

OnTerrain::WayPlanes OnTerrain::PlanesOf(const Vector3d& u) const {
  WayPlanes way;
  way.u = u;
  const auto consider = [&](const Vector3d& n) {
    const double along = n.dot(u);
    if (along > kGrazing) way.planes[way.count++] = {n, along, CoreNearest(n)};
  };
  consider(u);
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3d face = axes_.col(axis);
    consider(face.dot(u) < 0.0 ? Vector3d(-face) : face);
  }
  return way;
}

double OnTerrain::CoreNearest(const Vector3d& n) const {
  return n.dot(center_) - (n.transpose() * half_edges_).cwiseAbs().sum();
}

double OnTerrain::ExitBound(const Prism& prism, const WayPlanes& way) const {
  double exit = kInfinity;
  for (int k = 0; k < way.count; ++k) {
    const WayPlanes::Plane& plane = way.planes[k];
    const double farthest = prism.Farthest(plane.n);
    exit = std::min(exit, (farthest - plane.nearest + radius_) / plane.along);
  }
  const Vector3d n = prism.Normal();
  const double along = n.dot(way.u);
  if (!(along > kGrazing)) return exit;
  return std::min(exit, (n.dot(prism.top[0]) - CoreNearest(n) + radius_) / along);
}

bool OnTerrain::OverlapOfBox(const Prism& prism, const Vector3d& u, Stretch& overlap,
                             std::optional<double> at) const {
  if (core_ != Core::kBox) return false;
  overlap = {-kInfinity, kInfinity, u};
  // Returns false if more planes need not be considered.
  const auto consider = [&](const Vector3d& n) {
    const double along = n.dot(u), middle = n.dot(center_);
    const double half = (n.transpose() * half_edges_).cwiseAbs().sum();
    const auto [least, most] = prism.Extent(n);
    // What the core must move along n to reach the prism, and to be past it.
    const double to = least - middle - half, past = most - middle + half;
    if (along * along <= kNotAcross * kNotAcross * n.squaredNorm()) {
      if (to >= 0.0 || past <= 0.0) overlap.end = -kInfinity;
    } else {
      overlap.begin = std::max(overlap.begin, (along > 0.0 ? to : past) / along);
      const double end = (along > 0.0 ? past : to) / along;
      if (end < overlap.end) {
        overlap.end = end;
        overlap.n = along > 0.0 ? n : Vector3d(-n);
      }
    }
    return !at || (overlap.begin < *at && *at < overlap.end);
  };
  const auto across_axes = [&](const Vector3d& edge) {
    for (int axis = 0; axis < 3; ++axis) {
      const Vector3d n = edge.cross(Vector3d(axes_.col(axis)));
      // Along the axis itself there is no such plane.
      if (!(n.squaredNorm() > kNotAcross * kNotAcross * edge.squaredNorm())) continue;
      if (!consider(n)) return false;
    }
    return true;
  };
  const auto across_edges = [&] {
    for (int k = 0; k < 3; ++k) {
      const Vector3d edge = prism.top[(k + 1) % 3] - prism.top[k];
      if (!consider(edge.cross(Vector3d::UnitZ())) || !across_axes(edge)) return false;
    }
    return true;
  };
  const auto all = [&] {
    if (!consider(Vector3d::UnitZ()) || !consider(prism.Cross())) return false;
    for (int axis = 0; axis < 3; ++axis) {
      if (!consider(axes_.col(axis))) return false;
    }
    return across_axes(Vector3d::UnitZ()) && across_edges();
  };
  all();
  overlap.n.normalize();
  return true;
}

Prism OnTerrain::InField(Prism prism) const {
  for (Vector3d& corner : prism.top) corner += origin_;
  prism.base += origin_.z();
  return prism;
}

GjkEnding OnTerrain::Ask(const Prism& prism, const Vector3d& shift, double cutoff,
                         const GjkAccuracy& accuracy, GjkNearest& found) const {
  ++asked_;
  const Vector3d center = center_ + shift, half = half_edges_.col(2);
  NearestPoints guess;
  GjkEnding ending;
  const auto proves = [&] { return Proves(guess, prism, shift, cutoff, accuracy, found, ending); };
  if (core_ == Core::kSegment) {
    if (NearestOfSegment(prism.top, center - half, center + half, guess) && proves()) return ending;
  } else if (NearestOfFace(prism.top, Support(-prism.Cross()) + shift, guess)) {
    if (proves()) return ending;
  } else if (core_ == Core::kBox) {
    if (NearestOfCorner(prism.top, center, axes_, half_, guess) && proves()) return ending;
  }
  const auto support = [&](const Vector3d& n) {
    const Vector3d p1 = prism.Support(n), p2 = Support(-n) + shift;
    return Simplex::Corner{p1 - p2, p1, p2};
  };
  Simplex simplex;
  simplex.Add(support(prism.Cross()));
  return Gjk(support, kTooThin * size_, cutoff, accuracy, simplex, found);
}

// Whether the points are the nearest, by the plane normal to what is between them, or if that shows
// a distance of `cutoff` or more. Then fills `found` and `ending`, as Gjk would.
bool OnTerrain::Proves(const NearestPoints& guess, const Prism& prism, const Vector3d& shift,
                       double cutoff, const GjkAccuracy& accuracy, GjkNearest& found,
                       GjkEnding& ending) const {
  const Vector3d between = guess.p2 - guess.p1;
  const double distance = between.norm();
  if (!(distance > kTooThin * size_)) return false;
  const Vector3d n = between / distance;
  const double at_least = n.dot(Support(-n) + shift) - prism.Farthest(n);
  const double wanted = accuracy.gap + accuracy.share * std::abs(distance - accuracy.zero);
  const bool beyond = at_least >= cutoff;
  if (!beyond && distance - at_least > wanted) return false;
  ending = beyond ? GjkEnding::kBeyond : GjkEnding::kApart;
  found = {{-between, guess.p1, guess.p2}, n, distance};
  return true;
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
