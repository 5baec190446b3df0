#include <algorithm>

#include "base/block_cholesky.h"
#include "library/quadratic_program.h"
#include "library/questions.h"
#include "optimize/contact_matrix.h"
#include "optimize/lcp.h"
#include "problem/workspace.h"

namespace mjcf_pdg::bench {

void AskLcp(const Scene& scene, const VectorXd& q, Table& table, int& infeasible) {
  constexpr double kMargin = 0.12, kLimitReach = 0.5, kTolerance = 1e-8, kPenalty = 1e6,
                   kImmovable = 1e-12;
  const SceneTables& tables = scene.tables();
  const Options options;
  Workspace work(tables, options);
  work.Begin(q);
  work.finder.Pose(q);
  ContactRows rows;
  rows.Clear(tables.n);
  for (const NearPair& near : work.finder.Find(kMargin * work.problem().size)) {
    if (!tables.pairs[near.pair].moves) continue;
    const int row = rows.Append(near.distance);
    ContactRow(tables, work.finder.posed(), near.pair, near.p1_W, near.p2_W, near.n_W,
               rows.C.row(row));
  }
  const double size = work.problem().size;
  AppendLimitRows(tables, q, {kLimitReach, kLimitReach * size, size}, rows);
  const int n = tables.n, m = rows.m;
  if (m == 0) return;
  VectorXd r;
  MatrixXd J, H;
  work.norm.Linearize(q, r, J);
  work.norm.InnerProduct(J, H);
  BlockCholesky whitening;
  whitening.Factor(H, work.norm.blocks());
  VectorXd y = J.transpose() * r;
  whitening.SolveLower(y);
  MatrixXd G = rows.C.topRows(m).transpose();
  whitening.SolveLower(G);
  // To first order no joint moves the two geoms of some row, so that only an elastic answer exists.
  const auto lengths = G.colwise().norm();
  if (lengths.minCoeff() < kImmovable * lengths.maxCoeff()) {
    ++infeasible;
    return;
  }
  const VectorXd gap = rows.gap.head(m), b = G.transpose() * y - gap;
  const VectorXd mu = VectorXd::Constant(m, kPenalty);
  VectorXd lambda(m);
  LcpOptions how;
  how.max_steps = 10 * (n + m);
  how.tolerance = kTolerance;
  ActiveSetLcp active_set;
  LcpOutcome outcome;
  const double seconds = Seconds([&] { outcome = active_set.Solve(G, b, mu, how, lambda); });
  if ((lambda.array() >= mu.array()).any()) {  // rows conflict: only an elastic answer exists
    ++infeasible;
    return;
  }
  const std::string kind = m < 20 ? "LCP, fewer than 20 rows" : "LCP, 20 rows and more";
  const VectorXd z = G * lambda - y;
  // Answers are compared by violation and objective: the step z is unique, but the multipliers of
  // dependent rows are not.
  auto error = [&](const VectorXd& other) {
    const double violation = -(G.transpose() * other + gap).minCoeff();
    const double worse = (other + y).norm() - (z + y).norm();
    return std::max(violation, worse) / work.problem().size;
  };
  table.Add(kind, kOurs, seconds, outcome.converged ? error(z) : kNoAnswer);
  const QpOutcome daqp = SolveByDaqp(G, y, gap);
  if (daqp.built) {
    double setup = daqp.setup_seconds;
    const double alone = [&] {
      double least = daqp.seconds;
      for (int k = 1; k < kRepeats; ++k) {
        const QpOutcome again = SolveByDaqp(G, y, gap);
        least = std::min(least, again.seconds);
        setup = std::min(setup, again.setup_seconds);
      }
      return least;
    }();
    const double off = daqp.solved ? error(daqp.z) : kNoAnswer;
    table.Add(kind, "DAQP", alone, off);
    table.Add(kind, "DAQP, setup", setup + alone, off);
  }
  GaussSeidelLcp gauss_seidel;
  VectorXd swept(m);
  const double sweeping = Seconds([&] {
    swept.setZero();
    outcome = gauss_seidel.Solve(G, b, mu, how, swept);
  });
  table.Add(kind, "Gauss-Seidel", sweeping, outcome.converged ? error(G * swept - y) : kNoAnswer);
}

}  // namespace mjcf_pdg::bench
