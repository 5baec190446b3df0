// The linear complementarity problem of the constrained optimization, plain matrices only.
//
//   find 0 <= λ <= μ with w = A λ - b and, entry by entry,
//   w >= 0 where λ = 0,   w = 0 between,   w <= 0 where λ = μ
//
// It is the dual of   min ½‖y + z‖² + Σ μ_i s_i   s.t.  G z + s >= -gap, s >= 0
// with A = G Gᵀ, b = G y - gap and z = Gᵀλ - y; in whitened coordinates the paper's
// C' H⁻¹ C'ᵀ λ - C' X_c >= 0 (Eq. 12, 30).
// Source: Tang & Kim, Sec. 3.2 and 5.3 (projected Gauss-Seidel).
// Differs from it:
//   1. An upper bound μ (elastic rows): conflicting contacts have an answer too. μ = ∞: the paper's.
//   2. Beside Gauss-Seidel, an active-set method (Goldfarb & Idnani's dual steps with bounds) that
//      ends in finitely many steps and copes with dependent rows.
#ifndef MJCF_PDG_SRC_LCP_H_
#define MJCF_PDG_SRC_LCP_H_

#include <Eigen/Dense>
#include <vector>

namespace mjcf_pdg {

struct LcpOptions {
  int max_steps = 1000;      // sweeps (Gauss-Seidel) or changes of the active set
  double tolerance = 1e-10;  // largest residual that counts as zero, in units of b
};

struct LcpOutcome {
  bool converged = false;
  int steps = 0;
};

// Projected Gauss-Seidel from the given λ (warm start). A (m × m) symmetric positive semidefinite;
// rows with a zero diagonal keep λ = 0.
LcpOutcome SolveProjectedGaussSeidel(const Eigen::MatrixXd& A, const Eigen::VectorXd& b,
                                     const Eigen::VectorXd& mu, const LcpOptions& options,
                                     Eigen::VectorXd& lambda);

// Active-set method from λ = 0. Keeps scratch between calls.
class ActiveSetLcp {
 public:
  LcpOutcome Solve(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, const Eigen::VectorXd& mu,
                   const LcpOptions& options, Eigen::VectorXd& lambda);

 private:
  enum class Side : char { kLow, kFree, kHigh };

  int MostViolated(const Eigen::MatrixXd& A, const Eigen::VectorXd& slack, double tolerance) const;
  void Enter(const Eigen::MatrixXd& A, const Eigen::VectorXd& mu, int row, double slack_row,
             Eigen::VectorXd& lambda);
  void SolveFree(const Eigen::MatrixXd& A, int row);

  std::vector<Side> side_;
  std::vector<int> free_;
  Eigen::MatrixXd factor_;
  Eigen::VectorXd direction_;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_LCP_H_
