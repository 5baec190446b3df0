// Exact signed distance of a capsule and a box.
//
// MuJoCo 4.0's own capsule-box test misses capsules that pierce the box, however deep. Both shapes
// are convex: outside, the distance from the segment to the box is a convex function of one
// parameter; inside, the depth is attained on a face of the Minkowski difference, whose normals are
// the box's faces and the cross products of its edges with the segment.
#ifndef MJCF_PDG_SRC_CAPSULE_BOX_H_
#define MJCF_PDG_SRC_CAPSULE_BOX_H_

#include <Eigen/Dense>

namespace mjcf_pdg {

// d = n · (p2 - p1) in whatever frame the question was asked; n is the unit normal from shape 1
// (the capsule) to shape 2 (the box), p1 and p2 are the witness points.
struct SignedGap {
  double distance = 0.0;
  Eigen::Vector3d p1 = Eigen::Vector3d::Zero();
  Eigen::Vector3d p2 = Eigen::Vector3d::Zero();
  Eigen::Vector3d n = Eigen::Vector3d::UnitX();
};

// In the box's frame: the capsule's segment from `a` to `b` and radius, the box's half sizes [m].
SignedGap CapsuleBoxGap(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double radius,
                        const Eigen::Vector3d& half);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_CAPSULE_BOX_H_
