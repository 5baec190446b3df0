// What a signed distance of two shapes comes with.
#ifndef MJCF_PDG_SRC_BASE_SIGNED_GAP_H_
#define MJCF_PDG_SRC_BASE_SIGNED_GAP_H_

#include <Eigen/Dense>

namespace mjcf_pdg {

// d = n · (p2 - p1) in whatever frame the question was asked; n is the unit normal from shape 1 to
// shape 2, p1 and p2 are the witness points.
struct SignedGap {
  double distance = 0.0;
  Eigen::Vector3d p1 = Eigen::Vector3d::Zero();
  Eigen::Vector3d p2 = Eigen::Vector3d::Zero();
  Eigen::Vector3d n = Eigen::Vector3d::UnitX();
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_BASE_SIGNED_GAP_H_
