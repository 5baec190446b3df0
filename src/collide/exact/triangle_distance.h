// The distance of two triangles: FCL's test, which it keeps in an internal header.
#ifndef MJCF_PDG_SRC_COLLIDE_EXACT_TRIANGLE_DISTANCE_H_
#define MJCF_PDG_SRC_COLLIDE_EXACT_TRIANGLE_DISTANCE_H_

#include <Eigen/Dense>

namespace mjcf_pdg {

// 0 where they intersect, and on_a, on_b are then any points; else the nearest points. Tree units
// (triangle_bvh.h); `b` may be a segment, with two equal corners.
double TriangleDistance(const Eigen::Vector3d a[3], const Eigen::Vector3d b[3],
                        Eigen::Vector3d& on_a, Eigen::Vector3d& on_b);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_COLLIDE_EXACT_TRIANGLE_DISTANCE_H_
