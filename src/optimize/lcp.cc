#include "optimize/lcp.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/grow.h"

namespace mjcf_pdg {
namespace {

// A row whose part independent of the free rows is below this share counts as dependent.
constexpr double kDependent = 1e-9;

}  // namespace

void GaussSeidelLcp::Reserve(int n, int m) {
  x_.resize(n);
  GrowTo(m, diagonal_);
}

LcpOutcome GaussSeidelLcp::Solve(const ConstMatrixRef& G, const ConstVectorRef& b,
                                 const ConstVectorRef& mu, const LcpOptions& options,
                                 VectorRef lambda) {
  GrowTo(b.size(), diagonal_);
  diagonal_.head(b.size()) = G.colwise().squaredNorm();
  x_.resize(G.rows());
  x_.noalias() = G * lambda;
  LcpOutcome outcome;
  while (outcome.steps < options.max_steps && !outcome.converged) {
    double residual = 0.0;
    for (Eigen::Index i = 0; i < b.size(); ++i) {
      if (diagonal_[i] <= 0.0) continue;
      const double next =
          std::clamp(lambda[i] + (b[i] - G.col(i).dot(x_)) / diagonal_[i], 0.0, mu[i]);
      const double change = next - lambda[i];
      residual = std::max(residual, std::abs(change) * diagonal_[i]);
      x_ += change * G.col(i);
      lambda[i] = next;
    }
    ++outcome.steps;
    outcome.converged = residual <= options.tolerance;
  }
  return outcome;
}

void ActiveSetLcp::Reserve(int n, int m) {
  GrowTo(m, side_);
  GrowTo(m, norms_);
  GrowTo(m, inverse_norms_);
  GrowTo(m, slack_);
  x_.resize(n);
  g_.setZero(n);
  // No more than n rows are independent, but for rounding.
  free_.reserve(n + 1);
  GrowTo(n + 1, forward_);
  GrowTo(n + 1, direction_);
  if (factor_.rows() <= n) factor_.resize(n + 1, n + 1);
}

LcpOutcome ActiveSetLcp::Solve(const ConstMatrixRef& G, const ConstVectorRef& b,
                               const ConstVectorRef& mu, const LcpOptions& options,
                               VectorRef lambda, const Packing& packing) {
  supports_ = packing.supports;
  m_ = static_cast<int>(b.size());
  n_ = supports_.empty() ? static_cast<int>(G.rows()) : packing.rows;
  Reserve(n_, m_);
  lambda.setZero();
  side_.head(m_).setConstant(kLow);
  free_.clear();
  FillNorms(G);
  UpdateSlack(G, b, lambda);
  LcpOutcome outcome;
  while (outcome.steps < options.max_steps) {
    const int row = MostViolated(options.tolerance);
    if (row < 0) {
      outcome.converged = true;
      break;
    }
    Enter(G, mu, row, lambda);
    UpdateSlack(G, b, lambda);
    ++outcome.steps;
  }
  return outcome;
}

void ActiveSetLcp::FillNorms(const ConstMatrixRef& G) {
  if (supports_.empty()) {
    norms_.head(m_) = G.colwise().norm().transpose();
  } else {
    for (int i = 0; i < m_; ++i) norms_[i] = G.col(i).head(supports_[i].size()).norm();
  }
  inverse_norms_.head(m_) = (norms_.head(m_) > 0.0).select(norms_.head(m_).inverse(), 0.0);
}

void ActiveSetLcp::UpdateSlack(const ConstMatrixRef& G, const ConstVectorRef& b,
                               const VectorRef& lambda) {
  x_.setZero(n_);
  for (Eigen::Index i = 0; i < lambda.size(); ++i) {
    if (lambda[i] == 0.0) continue;
    if (supports_.empty()) {
      x_ += lambda[i] * G.col(i);
    } else {
      AddMultiple(lambda[i], supports_[i], G.col(i).data(), x_);
    }
  }
  auto slack = slack_.head(m_);
  slack = b;
  if (supports_.empty()) {
    slack.noalias() -= G.transpose() * x_;
  } else {
    for (int i = 0; i < m_; ++i) slack[i] -= Dot(supports_[i], G.col(i).data(), x_);
  }
}

// By its distance in z; -1 if no row is beyond `tolerance`.
int ActiveSetLcp::MostViolated(double tolerance) const {
  int worst = -1;
  double farthest = 0.0;
  for (int i = 0; i < m_; ++i) {
    const double violation = side_[i] * slack_[i];
    if (violation > tolerance && violation * inverse_norms_[i] > farthest) {
      farthest = violation * inverse_norms_[i];
      worst = i;
    }
  }
  return worst;
}

// `row`, just solved for by SolveFree, becomes the last of the free rows.
void ActiveSetLcp::AddFree(int row) {
  const int f = static_cast<int>(free_.size());
  if (factor_.rows() <= f) factor_.conservativeResize(2 * f + 8, 2 * f + 8);
  factor_.row(f).head(f) = forward_.head(f).transpose();
  factor_(f, f) = std::sqrt(schur_);
  free_.push_back(row);
}

// The factor loses row k; rotations of neighbouring columns make the rows below triangular again.
void ActiveSetLcp::RemoveFree(int k) {
  free_.erase(free_.begin() + k);
  const int f = static_cast<int>(free_.size());
  for (int i = k; i < f; ++i) factor_.row(i).head(i + 2) = factor_.row(i + 1).head(i + 2);
  Eigen::JacobiRotation<double> rotation;
  for (int j = k; j < f; ++j) {
    rotation.makeGivens(factor_(j, j), factor_(j, j + 1));
    factor_.middleRows(j, f - j).applyOnTheRight(j, j + 1, rotation);
  }
}

// x becomes L⁻ᵀ x.
void ActiveSetLcp::SolveBackward(VectorRef x) const {
  for (int i = static_cast<int>(free_.size()) - 1; i >= 0; --i) {
    x[i] /= factor_(i, i);
    x.head(i) -= x[i] * factor_.row(i).head(i).transpose();
  }
}

// x becomes L⁻¹ x.
void ActiveSetLcp::SolveForward(VectorRef x) const {
  for (int i = 0; i < static_cast<int>(free_.size()); ++i) {
    x[i] = (x[i] - factor_.row(i).head(i).dot(x.head(i))) / factor_(i, i);
  }
}

// forward = G_Fᵀ g.
void ActiveSetLcp::FillForward(const ConstMatrixRef& G, int row, VectorRef forward) {
  const int f = static_cast<int>(free_.size());
  if (supports_.empty()) {
    for (int k = 0; k < f; ++k) forward[k] = G.col(free_[k]).dot(G.col(row));
    return;
  }
  AddMultiple(1.0, supports_[row], G.col(row).data(), g_);
  for (int k = 0; k < f; ++k) forward[k] = Dot(supports_[free_[k]], G.col(free_[k]).data(), g_);
  SetZero(supports_[row], g_);
}

// direction_ = (G_FᵀG_F)⁻¹ G_Fᵀ g for the free set F and g = G_row, and schur_.
void ActiveSetLcp::SolveFree(const ConstMatrixRef& G, int row) {
  const int f = static_cast<int>(free_.size());
  GrowTo(f, forward_);
  GrowTo(f, direction_);
  auto forward = forward_.head(f), direction = direction_.head(f);
  FillForward(G, row, forward);
  SolveForward(forward);
  schur_ = std::max(0.0, norms_[row] * norms_[row] - forward.squaredNorm());
  direction = forward;
  SolveBackward(direction);
}

// Moves λ_row off its bound while the free rows keep their slack at zero, until its own slack is
// zero or it reaches the other bound; free multipliers that reach a bound leave the free set.
void ActiveSetLcp::Enter(const ConstMatrixRef& G, const ConstVectorRef& mu, int row,
                         VectorRef& lambda) {
  const double sign = side_[row];
  while (true) {
    SolveFree(G, row);
    const bool dependent = schur_ <= kDependent * norms_[row] * norms_[row];
    const double to_zero_slack = dependent ? std::numeric_limits<double>::infinity()
                                           : std::max(0.0, sign * slack_[row] / schur_);
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
    slack_[row] -= sign * step * schur_;
    for (std::size_t k = 0; k < free_.size(); ++k) {
      lambda[free_[k]] -= sign * step * direction_[k];
    }
    if (leaving < 0) {
      const bool stays_free = to_zero_slack < own_room;
      side_[row] = stays_free ? kFree : -sign;
      if (stays_free) AddFree(row);
      if (!stays_free) lambda[row] = sign > 0.0 ? mu[row] : 0.0;
      return;
    }
    const int leaver = free_[leaving];
    const bool high = -sign * direction_[leaving] > 0.0;
    side_[leaver] = high ? kHigh : kLow;
    lambda[leaver] = high ? mu[leaver] : 0.0;
    RemoveFree(leaving);
  }
}

}  // namespace mjcf_pdg
