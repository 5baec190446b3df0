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
  candidates_.reserve(m);
  violated_.reserve(m);
  GrowTo(n + 1, forward_);
  GrowTo(n + 1, direction_);
  factor_.Reserve(n + 1);
}

LcpOutcome ActiveSetLcp::Solve(const ConstMatrixRef& G, const ConstVectorRef& b,
                               const ConstVectorRef& mu, const LcpOptions& options,
                               VectorRef lambda, const Packing& packing) {
  lambda.setZero();
  return SolveFrom(G, b, mu, options, lambda, packing);
}

LcpOutcome ActiveSetLcp::SolveFrom(const ConstMatrixRef& G, const ConstVectorRef& b,
                                   const ConstVectorRef& mu, const LcpOptions& options,
                                   VectorRef lambda, const Packing& packing) {
  supports_ = packing.supports;
  m_ = static_cast<int>(b.size());
  n_ = supports_.empty() ? static_cast<int>(G.rows()) : packing.rows;
  Reserve(n_, m_);
  FillNorms(G);
  Begin(G, b, mu, lambda);
  LcpOutcome outcome{.steps = factor_.size()};
  while (outcome.steps < options.max_steps) {
    FindViolated(options.tolerance);
    int row = MostViolated(options.tolerance);
    if (row < 0) {
      outcome.converged = true;
      break;
    }
    while (row >= 0 && outcome.steps < options.max_steps) {
      Enter(G, mu, row, lambda);
      ++outcome.steps;
      UpdateMotion(G, lambda);
      if (supports_.empty()) break;  // whole columns are as quickly multiplied all at once
      for (const int i : violated_) slack_[i] = b[i] - Dot(supports_[i], G.col(i).data(), x_);
      row = MostViolated(options.tolerance);
    }
    UpdateSlack(G, b);
  }
  return outcome;
}

// Rows between their bounds become free, as many as are independent, and λ of these what makes
// their slack zero. Where that is beyond a bound the row goes there, until none is.
void ActiveSetLcp::Begin(const ConstMatrixRef& G, const ConstVectorRef& b, const ConstVectorRef& mu,
                         VectorRef& lambda) {
  free_.clear();
  factor_.Truncate(0);
  candidates_.clear();
  for (int i = 0; i < m_; ++i) {
    const bool high = lambda[i] > 0.0 && lambda[i] >= mu[i];
    if (!high && lambda[i] > 0.0) candidates_.push_back(i);
    side_[i] = high ? kHigh : kLow;
    lambda[i] = high ? mu[i] : 0.0;
  }
  OrderByNeighbours(supports_, candidates_);
  for (bool settled = false; !settled;) {
    FreeIndependent(G, lambda);
    UpdateMotion(G, lambda);
    UpdateSlack(G, b);
    settled = SolveForFree(mu, lambda);
  }
  if (free_.empty()) return;
  UpdateMotion(G, lambda);
  UpdateSlack(G, b);
}

// Those of candidates_ that are independent of each other and of the free rows; the others are not
// needed.
void ActiveSetLcp::FreeIndependent(const ConstMatrixRef& G, VectorRef& lambda) {
  for (const int row : candidates_) {
    FillForward(G, row);
    if (Dependent(row)) {
      side_[row] = kLow;
      lambda[row] = 0.0;
    } else {
      AddFree(row);
    }
  }
}

// Adds to λ what makes the slacks of the free rows zero. If some leave their bounds, these rows go
// there, all after the first of them become candidates, and the answer is false.
bool ActiveSetLcp::SolveForFree(const ConstVectorRef& mu, VectorRef& lambda) {
  const int f = factor_.size();
  GrowTo(f, direction_);
  auto change = direction_.head(f);
  for (int k = 0; k < f; ++k) change[k] = slack_[free_[k]];
  factor_.SolveForward(change);
  factor_.SolveBackward(change);
  int kept = f;
  candidates_.clear();
  for (int k = 0; k < f; ++k) {
    const int row = free_[k];
    const double value = lambda[row] + change[k];
    lambda[row] = std::clamp(value, 0.0, mu[row]);
    const bool leaves = value <= 0.0 || value >= mu[row];
    if (leaves) side_[row] = value > 0.0 ? kHigh : kLow;
    if (leaves) kept = std::min(kept, k);
    if (!leaves && kept < k) candidates_.push_back(row);
  }
  free_.resize(kept);
  factor_.Truncate(kept);
  return kept == f;
}

void ActiveSetLcp::FillNorms(const ConstMatrixRef& G) {
  if (supports_.empty()) {
    norms_.head(m_) = G.colwise().norm().transpose();
  } else {
    for (int i = 0; i < m_; ++i) norms_[i] = G.col(i).head(supports_[i].size()).norm();
  }
  inverse_norms_.head(m_) = (norms_.head(m_) > 0.0).select(norms_.head(m_).inverse(), 0.0);
}

void ActiveSetLcp::UpdateMotion(const ConstMatrixRef& G, const VectorRef& lambda) {
  x_.setZero(n_);
  for (Eigen::Index i = 0; i < lambda.size(); ++i) {
    if (lambda[i] == 0.0) continue;
    if (supports_.empty()) {
      x_ += lambda[i] * G.col(i);
    } else {
      AddMultiple(lambda[i], supports_[i], G.col(i).data(), x_);
    }
  }
}

void ActiveSetLcp::UpdateSlack(const ConstMatrixRef& G, const ConstVectorRef& b) {
  auto slack = slack_.head(m_);
  slack = b;
  if (supports_.empty()) {
    slack.noalias() -= G.transpose() * x_;
  } else {
    for (int i = 0; i < m_; ++i) slack[i] -= Dot(supports_[i], G.col(i).data(), x_);
  }
}

void ActiveSetLcp::FindViolated(double tolerance) {
  violated_.clear();
  for (int i = 0; i < m_; ++i) {
    if (side_[i] * slack_[i] > tolerance) violated_.push_back(i);
  }
}

// Of those that FindViolated found, by its distance in z; -1 if no row is beyond `tolerance` any
// more.
int ActiveSetLcp::MostViolated(double tolerance) const {
  int worst = -1;
  double farthest = 0.0;
  for (const int i : violated_) {
    const double violation = side_[i] * slack_[i];
    if (violation > tolerance && violation * inverse_norms_[i] > farthest) {
      farthest = violation * inverse_norms_[i];
      worst = i;
    }
  }
  return worst;
}

bool ActiveSetLcp::Dependent(int row) const {
  return schur_ <= kDependent * norms_[row] * norms_[row];
}

// `row`, of which FillForward has been called, becomes the last of the free rows.
void ActiveSetLcp::AddFree(int row) {
  side_[row] = kFree;
  factor_.Append(forward_.head(factor_.size()), std::sqrt(schur_));
  free_.push_back(row);
}

void ActiveSetLcp::RemoveFree(int k) {
  free_.erase(free_.begin() + k);
  factor_.Remove(k);
}

// forward_ = L⁻¹ G_Fᵀ g for the free set F and g = G_row, and schur_.
void ActiveSetLcp::FillForward(const ConstMatrixRef& G, int row) {
  const int f = factor_.size();
  GrowTo(f, forward_);
  auto forward = forward_.head(f);
  if (supports_.empty()) {
    for (int k = 0; k < f; ++k) forward[k] = G.col(free_[k]).dot(G.col(row));
  } else {
    AddMultiple(1.0, supports_[row], G.col(row).data(), g_);
    for (int k = 0; k < f; ++k) forward[k] = Dot(supports_[free_[k]], G.col(free_[k]).data(), g_);
    SetZero(supports_[row], g_);
  }
  factor_.SolveForward(forward);
  schur_ = std::max(0.0, norms_[row] * norms_[row] - forward.squaredNorm());
}

// direction_ = (G_FᵀG_F)⁻¹ G_Fᵀ g for the free set F and g = G_row, and schur_.
void ActiveSetLcp::SolveFree(const ConstMatrixRef& G, int row) {
  const int f = factor_.size();
  FillForward(G, row);
  GrowTo(f, direction_);
  direction_.head(f) = forward_.head(f);
  factor_.SolveBackward(direction_.head(f));
}

// Moves λ_row off its bound while the free rows keep their slack at zero, until its own slack is
// zero or it reaches the other bound; free multipliers that reach a bound leave the free set.
void ActiveSetLcp::Enter(const ConstMatrixRef& G, const ConstVectorRef& mu, int row,
                         VectorRef& lambda) {
  const double sign = side_[row];
  while (true) {
    SolveFree(G, row);
    const double to_zero_slack = Dependent(row) ? std::numeric_limits<double>::infinity()
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
      if (stays_free) {
        AddFree(row);
      } else {
        side_[row] = -sign;
        lambda[row] = sign > 0.0 ? mu[row] : 0.0;
      }
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
