// The local optimum of σ that an answer is at, to full precision: sequential quadratic programming
// with exact second derivatives, which a solve does without. It ends within 1e-4 of the optimum
// or so, which moves σ by 1e-8 of itself but its derivatives by 1e-4.
//
// The optimum is that of ½σ subject to the rows of PartedConstraints, with multipliers λ: the point
// where the gradient of the Lagrangian ½σ - λ·g by q and by the planes is zero.
#ifndef MJCF_PDG_SRC_GRADIENT_CONVERGED_OPTIMUM_H_
#define MJCF_PDG_SRC_GRADIENT_CONVERGED_OPTIMUM_H_

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "gradient/parted_constraints.h"
#include "optimize/lcp.h"
#include "problem/workspace.h"

namespace mjcf_pdg {

// The steps of finite differences, which are central and of analytic first derivatives: rotations
// [rad]; translations [size]. Their own error is then some 1e-10 of the derivative, and rounding
// adds as much.
inline constexpr double kTurnStep = 1e-5, kSlideStep = 1e-4;
double DifferenceStep(const SceneTables& all, const JointEntry& joint, int k);

// The unknowns are y = (movable entries of dq, n; the planes' unknowns).
class ConvergedOptimum {
 public:
  // `work` is at its problem; `all` is WithAllJoints of its tables. Both are kept by reference.
  ConvergedOptimum(Workspace& work, const SceneTables& all);

  void SetMocap(const MocapPoses& poses) { constraints_.SetMocap(poses); }

  enum class Ending {
    kConverged,
    kNotSmooth,     // a near pair has no smooth distance: q is the answer as it was
    kNotConverged,  // q is where the steps ended
  };
  // From the answer q (nq) of the workspace's problem.
  Ending Run(const VectorXd& q);

  const VectorXd& q() const { return q_; }                               // nq
  const PartedConstraints& constraints() const { return constraints_; }  // evaluated at q()
  const VectorXd& lambda() const { return lambda_; }  // per row; 0: not active [m per unit of row]
  double moved() const { return moved_; }             // √σ from the answer to q(), about [m]

  // The near pairs whose planes are idle, at q(), where the finder stays posed.
  const std::vector<NearPair>& IdlePairs();

  int unknowns() const { return work_.problem().tables.n + constraints_.plane_unknowns(); }
  // Evaluates the rows at q(), after Forces or SecondDerivative has done so elsewhere.
  void Evaluate() { constraints_.Evaluate(q_); }
  // The row's derivative by y.
  Eigen::RowVectorXd RowByUnknowns(int row) const;
  // The Lagrangian's second derivative by y at q(), for λ.
  void SecondDerivative(const VectorXd& lambda, MatrixXd& second);
  // Σ λ times the rows' derivatives, at q, by dq of all joints (nv) and by the planes' unknowns.
  void Forces(const VectorXd& q, const VectorXd& lambda, VectorXd& by_q, VectorXd& by_plane);

 private:
  const std::vector<NearPair>& FindNear();
  VectorXd PlaneCost() const;
  void RecallForces();
  bool FactorExact(const VectorXd& plane_cost);
  void FactorNorm(const VectorXd& plane_cost);
  void SolveRows();
  double LargestTurn() const;
  double Step();
  double HeldTurn();

  Workspace& work_;
  const SceneTables& all_;
  PartedConstraints constraints_;
  VectorXd q_, lambda_, r_, y_, z_, step_;
  MatrixXd J_, H_, G_;
  std::vector<NearPair> idle_;
  std::unordered_map<std::int64_t, double> known_;  // λ of the last step, by key
  Eigen::LLT<MatrixXd> whitening_;
  ActiveSetLcp lcp_;
  double moved_ = 0.0;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_GRADIENT_CONVERGED_OPTIMUM_H_
