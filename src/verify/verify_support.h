// The independent check's own bound on overlaps: supporting planes of convex geoms.
#ifndef MJCF_PDG_SRC_VERIFY_VERIFY_SUPPORT_H_
#define MJCF_PDG_SRC_VERIFY_VERIFY_SUPPORT_H_

#include <mujoco/mujoco.h>

#include <Eigen/Dense>

namespace mjcf_pdg {

// The largest signed distance along directions from geom 1 to geom 2 as posed in `d`, sought around
// the unit vector n_W until it is `enough` [m]: of spheres, capsules, ellipsoids, cylinders, boxes
// and hulls of meshes. Moving geom 2 by its negative along that direction parts them, so that it is
// never above the true signed distance, whatever n_W is.
double DistanceAlong(const mjModel& m, const mjData& d, int geom1, int geom2,
                     const Eigen::Vector3d& n_W, double enough);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_VERIFY_VERIFY_SUPPORT_H_
