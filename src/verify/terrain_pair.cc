#include "verify/terrain_pair.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mjcf_pdg::verify {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Normals of the surface whose cosine is above this are the same way out.
constexpr double kSameWay = 0.98;
// A way out is turned towards the plane at its end so often, while that makes it shorter by this
// share.
constexpr int kMostTurns = 3;
constexpr double kShorter = 1e-6;
// Planes that are asked for the way out of one prism, and how often a way may lead into others.
constexpr int kMostPlanes = 40, kMostRounds = 8;

Vector3d UpwardNormal(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  return (b - a).cross(c - a).normalized();
}

}  // namespace

TerrainPair::TerrainPair(const PosedPair& posed) : shape_(posed.model.shapes[posed.pair.geom2]) {
  const mjModel& m = posed.model.unblinded;
  const int field = m.geom_dataid[posed.pair.geom1];
  size_ = m.hfield_size + 4 * field;
  heights_ = m.hfield_data + m.hfield_adr[field];
  rows_ = m.hfield_nrow[field];
  cols_ = m.hfield_ncol[field];
  R_field_ = GeomRotation(posed.data, posed.pair.geom1);
  field_W_ = VectorAt(posed.data.geom_xpos + 3 * posed.pair.geom1);
  R_ = R_field_.transpose() * GeomRotation(posed.data, posed.pair.geom2);
  const Vector3d origin_W = VectorAt(posed.data.geom_xpos + 3 * posed.pair.geom2);
  origin_ = R_field_.transpose() * (origin_W - field_W_);
  rounding_ = std::numeric_limits<double>::epsilon() * 64.0 *
              (posed.size() + origin_W.norm() + field_W_.norm());
}

Vector3d TerrainPair::Farthest(const Vector3d& n) const {
  return R_ * shape_.Support(R_.transpose() * n) + shape_.radius * n;
}

TerrainPair::Corners TerrainPair::PrismAt(int row, int col, int triangle) const {
  const std::array<std::array<int, 2>, 3> at =
      triangle == 0 ? std::array<std::array<int, 2>, 3>{{{0, 0}, {0, 1}, {1, 1}}}
                    : std::array<std::array<int, 2>, 3>{{{0, 0}, {1, 1}, {1, 0}}};
  Corners corners;
  for (int k = 0; k < 3; ++k) {
    const int r = row + at[k][0], c = col + at[k][1];
    corners[k] =
        Vector3d(size_[0] * (2.0 * c / (cols_ - 1) - 1.0), size_[1] * (2.0 * r / (rows_ - 1) - 1.0),
                 size_[2] * heights_[r * cols_ + c]) -
        origin_;
    corners[3 + k] = {corners[k].x(), corners[k].y(), -size_[3] - origin_.z()};
  }
  return corners;
}

template <typename Visit>
bool TerrainPair::ForEachPrism(const Vector3d& shift, double reach, Visit visit) const {
  const double beyond = reach + rounding_;
  const int cells[2] = {cols_ - 1, rows_ - 1};
  int first[2], last[2];
  for (int axis = 0; axis < 2; ++axis) {
    const Vector3d n = Vector3d::Unit(axis);
    const double at = origin_[axis] + shift[axis];
    const double per_metre = cells[axis] / (2.0 * size_[axis]);
    const double from = (at + Farthest(-n)[axis] - beyond + size_[axis]) * per_metre;
    const double to = (at + Farthest(n)[axis] + beyond + size_[axis]) * per_metre;
    if (!(to >= 0.0 && from <= cells[axis])) return true;
    first[axis] = static_cast<int>(std::clamp(std::floor(from), 0.0, cells[axis] - 1.0));
    last[axis] = static_cast<int>(std::clamp(std::floor(to), 0.0, cells[axis] - 1.0));
  }
  const double lowest = Farthest(-Vector3d::UnitZ()).z() + shift.z() - beyond;
  for (int row = first[1]; row <= last[1]; ++row) {
    for (int col = first[0]; col <= last[0]; ++col) {
      for (int triangle = 0; triangle < 2; ++triangle) {
        const Corners corners = PrismAt(row, col, triangle);
        const double top = std::max({corners[0].z(), corners[1].z(), corners[2].z()});
        if (top > lowest && !visit(corners)) return false;
      }
    }
  }
  return true;
}

// A certificate about one prism and the geom moved by `shift`, in the frame of the prism, which has
// its origin at the first corner: it measures, or decides about `needed`.
Certificate TerrainPair::About(const Corners& corners, const Vector3d& shift, double needed,
                               double cutoff, bool measure) const {
  Corners own;
  ConvexShape prism;
  prism.type = mjGEOM_HFIELD;
  for (int k = 0; k < 6; ++k) {
    own[k] = corners[k] - corners[0];
    prism.extent = std::max(prism.extent, own[k].norm());
  }
  prism.prism = &own;
  const ConvexPair pair{prism, shape_, R_, shift - corners[0]};
  Certificate found = measure
                          ? verify::Measure(pair, cutoff, Search::kLocal)
                          : Decide(pair, needed, UpwardNormal(corners[0], corners[1], corners[2]));
  found.p1 += corners[0];
  found.p2 += corners[0] - shift;
  return found;
}

// Whether the geom moved by `shift` does not overlap the prism. The plane of the prism's top, with
// the prism below, is a certificate; else one is sought.
bool TerrainPair::Parted(const Corners& corners, const Vector3d& shift) const {
  const Vector3d n = UpwardNormal(corners[0], corners[1], corners[2]);
  if (n.dot(Farthest(-n) + shift - corners[0]) >= -rounding_) return true;
  return About(corners, shift, -rounding_, 0.0, false).proof == Proof::kPlane;
}

// Whether the geom moved by `shift` overlaps no prism.
bool TerrainPair::Free(const Vector3d& shift) const {
  return ForEachPrism(shift, 0.0, [&](const Corners& corners) { return Parted(corners, shift); });
}

// Out of the field's box: past a side, below the base, or above all of it.
TerrainPair::Way TerrainPair::LeaveBox() const {
  const Vector3d low(-size_[0], -size_[1], -size_[3]), high(size_[0], size_[1], size_[2]);
  Way best{Vector3d::UnitZ(), Vector3d::UnitZ(), kInfinity};
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      const Vector3d u = sign * Vector3d::Unit(axis);
      const double side = sign * ((sign > 0.0 ? high : low)[axis] - origin_[axis]);
      const double length = side - u.dot(Farthest(-u));
      if (length < best.length) best = {u, u, length};
    }
  }
  return best;
}

// Up, and normals of the surface that the geom overlaps.
TerrainPair::Directions TerrainPair::WaysOut() const {
  Directions ways;
  ways.u[ways.size++] = Vector3d::UnitZ();
  ForEachPrism(Vector3d::Zero(), 0.0, [&](const Corners& corners) {
    const Vector3d n = UpwardNormal(corners[0], corners[1], corners[2]);
    const auto same = [&n](const Vector3d& known) { return known.dot(n) > kSameWay; };
    const bool known = std::any_of(ways.u.begin(), ways.u.begin() + ways.size, same);
    if (!known && !Parted(corners, Vector3d::Zero())) ways.u[ways.size++] = n;
    return ways.size < ways.u.size();
  });
  return ways;
}

Proof TerrainPair::Judge(double needed) const {
  const Vector3d here = Vector3d::Zero();
  if (needed > 0.0) {
    Proof proof = Proof::kPlane;
    ForEachPrism(here, needed, [&](const Corners& corners) {
      const Proof of_prism = About(corners, here, needed - rounding_, 0.0, false).proof;
      if (of_prism != Proof::kPlane) proof = of_prism;
      return proof != Proof::kPoints;
    });
    return proof;
  }
  if (Free(here) || Free(-needed * Vector3d::UnitZ())) return Proof::kPlane;
  const bool shown = !ForEachPrism(here, 0.0, [&](const Corners& corners) {
    return About(corners, here, needed - rounding_, 0.0, false).proof != Proof::kPoints;
  });
  if (shown) return Proof::kPoints;
  return Overlap().distance >= needed ? Proof::kPlane : Proof::kUnproven;
}

Reading TerrainPair::Measure(double cutoff) const {
  if (!Free(Vector3d::Zero())) {
    const Reading overlap = Overlap();
    return overlap.distance < cutoff ? overlap : Reading{.distance = kInfinity};
  }
  Certificate nearest;
  nearest.gap = std::max(cutoff, 0.0);
  bool any = false;
  ForEachPrism(Vector3d::Zero(), nearest.gap, [&](const Corners& corners) {
    const Vector3d n = UpwardNormal(corners[0], corners[1], corners[2]);
    if (n.dot(Farthest(-n) - corners[0]) >= nearest.gap) return true;
    const Certificate found = About(corners, Vector3d::Zero(), 0.0, nearest.gap, true);
    if (found.gap < nearest.gap) {
      nearest = found;
      any = true;
    }
    return true;
  });
  return any ? ToWorld(nearest) : Reading{.distance = kInfinity};
}

// How far the geom must go along u to leave one prism. It begins beyond the prism; each plane that
// parts the two there tells how far back it may come.
TerrainPair::Way TerrainPair::Leave(const Corners& corners, const Vector3d& u) const {
  Way way{u, u, -kInfinity};
  for (const Vector3d& corner : corners) way.length = std::max(way.length, u.dot(corner));
  way.length -= u.dot(Farthest(-u));
  for (int k = 0; k < kMostPlanes; ++k) {
    const Certificate plane = About(corners, way.length * u, 0.0, kInfinity, true);
    const double along = plane.n.dot(u);
    if (!(along > 0.0 && plane.gap > rounding_)) break;
    way.n = plane.n;
    way.length -= plane.gap / along;
  }
  return way;
}

// Replaces `best` by the way along the unit vector u if that is found to be shorter, and returns
// whether it is. The last round over the prisms is the proof that it leads out of all of them.
bool TerrainPair::Shorten(const Vector3d& u, Way& best) const {
  const double limit = best.length * (1.0 - kShorter);
  Way way{u, u, 0.0};
  const auto follow = [&](const Corners& corners) {
    const Way out = Leave(corners, u);
    if (out.length > way.length) way = out;
    return way.length < limit;
  };
  // The prism whose top, seen as a plane, is farthest comes first: it is likely to be the last.
  Corners farthest;
  double most = 0.0;
  ForEachPrism(Vector3d::Zero(), 0.0, [&](const Corners& corners) {
    const Vector3d n = UpwardNormal(corners[0], corners[1], corners[2]);
    const double deep = n.dot(corners[0] - Farthest(-n)), along = n.dot(u);
    if (along > 0.0 && deep > most * along) {
      most = deep / along;
      farthest = corners;
    }
    return true;
  });
  if (most > 0.0 && !Parted(farthest, Vector3d::Zero()) && !follow(farthest)) return false;
  for (int round = 0; round < kMostRounds; ++round) {
    bool parted = true;
    const bool shorter = ForEachPrism(way.length * u, 0.0, [&](const Corners& corners) {
      if (Parted(corners, way.length * u)) return true;
      parted = false;
      return follow(corners);
    });
    if (!shorter) return false;
    if (!parted) continue;
    best = way;
    return true;
  }
  return false;
}

// The shortest of the ways out, with the geom's farthest point against it.
Reading TerrainPair::Overlap() const {
  Way best = LeaveBox();
  const Directions ways = WaysOut();
  for (std::size_t k = 0; k < ways.size; ++k) Shorten(ways.u[k], best);
  for (int turn = 0; turn < kMostTurns; ++turn) {
    if (!Shorten(Vector3d(best.n), best)) break;
  }
  Certificate found;
  found.gap = -best.length;
  found.n = best.u;
  found.p2 = Farthest(-best.u);
  found.p1 = found.p2 + best.length * best.u;
  return ToWorld(found);
}

Reading TerrainPair::ToWorld(const Certificate& found) const {
  const auto point = [this](const Vector3d& p) {
    return Vector3d(field_W_ + R_field_ * (origin_ + p));
  };
  return {found.gap, R_field_ * found.n, point(found.p1), point(found.p2)};
}

}  // namespace mjcf_pdg::verify
