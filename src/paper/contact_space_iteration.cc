#include "paper/contact_space_iteration.h"

#include <algorithm>
#include <cassert>

#include "base/grow.h"
#include "base/tuning.h"

namespace mjcf_pdg {

namespace tune = tuning::paper;

namespace {

constexpr int kContacts = 128;     // that there is room for from the start
constexpr double kNoBound = 1e12;  // μ of rows that nothing may violate

}  // namespace

ContactSpaceIteration::ContactSpaceIteration(Workspace& work)
    : problem_(work.problem()),
      work_(work),
      ccd_(work.problem().tables, work.finder),
      projection_(work.problem().tables, ccd_) {
  projection_options_.ccd.tolerance = work.problem().tolerances.accept;
  projection_options_.ccd.budget = &work.budget;
  const SceneTables& tables = problem_.tables;
  const int n = tables.n, nq = static_cast<int>(tables.model->nq), k = work.norm.rows();
  const int contacts = std::min(kContacts, static_cast<int>(tables.pairs.size()));
  const int rows = contacts + 2 * static_cast<int>(tables.joints.size());
  rows_.Reserve(rows, n);
  GrowTo(n, rows, G_);
  for (VectorXd* per_row : {&b_, &mu_, &lambda_}) GrowTo(rows, *per_row);
  lcp_.Reserve(n, rows);
  whitening_.Reserve(n);
  J_.resize(k, n);
  H_.resize(n, n);
  r_.resize(k);
  for (VectorXd* per_dof : {&y_, &dq_, &z_}) per_dof->resize(n);
  for (VectorXd* q : {&q_, &result_.q, &next_.q}) q->resize(nq);
  next_.pairs.reserve(tables.pairs.size());
  result_.sigmas.reserve(1 + IterationOptions{}.max_iterations);
}

void ContactSpaceIteration::Optimize(const VectorXd& q_c, const IterationOptions& options,
                                     VectorXd& q) {
  const SceneTables& tables = problem_.tables;
  rows_.Clear(tables.n);
  dq_.setZero(tables.n);
  AppendContactRows(q_c);
  constexpr double kAll = std::numeric_limits<double>::infinity();
  AppendLimitRows(tables, q_c, {kAll, kAll, problem_.size}, rows_);
  work_.norm.Linearize(q_c, r_, J_);
  work_.norm.InnerProduct(J_, H_);
  whitening_.Factor(H_, work_.norm.blocks());
  Minimize(q_c, options, q);
}

// The contacts at q_c ⊕ dq_, linearized there: c·(dq - dq_) + gap >= 0.
void ContactSpaceIteration::AppendContactRows(const VectorXd& q) {
  const double band = tune::kTouchingBand * projection_options_.ccd.Gap();
  work_.finder.Pose(q);
  for (const NearPair& near : work_.finder.Find(problem_.clearance + band)) {
    const double gap = near.distance - problem_.required[near.pair];
    if (!problem_.tables.pairs[near.pair].moves || gap > band) continue;
    const int row = rows_.Append(0.0, {.pair = near.pair});
    ContactRow(problem_.tables, work_.finder.posed(), near.pair, near.p1_W, near.p2_W, near.n_W,
               rows_.C.row(row));
    rows_.gap[row] = gap - rows_.C.row(row).dot(dq_);
  }
}

// In whitened coordinates r = H^½ X: C' = C (dq/dX), and X* = H⁻¹ C'ᵀ λ* reads r* = G λ*.
void ContactSpaceIteration::Minimize(const VectorXd& q_c, const IterationOptions& options,
                                     VectorXd& q) {
  const int n = problem_.tables.n, m = rows_.m;
  GrowTo(n, m, G_);
  for (VectorXd* per_row : {&b_, &mu_, &lambda_}) GrowTo(m, *per_row);
  auto G = G_.leftCols(m);
  auto b = b_.head(m), mu = mu_.head(m), lambda = lambda_.head(m);
  y_.noalias() = J_.transpose() * r_;
  whitening_.SolveLower(y_);
  G = rows_.C.topRows(m).transpose();
  whitening_.SolveLower(G);
  b.noalias() = G.transpose() * y_;
  b -= rows_.gap.head(m);
  mu.setConstant(kNoBound);
  lambda.setZero();
  LcpOptions lcp;
  lcp.max_steps = options.max_sweeps;
  result_.sweeps += lcp_.Solve(G, b, mu, lcp, lambda).steps;
  z_.noalias() = G * lambda;
  dq_ = z_ - y_;
  whitening_.SolveUpper(dq_);
  work_.norm.Retract(q_c, dq_, q);
  ClampToLimits(problem_.tables, q);
}

// The minimizer, where it collides, tells which contacts were missing or curve too much: they join
// the others, and the minimum is sought again, until it is free.
bool ContactSpaceIteration::Correct(const VectorXd& q_c, const IterationOptions& options,
                                    VectorXd& q) {
  for (int k = 0; k < options.corrections && !work_.Spent(); ++k) {
    AppendContactRows(q);
    Minimize(q_c, options, q);
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

IterationStatus ContactSpaceIteration::Step(const IterationOptions& options) {
  ++result_.iterations;
  Optimize(result_.q, options, q_);
  next_ = Reproject(result_.q, q_);
  double sigma = work_.norm.Sigma(next_.q);
  if (!work_.Free(q_) && Correct(result_.q, options, q_)) {
    const ProjectionResult& corrected = Reproject(result_.q, q_);
    const double corrected_sigma = work_.norm.Sigma(corrected.q);
    if (corrected.start_free && corrected_sigma < sigma) {
      next_ = corrected;
      sigma = corrected_sigma;
    }
  }
  if (!next_.start_free) return IterationStatus::kRefusedByCcd;
  if (!(sigma <= (1.0 + options.convergence) * result_.sigma)) return IterationStatus::kWouldRise;
  const bool settled = sigma >= (1.0 - options.convergence) * result_.sigma;
  if (sigma < result_.sigma) {
    result_.q = next_.q;
    result_.sigma = sigma;
    result_.certified = result_.certified && next_.certified;
    result_.sigmas.push_back(sigma);
  }
  return settled ? IterationStatus::kConverged : IterationStatus::kIterationLimit;
}

// Tells an observer of the accepted configuration; the rows are those of the last constrained
// optimization.
void ContactSpaceIteration::Observe(bool stepped) {
  if (!work_.Watched()) return;
  std::vector<ObservedRow>& rows = work_.recorder->rows();
  rows.clear();
  if (stepped) AppendObserved(problem_.tables, rows_, lambda_, rows);
  work_.recorder->Tell({result_.q, result_.sigma, 0.0, true});
}

const IterationResult& ContactSpaceIteration::Run(const VectorXd& q_f,
                                                  const IterationOptions& options) {
  projection_options_.reverse_samples = options.reverse_samples;
  const ProjectionResult& first =
      projection_.Project(q_f, problem_.q_in, projection_options_, &problem_.required);
  result_.q = first.q;
  result_.start_free = first.start_free;
  result_.certified = first.certified;
  result_.sigma = std::numeric_limits<double>::infinity();
  result_.sigmas.clear();
  result_.iterations = result_.sweeps = 0;
  result_.status = IterationStatus::kStartNotFree;
  if (!result_.start_free) return result_;
  result_.sigma = work_.norm.Sigma(result_.q);
  result_.sigmas.push_back(result_.sigma);
  if (work_.Watched()) work_.recorder->BeginDescent(options.start);
  Observe(false);
  result_.status = IterationStatus::kIterationLimit;
  while (result_.status == IterationStatus::kIterationLimit &&
         result_.iterations < options.max_iterations) {
    if (work_.Spent()) {
      result_.status = IterationStatus::kBudget;
    } else {
      result_.status = Step(options);
      Observe(true);
    }
  }
  assert(std::is_sorted(result_.sigmas.rbegin(), result_.sigmas.rend()));
  return result_;
}

}  // namespace mjcf_pdg
