// What a planner asks of the scene.
#include "plan/motion_prover.h"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "tests/plan/plan_test_support.h"

namespace mjcf_pdg {
namespace {

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

}  // namespace
}  // namespace mjcf_pdg
