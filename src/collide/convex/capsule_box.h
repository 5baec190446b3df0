// Exact signed distance of a capsule and a box; ContactFinder uses it for all such pairs.
//
// MuJoCo 4.0's own capsule-box test misses capsules that pierce the box, however deep. If the
// capsule's segment and the box are apart, the distance is the minimum of a convex function of one
// parameter along the segment. If they meet, the penetration depth is attained on a face of their
// Minkowski difference; the normals of these faces are those of the box's faces and the cross
// products of its edges with the segment.
#ifndef MJCF_PDG_SRC_COLLIDE_CONVEX_CAPSULE_BOX_H_
#define MJCF_PDG_SRC_COLLIDE_CONVEX_CAPSULE_BOX_H_

#include <Eigen/Dense>

#include "base/signed_gap.h"

namespace mjcf_pdg {

// The signed distance of capsule (shape 1) and box (shape 2), in the box's frame [m]: negative
// where they overlap. `a` and `b` are the ends of the capsule's segment, `half` the box's half
// sizes.
SignedGap CapsuleBoxGap(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double radius,
                        const Eigen::Vector3d& half);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_COLLIDE_CONVEX_CAPSULE_BOX_H_
