// The linear complementarity problem of the constrained optimization, plain matrices only.
//
//   min ½‖y + z‖² + Σ μ_i s_i   subject to   Gᵀz + s >= -gap,  s >= 0
//
// in whitened coordinates (z = H^½ dX, y = H^½ X_c, G = H^-½ C'ᵀ). Its solution is z = G λ - y with
//
//   0 <= λ <= μ,  w = Gᵀ G λ - b,  b = Gᵀ y - gap, and entry by entry
//   w >= 0 where λ = 0,   w = 0 between,   w <= 0 where λ = μ
//
// GᵀG is the paper's C' H⁻¹ C'ᵀ, Gᵀy its C' X_c (Eq. 12, 30).
// Source: Tang & Kim, Sec. 3.2 and 5.3 (projected Gauss-Seidel).
// Differs from it:
//   1. An upper bound μ (elastic rows): conflicting contacts have an answer too. The paper's is
//      μ = ∞.
//   2. Beside Gauss-Seidel, an active-set method (Goldfarb & Idnani's dual steps, with bounds) that
//      ends in finitely many steps and copes with dependent rows.
//   3. Where many bodies move, a row concerns two of them: the active-set method takes packed
//      columns, and its factor has an envelope (free_factor.h).
//   4. The active-set method can begin with the rows of an earlier solution. Satisfied rows are
//      looked at again only when no other is violated.
#ifndef MJCF_PDG_SRC_OPTIMIZE_LCP_H_
#define MJCF_PDG_SRC_OPTIMIZE_LCP_H_

#include <Eigen/Dense>
#include <vector>

#include "base/support.h"
#include "optimize/free_factor.h"

namespace mjcf_pdg {

struct LcpOptions {
  int max_steps = 1000;      // sweeps (Gauss-Seidel) or changes of the active set
  double tolerance = 1e-10;  // largest residual that counts as zero, in units of b
};

struct LcpOutcome {
  bool converged = false;
  int steps = 0;
};

using ConstMatrixRef = Eigen::Ref<const Eigen::MatrixXd>;
using ConstVectorRef = Eigen::Ref<const Eigen::VectorXd>;
using VectorRef = Eigen::Ref<Eigen::VectorXd>;

// In both, G is n × m, one column per row of C, and b, μ and λ have m entries. Both keep scratch
// between calls, which grows only.

// Projected Gauss-Seidel from the given λ (warm start); zero columns keep λ = 0.
class GaussSeidelLcp {
 public:
  // Room for problems up to n × m.
  void Reserve(int n, int m);

  LcpOutcome Solve(const ConstMatrixRef& G, const ConstVectorRef& b, const ConstVectorRef& mu,
                   const LcpOptions& options, VectorRef lambda);

 private:
  Eigen::VectorXd diagonal_;  // of GᵀG, in the first m entries
  Eigen::VectorXd x_;         // G λ
};

// Active-set method. μ must be finite. The columns of G may be packed, each from its first row on.
class ActiveSetLcp {
 public:
  // Room for problems up to n × m.
  void Reserve(int n, int m);

  // What λ was is ignored.
  LcpOutcome Solve(const ConstMatrixRef& G, const ConstVectorRef& b, const ConstVectorRef& mu,
                   const LcpOptions& options, VectorRef lambda, const Packing& packing = {});
  // Begins with the rows that are between their bounds in the given λ, and those that are at μ
  // (warm start). As many as it frees of the former count as steps, so that the steps tell what the
  // problem is like and not where it began.
  LcpOutcome SolveFrom(const ConstMatrixRef& G, const ConstVectorRef& b, const ConstVectorRef& mu,
                       const LcpOptions& options, VectorRef lambda, const Packing& packing = {});

 private:
  // Where a multiplier is: which sign its row's slack must not have.
  static constexpr double kLow = 1.0, kFree = 0.0, kHigh = -1.0;

  void FillNorms(const ConstMatrixRef& G);
  void UpdateMotion(const ConstMatrixRef& G, const VectorRef& lambda);
  void UpdateSlack(const ConstMatrixRef& G, const ConstVectorRef& b);
  void FindViolated(double tolerance);
  void Begin(const ConstMatrixRef& G, const ConstVectorRef& b, const ConstVectorRef& mu,
             VectorRef& lambda);
  void FreeIndependent(const ConstMatrixRef& G, VectorRef& lambda);
  bool SolveForFree(const ConstVectorRef& mu, VectorRef& lambda);
  int MostViolated(double tolerance) const;
  void Enter(const ConstMatrixRef& G, const ConstVectorRef& mu, int row, VectorRef& lambda);
  bool Dependent(int row) const;
  void AddFree(int row);
  void RemoveFree(int k);
  void FillForward(const ConstMatrixRef& G, int row);
  void SolveFree(const ConstMatrixRef& G, int row);

  // Of arrays per row the first m_ entries are in use, of those per free row as many as free_ has.
  int n_ = 0, m_ = 0;
  std::span<const Support> supports_;  // empty: G is not packed
  Eigen::ArrayXd side_;                // kLow, kFree or kHigh of each row
  std::vector<int> free_;              // rows strictly between their bounds
  Eigen::ArrayXd norms_;               // of G's columns
  Eigen::ArrayXd inverse_norms_;
  Eigen::VectorXd slack_;        // b - GᵀG λ: positive where a constraint is violated
  Eigen::VectorXd x_;            // G λ
  Eigen::VectorXd g_;            // the entering column, with zeros; else all zero
  FreeFactor factor_;            // of the free rows
  std::vector<int> violated_;    // rows that a pass over all found violated
  std::vector<int> candidates_;  // rows that may become free where a solve begins
  Eigen::VectorXd forward_;      // L⁻¹ G_Fᵀ g for the entering row g
  double schur_ = 0.0;           // ‖g‖² - ‖L⁻¹ G_Fᵀ g‖²
  Eigen::VectorXd direction_;    // how the free multipliers answer to the entering one
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_OPTIMIZE_LCP_H_
