// Convex geoms as the lower bound sees them: a farthest point along a direction, extreme points.
//
// Part of lower_bound.h.
#ifndef MJCF_PDG_SRC_BOUND_LOWER_BOUND_GEOM_H_
#define MJCF_PDG_SRC_BOUND_LOWER_BOUND_GEOM_H_

#include <mujoco/mujoco.h>

#include <vector>

#include "collide/convex/support_points.h"
#include "model/kinematics.h"

namespace mjcf_pdg {

// At q_in, in world axes.
struct ConvexGeom {
  const SupportPoints* support = nullptr;
  int geom = 0;
  double core_radius = 0.0;  // by which it exceeds its support points [m]
  Vector3d center;
  Matrix3d R;
  // The geom is the hull of the points, grown by the radius; a round geom is inside that.
  std::vector<Vector3d> points;
  double radius = 0.0;
  bool round = false;  // a cylinder or ellipsoid, whose points are not its own

  // The geom's farthest point along n.
  Vector3d Support(const Vector3d& n) const;
};

// Any geom with a signed distance; of a plane, nothing but center and R is of use.
ConvexGeom ConvexGeomOf(const PosedModel& posed, const SupportPoints& support, int geom);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_BOUND_LOWER_BOUND_GEOM_H_
