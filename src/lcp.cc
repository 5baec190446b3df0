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

LcpOutcome SolveProjectedGaussSeidel(const Eigen::Ref<const MatrixXd>& G, const VectorXd& b,
                                     const VectorXd& mu, const LcpOptions& options,
                                     VectorXd& lambda) {
  const VectorXd diagonal = G.colwise().squaredNorm();
  VectorXd x = G * lambda;
  LcpOutcome outcome;
  while (outcome.steps < options.max_steps && !outcome.converged) {
    double residual = 0.0;
    for (Eigen::Index i = 0; i < b.size(); ++i) {
      if (diagonal[i] <= 0.0) continue;
      const double next =
          std::clamp(lambda[i] + (b[i] - G.col(i).dot(x)) / diagonal[i], 0.0, mu[i]);
      const double change = next - lambda[i];
      residual = std::max(residual, std::abs(change) * diagonal[i]);
      x += change * G.col(i);
      lambda[i] = next;
    }
    ++outcome.steps;
    outcome.converged = residual <= options.tolerance;
  }
  return outcome;
}

LcpOutcome ActiveSetLcp::Solve(const ConstMatrix& G, const VectorXd& b, const VectorXd& mu,
                               const LcpOptions& options, VectorXd& lambda) {
  lambda.setZero(b.size());
  side_.assign(b.size(), Side::kLow);
  free_.clear();
  norms_ = G.colwise().norm();
  slack_ = b;
  LcpOutcome outcome;
  while (outcome.steps < options.max_steps) {
    const int row = MostViolated(options.tolerance);
    if (row < 0) {
      outcome.converged = true;
      break;
    }
    Enter(G, mu, row, lambda);
    x_.noalias() = G * lambda;
    slack_ = b;
    slack_.noalias() -= G.transpose() * x_;
    ++outcome.steps;
  }
  return outcome;
}

int ActiveSetLcp::MostViolated(double tolerance) const {
  int worst = -1;
  double most = 0.0;
  for (int i = 0; i < static_cast<int>(side_.size()); ++i) {
    if (side_[i] == Side::kFree || norms_[i] <= 0.0) continue;
    const double violation = side_[i] == Side::kLow ? slack_[i] : -slack_[i];
    if (violation > tolerance && violation > most * norms_[i]) {
      most = violation / norms_[i];
      worst = i;
    }
  }
  return worst;
}

// direction_ = (G_FᵀG_F)⁻¹ G_Fᵀ g for the free set F and g = G_row. Returns what of ‖g‖² is left.
double ActiveSetLcp::SolveFree(const ConstMatrix& G, int row) {
  const int f = static_cast<int>(free_.size());
  factor_.resize(f, f);
  direction_.resize(f);
  for (int i = 0; i < f; ++i) {
    for (int j = 0; j <= i; ++j) factor_(i, j) = G.col(free_[i]).dot(G.col(free_[j]));
    direction_[i] = G.col(free_[i]).dot(G.col(row));
  }
  Eigen::LLT<Eigen::Ref<MatrixXd>> llt(factor_);
  llt.matrixL().solveInPlace(direction_);
  const double left = norms_[row] * norms_[row] - direction_.squaredNorm();
  llt.matrixU().solveInPlace(direction_);
  return std::max(0.0, left);
}

// Moves λ_row off its bound while the free rows keep their slack at zero, until its own slack is
// zero or it reaches the other bound; free multipliers that reach a bound leave the free set.
void ActiveSetLcp::Enter(const ConstMatrix& G, const VectorXd& mu, int row, VectorXd& lambda) {
  const double sign = side_[row] == Side::kLow ? 1.0 : -1.0;
  while (true) {
    const double schur = SolveFree(G, row);
    const bool dependent = schur <= kDependent * norms_[row] * norms_[row];
    const double to_zero_slack = dependent ? std::numeric_limits<double>::infinity()
                                           : std::max(0.0, sign * slack_[row] / schur);
    const double own_room = sign > 0.0 ? mu[row] - lambda[row] : lambda[row];
    double step = std::min(to_zero_slack, own_room);
    int leaving = -1;
    for (int k = 0; k < static_cast<int>(free_.size()); ++k) {
      const double rate = -sign * direction_[k];
      const double value = lambda[free_[k]];
      const double room = rate > 0.0   ? (mu[free_[k]] - value) / rate
                          : rate < 0.0 ? -value / rate
                                       : std::numeric_limits<double>::infinity();
      if (room < step) {
        step = std::max(0.0, room);
        leaving = k;
      }
    }
    lambda[row] += sign * step;
    slack_[row] -= sign * step * schur;
    for (std::size_t k = 0; k < free_.size(); ++k) {
      lambda[free_[k]] -= sign * step * direction_[k];
    }
    if (leaving < 0) {
      const bool stays_free = to_zero_slack < own_room;
      side_[row] = stays_free ? Side::kFree : sign > 0.0 ? Side::kHigh : Side::kLow;
      if (stays_free) free_.push_back(row);
      if (!stays_free) lambda[row] = sign > 0.0 ? mu[row] : 0.0;
      return;
    }
    const int left = free_[leaving];
    const bool high = -sign * direction_[leaving] > 0.0;
    side_[left] = high ? Side::kHigh : Side::kLow;
    lambda[left] = high ? mu[left] : 0.0;
    free_.erase(free_.begin() + leaving);
  }
}

}  // namespace mjcf_pdg
