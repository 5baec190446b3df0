#include "lower_bound_geom.h"

#include <cmath>
#include <limits>
#include <optional>

#include "mesh_hull.h"

namespace mjcf_pdg {
namespace {

void AddMeshPoints(const mjModel& m, int geom, ConvexGeom& shape) {
  const int mesh = m.geom_dataid[geom];
  const float* vert = m.mesh_vert + 3 * static_cast<std::ptrdiff_t>(m.mesh_vertadr[mesh]);
  auto add = [&](int vertex) {
    const float* v = vert + 3 * static_cast<std::ptrdiff_t>(vertex);
    shape.points.push_back(shape.center + shape.R * Vector3d(v[0], v[1], v[2]));
  };
  if (const std::optional<MeshHull> hull = HullOf(m, mesh)) {
    for (const int vertex : hull->vertices) add(vertex);
  } else {
    for (int vertex = 0; vertex < m.mesh_vertnum[mesh]; ++vertex) add(vertex);
  }
}

}  // namespace

Vector3d ConvexGeom::Support(const Vector3d& n) const {
  if (IsRound()) return RoundSupport(n);
  const Vector3d* best = &points[0];
  double far = -std::numeric_limits<double>::infinity();
  for (const Vector3d& p : points) {
    const double along = n.dot(p);
    if (along > far) {
      far = along;
      best = &p;
    }
  }
  return *best + radius * n.normalized();
}

Vector3d ConvexGeom::RoundSupport(const Vector3d& n) const {
  const Vector3d local = R.transpose() * n;
  if (type == mjGEOM_ELLIPSOID) {
    const Vector3d scaled = size.cwiseProduct(local);
    return center + R * size.cwiseProduct(scaled.normalized());
  }
  const double side = local.head<2>().norm();
  Vector3d p(0, 0, local.z() >= 0.0 ? size[1] : -size[1]);
  if (side > 1e-12) p.head<2>() = size[0] / side * local.head<2>();
  return center + R * p;
}

ConvexGeom ConvexGeomOf(const mjModel& m, const mjData& d, int geom) {
  ConvexGeom shape;
  shape.type = m.geom_type[geom];
  shape.center = AsVector(d.geom_xpos + 3 * geom);
  shape.R = AsMatrix(d.geom_xmat + 9 * geom);
  shape.size = AsVector(m.geom_size + 3 * geom);
  auto add = [&](double x, double y, double z) {
    shape.points.push_back(shape.center + shape.R * Vector3d(x, y, z));
  };
  const Vector3d& size = shape.size;
  if (shape.type == mjGEOM_MESH) {
    AddMeshPoints(m, geom, shape);
  } else if (shape.type == mjGEOM_BOX) {
    for (int i = 0; i < 8; ++i) {
      add(i & 1 ? size[0] : -size[0], i & 2 ? size[1] : -size[1], i & 4 ? size[2] : -size[2]);
    }
  } else if (shape.type == mjGEOM_CYLINDER) {
    constexpr int kSides = 12;  // of a prism about it
    const double outer = size[0] / std::cos(mjPI / kSides);
    for (int i = 0; i < kSides; ++i) {
      const double x = outer * std::cos(2 * mjPI * i / kSides);
      const double y = outer * std::sin(2 * mjPI * i / kSides);
      add(x, y, size[1]);
      add(x, y, -size[1]);
    }
  } else {
    const double half = shape.type == mjGEOM_CAPSULE ? size[1] : 0.0;
    add(0, 0, half);
    if (half > 0.0) add(0, 0, -half);
    shape.radius = shape.type == mjGEOM_ELLIPSOID ? size.maxCoeff() : size[0];
  }
  return shape;
}

}  // namespace mjcf_pdg
