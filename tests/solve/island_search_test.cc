// Scenes of several trees, solved island by island (solve/island_search.h).
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "mjcf_pdg/pdg.h"
#include "model/kinematics.h"
#include "tests/support/heap.h"
#include "tests/support/test_support.h"
#include "tests/support/witness.h"

namespace mjcf_pdg::test {
namespace {

using Q = std::vector<double>;

// With `GetParam()` more trees far away, without weight: with few trees a scene is solved as a
// whole, with many island by island, and both must answer alike.
class IslandSearchTest : public MujocoTest, public testing::WithParamInterface<int> {
 protected:
  Scene World(const std::string& inside, const std::string& more = "") const {
    std::string idle;
    for (int k = 0; k < GetParam(); ++k) {
      idle += "<body pos='" + std::to_string(k) +
              " 0 99'><joint type='slide'/><geom size='.05' mass='1e-9'/></body>";
    }
    return Scene::FromString("<mujoco><worldbody>" + inside + idle + "</worldbody>" + more +
                             "</mujoco>");
  }

  // Boxes of 10 cm on a floor, `count` of them.
  Scene Boxes(int count) const {
    std::string xml = R"(<geom type="plane" size="0 0 1"/>)";
    for (int k = 0; k < count; ++k) {
      xml += R"(<body><freejoint/><geom type="box" size=".05 .05 .05"/></body>)";
    }
    return World(xml);
  }

  // With the trees far away where they begin.
  static Q Whole(const Scene& scene, Q q) {
    const Q begin = scene.DefaultQpos();
    q.insert(q.end(), begin.begin() + static_cast<std::ptrdiff_t>(q.size()), begin.end());
    return q;
  }
};

INSTANTIATE_TEST_SUITE_P(AsAWholeAndInIslands, IslandSearchTest, testing::Values(0, 9));

Q At(const std::vector<std::array<double, 2>>& places) {
  Q q;
  for (const auto& [x, y] : places) q.insert(q.end(), {x, y, 0.05, 1, 0, 0, 0});
  return q;
}

bool SameBody(const Q& a, const Q& b, int body) {
  return std::equal(a.begin() + 7 * body, a.begin() + 7 * body + 7, b.begin() + 7 * body);
}

// A bead on a rail along x, of radius .1 and 1 kg.
std::string Bead(const std::string& name, double x) {
  return "<body name='" + name + "' pos='" + std::to_string(x) + " 0 0'><joint name='" + name +
         "' type='slide' axis='1 0 0'/><geom name='" + name + "' size='.1' mass='1'/></body>";
}
const std::string kWall = R"(<geom name="wall" type="box" size=".5 1 1" pos="-.5 0 0"/>)";

TEST_P(IslandSearchTest, BystandersNeitherMoveNorMatter) {
  const Scene alone = Boxes(2);
  const Q two = Whole(alone, At({{0, 0}, {.09, 0}}));
  const Result reference = Solver(alone).Solve(two);
  ASSERT_EQ(reference.status, Status::kSolved);
  for (const int count : {3, 12, 40}) {
    const Scene scene = Boxes(count);
    std::vector<std::array<double, 2>> places = {{0, 0}, {.09, 0}};
    for (int k = 2; k < count; ++k) places.push_back({.3 * (k % 7), .3 + .3 * (k / 7)});
    const Q q = Whole(scene, At(places));
    const Result result = Solver(scene).Solve(q);
    ASSERT_EQ(result.status, Status::kSolved) << result.reason;
    EXPECT_GE(Witness(scene).Least(result.q), -1.1e-6);
    EXPECT_NEAR(result.sigma * count, 2 * reference.sigma, 1e-3 * 2 * reference.sigma);
    EXPECT_NEAR(result.sigma_lower_bound * count, 2 * reference.sigma_lower_bound,
                1e-6 * reference.sigma);
    for (int body = 2; body < count; ++body) EXPECT_TRUE(SameBody(q, result.q, body)) << body;
    EXPECT_LE(result.stats.collision_queries, 3 * reference.stats.collision_queries);
  }
}

TEST_P(IslandSearchTest, IslandsAddUp) {
  const Scene scene = Boxes(7);
  const std::vector<std::array<double, 2>> apart = {{0, 0}, {.3, 0},  {1, 0}, {1.3, 0},
                                                    {2, 0}, {2.3, 0}, {3, 0}};
  std::vector<std::array<double, 2>> one = apart, other = apart, both = apart;
  one[1] = both[1] = {.09, 0};
  other[3] = both[3] = {1.08, .02};
  Solver solver(scene);
  const Result of_one = solver.Solve(Whole(scene, At(one))),
               of_other = solver.Solve(Whole(scene, At(other))),
               of_both = solver.Solve(Whole(scene, At(both)));
  ASSERT_EQ(of_both.status, Status::kSolved) << of_both.reason;
  EXPECT_GE(Witness(scene).Least(of_both.q), -1.1e-6);
  // As a whole: as near as descents end, and with as many cells of a bound for both.
  const bool islands = GetParam() > 0;
  const double sigmas = of_one.sigma + of_other.sigma;
  const double bounds = of_one.sigma_lower_bound + of_other.sigma_lower_bound;
  EXPECT_NEAR(of_both.sigma, sigmas, (islands ? 1e-9 : 1e-4) * sigmas);
  EXPECT_NEAR(of_both.sigma_lower_bound, bounds, (islands ? 1e-9 : 0.3) * bounds);
  for (const int body : {4, 5, 6}) EXPECT_TRUE(SameBody(At(both), of_both.q, body));
}

// The first bead is 2 cm in the wall, and 1 cm of room is left before the second one: both move.
TEST_P(IslandSearchTest, WhatStandsInTheWayIsPushed) {
  const Scene scene = World(kWall + Bead("first", .08) + Bead("second", .29) + Bead("last", 2));
  const Result result = Solver(scene).Solve(Whole(scene, Q{0, 0, 0}));
  ASSERT_EQ(result.status, Status::kSolved) << result.reason;
  EXPECT_NEAR(result.q[0], .02, 2e-6);
  EXPECT_NEAR(result.q[1], .01, 4e-6);
  EXPECT_EQ(result.q[2], 0);
  EXPECT_NEAR(result.sigma, (.02 * .02 + .01 * .01) / 3, 1e-7);
}

// As before, with more beads in a row, each 1 mm before the next: the last one stays.
TEST_P(IslandSearchTest, WhatIsPushedPushesTheNext) {
  std::string xml = kWall;
  constexpr int kBeads = 5;
  for (int k = 0; k < kBeads; ++k) xml += Bead("bead" + std::to_string(k), .097 + .201 * k);
  const Scene scene = World(xml);
  const Result result = Solver(scene).Solve(Whole(scene, Q(kBeads, 0.0)));
  ASSERT_EQ(result.status, Status::kSolved) << result.reason;
  EXPECT_NEAR(result.q[0], .003, 2e-6);
  EXPECT_NEAR(result.q[1], .002, 4e-6);
  EXPECT_NEAR(result.q[2], .001, 6e-6);
  EXPECT_NEAR(result.q[4], 0, 1e-9);
}

// A tray carries the cup, but the cup comes out of the wall along it.
TEST_P(IslandSearchTest, WhatIsOnlyTouchedStays) {
  const Scene scene = World(R"(
      <geom type="box" size=".5 1 1" pos="-.5 0 0"/>
      <body name="tray" pos=".5 0 .2"><freejoint/><geom type="box" size=".4 .3 .01"/></body>
      <body name="cup" pos=".14 0 .26"><freejoint/><geom type="box" size=".05 .05 .05"/></body>)");
  Q q = scene.DefaultQpos();
  q[7] = .04;
  const Result result = Solver(scene).Solve(q);
  ASSERT_EQ(result.status, Status::kSolved) << result.reason;
  EXPECT_TRUE(SameBody(q, result.q, 0));
  EXPECT_NEAR(result.q[7], .05, 1e-4);
}

TEST_P(IslandSearchTest, AnswersThatMeetAreUnited) {
  // Two boxes leave their walls towards each other, where there is not room for both.
  const Scene scene = World(R"(
      <geom type="box" size=".5 1 1" pos="-.5 0 0"/><geom type="box" size=".5 1 1" pos=".727 0 0"/>
      <body><joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/>
        <geom type="box" size=".05 .05 .05"/></body>
      <body><joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/>
        <geom type="box" size=".06 .06 .06"/></body>
      <body><freejoint/><geom size=".01"/></body>)");
  const Q q = Whole(scene, {.03, 0, .18, .02, 5, 0, 0, 1, 0, 0, 0});
  ASSERT_GT(Witness(scene).Least(q), -.03);
  const Result result = Solver(scene).Solve(q);
  ASSERT_EQ(result.status, Status::kSolved) << result.reason;
  EXPECT_GE(Witness(scene).Least(result.q), -1.1e-6);
  // There is room for 22.7 cm between the walls; both take 22. Hence they can stay side by side.
  EXPECT_NEAR(result.q[0], .05, 1e-5);
  EXPECT_NEAR(result.q[2], .167, 1e-5);
  EXPECT_NEAR(result.q[1], 0, 1e-5);
  EXPECT_NEAR(result.q[3], .02, 1e-5);
}

TEST_P(IslandSearchTest, ATreeOutsideItsLimitsMovesWithoutTouchingAnything) {
  const Scene scene =
      World(kWall + Bead("bead", .08) + R"(<body pos="5 0 0"><joint range="-30 30" limited="true"
      axis="0 1 0"/><geom type="capsule" size=".05 .2"/></body>)" +
            Bead("idle", 2));
  const Result result = Solver(scene).Solve(Whole(scene, Q{0, 1, 0}));
  ASSERT_EQ(result.status, Status::kSolved) << result.reason;
  EXPECT_NEAR(result.q[0], .02, 2e-6);
  EXPECT_NEAR(result.q[1], mjPI / 6, 1e-9);
  EXPECT_EQ(result.q[2], 0);
}

// The second bead follows the first by half of its way, though nothing touches it.
TEST_P(IslandSearchTest, CoupledTreesMoveTogether) {
  const Scene scene =
      World(kWall + Bead("first", .08) + Bead("second", 2) + Bead("idle", 4),
            "<equality><joint joint1='second' joint2='first' polycoef='0 .5 0 0 0'/></equality>");
  const Result result = Solver(scene).Solve(Whole(scene, Q{0, 0, 0}));
  ASSERT_EQ(result.status, Status::kSolved) << result.reason;
  EXPECT_NEAR(result.q[0], .02, 2e-6);
  EXPECT_NEAR(result.q[1], .01, 2e-6);
  EXPECT_EQ(result.q[2], 0);
  EXPECT_LE(result.equality_residual, 1e-6);
  // A violated coupling is mended where nothing overlaps, and moves nothing else.
  const Result mended = Solver(scene).Solve(Whole(scene, Q{.1, 0, .3}));
  ASSERT_EQ(mended.status, Status::kSolved) << mended.reason;
  EXPECT_NEAR(mended.q[1], .5 * mended.q[0], 1e-6);
  EXPECT_EQ(mended.q[2], .3);
}

TEST_P(IslandSearchTest, AFreeHintIsNeverThrownAway) {
  const Scene scene = Boxes(4);
  const Q q = Whole(scene, At({{0, 0}, {.04, .03}, {1, 0}, {1.05, .02}}));
  const Q free = Whole(scene, At({{0, 0}, {.2, 0}, {1, 0}, {1.2, 0}}));
  Solver solver(scene);
  solver.SetHint(free);
  for (const int queries : {1, 3, 10, 30, 100}) {
    solver.SetBudget({.queries = queries});
    const Result result = solver.Solve(q);
    EXPECT_EQ(result.status, Status::kSolved) << queries << " " << result.reason;
    EXPECT_TRUE(Verify(scene, result.q).free);
  }
}

// A bead in a wall finds a way round the one before it. That one is pushed when it may, and the
// search for both begins there, not at q_in again.
TEST(GrownIslandTest, BeginsWhereTheSmallerOneEnded) {
  const auto bead = [](const char* pos) {
    return "<body pos='" + std::string(pos) +
           "'><joint type='slide' axis='1 0 0'/><joint type='slide' axis='0 1 0'/>"
           "<geom size='.1' mass='1'/></body>";
  };
  std::string idle;
  for (int k = 0; k < 9; ++k) idle += bead((std::to_string(k) + " 0 99").c_str());
  const Scene scene = Scene::FromString("<mujoco><worldbody>" + kWall + bead(".05 0 0") +
                                        bead(".26 .05 0") + idle + "</worldbody></mujoco>");
  const Q q_in = scene.DefaultQpos();
  Solver solver(scene);
  Q last;  // where the descent before ended
  bool pushed = false, of_fewer = false;
  solver.SetObserver([&](const Iteration& it) {
    const Q q(it.q.begin(), it.q.end());
    if (it.step == 0 && !of_fewer && pushed) {
      of_fewer = true;
      EXPECT_STREQ(it.start, "direct");
      EXPECT_EQ(q, last);
    }
    pushed |= q[2] > .02;
    last = q;
  });
  const Result result = solver.Solve(q_in);
  ASSERT_EQ(result.status, Status::kSolved) << result.reason;
  EXPECT_TRUE(of_fewer);
}

// Boxes that something immovable holds in each other are not free, and said so; the others are
// parted all the same.
TEST_P(IslandSearchTest, OneIslandWithoutAnswerLeavesTheOthersTheirs) {
  const Scene scene = World(kWall + R"(<geom type="box" size=".5 1 1" pos=".65 0 0"/>
      <body pos=".075 0 0"><joint type="slide" axis="1 0 0" range="-.1 .1" limited="true"/>
        <geom name="stuck" size=".1"/></body>
      <body><freejoint/><geom type="box" size=".05 .05 .05"/></body>
      <body><freejoint/><geom type="box" size=".05 .05 .05"/></body>
      <body><freejoint/><geom type="box" size=".05 .05 .05"/></body>)");
  Q q = {0};
  for (const double x : {3.0, 3.08, 4.0}) q.insert(q.end(), {x, 0, 0, 1, 0, 0, 0});
  const Result result = Solver(scene).Solve(Whole(scene, q));
  ASSERT_EQ(result.status, Status::kUnsolved);
  EXPECT_NE(result.reason.find("stuck"), std::string::npos) << result.reason;
  EXPECT_GE(std::hypot(result.q[8] - result.q[1], result.q[9] - result.q[2]), .0999);
}

// Thirty bodies in half of the space that they need: to draw all of them anew seldom helps, so that
// hardly more is spent than the first descent of each island, and this one ends free although most
// of its contacts are curved.
TEST(HeapTest, IsSolvedWithFewQueries) {
  Random rng(5);
  constexpr int kHeaps = 6;
  int queries = 0;
  for (int k = 0; k < kHeaps; ++k) {
    const Heap heap(30, rng);
    const Scene scene = Scene::FromString(heap.xml);
    const Result result = Solver(scene).Solve(heap.q);
    EXPECT_EQ(result.status, Status::kSolved);
    EXPECT_TRUE(Verify(scene, result.q).free);
    queries += result.stats.collision_queries;
  }
  EXPECT_LT(queries, 200 * kHeaps);
}

}  // namespace
}  // namespace mjcf_pdg::test
