// Searches of one planner in one scene.
#include "plan/tree_search.h"

#include <gtest/gtest.h>

#include <memory>

#include "tests/plan/plan_test_support.h"

namespace mjcf_pdg {
namespace {

TEST(TreeSearchTest, AShareOfAStep) {
  const Scene scene = BarAndGap(0.25);
  const PlanOptions options = With("birrt-pdg");
  const auto space = std::make_shared<ConfigurationSpace>(
      scene, MocapPoses{}, VectorXd{{-1.0, 0.0, 0.0}}, VectorXd{{1.0, 0.0, 0.0}});
  const auto never = [] { return false; };
  const TreeSearch whole({scene, options, space, 1e-4, true, 1.0, never});
  const TreeSearch quarter({scene, options, space, 1e-4, true, 0.25, never});
  EXPECT_NEAR(quarter.step(), 0.25 * whole.step(), 1e-12);
}

}  // namespace
}  // namespace mjcf_pdg
