// The tools of base/ and the cache of frames, each by its definition.
#include <algorithm>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <vector>

#include "base/block_cholesky.h"
#include "base/grow.h"
#include "base/in_order.h"
#include "base/random.h"
#include "start/motion_coherence.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

TEST(BlockCholeskyTest, APartOfAVectorIsSolvedAsTheWhole) {
  Random rng(2);
  const std::vector<ColumnRange> blocks = {{0, 6}, {6, 1}, {7, 3}, {10, 6}, {16, 2}};
  const MatrixXd A = rng.Normals(18) * rng.Normals(18).transpose();
  BlockCholesky cholesky;
  cholesky.Factor(A * A.transpose() + MatrixXd::Identity(18, 18), blocks);
  VectorXd whole = VectorXd::Zero(18);
  whole.segment<10>(6) = rng.Normals(10);
  VectorXd part = whole.segment<10>(6);
  cholesky.SolveLower(whole);
  cholesky.SolveLower({6, 10}, part.data());
  EXPECT_LT((part - whole.segment<10>(6)).norm(), 1e-14);
}

TEST(BlockCholeskyTest, SolvesWithTheFactorOfTheDiagonalBlocksAlone) {
  Random rng(1);
  BlockCholesky cholesky;
  for (int trial = 0; trial < 30; ++trial) {
    std::vector<ColumnRange> blocks;
    int n = 0;
    for (int k = 0; k < 5; ++k) {
      blocks.push_back({n, 1 + rng.Index(9)});
      n += blocks.back().size;
    }
    MatrixXd A(n, n), alone = MatrixXd::Zero(n, n);
    for (int j = 0; j < n; ++j) A.col(j) = rng.Normals(n);
    const MatrixXd H = A * A.transpose() + MatrixXd::Identity(n, n);
    for (const ColumnRange& b : blocks) {
      alone.block(b.begin, b.begin, b.size, b.size) = H.block(b.begin, b.begin, b.size, b.size);
    }
    const MatrixXd L = alone.llt().matrixL();
    cholesky.Factor(H, blocks);
    MatrixXd B(n, 3);
    for (int j = 0; j < 3; ++j) B.col(j) = rng.Normals(n);
    MatrixXd lower = B, upper = B;
    cholesky.SolveLower(lower);
    cholesky.SolveUpper(upper);
    EXPECT_LT((L * lower - B).norm(), 1e-10);
    EXPECT_LT((L.transpose() * upper - B).norm(), 1e-10);
  }
}

TEST(GrowTest, SizesOnlyGrowAndRowsAreExact) {
  VectorXd v;
  MatrixXd m;
  Eigen::Index entries = 0;
  for (const Eigen::Index size : {3, 2, 10, 11, 1, 40}) {
    GrowTo(size, v);
    EXPECT_GE(v.size(), std::max(size, entries));
    entries = v.size();
    GrowTo(4, size, m);
    EXPECT_EQ(m.rows(), 4);
    EXPECT_GE(m.cols(), size);
    const double* const before = m.data();
    GrowTo(4, m.cols(), m);
    EXPECT_EQ(m.data(), before);
  }
  GrowTo(5, 1, m);
  EXPECT_EQ(m.rows(), 5);
  EXPECT_GE(m.cols(), 1);
}

TEST(BaseRandomTest, BitsAreThoseOfSplitMix64) {
  mjcf_pdg::Random random(0);
  EXPECT_EQ(random.Bits(), 0xe220a8397b1dcdafu);
  EXPECT_EQ(random.Bits(), 0x6e789e6aa1b965f4u);
  EXPECT_EQ(random.Bits(), 0x06c45d188009454fu);
  double sum = 0.0, squares = 0.0, uniform = 0.0;
  constexpr int kDraws = 20000;
  for (int k = 0; k < kDraws; ++k) {
    const double u = random.Uniform(), x = random.Normal();
    ASSERT_TRUE(u > 0.0 && u < 1.0);
    uniform += u / kDraws, sum += x / kDraws, squares += x * x / kDraws;
  }
  EXPECT_NEAR(uniform, 0.5, 0.01);
  EXPECT_NEAR(sum, 0.0, 0.03);
  EXPECT_NEAR(squares, 1.0, 0.04);
}

TEST(InOrderTest, ItemsAreTakenAndToldInOrderByAnyNumberOfThreads) {
  for (const std::size_t threads : {1, 2, 5}) {
    for (const int end : {0, 1, 3000}) {
      for (const int last : {3000, 700}) {
        int taken = 0, next = 0;
        std::vector<int> by_thread(threads, 0);
        InOrder<int> in_order(threads);
        in_order.Run(
            [&](int& item) {
              item = taken;
              return taken++ < end;
            },
            [&](std::size_t thread, int& item) {
              ++by_thread[thread];
              item = 3 * item;
            },
            [&](std::size_t index, const int& item) {
              EXPECT_EQ(index, static_cast<std::size_t>(next));
              EXPECT_EQ(item, 3 * next);
              return ++next < last;
            });
        EXPECT_EQ(next, std::min(end, last));
        int worked = 0;
        for (const int count : by_thread) worked += count;
        EXPECT_GE(worked, next);
        const auto waiting = InOrder<int>::kWaitingPerThread * threads;
        EXPECT_LE(worked, next + static_cast<int>(waiting));
      }
    }
  }
}

TEST(InOrderTest, WhatWasTakenBeforeAnExceptionIsToldAndTheFirstIsThrownOn) {
  for (const std::size_t threads : {1, 3}) {
    int taken = 0, told = 0;
    InOrder<int> in_order(threads);
    const auto take = [&](int& item) {
      if (taken == 50) throw std::runtime_error("take");
      item = taken++;
      return true;
    };
    const auto tell = [&](std::size_t, const int&) { return ++told > 0; };
    EXPECT_THROW(in_order.Run(take, [](std::size_t, int&) {}, tell), std::runtime_error);
    EXPECT_EQ(told, 50);
    InOrder<int> other(threads);
    taken = told = 0;
    const auto work = [](std::size_t, int& item) {
      if (item == 20) throw std::logic_error("work");
    };
    // The thread that has item 20 may be stopped by the system while others take all that there are.
    const auto take_all = [&](int& item) { return (item = taken++) < 50; };
    EXPECT_THROW(other.Run(take_all, work, tell), std::logic_error);
    EXPECT_LE(told, 20);
  }
}

class ConfigurationCacheTest : public MujocoTest {};

TEST_F(ConfigurationCacheTest, TheLastOnesComeBackNearestFirst) {
  SceneOptions options;
  options.fixed = {"frozen"};
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody><geom size=".1"/>
      <body name="frozen" pos="1 0 0"><joint type="slide" axis="1 0 0"/><geom size=".1"/>
        <body name="moving" pos=".5 0 0"><joint axis="0 1 0"/><geom size=".1" pos=".2 0 0"/>
        </body></body></worldbody></mujoco>)",
                                        options);
  const Options none;
  Workspace work(scene.tables(), none);
  work.Begin(Eigen::Vector2d(0.3, 0.1));
  Random rng(2);
  ConfigurationCache cache(5);
  std::vector<Eigen::Vector2d> all;
  for (int k = 0; k < 23; ++k) {
    EXPECT_EQ(cache.empty(), k % 12 == 0);
    all.emplace_back(rng.Uniform(-1, 1), rng.Uniform(-1, 1));
    cache.Add(all.back());
    if (all.size() > 5) all.erase(all.begin());
    std::vector<double> angles;
    for (const Eigen::Vector2d& q : all) angles.push_back(q[1]);
    std::sort(angles.begin(), angles.end(),
              [](double a, double b) { return std::abs(a - 0.1) < std::abs(b - 0.1); });
    for (const std::size_t count : {2u, 9u}) {
      const std::vector<VectorXd> found = cache.NearestFirst(work, count);
      ASSERT_EQ(found.size(), std::min(count, angles.size()));
      for (std::size_t i = 0; i < found.size(); ++i) {
        EXPECT_EQ(found[i], Eigen::Vector2d(0.3, angles[i]));
      }
    }
    if (k % 12 != 11) continue;
    cache.Clear();
    all.clear();
  }
}

}  // namespace
}  // namespace mjcf_pdg::test
