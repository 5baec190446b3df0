// The pose of one frame in another.
#ifndef MJCF_PDG_SRC_BASE_RELATIVE_POSE_H_
#define MJCF_PDG_SRC_BASE_RELATIVE_POSE_H_

#include <Eigen/Dense>

namespace mjcf_pdg {

// The pose of frame b in frame a: x_a = R x_b + t.
struct RelativePose {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d t = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator*(const Eigen::Vector3d& x) const { return R * x + t; }
  RelativePose Inverse() const { return {R.transpose(), -(R.transpose() * t)}; }
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_BASE_RELATIVE_POSE_H_
