#include "bound/lower_bound_geom.h"

#include <cmath>
#include <stdexcept>

namespace mjcf_pdg {

Vector3d ConvexGeom::Support(const Vector3d& n) const {
  if (!support) {
    int farthest = 0;
    for (int k = 1; k < num_points_; ++k) {
      if (n.dot(points_G_[k]) > n.dot(points_G_[farthest])) farthest = k;
    }
    return points_G_[farthest];
  }
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
  switch (type) {
    case mjGEOM_PLANE:
      break;
    case mjGEOM_MESH:
      hull_ = support->HullPoints(geom);
      num_points_ = static_cast<int>(hull_.size());
      break;
    case mjGEOM_BOX:
      AddCorners(size);
      break;
    case mjGEOM_CYLINDER:
      AddPrism(size[0], size[1]);
      break;
    case mjGEOM_SPHERE:
    case mjGEOM_ELLIPSOID:
      AddPoint(0, 0, 0);
      radius = type == mjGEOM_ELLIPSOID ? size.maxCoeff() : size[0];
      break;
    case mjGEOM_CAPSULE:
      AddPoint(0, 0, size[1]);
      if (size[1] > 0.0) AddPoint(0, 0, -size[1]);
      radius = size[0];
      break;
    default:
      throw std::logic_error("a geom of this type has no extreme points");
  }
}

void ConvexGeom::Fill(std::span<const Vector3d> corners_W) {
  support = nullptr;
  round = false;
  core_radius = radius = 0.0;
  center.setZero();
  R.setIdentity();
  hull_ = {};
  num_points_ = 0;
  for (const Vector3d& corner : corners_W) AddPoint(corner.x(), corner.y(), corner.z());
}

void ConvexGeom::AddCorners(const Vector3d& half) {
  for (int i = 0; i < 8; ++i) {
    AddPoint(i & 1 ? half[0] : -half[0], i & 2 ? half[1] : -half[1], i & 4 ? half[2] : -half[2]);
  }
}

void ConvexGeom::AddPrism(double inner, double half) {
  const double outer = inner / std::cos(mjPI / kSides);
  for (int i = 0; i < kSides; ++i) {
    const double x = outer * std::cos(2 * mjPI * i / kSides);
    const double y = outer * std::sin(2 * mjPI * i / kSides);
    AddPoint(x, y, half);
    AddPoint(x, y, -half);
  }
}

}  // namespace mjcf_pdg
