#include "paper/contact_space_iteration.h"

#include <algorithm>
#include <cassert>

namespace mjcf_pdg {
namespace {

constexpr double kTouchingBand = 10.0;  // in units of the CCD's gap
constexpr double kNoBound = 1e12;       // μ of rows that nothing may violate

}  // namespace

ContactSpaceIteration::ContactSpaceIteration(Workspace& work)
    : problem_(work.problem()),
      work_(work),
      ccd_(work.problem().tables, work.finder),
      projection_(work.problem().tables, ccd_) {
  projection_options_.ccd.tolerance = work.problem().tolerances.accept;
}

VectorXd ContactSpaceIteration::Optimize(const VectorXd& q_c, const IterationOptions& options,
                                         int& sweeps) {
  const SceneTables& tables = problem_.tables;
  rows_.Clear(tables.n);
  dq_.setZero(tables.n);
  AppendContactRows(q_c);
  constexpr double kAll = std::numeric_limits<double>::infinity();
  AppendLimitRows(tables, q_c, {kAll, kAll, problem_.size}, rows_);
  work_.norm.Linearize(q_c, r_, J_);
  work_.norm.InnerProduct(J_, H_);
  whitening_.Factor(H_, work_.norm.blocks());
  return Minimize(q_c, options, sweeps);
}

// The contacts at q_c ⊕ dq_, linearized there: c·(dq - dq_) + gap >= 0.
void ContactSpaceIteration::AppendContactRows(const VectorXd& q) {
  const double band = kTouchingBand * projection_options_.ccd.Gap();
  work_.finder.Pose(q);
  for (const NearPair& near : work_.finder.Find(problem_.options.clearance + band)) {
    const double gap = near.distance - problem_.required[near.pair];
    if (!problem_.tables.pairs[near.pair].moves || gap > band) continue;
    const int row = rows_.Append(0.0);
    ContactRow(problem_.tables, work_.finder.posed(), near.pair, near.p1_W, near.p2_W, near.n_W,
               rows_.C.row(row));
    rows_.gap[row] = gap - rows_.C.row(row).dot(dq_);
  }
}

// In whitened coordinates r = H^½ X: C' = C (dq/dX), and X* = H⁻¹ C'ᵀ λ* reads r* = G λ*.
VectorXd ContactSpaceIteration::Minimize(const VectorXd& q_c, const IterationOptions& options,
                                         int& sweeps) {
  VectorXd y = J_.transpose() * r_;
  whitening_.SolveLower(y);
  G_ = rows_.C.topRows(rows_.m).transpose();
  whitening_.SolveLower(G_);
  b_ = G_.transpose() * y - rows_.gap.head(rows_.m);
  mu_.setConstant(rows_.m, kNoBound);
  lambda_.setZero(rows_.m);
  LcpOptions lcp;
  lcp.max_steps = options.max_sweeps;
  sweeps += lcp_.Solve(G_, b_, mu_, lcp, lambda_).steps;
  dq_ = G_ * lambda_ - y;
  whitening_.SolveUpper(dq_);
  VectorXd q;
  work_.norm.Retract(q_c, dq_, q);
  ClampToLimits(problem_.tables, q);
  return q;
}

// The minimizer, where it collides, tells which contacts were missing or curve too much: they join
// the others, and the minimum is sought again, until it is free.
bool ContactSpaceIteration::Correct(const VectorXd& q_c, const IterationOptions& options,
                                    VectorXd& q, int& sweeps) {
  for (int k = 0; k < options.corrections; ++k) {
    AppendContactRows(q);
    q = Minimize(q_c, options, sweeps);
    if (!q.allFinite()) return false;
    if (work_.Free(q)) return true;
  }
  return false;
}

const ProjectionResult& ContactSpaceIteration::Reproject(const VectorXd& q_c, const VectorXd& q) {
  return work_.Free(q)
             ? projection_.Project(q, problem_.q_in, projection_options_, &problem_.required)
             : projection_.Project(q_c, q, projection_options_, &problem_.required);
}

IterationStatus ContactSpaceIteration::Step(const IterationOptions& options,
                                            IterationResult& result) {
  ++result.iterations;
  VectorXd q = Optimize(result.q, options, result.sweeps);
  ProjectionResult next = Reproject(result.q, q);
  double sigma = work_.norm.Sigma(next.q);
  if (!work_.Free(q) && Correct(result.q, options, q, result.sweeps)) {
    const ProjectionResult& corrected = Reproject(result.q, q);
    const double corrected_sigma = work_.norm.Sigma(corrected.q);
    if (corrected.start_free && corrected_sigma < sigma) {
      next = corrected;
      sigma = corrected_sigma;
    }
  }
  if (!next.start_free) return IterationStatus::kRefusedByCcd;
  if (!(sigma <= (1.0 + options.convergence) * result.sigma)) return IterationStatus::kWouldRise;
  const bool settled = sigma >= (1.0 - options.convergence) * result.sigma;
  if (sigma < result.sigma) {
    result.q = next.q;
    result.sigma = sigma;
    result.certified = result.certified && next.certified;
    result.sigmas.push_back(sigma);
  }
  return settled ? IterationStatus::kConverged : IterationStatus::kIterationLimit;
}

IterationResult ContactSpaceIteration::Run(const VectorXd& q_f, const IterationOptions& options) {
  IterationResult result;
  projection_options_.reverse_samples = options.reverse_samples;
  const ProjectionResult& first =
      projection_.Project(q_f, problem_.q_in, projection_options_, &problem_.required);
  result.q = first.q;
  result.start_free = first.start_free;
  result.certified = first.certified;
  if (!result.start_free) return result;
  result.sigma = work_.norm.Sigma(result.q);
  result.sigmas.push_back(result.sigma);
  result.status = IterationStatus::kIterationLimit;
  while (result.status == IterationStatus::kIterationLimit &&
         result.iterations < options.max_iterations) {
    result.status = work_.Spent() ? IterationStatus::kTimeLimit : Step(options, result);
  }
  assert(std::is_sorted(result.sigmas.rbegin(), result.sigmas.rend()));
  return result;
}

}  // namespace mjcf_pdg
