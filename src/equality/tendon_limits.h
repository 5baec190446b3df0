// The length limits of tendons that are held while solving: lo <= L(q) <= hi.
//
// Not in the source, which knows the limits of joints alone (Tang & Kim, Sec. 5.3).
#ifndef MJCF_PDG_SRC_EQUALITY_TENDON_LIMITS_H_
#define MJCF_PDG_SRC_EQUALITY_TENDON_LIMITS_H_

#include <vector>

#include "model/kinematics.h"

namespace mjcf_pdg {

// One per thread. Two limits a tendon, in order of ids: that of L - lo and that of hi - L.
class TendonLimits {
 public:
  explicit TendonLimits(const SceneTables& tables);

  bool any() const { return !tendons_.empty(); }

  // Evaluates the limits at the pose of `d`, for which mj_tendon has run.
  void Linearize(const mjData& d);
  // What is left of each limit, negative if it is exceeded [m; of a fixed tendon in units of its
  // joints times their coefficients].
  const VectorXd& slack() const { return slack_; }
  const MatrixXd& jacobian() const { return jacobian_; }  // of slack() by dq, a row per limit
  // By what a limit's row is multiplied to count like those of joints: the joint that changes it
  // fastest then changes it by its travel, or by its arc at the scene's size. 0: no joint does.
  const VectorXd& scale() const { return scale_; }

  // The largest excess; 0 if all limits hold.
  double Excess() const;

 private:
  const SceneTables& tables_;
  std::vector<int> tendons_;  // ids in the model
  VectorXd slack_, scale_;
  MatrixXd jacobian_;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_EQUALITY_TENDON_LIMITS_H_
