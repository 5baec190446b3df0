// The independent check's own least signed distance of a primitive over a triangle, by golden
// sections: slow, and another road than the solver's (primitive_sdf.h).
#ifndef MJCF_PDG_SRC_VERIFY_PRIMITIVE_DISTANCE_H_
#define MJCF_PDG_SRC_VERIFY_PRIMITIVE_DISTANCE_H_

#include <Eigen/Dense>

namespace mjcf_pdg::verify {

// Signed distance of x from a plane (z <= 0), sphere, capsule, ellipsoid or cylinder in its own
// frame [m]. `type` is mjtGeom, `size` MuJoCo's.
double RoundDistanceAt(int type, const Eigen::Vector3d& size, const Eigen::Vector3d& x);

// Its least value on a triangle; x becomes the point.
double RoundDistanceOnTriangle(int type, const Eigen::Vector3d& size,
                               const Eigen::Vector3d corners[3], Eigen::Vector3d& x);

// The unit normal at x, by differences.
Eigen::Vector3d RoundNormalAt(int type, const Eigen::Vector3d& size, const Eigen::Vector3d& x);

}  // namespace mjcf_pdg::verify

#endif  // MJCF_PDG_SRC_VERIFY_PRIMITIVE_DISTANCE_H_
