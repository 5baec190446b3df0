#include "lcp.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mjcf_pdg {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// A row whose part independent of the free rows is below this share counts as dependent.
constexpr double kDependent = 1e-9;

}  // namespace

LcpOutcome SolveProjectedGaussSeidel(const MatrixXd& A, const VectorXd& b, const VectorXd& mu,
                                     const LcpOptions& options, VectorXd& lambda) {
  const Eigen::Index m = b.size();
  LcpOutcome outcome;
  while (outcome.steps < options.max_steps && !outcome.converged) {
    double residual = 0.0;
    for (Eigen::Index i = 0; i < m; ++i) {
      if (A(i, i) <= 0.0) continue;
      const double next =
          std::clamp(lambda[i] + (b[i] - A.col(i).dot(lambda)) / A(i, i), 0.0, mu[i]);
      residual = std::max(residual, std::abs(next - lambda[i]) * A(i, i));
      lambda[i] = next;
    }
    ++outcome.steps;
    outcome.converged = residual <= options.tolerance;
  }
  return outcome;
}

LcpOutcome ActiveSetLcp::Solve(const MatrixXd& A, const VectorXd& b, const VectorXd& mu,
                               const LcpOptions& options, VectorXd& lambda) {
  lambda.setZero(b.size());
  side_.assign(b.size(), Side::kLow);
  free_.clear();
  VectorXd slack = b;  // b - A λ: positive where a constraint is violated
  LcpOutcome outcome;
  while (outcome.steps < options.max_steps) {
    const int row = MostViolated(A, slack, options.tolerance);
    if (row < 0) {
      outcome.converged = true;
      break;
    }
    Enter(A, mu, row, slack[row], lambda);
    slack.noalias() = b - A * lambda;
    ++outcome.steps;
  }
  return outcome;
}

int ActiveSetLcp::MostViolated(const MatrixXd& A, const VectorXd& slack, double tolerance) const {
  int worst = -1;
  double most = 0.0;
  for (int i = 0; i < static_cast<int>(side_.size()); ++i) {
    if (side_[i] == Side::kFree || A(i, i) <= 0.0) continue;
    const double violation = side_[i] == Side::kLow ? slack[i] : -slack[i];
    if (violation <= tolerance) continue;
    const double scaled = violation / std::sqrt(A(i, i));
    if (scaled > most) {
      most = scaled;
      worst = i;
    }
  }
  return worst;
}

// direction_ = A_FF⁻¹ A_F,row for the free set F.
void ActiveSetLcp::SolveFree(const MatrixXd& A, int row) {
  const int f = static_cast<int>(free_.size());
  factor_.resize(f, f);
  direction_.resize(f);
  for (int i = 0; i < f; ++i) {
    for (int j = 0; j <= i; ++j) factor_(i, j) = A(free_[i], free_[j]);
    direction_[i] = A(free_[i], row);
  }
  Eigen::LLT<Eigen::Ref<MatrixXd>> llt(factor_);
  llt.solveInPlace(direction_);
}

// Moves λ_row off its bound while the free rows keep their slack at zero, until its own slack is
// zero or it reaches the other bound; free multipliers that reach a bound leave the free set.
void ActiveSetLcp::Enter(const MatrixXd& A, const VectorXd& mu, int row, double slack_row,
                         VectorXd& lambda) {
  const double sign = side_[row] == Side::kLow ? 1.0 : -1.0;
  while (true) {
    SolveFree(A, row);
    double schur = A(row, row);
    for (std::size_t k = 0; k < free_.size(); ++k) schur -= A(row, free_[k]) * direction_[k];
    const bool dependent = schur <= kDependent * A(row, row);
    double step = dependent ? std::numeric_limits<double>::infinity()
                            : std::max(0.0, sign * slack_row / schur);
    const double own_room = sign > 0.0 ? mu[row] - lambda[row] : lambda[row];
    bool to_other_bound = own_room <= step;
    step = std::min(step, own_room);
    int leaving = -1;
    for (std::size_t k = 0; k < free_.size(); ++k) {
      const double rate = -sign * direction_[k];
      if (rate == 0.0) continue;
      const double value = lambda[free_[k]];
      const double room = rate > 0.0 ? (mu[free_[k]] - value) / rate : -value / rate;
      if (room < step) {
        step = std::max(0.0, room);
        leaving = static_cast<int>(k);
        to_other_bound = false;
      }
    }
    lambda[row] += sign * step;
    for (std::size_t k = 0; k < free_.size(); ++k) {
      lambda[free_[k]] -= sign * step * direction_[k];
    }
    slack_row -= sign * step * std::max(0.0, schur);
    if (leaving >= 0) {
      const int left = free_[leaving];
      const bool high = -sign * direction_[leaving] > 0.0;
      side_[left] = high ? Side::kHigh : Side::kLow;
      lambda[left] = high ? mu[left] : 0.0;
      free_.erase(free_.begin() + leaving);
      continue;
    }
    side_[row] = to_other_bound ? (sign > 0.0 ? Side::kHigh : Side::kLow) : Side::kFree;
    if (!to_other_bound) free_.push_back(row);
    if (to_other_bound) lambda[row] = sign > 0.0 ? mu[row] : 0.0;
    return;
  }
}

}  // namespace mjcf_pdg
