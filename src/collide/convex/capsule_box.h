// Exact signed distance of a capsule and a box.
//
// MuJoCo 4.0's own capsule-box test misses capsules that pierce the box, however deep. Both shapes
// are convex: outside, the distance from the segment to the box is a convex function of one
// parameter; inside, the depth is attained on a face of the Minkowski difference, whose normals are
// the box's faces and the cross products of its edges with the segment.
#ifndef MJCF_PDG_SRC_COLLIDE_CONVEX_CAPSULE_BOX_H_
#define MJCF_PDG_SRC_COLLIDE_CONVEX_CAPSULE_BOX_H_

#include <Eigen/Dense>

#include "base/signed_gap.h"

namespace mjcf_pdg {

// From the capsule to the box, in the box's frame: the capsule's segment from `a` to `b` and
// radius, the box's half sizes [m].
SignedGap CapsuleBoxGap(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double radius,
                        const Eigen::Vector3d& half);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_COLLIDE_CONVEX_CAPSULE_BOX_H_
