#include "norm/change.h"

#include <cmath>

namespace mjcf_pdg {

void Change(const SceneTables& tables, const VectorXd& from, const VectorXd& to, VectorXd& X,
            MatrixXd* D) {
  X.resize(tables.n);
  if (D) D->setIdentity(tables.n, tables.n);
  for (const JointEntry& joint : tables.joints) {
    if (joint.type == mjJNT_SLIDE) {
      X[joint.col] = to[joint.qadr] - from[joint.qadr];
    } else if (joint.type == mjJNT_HINGE) {
      const double half = 0.5 * (to[joint.qadr] - from[joint.qadr]);
      X[joint.col] = 2.0 * std::sin(half);
      if (D) (*D)(joint.col, joint.col) = std::cos(half);
    } else {
      if (joint.type == mjJNT_FREE) {
        X.segment<3>(joint.col) = to.segment<3>(joint.qadr) - from.segment<3>(joint.qadr);
      }
      const int adr = QuatAddress(joint), col = RotationColumn(joint);
      Eigen::Quaterniond p = QuatAt(from, adr).conjugate() * QuatAt(to, adr);
      if (p.w() < 0.0) p.coeffs() = -p.coeffs();
      X.segment<3>(col) = 2.0 * p.vec();
      if (D) D->block<3, 3>(col, col) = p.w() * Matrix3d::Identity() + Skew(p.vec());
    }
  }
}

}  // namespace mjcf_pdg
