// That no motion shorter than the length undoes so much, and that hardly longer ones do.
#include "bound/farthest_motion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

constexpr int kLooks = 40;

struct Problem {
  std::vector<Coordinates> coordinates;
  std::vector<BendBlock> bends;
  Eigen::VectorXd g;
  double E = 0.0;

  explicit Problem(Random& rng, double bent) {
    int at = 0;
    const int movers = 1 + rng.Index(4);
    for (int k = 0; k < movers; ++k) {
      static constexpr int kKinds[][2] = {{1, 0}, {0, 1}, {0, 3}, {3, 3}};
      const auto& [slides, turns] = kKinds[rng.Index(4)];
      coordinates.push_back({.at = at, .slides = slides, .turns = turns});
      at += slides + turns;
      BendBlock& block = bends.emplace_back();
      block.d = bent * rng.Uniform();
      const Matrix3d any = Matrix3d::NullaryExpr([&] { return rng.Normal(); });
      if (turns == 1) block.B(0, 0) = bent * rng.Normal();
      if (turns == 3) block.B = 0.5 * bent * (any + any.transpose());
    }
    g = rng.Normals(at);
    E = rng.Chance(0.5) ? rng.Uniform() : 0.0;
  }

  Undoing Of() const { return {coordinates, bends, g, E}; }
  double At(const Eigen::VectorXd& x) const {
    double sum = g.dot(x) + E * x.norm();
    for (std::size_t k = 0; k < bends.size(); ++k) {
      const Coordinates& part = coordinates[k];
      sum += 0.5 * bends[k].d * part.SquaredNorm(x);
      const int turns = part.turns;
      const Eigen::VectorXd w = x.segment(part.at + part.slides, turns);
      sum += 0.5 * w.dot(bends[k].B.topLeftCorner(turns, turns) * w);
    }
    return sum;
  }
  // The most that a motion of this length undoes, by ascent from a few starts.
  double Most(double length, Random& rng) const {
    double most = -1.0;
    for (int start = 0; start < 8; ++start) {
      Eigen::VectorXd x = start == 0 ? g : rng.Normals(static_cast<int>(g.size()));
      x *= length / x.norm();
      double at = At(x), step = 0.3;
      for (int k = 0; k < 300; ++k) {
        Eigen::VectorXd next = x + step * length * rng.Normals(static_cast<int>(g.size()));
        next *= length / next.norm();
        const double value = At(next);
        step *= value > at ? 1.3 : 0.93;
        if (value <= at) continue;
        at = value;
        x = next;
      }
      most = std::max(most, at);
    }
    return most;
  }
};

TEST(FarthestMotionTest, NoShorterMotionUndoesItAndOneHardlyLongerMostlyDoes) {
  Random rng(1);
  int tight = 0;
  for (int trial = 0; trial < 150; ++trial) {
    const Problem problem(rng, trial % 3 == 0 ? 0.0 : std::pow(10.0, rng.Uniform(-2.0, 1.0)));
    const double T = std::pow(10.0, rng.Uniform(-2.0, 1.0));
    Eigen::VectorXd x(problem.g.size());
    const double guess = T / (problem.g.norm() + problem.E);
    const double length = problem.Of().LeastLength(T, guess, kLooks, x);
    ASSERT_GT(length, 0.0);
    EXPECT_LE(problem.Most(length, rng), T * (1.0 + 1e-9)) << "trial " << trial;
    tight += problem.Most(1.06 * length, rng) > T;
  }
  EXPECT_GT(tight, 140);  // where most of Q is far from g, its eigenvalues are overestimated
}

TEST(FarthestMotionTest, AnyLooksProveSomethingAndMoreProveNoLess) {
  Random rng(2);
  for (int trial = 0; trial < 100; ++trial) {
    const Problem problem(rng, 1.0);
    const double T = std::pow(10.0, rng.Uniform(-2.0, 1.0));
    const double guess = T / problem.g.norm() * std::pow(10.0, rng.Uniform(-1.0, 1.0));
    double before = 0.0;
    for (const int looks : {1, 2, 5, 40}) {
      Eigen::VectorXd x(problem.g.size());
      const double length = problem.Of().LeastLength(T, guess, looks, x);
      EXPECT_GE(length, before);
      EXPECT_LE(problem.Most(length, rng), T * (1.0 + 1e-9)) << "trial " << trial;
      before = length;
    }
  }
}

TEST(FarthestMotionTest, WithoutBendsItIsOverlapOverGradient) {
  Random rng(3);
  for (int trial = 0; trial < 50; ++trial) {
    const Problem problem(rng, 0.0);
    const double T = rng.Uniform(0.1, 1.0), exact = T / (problem.g.norm() + problem.E);
    Eigen::VectorXd x(problem.g.size());
    EXPECT_NEAR(problem.Of().LeastLength(T, exact, 2, x), exact, 1e-9 * exact);
    EXPECT_NEAR(x.normalized().dot(problem.g.normalized()), 1.0, 1e-9);
  }
}

TEST(FarthestMotionTest, NothingIsProvenOfWhatIsNotToBeUndoneOrNotMoved) {
  Random rng(4);
  Problem problem(rng, 1.0);
  Eigen::VectorXd x(problem.g.size());
  EXPECT_EQ(problem.Of().LeastLength(0.0, 1.0, 5, x), 0.0);
  EXPECT_EQ(problem.Of().LeastLength(-1.0, 1.0, 5, x), 0.0);
  problem.g.setZero();
  EXPECT_EQ(problem.Of().LeastLength(1.0, 1.0, 5, x), 0.0);
}

}  // namespace
}  // namespace mjcf_pdg::test
