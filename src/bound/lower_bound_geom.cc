#include "bound/lower_bound_geom.h"

#include <cmath>

namespace mjcf_pdg {

Vector3d ConvexGeom::Support(const Vector3d& n) const {
  const Vector3d p = center + R * support->Support(geom, R.transpose() * n);
  return core_radius > 0.0 ? p + core_radius * n.normalized() : p;
}

void ConvexGeom::Fill(const PosedModel& posed, const SupportPoints& support_points, int geom_id) {
  const mjModel& m = *posed.model();
  const mjData& d = *posed.data();
  support = &support_points;
  geom = geom_id;
  const int type = m.geom_type[geom];
  round = type == mjGEOM_ELLIPSOID || type == mjGEOM_CYLINDER;
  core_radius = CoreRadius(m, geom);
  center = AsVector(d.geom_xpos + 3 * geom);
  R = AsMatrix(d.geom_xmat + 9 * geom);
  radius = 0.0;
  hull_ = {};
  num_points_ = 0;
  const Vector3d size = AsVector(m.geom_size + 3 * geom);
  if (type == mjGEOM_MESH) {
    hull_ = support->HullPoints(geom);
    num_points_ = static_cast<int>(hull_.size());
  } else if (type == mjGEOM_BOX) {
    for (int i = 0; i < 8; ++i) {
      AddPoint(i & 1 ? size[0] : -size[0], i & 2 ? size[1] : -size[1], i & 4 ? size[2] : -size[2]);
    }
  } else if (type == mjGEOM_CYLINDER) {
    const double outer = size[0] / std::cos(mjPI / kSides);
    for (int i = 0; i < kSides; ++i) {
      const double x = outer * std::cos(2 * mjPI * i / kSides);
      const double y = outer * std::sin(2 * mjPI * i / kSides);
      AddPoint(x, y, size[1]);
      AddPoint(x, y, -size[1]);
    }
  } else {
    const double half = type == mjGEOM_CAPSULE ? size[1] : 0.0;
    AddPoint(0, 0, half);
    if (half > 0.0) AddPoint(0, 0, -half);
    radius = type == mjGEOM_ELLIPSOID ? size.maxCoeff() : size[0];
  }
}

}  // namespace mjcf_pdg
