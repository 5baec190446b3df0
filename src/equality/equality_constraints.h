// The equality constraints e(q) = 0 that are held while solving: joint and tendon couplings,
// connects and welds; and with them the limits of tendons that are held. Residuals and Jacobians
// are those of MuJoCo (mj_makeConstraint), so that what is held here is what a simulation holds.
//
// Not in the source, whose models are trees of joints.
#ifndef MJCF_PDG_SRC_EQUALITY_EQUALITY_CONSTRAINTS_H_
#define MJCF_PDG_SRC_EQUALITY_EQUALITY_CONSTRAINTS_H_

#include <memory>
#include <span>
#include <vector>

#include "equality/tendon_limits.h"
#include "model/kinematics.h"

namespace mjcf_pdg {

// One per thread. Costs nothing where the scene holds neither an equality constraint nor a tendon
// limit.
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

  bool any() const { return any_; }  // some constraint is held, or some tendon limit

  // Evaluates the constraints at q (nq entries): residual(), jacobian() and tendon_limits(). Costs
  // nothing where the last evaluation was at that q.
  void Linearize(const VectorXd& q);
  const VectorXd& residual() const { return residual_; }  // k entries [m or rad]
  const MatrixXd& jacobian() const { return jacobian_; }  // k × n, of residual() by dq

  const TendonLimits& tendon_limits() const { return tendon_limits_; }

  // The largest residual, or excess of a tendon limit, at q; 0 if none is held [m or rad].
  double Violation(const VectorXd& q);

  // Brings q, which is inside its limits, onto the constraints and inside the tendon limits by
  // Gauss-Newton steps that change it least (a rotation counts as the arc at the scene's size) and
  // stay inside limits. Returns whether they hold then; if not, q is as near as it came.
  bool Project(VectorXd& q);

 private:
  double Largest() const;
  void ScaleRows();
  void CollectBroken();
  bool Correct(const VectorXd& q);
  void Mend(const VectorXd& weight);
  bool MendByGram();

  const SceneTables& tables_;
  mjModel model_;                      // with equality rows alone
  std::unique_ptr<PosedModel> posed_;  // null if no constraint is ever held
  TendonLimits tendon_limits_;
  bool any_ = false, equalities_ = false, tendons_ = false;  // equalities_: some is held; tendons_:
  VectorXd residual_, step_;                                 // mj_tendon is needed
  VectorXd nearest_;                                         // q where Project came nearest
  MatrixXd jacobian_;
  VectorXd broken_;  // the residuals, and tendon limits that are exceeded as if they were residuals
  MatrixXd broken_jacobian_;
  VectorXd weight_;         // per dof: the inverse of what a unit of it counts
  VectorXd linearized_at_;  // q of the last Linearize; empty: another evaluation is needed
  // Scratch of Mend.
  MatrixXd weighted_, gram_;
  VectorXd forces_;
  Eigen::LDLT<MatrixXd> of_gram_;
  Eigen::CompleteOrthogonalDecomposition<MatrixXd> solver_;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_EQUALITY_EQUALITY_CONSTRAINTS_H_
