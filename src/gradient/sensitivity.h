// Implicit differentiation of the optimality conditions: how σ and q change with q_in.
//
// With y the unknowns (movable dq, planes), g_A the active rows and L = ½σ - λ·g, the optimum has
// L_y = 0 and g_A = 0. By a parameter p, one of the nv entries of a change of q_in,
//
//   L_yy dy + L_yp - G_Aᵀ dλ = 0,    G_A dy + g_p = 0.
//
// A movable joint of q_in enters σ alone. A frozen one enters σ twice, for q has the same value
// there, and the rows.
#ifndef MJCF_PDG_SRC_GRADIENT_SENSITIVITY_H_
#define MJCF_PDG_SRC_GRADIENT_SENSITIVITY_H_

#include <vector>

#include "gradient/converged_optimum.h"

namespace mjcf_pdg {

class Sensitivity {
 public:
  // As for ConvergedOptimum; `optimum` is of the same two.
  Sensitivity(Workspace& work, const SceneTables& all, ConvergedOptimum& optimum);

  // Fills sigma() at q (nq): the derivative of σ by its first argument, and by what frozen joints
  // of q_in do to the rows, for the multipliers of the optimum. Must come before Answer.
  void Sigma(const VectorXd& q);
  const VectorXd& sigma() const { return sigma_; }  // nv

  // Fills answer() at the optimum, which has converged. Returns false if the optimum is not one
  // point, or if there is another obstacle to it.
  bool Answer();
  const MatrixXd& answer() const { return answer_; }  // nv × nv

  // How far q_in can move, until a row becomes active or stops to be so; each joint by this arc or
  // length at once [m], to first order. After Answer.
  double room() const { return room_; }

 private:
  void MoveInput(const JointEntry& joint, int k, const VectorXd& q);
  bool Solve(const std::vector<int>& active, const MatrixXd& second);
  Eigen::RowVectorXd RowByInput(int row) const;
  void MeasureRoom(const std::vector<int>& active, const MatrixXd& dlambda);
  double PerMetre(const Eigen::RowVectorXd& by_input) const;
  double Arm(int dof) const;  // what a unit of the dof counts as [m]

  Workspace& work_;
  const SceneTables& all_;
  ConvergedOptimum& optimum_;
  std::vector<char> slides_;  // nv
  VectorXd sigma_;            // nv
  MatrixXd mixed_;            // L_yp, unknowns × nv
  MatrixXd dy_;               // unknowns × nv
  MatrixXd answer_;           // nv × nv
  double room_ = 0.0;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_GRADIENT_SENSITIVITY_H_
