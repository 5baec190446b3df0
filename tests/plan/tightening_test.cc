// Paths of smaller bodies, retracted when they have grown.
#include "plan/tightening.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "tests/plan/plan_test_support.h"

namespace mjcf_pdg {
namespace {

// A bar of 0.6 × 0.2 m in the plane and a gap of `gap` m in a wall that is as thick as the bar is
// wide.
Scene BarAndGap(double gap) {
  const std::string y = std::to_string(2.0 + 0.5 * gap);
  return Scene::FromString(R"(<mujoco><worldbody>
    <geom type="box" size=".1 2 .5" pos="0 )" +
                           y + R"( 0"/>
    <geom type="box" size=".1 2 .5" pos="0 -)" +
                           y + R"( 0"/>
    <body><joint type="slide" axis="1 0 0" range="-2 2" limited="true"/>
      <joint type="slide" axis="0 1 0" range="-2 2" limited="true"/>
      <joint type="hinge" axis="0 0 1" range="-90 90" limited="true"/>
      <geom type="box" size=".3 .1 .2"/></body></worldbody></mujoco>)");
}

std::vector<VectorXd> Tightened(const Scene& scene, const std::vector<VectorXd>& wide,
                                std::int64_t samples = 1000) {
  const PlanOptions options = With("birrt-pdg");
  const auto space =
      std::make_shared<ConfigurationSpace>(scene, MocapPoses{}, wide.front(), wide.back());
  Tightening tightening({scene, options, space, 1e-4, true, 1.0, [] { return false; }});
  std::vector<VectorXd> path = tightening.Tighten(wide, samples);
  EXPECT_LE(space->samples(), samples);
  EXPECT_GT(tightening.cost().collision_queries, 0);
  return path;
}

// Slanted and beside the middle, as it would pass a gap that is wider.
std::vector<VectorXd> SlantedWay() {
  return {VectorXd{{-1.0, 0.03, 0.0}}, VectorXd{{-0.6, 0.03, 0.25}}, VectorXd{{0.6, 0.03, 0.25}},
          VectorXd{{1.0, 0.03, 0.0}}};
}

TEST(TighteningTest, APathThatOverlapsIsMadeFree) {
  const Scene scene = BarAndGap(0.206);  // 3 % wider than the bar
  const std::vector<VectorXd> wide = SlantedWay();
  MotionChecker checker(scene);
  ASSERT_EQ(checker.Check(test::ToVector(wide[1]), test::ToVector(wide[2])).outcome,
            MotionOutcome::kContact);
  const std::vector<VectorXd> path = Tightened(scene, wide);
  ASSERT_GE(path.size(), 3u);
  EXPECT_EQ(path.front(), wide.front());
  EXPECT_EQ(path.back(), wide.back());
  for (std::size_t k = 1; k < path.size(); ++k) {
    const auto one_way =
        checker.Check(test::ToVector(path[k - 1]), test::ToVector(path[k])).outcome;
    const auto other_way =
        checker.Check(test::ToVector(path[k]), test::ToVector(path[k - 1])).outcome;
    EXPECT_TRUE(one_way == MotionOutcome::kFree || other_way == MotionOutcome::kFree) << k;
  }
}

// The bar touches one wall. Its nearest free configurations, from each by itself, are no path.
TEST(TighteningTest, APathThatIsFollowedAlongContactsTakesNoSamples) {
  EXPECT_FALSE(Tightened(BarAndGap(0.35), SlantedWay(), 0).empty());
}

// Of a path through the gap the corners that it needs are left, of one beside the wall its ends.
TEST(MotionProverTest, StraightenedPathsKeepTheCornersThatTheyNeed) {
  const Scene scene = BarAndGap(0.25);
  const std::vector<VectorXd> through = {VectorXd{{-1.0, 0.8, 0.0}}, VectorXd{{-1.0, 0.4, 0.0}},
                                         VectorXd{{-0.9, 0.0, 0.0}}, VectorXd{{-0.6, 0.0, 0.0}},
                                         VectorXd{{0.1, 0.02, 0.0}}, VectorXd{{0.6, 0.0, 0.0}},
                                         VectorXd{{0.8, 0.1, 0.0}},  VectorXd{{0.9, -0.8, 0.0}}};
  const std::vector<VectorXd> beside(through.begin(), through.begin() + 4);
  const auto space =
      std::make_shared<ConfigurationSpace>(scene, MocapPoses{}, through.front(), through.back());
  MotionProver prover(scene, {}, space);
  const auto straightened = [&](std::vector<VectorXd> corners) {
    Straighten(prover, [] { return false; }, corners);
    return corners;
  };
  EXPECT_EQ(straightened(beside).size(), 2u);
  const std::vector<VectorXd> path = straightened(through);
  ASSERT_GE(path.size(), 4u);
  EXPECT_LT(path.size(), through.size());
  EXPECT_EQ(path.front(), through.front());
  EXPECT_EQ(path.back(), through.back());
  for (std::size_t k = 1; k < path.size(); ++k) EXPECT_TRUE(prover.IsFree(path[k - 1], path[k]));
  for (std::size_t k = 2; k < path.size(); ++k) EXPECT_FALSE(prover.IsFree(path[k - 2], path[k]));
}

TEST(TreeSearchTest, AShareOfAStep) {
  const Scene scene = BarAndGap(0.25);
  const PlanOptions options = With("birrt-pdg");
  const std::vector<VectorXd> way = SlantedWay();
  const auto space =
      std::make_shared<ConfigurationSpace>(scene, MocapPoses{}, way.front(), way.back());
  const auto never = [] { return false; };
  const TreeSearch whole({scene, options, space, 1e-4, true, 1.0, never});
  const TreeSearch quarter({scene, options, space, 1e-4, true, 0.25, never});
  EXPECT_NEAR(quarter.step(), 0.25 * whole.step(), 1e-12);
}

TEST(TighteningTest, APathThatIsFreeIsKept) {
  const std::vector<VectorXd> wide = SlantedWay();
  const std::vector<VectorXd> path = Tightened(BarAndGap(0.6), wide);
  ASSERT_GE(path.size(), 2u);
  EXPECT_EQ(path.front(), wide.front());
  EXPECT_EQ(path.back(), wide.back());
}

// Its mouth is not met on the way in, but on the way out of it.
TEST(TighteningTest, AHoleThatIsNotEnteredIsLeftBackwards) {
  EXPECT_FALSE(Tightened(BarAndGap(0.202), SlantedWay(), 0).empty());
}

TEST(TighteningTest, WithoutSamplesNoWayAroundIsFound) {
  const std::vector<VectorXd> through_the_wall = {
      VectorXd{{-1.0, 0.0, 0.0}}, VectorXd{{-0.6, 0.6, 0.0}}, VectorXd{{0.6, 0.6, 0.0}},
      VectorXd{{1.0, 0.0, 0.0}}};
  EXPECT_TRUE(Tightened(BarAndGap(0.6), through_the_wall, 0).empty());
  EXPECT_FALSE(Tightened(BarAndGap(0.6), through_the_wall).empty());
}

// A disc in a wall whose nearest way out is past its end, where no samples are drawn.
TEST(TighteningTest, APathDoesNotLeaveTheBounds) {
  const auto wall = [](double margin) {
    return Scene::FromString("<mujoco><statistic extent=\"" + std::to_string(2.0 * margin) +
                             R"("/><worldbody><geom type="box" size="1 .3 .5"/><body>
        <joint type="slide" axis="1 0 0" range="-2 2" limited="true"/>
        <joint type="slide" axis="0 1 0"/><geom type="cylinder" size=".1 .1"/></body>
        </worldbody></mujoco>)");
  };
  const std::vector<VectorXd> through = {VectorXd{{-1.2, 0.05}}, VectorXd{{1.2, 0.05}}};
  EXPECT_FALSE(Tightened(wall(0.6), through).empty());
  EXPECT_TRUE(Tightened(wall(0.2), through).empty());
}

TEST(TighteningTest, ThroughAGapThatIsNarrowerNoneIsFound) {
  EXPECT_TRUE(Tightened(BarAndGap(0.198), SlantedWay()).empty());
}

}  // namespace
}  // namespace mjcf_pdg
