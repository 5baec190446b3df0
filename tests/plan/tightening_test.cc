// Paths of smaller bodies, retracted when they have grown.
#include "plan/tightening.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "tests/plan/plan_test_support.h"

namespace mjcf_pdg {
namespace {

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
