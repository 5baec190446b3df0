#include "local_optimization.h"

#include <algorithm>
#include <cmath>

namespace mjcf_pdg {
namespace {

constexpr int kMaxContactRows = 48;
constexpr double kFirstPrice = 10.0;   // μ [m]
constexpr double kHighestPrice = 1e4;
constexpr double kLimitPrice = 1e6;    // joint limits give way to nothing
constexpr int kPatience = 2;           // steps without progress before the trust radius shrinks
constexpr double kLimitReach = 0.5;    // joint limits farther than this get no row [rad or m]

}  // namespace

LocalOptimization::LocalOptimization(Problem& problem) : problem_(problem) {}

void LocalOptimization::Evaluate(const VectorXd& q, double margin, Iterate& out) {
  out.q = q;
  out.sigma = problem_.norm.Sigma(q);
  problem_.finder.Pose(q);
  out.near = problem_.finder.Find(margin);
  out.violation = 0.0;
  out.worst = -1.0;
  for (const NearPair& near : out.near) {
    const double needed = problem_.required[near.pair] - near.distance;
    out.violation += std::max(0.0, needed - problem_.tolerances.aim);
    out.worst = std::max(out.worst, needed - problem_.tolerances.accept);
  }
}

// Rows at the posed configuration, nearest first; joint limits after them.
void LocalOptimization::Linearize(const Iterate& at, double margin) {
  const SceneTables& tables = problem_.tables;
  const PosedModel& posed = problem_.finder.posed();
  const double merge = 1e-3 * problem_.size;
  std::vector<const NearPair*> nearest;
  for (const NearPair& near : at.near) {
    if (tables.pairs[near.pair].moves) nearest.push_back(&near);
  }
  auto slack = [this](const NearPair& near) {
    return near.distance - problem_.required[near.pair];
  };
  if (nearest.size() > kMaxContactRows) {
    std::nth_element(nearest.begin(), nearest.begin() + kMaxContactRows, nearest.end(),
                     [&](const NearPair* a, const NearPair* b) { return slack(*a) < slack(*b); });
    nearest.resize(kMaxContactRows);
  }
  rows_.Clear(tables.n);
  for (const NearPair* near : nearest) {
    const double offset = problem_.tolerances.aim - problem_.required[near->pair];
    const int row = rows_.Append(near->distance + offset, true);
    ContactRow(tables, posed, near->pair, near->p1_W, near->p2_W, near->n_W, rows_.C.row(row));
    memory_.ForEach(tables, posed, *near, merge, [&](const Vector3d& p1_W, const Vector3d& p2_W) {
      const double distance = near->n_W.dot(p2_W - p1_W);
      if (distance > margin) return;
      const int extra = rows_.Append(distance + offset, true);
      ContactRow(tables, posed, near->pair, p1_W, p2_W, near->n_W, rows_.C.row(extra));
    });
    memory_.Add(tables, posed, *near, merge);
  }
  AppendLimitRows(tables, at.q, kLimitReach, rows_);
  problem_.norm.Linearize(at.q, r_, J_);
}

double LocalOptimization::SolveStep(double trust_radius) {
  const int n = problem_.tables.n, m = rows_.m;
  // H = JᵀJ = L Lᵀ; z = Lᵀ dq; y = L⁻¹ Jᵀ r; Gᵀ = L⁻¹ Cᵀ.
  H_.noalias() = J_.transpose() * J_;
  H_.diagonal().array() += 1e-8 * H_.diagonal().mean() + 1e-12;
  Eigen::LLT<Eigen::Ref<MatrixXd>> llt(H_);
  y_.noalias() = J_.transpose() * r_;
  llt.matrixL().solveInPlace(y_);
  G_ = rows_.C.topRows(m).transpose();
  llt.matrixL().solveInPlace(G_);  // n × m
  A_.noalias() = G_.transpose() * G_;
  b_ = G_.transpose() * y_ - rows_.gap.head(m);
  bounds_.resize(m);
  for (int i = 0; i < m; ++i) bounds_[i] = rows_.elastic[i] ? mu_ : kLimitPrice;
  LcpOptions options;
  options.max_steps = 10 * (n + m);
  options.tolerance = 0.01 * problem_.tolerances.user;
  lcp_steps_ += lcp_.Solve(A_, b_, bounds_, options, lambda_).steps;
  z_ = G_ * lambda_ - y_;
  predicted_sigma_ = (y_ + z_).squaredNorm();
  const double length = z_.norm();
  if (length > trust_radius) z_ *= trust_radius / length;
  dq_ = z_;
  llt.matrixU().solveInPlace(dq_);
  return std::min(length, trust_radius);
}

LocalResult LocalOptimization::Run(const VectorXd& q, const LocalOptions& options) {
  memory_.Clear(problem_.tables.pairs.size());
  mu_ = kFirstPrice;
  double radius = options.trust_radius;
  double margin = 0.25 * problem_.size;
  const double first_margin = margin;
  Iterate best, trial;
  Evaluate(q, margin, best);
  LocalResult result;
  auto keep_if_better = [&](const Iterate& it) {
    if (Free(it) && (!result.free || it.sigma < result.sigma)) {
      result.free = true;
      result.sigma = it.sigma;
      result.q = it.q;
    }
  };
  keep_if_better(best);
  Iterate current = best;
  int impatience = 0;
  int settled = 0;
  while (result.iterations < options.max_iterations) {
    ++result.iterations;
    problem_.finder.Pose(current.q);
    Linearize(current, margin);
    const double length = SolveStep(radius);
    if (predicted_sigma_ > options.give_up_sigma && result.iterations > 3) break;
    problem_.norm.Retract(current.q, dq_, trial.q);
    VectorXd next = trial.q;
    ClampToLimits(problem_.tables, next);
    margin = std::clamp(3.0 * length, 0.02 * problem_.size, 4.0 * first_margin);
    Evaluate(next, margin, trial);
    const double previous_sigma = result.sigma;
    keep_if_better(trial);
    const double gain = Merit(best) - Merit(trial);
    const bool small = length < 1e-7 + 1e-4 * std::sqrt(trial.sigma);
    if (gain > 0.0) {
      best = trial;
      impatience = 0;
    } else {
      ++impatience;
    }
    current = trial;
    if (Free(trial) && result.free) {
      const bool stalls = std::abs(previous_sigma - trial.sigma) <=
                          options.convergence * trial.sigma;
      settled = stalls || small ? settled + 1 : 0;
      if (small || settled >= 2) break;
    } else if (small && impatience > 0) {
      // Converged to an overlap: raise its price, or admit that contacts conflict here.
      if (mu_ >= kHighestPrice) break;
      mu_ *= 10.0;
      best = current;
      impatience = 0;
    }
    if (impatience > kPatience) {
      radius = std::min(radius, length) / 4.0;
      current = best;
      impatience = 0;
      if (radius < 1e-7) break;
    }
  }
  if (!result.free) {
    result.q = best.q;
    result.sigma = best.sigma;
    result.violation = best.violation;
  }
  return result;
}

}  // namespace mjcf_pdg
