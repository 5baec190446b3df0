// Signed distances of planes and round primitives from points and triangles, for the verifier. The
// least distance of a triangle is found by nested golden section searches: slow, and by another
// method than the solver's (collide/exact/primitive_sdf.h).
#ifndef MJCF_PDG_SRC_VERIFY_EXACT_PRIMITIVE_DISTANCE_H_
#define MJCF_PDG_SRC_VERIFY_EXACT_PRIMITIVE_DISTANCE_H_

#include <Eigen/Dense>

namespace mjcf_pdg::verify {

// The signed distance [m] of the point x, in the geom frame, from a plane (the half-space z <= 0),
// sphere, capsule, ellipsoid or cylinder. `type` is an mjtGeom, `size` is as in geom_size.
double RoundDistanceAt(int type, const Eigen::Vector3d& size, const Eigen::Vector3d& x);

// The least RoundDistanceAt over the points of a triangle; x becomes a point that has it.
double RoundDistanceOnTriangle(int type, const Eigen::Vector3d& size,
                               const Eigen::Vector3d corners[3], Eigen::Vector3d& x);

// The unit gradient of RoundDistanceAt at x, by central differences; the z axis where it is zero.
Eigen::Vector3d RoundNormalAt(int type, const Eigen::Vector3d& size, const Eigen::Vector3d& x);

}  // namespace mjcf_pdg::verify

#endif  // MJCF_PDG_SRC_VERIFY_EXACT_PRIMITIVE_DISTANCE_H_
