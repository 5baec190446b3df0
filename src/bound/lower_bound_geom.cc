#include "bound/lower_bound_geom.h"

#include <cmath>

#include "ccd/motion_bound.h"

namespace mjcf_pdg {
Vector3d ConvexGeom::Support(const Vector3d& n) const {
  const Vector3d p = center + R * support->Farthest(geom, R.transpose() * n);
  return core_radius > 0.0 ? p + core_radius * n.normalized() : p;
}

ConvexGeom ConvexGeomOf(const PosedModel& posed, const SupportPoints& support, int geom) {
  const mjModel& m = *posed.model();
  const mjData& d = *posed.data();
  ConvexGeom shape;
  shape.support = &support;
  shape.geom = geom;
  const int type = m.geom_type[geom];
  shape.round = type == mjGEOM_ELLIPSOID || type == mjGEOM_CYLINDER;
  shape.core_radius = CoreRadius(m, geom);
  shape.center = AsVector(d.geom_xpos + 3 * geom);
  shape.R = AsMatrix(d.geom_xmat + 9 * geom);
  auto add = [&](double x, double y, double z) {
    shape.points.push_back(shape.center + shape.R * Vector3d(x, y, z));
  };
  const Vector3d size = AsVector(m.geom_size + 3 * geom);
  if (type == mjGEOM_MESH) {
    for (const Eigen::Vector3f& p : support.HullPoints(geom)) add(p.x(), p.y(), p.z());
  } else if (type == mjGEOM_BOX) {
    for (int i = 0; i < 8; ++i) {
      add(i & 1 ? size[0] : -size[0], i & 2 ? size[1] : -size[1], i & 4 ? size[2] : -size[2]);
    }
  } else if (type == mjGEOM_CYLINDER) {
    constexpr int kSides = 12;  // of a prism about it
    const double outer = size[0] / std::cos(mjPI / kSides);
    for (int i = 0; i < kSides; ++i) {
      const double x = outer * std::cos(2 * mjPI * i / kSides);
      const double y = outer * std::sin(2 * mjPI * i / kSides);
      add(x, y, size[1]);
      add(x, y, -size[1]);
    }
  } else {
    const double half = type == mjGEOM_CAPSULE ? size[1] : 0.0;
    add(0, 0, half);
    if (half > 0.0) add(0, 0, -half);
    shape.radius = type == mjGEOM_ELLIPSOID ? size.maxCoeff() : size[0];
  }
  return shape;
}

}  // namespace mjcf_pdg
