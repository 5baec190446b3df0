#include "optimize/lcp.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "tests/support/test_support.h"

namespace mjcf_pdg {

// Also what GoogleTest prints of an outcome.
void PrintTo(const LcpOutcome& outcome, std::ostream* os) {
  *os << (outcome.converged ? "converged" : "not converged") << " after " << outcome.steps;
}

namespace test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kUnbounded = 1e6;  // μ that no multiplier of these problems comes near

struct Lcp {
  MatrixXd G;
  VectorXd b, mu;

  int n() const { return static_cast<int>(G.rows()); }
  int m() const { return static_cast<int>(G.cols()); }
};

// More rows than dimensions when m > n: some are then dependent. b of either sign: some are idle.
Lcp RandomLcp(Random& rng, int n, int m, double mu = kUnbounded) {
  Lcp lcp{MatrixXd(n, m), rng.Normals(m), VectorXd::Constant(m, mu)};
  for (int i = 0; i < m; ++i) lcp.G.col(i) = rng.Normals(n);
  return lcp;
}

// Gives b a point x that satisfies every row, Gᵀx >= b, some of them barely.
void MakeFeasible(Random& rng, Lcp& lcp) {
  lcp.b = lcp.G.transpose() * rng.Normals(lcp.n());
  for (int i = 0; i < lcp.m(); ++i) lcp.b[i] -= rng.Uniform(0.0, 0.5);
}

Lcp RandomFeasibleLcp(Random& rng, int n, int m) {
  Lcp lcp = RandomLcp(rng, n, m);
  MakeFeasible(rng, lcp);
  return lcp;
}

// The problem of these columns, in this order.
Lcp Picked(const Lcp& lcp, const std::vector<int>& columns) {
  const int m = static_cast<int>(columns.size());
  Lcp out{MatrixXd(lcp.n(), m), VectorXd(m), VectorXd(m)};
  for (int i = 0; i < m; ++i) {
    out.G.col(i) = lcp.G.col(columns[i]);
    out.b[i] = lcp.b[columns[i]];
    out.mu[i] = lcp.mu[columns[i]];
  }
  return out;
}

// Largest violation of what lcp.h promises of λ, in units of b.
double KktResidual(const Lcp& lcp, const VectorXd& lambda) {
  const VectorXd w = lcp.G.transpose() * (lcp.G * lambda) - lcp.b;
  double residual = 0.0;
  for (int i = 0; i < lcp.m(); ++i) {
    if (lambda[i] < 0.0 || lambda[i] > lcp.mu[i]) return 1e300;
    if (lcp.G.col(i).isZero(0.0)) continue;  // nothing can be done about such a row
    if (lambda[i] < lcp.mu[i]) residual = std::max(residual, -w[i]);
    if (lambda[i] > 0.0) residual = std::max(residual, w[i]);
  }
  return residual;
}

double DualObjective(const Lcp& lcp, const VectorXd& lambda) {
  return lcp.b.dot(lambda) - 0.5 * (lcp.G * lambda).squaredNorm();
}

VectorXd ActiveSet(const Lcp& lcp) {
  VectorXd lambda(lcp.m());
  ActiveSetLcp solver;
  const LcpOutcome outcome = solver.Solve(lcp.G, lcp.b, lcp.mu, {}, lambda);
  EXPECT_TRUE(outcome.converged) << ::testing::PrintToString(outcome);
  return lambda;
}

VectorXd GaussSeidel(const Lcp& lcp) {
  VectorXd lambda = VectorXd::Zero(lcp.m());
  LcpOptions options;
  options.max_steps = 200000;
  const LcpOutcome outcome = GaussSeidelLcp().Solve(lcp.G, lcp.b, lcp.mu, options, lambda);
  EXPECT_TRUE(outcome.converged) << ::testing::PrintToString(outcome);
  return lambda;
}

// The dense reference: tries every assignment of low, free and high to the rows.
VectorXd BruteForce(const Lcp& lcp) {
  const int m = lcp.m();
  const int cases = static_cast<int>(std::lround(std::pow(3, m)));
  VectorXd best = VectorXd::Zero(m);
  double least = 1e300;
  for (int code = 0; code < cases; ++code) {
    VectorXd lambda = VectorXd::Zero(m);
    std::vector<int> free;
    for (int i = 0, rest = code; i < m; ++i, rest /= 3) {
      if (rest % 3 == 1) free.push_back(i);
      if (rest % 3 == 2) lambda[i] = lcp.mu[i];
    }
    if (!free.empty()) {
      const Lcp part = Picked(lcp, free);
      const VectorXd rhs = part.b - part.G.transpose() * (lcp.G * lambda);
      const MatrixXd gram = part.G.transpose() * part.G;
      const VectorXd solved = gram.completeOrthogonalDecomposition().solve(rhs);
      for (std::size_t k = 0; k < free.size(); ++k) lambda[free[k]] = solved[k];
    }
    const double residual = KktResidual(lcp, lambda);
    if (residual < least) {
      least = residual;
      best = lambda;
    }
  }
  EXPECT_LT(least, 1e-9);
  return best;
}

TEST(LcpTest, BothMethodsSolveTheSameKktSystemOfIndependentRows) {
  Random rng(1);
  int free = 0, low = 0;
  for (int k = 0; k < 200; ++k) {
    const int n = 6 + rng.Index(20);
    const Lcp lcp = RandomLcp(rng, n, 1 + rng.Index(n / 2));
    const VectorXd a = ActiveSet(lcp), g = GaussSeidel(lcp);
    EXPECT_LT(KktResidual(lcp, a), 1e-9);
    EXPECT_LT(KktResidual(lcp, g), 1e-8);
    EXPECT_LT((a - g).lpNorm<Eigen::Infinity>(), 1e-7);  // GᵀG is regular: λ itself is unique
    free += static_cast<int>((a.array() > 0.0).count());
    low += static_cast<int>((a.array() == 0.0).count());
  }
  EXPECT_GT(free, 400);
  EXPECT_GT(low, 300);
}

TEST(LcpTest, BothMethodsGiveTheSameMotionWhenRowsAreDependent) {
  Random rng(2);
  int beyond_rank = 0;
  for (int k = 0; k < 100; ++k) {
    const int n = 3 + rng.Index(6), m = n + 1 + rng.Index(2 * n);
    Lcp lcp = RandomLcp(rng, n, m);
    for (int i = 1; i < m; i += 3) {  // exact and opposed duplicates
      lcp.G.col(i) = (rng.Chance(0.7) ? 1.0 : -0.1) * lcp.G.col(i - 1);
    }
    MakeFeasible(rng, lcp);
    const VectorXd a = ActiveSet(lcp), g = GaussSeidel(lcp);
    EXPECT_LT(KktResidual(lcp, a), 1e-8);
    EXPECT_LT((lcp.G * a - lcp.G * g).norm(), 1e-6 * (1.0 + (lcp.G * a).norm()));
    beyond_rank += m > n;
  }
  EXPECT_EQ(beyond_rank, 100);
}

TEST(LcpTest, AgreesWithADenseSearchOverActiveSets) {
  Random rng(3);
  int at_bound = 0, free = 0;
  for (int k = 0; k < 300; ++k) {
    const int m = 1 + rng.Index(5);
    const Lcp lcp = RandomLcp(rng, 1 + rng.Index(6), m, rng.Uniform(0.05, 1.0));
    const VectorXd reference = BruteForce(lcp), a = ActiveSet(lcp), g = GaussSeidel(lcp);
    EXPECT_LT((lcp.G * (a - reference)).norm(), 1e-8) << Join(a) << "\n" << Join(reference);
    EXPECT_LT((lcp.G * (g - reference)).norm(), 1e-6) << Join(g) << "\n" << Join(reference);
    at_bound += static_cast<int>((a.array() == lcp.mu.array()).count());
    free += static_cast<int>((a.array() > 0.0 && a.array() < lcp.mu.array()).count());
  }
  EXPECT_GT(at_bound, 100);
  EXPECT_GT(free, 100);
}

TEST(LcpTest, ConflictingRowsPushAsHardAsTheyMay) {
  // Two walls closer than the body is wide: no place satisfies both.
  Lcp lcp{MatrixXd(2, 3), Eigen::Vector3d(1.0, 0.6, 0.25), Eigen::Vector3d(40, 60, 40)};
  lcp.G << 1, -1, 0, 0, 0, 1;
  for (const VectorXd& lambda : {ActiveSet(lcp), GaussSeidel(lcp)}) {
    EXPECT_EQ(lambda[0], 40.0);          // the cheaper one gives way,
    EXPECT_NEAR(lambda[1], 40.6, 1e-9);  // the dearer one is satisfied
    EXPECT_NEAR(lambda[2], 0.25, 1e-9);
  }
  lcp.mu.setConstant(40.0);
  for (const VectorXd& lambda : {ActiveSet(lcp), GaussSeidel(lcp)}) {
    EXPECT_EQ(lambda[0], 40.0);  // as dear: they meet in the middle
    EXPECT_EQ(lambda[1], 40.0);
    EXPECT_NEAR(lambda[2], 0.25, 1e-9);
  }
}

TEST(LcpTest, ABoundBeyondAllMultipliersChangesNothing) {
  Random rng(4);
  for (int k = 0; k < 50; ++k) {
    Lcp lcp = RandomFeasibleLcp(rng, 8, 12);
    const VectorXd x = lcp.G * ActiveSet(lcp);
    for (const double mu : {1e5, 1e9, 1e12}) {
      lcp.mu.setConstant(mu);
      EXPECT_LT((lcp.G * ActiveSet(lcp) - x).norm(), 1e-8);
    }
    EXPECT_GE((lcp.G.transpose() * x - lcp.b).minCoeff(), -1e-8);  // feasible: no row gives way
  }
}

TEST(LcpTest, RowsThatNoMotionCanChangeKeepTheirMultiplierAtZero) {
  Random rng(5);
  Lcp lcp = RandomLcp(rng, 6, 5);
  lcp.G.col(1).setZero();
  lcp.G.col(4).setZero();
  lcp.b[1] = 7.0;
  lcp.b[4] = -7.0;
  const VectorXd rest = ActiveSet(Picked(lcp, {0, 2, 3}));
  for (const VectorXd& lambda : {ActiveSet(lcp), GaussSeidel(lcp)}) {
    EXPECT_EQ(lambda[1], 0.0);
    EXPECT_EQ(lambda[4], 0.0);
    EXPECT_NEAR(lambda[0], rest[0], 1e-9);
    EXPECT_NEAR(lambda[3], rest[2], 1e-9);
  }
}

TEST(LcpTest, ManyCopiesOfAContactMoveNothingFurtherThanOne) {
  Random rng(6);
  const Lcp one = RandomFeasibleLcp(rng, 7, 4);
  std::vector<int> copies;
  for (int k = 0; k < 40; ++k) copies.push_back(k % 4);
  const Lcp many = Picked(one, copies);
  const VectorXd x = one.G * ActiveSet(one);
  EXPECT_GT(x.norm(), 0.1);
  EXPECT_LT((many.G * ActiveSet(many) - x).norm(), 1e-8);
  EXPECT_LT((many.G * GaussSeidel(many) - x).norm(), 1e-8);
}

TEST(LcpTest, NoRowsMeanNoMotion) {
  const Lcp lcp{MatrixXd(5, 0), VectorXd(0), VectorXd(0)};
  EXPECT_EQ(ActiveSet(lcp).size(), 0);
  EXPECT_EQ(GaussSeidel(lcp).size(), 0);
}

TEST(LcpTest, AtTheSolutionASweepChangesNothing) {
  Random rng(7);
  for (int k = 0; k < 50; ++k) {
    const Lcp lcp = RandomLcp(rng, 20, 10);
    VectorXd lambda = ActiveSet(lcp);
    LcpOptions looser;
    looser.tolerance = 1e-8;
    EXPECT_EQ(GaussSeidelLcp().Solve(lcp.G, lcp.b, lcp.mu, looser, lambda).steps, 1);
  }
}

TEST(LcpTest, TheOrderOfTheRowsDoesNotChangeTheMotion) {
  Random rng(9);
  const Lcp lcp = RandomFeasibleLcp(rng, 6, 15);
  const VectorXd x = lcp.G * ActiveSet(lcp);
  std::vector<int> order(15);
  std::iota(order.begin(), order.end(), 0);
  for (int k = 0; k < 30; ++k) {
    for (int i = 14; i > 0; --i) std::swap(order[i], order[rng.Index(i + 1)]);
    const Lcp shuffled = Picked(lcp, order);
    EXPECT_LT((shuffled.G * ActiveSet(shuffled) - x).norm(), 1e-8);
    EXPECT_LT((shuffled.G * GaussSeidel(shuffled) - x).norm(), 1e-7);
  }
}

TEST(LcpTest, TheDualObjectiveNeverFalls) {
  Random rng(10);
  int risen = 0;
  for (int k = 0; k < 30; ++k) {
    const Lcp lcp = RandomLcp(rng, 8, 14, k % 2 ? 0.5 : 50.0);
    VectorXd swept = VectorXd::Zero(14), lambda(14);
    double sweeps_value = 0.0, steps_value = 0.0;
    for (int step = 1; step <= 30; ++step) {
      LcpOptions options;
      options.max_steps = 1;
      GaussSeidelLcp().Solve(lcp.G, lcp.b, lcp.mu, options, swept);
      EXPECT_GE(DualObjective(lcp, swept), sweeps_value - 1e-12 * (1.0 + sweeps_value));
      sweeps_value = DualObjective(lcp, swept);
      options.max_steps = step;
      ActiveSetLcp().Solve(lcp.G, lcp.b, lcp.mu, options, lambda);
      EXPECT_GE(DualObjective(lcp, lambda), steps_value - 1e-9 * (1.0 + steps_value));
      risen += DualObjective(lcp, lambda) > steps_value;
      steps_value = DualObjective(lcp, lambda);
    }
  }
  EXPECT_GT(risen, 100);
}

TEST(LcpTest, TooFewStepsAreNotCalledConverged) {
  Random rng(11);
  const Lcp lcp = RandomFeasibleLcp(rng, 20, 20);
  LcpOptions options;
  options.max_steps = 2;
  VectorXd lambda = VectorXd::Zero(20);
  const LcpOutcome sweeps = GaussSeidelLcp().Solve(lcp.G, lcp.b, lcp.mu, options, lambda);
  EXPECT_FALSE(sweeps.converged);
  EXPECT_EQ(sweeps.steps, 2);
  const LcpOutcome steps = ActiveSetLcp().Solve(lcp.G, lcp.b, lcp.mu, options, lambda);
  EXPECT_FALSE(steps.converged);
  EXPECT_EQ(steps.steps, 2);
}

TEST(LcpTest, ALargerProblemBeforeLeavesNoTrace) {
  Random rng(12);
  const Lcp small = RandomLcp(rng, 5, 7, 0.8), big = RandomLcp(rng, 30, 40);
  ActiveSetLcp solver;
  VectorXd first(7), other(40), third(7);
  solver.Solve(small.G, small.b, small.mu, {}, first);
  solver.Solve(big.G, big.b, big.mu, {}, other);
  solver.Solve(small.G, small.b, small.mu, {}, third);
  EXPECT_EQ(first, third);
  EXPECT_EQ(first, ActiveSet(small));
}

// Columns of bodies with 6, 2, 6 and 3 coordinates, each of one or two of them.
TEST(LcpTest, PackedColumnsHaveTheSolutionOfTheWholeOnes) {
  Random rng(17);
  const std::vector<ColumnRange> bodies = {{0, 6}, {6, 2}, {8, 6}, {14, 3}};
  const int n = 17;
  ActiveSetLcp solver;
  for (int trial = 0; trial < 40; ++trial) {
    const int m = 5 + rng.Index(30);
    Lcp lcp = RandomLcp(rng, n, m, 10.0);
    MatrixXd packed = MatrixXd::Constant(12, m, 1e300);  // what is not packed must not be read
    std::vector<Support> supports;
    for (int i = 0; i < m; ++i) {
      const int first = rng.Index(4), second = rng.Index(4);
      const Support s{bodies[first], first == second ? ColumnRange{} : bodies[second]};
      VectorXd whole = VectorXd::Zero(n);
      for (const ColumnRange& range : {s.first, s.second}) {
        whole.segment(range.begin, range.size) = lcp.G.col(i).segment(range.begin, range.size);
      }
      lcp.G.col(i) = whole;
      packed.col(i).head(s.first.size) = whole.segment(s.first.begin, s.first.size);
      packed.col(i).segment(s.first.size, s.second.size) =
          whole.segment(s.second.begin, s.second.size);
      supports.push_back(s);
    }
    VectorXd lambda(m);
    const LcpOutcome outcome =
        solver.Solve(packed, lcp.b, lcp.mu, {}, lambda, {.rows = n, .supports = supports});
    EXPECT_TRUE(outcome.converged) << ::testing::PrintToString(outcome);
    EXPECT_LT(KktResidual(lcp, lambda), 1e-8);
    EXPECT_NEAR(DualObjective(lcp, lambda), DualObjective(lcp, ActiveSet(lcp)), 1e-8);
    const VectorXd cold = lambda;
    for (int i = 0; i < m; ++i) lambda[i] = rng.Chance(0.3) ? rng.Uniform(0.0, 12.0) : 0.0;
    EXPECT_TRUE(
        solver.SolveFrom(packed, lcp.b, lcp.mu, {}, lambda, {.rows = n, .supports = supports})
            .converged);
    EXPECT_LT(KktResidual(lcp, lambda), 1e-8);
    EXPECT_LT((lcp.G * (lambda - cold)).norm(), 1e-7);
  }
}

// Of any number of rows, some of them dependent or in conflict, and guesses that are wrong by much.
TEST(LcpTest, AnyStartEndsAtTheSameMotion) {
  Random rng(18);
  int at_bound = 0, guessed = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const int n = 2 + rng.Index(20), m = 1 + rng.Index(3 * n);
    Lcp lcp = RandomLcp(rng, n, m, rng.Chance(0.5) ? 0.5 : 50.0);
    for (int i = 1; i < m; ++i) {
      if (rng.Chance(0.3)) lcp.G.col(i) = (rng.Chance(0.7) ? 1.0 : -0.5) * lcp.G.col(i - 1);
    }
    const VectorXd cold = ActiveSet(lcp);
    VectorXd lambda(m);
    for (int i = 0; i < m; ++i) lambda[i] = rng.Chance(0.5) ? 0.0 : rng.Uniform(0.0, 60.0);
    guessed += static_cast<int>((lambda.array() > 0.0 && lambda.array() < lcp.mu.array()).count());
    ActiveSetLcp solver;
    const LcpOutcome outcome = solver.SolveFrom(lcp.G, lcp.b, lcp.mu, {}, lambda);
    EXPECT_TRUE(outcome.converged) << ::testing::PrintToString(outcome);
    EXPECT_LT(KktResidual(lcp, lambda), 1e-8);
    EXPECT_LT((lcp.G * (lambda - cold)).norm(), 1e-7);
    at_bound += static_cast<int>((lambda.array() == lcp.mu.array()).count());
  }
  EXPECT_GT(at_bound, 300);
  EXPECT_GT(guessed, 500);
}

// Which is what an estimate of its cost by its steps relies on.
TEST(LcpTest, AStartAtTheSolutionTakesAStepForEachFreeRow) {
  Random rng(19);
  int all = 0;
  for (int trial = 0; trial < 50; ++trial) {
    const int n = 6 + rng.Index(20);
    const Lcp lcp = RandomLcp(rng, n, n / 2, 0.5);
    const VectorXd cold = ActiveSet(lcp);
    VectorXd lambda = cold;
    ActiveSetLcp solver;
    const LcpOutcome outcome = solver.SolveFrom(lcp.G, lcp.b, lcp.mu, {}, lambda);
    EXPECT_TRUE(outcome.converged);
    EXPECT_EQ(outcome.steps, (cold.array() > 0.0 && cold.array() < lcp.mu.array()).count());
    EXPECT_LT((lambda - cold).lpNorm<Eigen::Infinity>(), 1e-9);
    all += outcome.steps;
  }
  EXPECT_GT(all, 100);
}

TEST(LcpTest, TheActiveSetMethodEndsWithinTheStepsOfALocalOptimization) {
  // As in use: up to 100 rows, most of them duplicates and opposed pairs, penalty weights from 10
  // to 10⁶.
  Random rng(13);
  int at_bound = 0;
  for (int k = 0; k < 60; ++k) {
    const int n = 6 + rng.Index(35), m = 20 + rng.Index(80);
    Lcp lcp = RandomLcp(rng, n, m, std::pow(10.0, 1 + rng.Index(4)));
    for (int i = 0; i < m; ++i) {
      if (i > 4 && rng.Chance(0.6)) lcp.G.col(i) = lcp.G.col(rng.Index(i)) + 1e-4 * lcp.G.col(i);
      if (rng.Chance(0.1)) lcp.G.col(i) *= -1.0;
      if (rng.Chance(0.2)) lcp.mu[i] = 1e6;
    }
    LcpOptions options;
    options.max_steps = 10 * (n + m);
    options.tolerance = 1e-8;
    VectorXd lambda(m);
    ActiveSetLcp solver;
    const LcpOutcome outcome = solver.Solve(lcp.G, lcp.b, lcp.mu, options, lambda);
    EXPECT_TRUE(outcome.converged) << ::testing::PrintToString(outcome) << " of " << m << " rows";
    EXPECT_LT(KktResidual(lcp, lambda), 1e-5);
    at_bound += static_cast<int>((lambda.array() == lcp.mu.array()).count());
  }
  EXPECT_GT(at_bound, 20);
}

}  // namespace
}  // namespace test
}  // namespace mjcf_pdg
