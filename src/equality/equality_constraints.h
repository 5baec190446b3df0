// The equality constraints e(q) = 0 that are held while solving: joint and tendon couplings,
// connects and welds. Residuals and Jacobians are those of MuJoCo (mj_makeConstraint), so that what
// is held here is what a simulation holds.
//
// Not in the source, whose models are trees of joints.
#ifndef MJCF_PDG_SRC_EQUALITY_EQUALITY_CONSTRAINTS_H_
#define MJCF_PDG_SRC_EQUALITY_EQUALITY_CONSTRAINTS_H_

#include <memory>
#include <span>
#include <vector>

#include "model/kinematics.h"

namespace mjcf_pdg {

// One per thread. Costs nothing where the scene holds no equality constraint.
class EqualityConstraints {
 public:
  explicit EqualityConstraints(const SceneTables& tables);
  EqualityConstraints(const EqualityConstraints&) = delete;
  EqualityConstraints& operator=(const EqualityConstraints&) = delete;

  // Both take effect with the next call. `active` has an entry per equality constraint of the model
  // (mjData::eq_active); empty: as in the model.
  void SetMocap(const MocapPoses& poses);
  void SetActive(std::span<const mjtBool> active);
  std::span<const mjtBool> active() const;  // those that are held

  bool any() const { return any_; }  // some constraint is held

  // Evaluates the constraints at q (nq entries): residual() and jacobian().
  void Linearize(const VectorXd& q);
  const VectorXd& residual() const { return residual_; }  // k entries [m or rad]
  const MatrixXd& jacobian() const { return jacobian_; }  // k × n, of residual() by dq

  // The largest residual at q; 0 if none is held [m or rad].
  double Violation(const VectorXd& q);

  // Brings q, which is inside its limits, onto the constraints by Gauss-Newton steps that change
  // it least (a rotation counts as the arc at the scene's size) and stay inside limits. Returns
  // whether they hold then; if not, q is as near as it came.
  bool Project(VectorXd& q);

 private:
  double Largest() const { return residual_.size() ? residual_.lpNorm<Eigen::Infinity>() : 0.0; }
  void ScaleRows();
  bool Correct(const VectorXd& q);

  const SceneTables& tables_;
  mjModel model_;                      // with equality rows alone
  std::unique_ptr<PosedModel> posed_;  // null if no constraint is ever held
  bool any_ = false, has_tendons_ = false;
  VectorXd residual_, step_;
  MatrixXd jacobian_;
  VectorXd weight_;  // per dof: the inverse of what a unit of it counts
  Eigen::CompleteOrthogonalDecomposition<MatrixXd> solver_;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_EQUALITY_EQUALITY_CONSTRAINTS_H_
