// The signed distance of two shapes with its witness points and normal: what all narrow phases
// give.
#ifndef MJCF_PDG_SRC_BASE_SIGNED_GAP_H_
#define MJCF_PDG_SRC_BASE_SIGNED_GAP_H_

#include <Eigen/Dense>

namespace mjcf_pdg {

// In the frame and unit of length of the query that fills it. distance = n · (p2 - p1), except
// where the query says that the depth is unknown.
struct SignedGap {
  double distance = 0.0;                         // negative: the shapes overlap
  Eigen::Vector3d p1 = Eigen::Vector3d::Zero();  // witness point on shape 1
  Eigen::Vector3d p2 = Eigen::Vector3d::Zero();  // witness point on shape 2
  Eigen::Vector3d n = Eigen::Vector3d::UnitX();  // unit normal from shape 1 to shape 2
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_BASE_SIGNED_GAP_H_
