#include "verify/sdf_pair.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "verify/exact/primitive_distance.h"

namespace mjcf_pdg::verify {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Steepest slope that the functions are assumed to have. MuJoCo's own plugins have up to 2 (nuts).
constexpr double kSlope = 2.0;
// Cells of a search, and of one around a low point.
constexpr int kMostCells = 6000, kZoomCells = 250;
// So many low points are looked at closely, in boxes that become smaller by kZoom until they are
// kFinest of the first.
constexpr int kLowPoints = 4, kMostZooms = 40;
constexpr double kZoom = 0.4, kFinest = 1e-5;

double BoxDistance(const Vector3d& half, const Vector3d& x) {
  const Vector3d outside = (x.cwiseAbs() - half).cwiseMax(0.0);
  return outside.norm() + std::min(0.0, (x.cwiseAbs() - half).maxCoeff());
}

// Of the convex hull of a mesh: the farthest of the planes of its faces.
double HullDistance(const mjModel& m, int mesh, const Vector3d& x) {
  double distance = -kInfinity;
  const int begin = m.mesh_polyadr[mesh], end = begin + m.mesh_polynum[mesh];
  for (int face = begin; face < end; ++face) {
    const int corner = m.mesh_vertadr[mesh] + m.mesh_polyvert[m.mesh_polyvertadr[face]];
    const float* p = m.mesh_vert + 3 * corner;
    const Vector3d n = VectorAt(m.mesh_polynormal + 3 * face);
    distance = std::max(distance, n.dot(x) - n.dot(Vector3d(p[0], p[1], p[2])));
  }
  return distance;
}

// Of the function of an SDF geom. That of a plugin is in the frame in which its mesh was made.
double SdfDistance(const mjModel& m, const mjData& d, int geom, Vector3d x) {
  const mjpPlugin* plugin = nullptr;
  int id = m.geom_dataid[geom];
  if (m.geom_plugin[geom] >= 0) {
    const Vector3d y = x;
    mju_rotVecQuat(x.data(), y.data(), m.mesh_quat + 4 * id);
    x += VectorAt(m.mesh_pos + 3 * id);
    plugin = mjc_getSDF(&m, geom);
    id = m.geom_plugin[geom];
  }
  mjtGeom type = mjGEOM_SDF;
  const mjSDF field = {&plugin, &id, mjSDFTYPE_SINGLE, nullptr, nullptr, &type};
  return mjc_distance(&m, &d, &field, x.data());
}

}  // namespace

Eigen::AlignedBox3d SdfPair::BoxOf(int geom) const {
  const mjModel& m = posed_.model.unblinded;
  const bool plane = m.geom_type[geom] == mjGEOM_PLANE;
  const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> R(posed_.data.geom_xmat +
                                                                         9 * geom);
  const Vector3d middle =
      VectorAt(posed_.data.geom_xpos + 3 * geom) + R * VectorAt(m.geom_aabb + 6 * geom);
  const Vector3d half = plane ? Vector3d(Vector3d::Constant(mjMAXVAL))
                              : Vector3d(R.cwiseAbs() * VectorAt(m.geom_aabb + 6 * geom + 3));
  return {middle - half, middle + half};
}

double SdfPair::Distance(int geom, const Vector3d& x_W) const {
  const mjModel& m = posed_.model.unblinded;
  const mjData& d = posed_.data;
  const Vector3d from = x_W - VectorAt(d.geom_xpos + 3 * geom);
  Vector3d x;
  mju_mulMatTVec3(x.data(), d.geom_xmat + 9 * geom, from.data());
  const Vector3d size = VectorAt(m.geom_size + 3 * geom);
  switch (m.geom_type[geom]) {
    case mjGEOM_SDF:
      return SdfDistance(m, d, geom, x);
    case mjGEOM_BOX:
      return BoxDistance(size, x);
    case mjGEOM_MESH:
      return HullDistance(m, m.geom_dataid[geom], x);
    default:
      return RoundDistanceAt(m.geom_type[geom], size, x);
  }
}

double SdfPair::Larger(const Vector3d& x_W) const {
  return std::max(Distance(posed_.pair.geom1, x_W), Distance(posed_.pair.geom2, x_W));
}

SdfPair::Cell SdfPair::MakeCell(const Vector3d& middle_W, const Vector3d& half) const {
  const double value = Larger(middle_W);
  return {value - kSlope * half.norm(), value, middle_W, half};
}

void SdfPair::Search(const Eigen::AlignedBox3d& box, double below, int most,
                     std::vector<Cell>& cells, Lowest& lowest) const {
  const auto higher = [](const Cell& a, const Cell& b) { return a.at_least > b.at_least; };
  const auto add = [&](const Vector3d& middle_W, const Vector3d& half) {
    const Cell cell = MakeCell(middle_W, half);
    if (cell.value < lowest.value) lowest = {cell.value, middle_W};
    if (!(cell.at_least < below)) return;
    cells.push_back(cell);
    std::push_heap(cells.begin(), cells.end(), higher);
  };
  cells.clear();
  add(box.center(), 0.5 * box.sizes());
  // The longest side is halved.
  for (int count = 0; count < most && !cells.empty(); ++count) {
    std::pop_heap(cells.begin(), cells.end(), higher);
    const Cell cell = cells.back();
    cells.pop_back();
    if (cell.at_least >= lowest.value) return;
    Eigen::Index side;
    cell.half.maxCoeff(&side);
    Vector3d half = cell.half, aside = Vector3d::Zero();
    half[side] *= 0.5;
    aside[side] = half[side];
    add(cell.middle_W - aside, half);
    add(cell.middle_W + aside, half);
  }
}

// The box is made smaller unless the lowest point has moved far in it: where the geoms are nearly
// parallel it is a long way to the lowest.
void SdfPair::ZoomIn(double half, Lowest& lowest) const {
  std::vector<Cell> cells;
  const double least = kFinest * half;
  for (int zoom = 0; zoom < kMostZooms && half > least; ++zoom) {
    const Vector3d around = Vector3d::Constant(half), before = lowest.x_W;
    Search({before - around, before + around}, kInfinity, kZoomCells, cells, lowest);
    if ((lowest.x_W - before).lpNorm<Eigen::Infinity>() < 0.5 * half) half *= kZoom;
  }
}

Reading SdfPair::Measure(double cutoff) const {
  Eigen::AlignedBox3d box = BoxOf(posed_.pair.geom1).intersection(BoxOf(posed_.pair.geom2));
  const double around = 0.5 * std::max(cutoff, 0.0);
  box.min().array() -= around;
  box.max().array() += around;
  if (box.isEmpty()) return {.distance = kInfinity};
  std::vector<Cell> cells;
  Lowest lowest{kInfinity, box.center()};
  Search(box, 0.5 * cutoff, kMostCells, cells, lowest);
  // Then the low points that are left, far from each other.
  std::sort(cells.begin(), cells.end(),
            [](const Cell& a, const Cell& b) { return a.value < b.value; });
  std::vector<Lowest> points = {lowest};
  const double apart = cells.empty() ? 0.0 : 4.0 * cells.front().half.norm();
  for (const Cell& cell : cells) {
    if (static_cast<int>(points.size()) == kLowPoints) break;
    const auto near = [&](const Lowest& p) { return (p.x_W - cell.middle_W).norm() < apart; };
    if (std::none_of(points.begin(), points.end(), near))
      points.push_back({cell.value, cell.middle_W});
  }
  for (Lowest& point : points) {
    if (cells.empty()) break;
    ZoomIn(apart, point);
    if (point.value < lowest.value) lowest = point;
  }
  const double f1 = Distance(posed_.pair.geom1, lowest.x_W);
  const double f2 = Distance(posed_.pair.geom2, lowest.x_W);
  Reading reading{.distance = 2.0 * std::max(f1, f2)};
  if (!(reading.distance < cutoff)) return {.distance = kInfinity};
  const double step = 1e-6 * posed_.size();
  Vector3d n;
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3d by = step * Vector3d::Unit(axis);
    n[axis] = Distance(posed_.pair.geom1, lowest.x_W + by) -
              Distance(posed_.pair.geom1, lowest.x_W - by) -
              Distance(posed_.pair.geom2, lowest.x_W + by) +
              Distance(posed_.pair.geom2, lowest.x_W - by);
  }
  reading.n_W = n.norm() > 0.0 ? Vector3d(n.normalized()) : Vector3d::UnitZ();
  reading.p1_W = lowest.x_W - f1 * reading.n_W;
  reading.p2_W = lowest.x_W + f2 * reading.n_W;
  return reading;
}

}  // namespace mjcf_pdg::verify
