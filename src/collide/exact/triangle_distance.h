// The distance of two triangles, by FCL's test. This unit keeps FCL's internal header out of the
// others.
#ifndef MJCF_PDG_SRC_COLLIDE_EXACT_TRIANGLE_DISTANCE_H_
#define MJCF_PDG_SRC_COLLIDE_EXACT_TRIANGLE_DISTANCE_H_

#include <Eigen/Dense>

namespace mjcf_pdg {

// Returns the distance of the triangles with corners a and b, and their nearest points on_a, on_b.
// If they intersect it returns 0, and the points mean nothing. All in tree units (triangle_bvh.h),
// since FCL's test has absolute thresholds. `b` may be a segment: two of its corners are equal.
double TriangleDistance(const Eigen::Vector3d a[3], const Eigen::Vector3d b[3],
                        Eigen::Vector3d& on_a, Eigen::Vector3d& on_b);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_COLLIDE_EXACT_TRIANGLE_DISTANCE_H_
