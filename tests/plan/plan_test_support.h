// What tests of planning share.
#ifndef MJCF_PDG_TESTS_PLAN_PLAN_TEST_SUPPORT_H_
#define MJCF_PDG_TESTS_PLAN_PLAN_TEST_SUPPORT_H_

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "model/kinematics.h"
#include "plan/plan.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg {

inline PlanOptions With(const std::string& planner, std::uint64_t seed = 1) {
  PlanOptions options;
  options.planner = planner;
  options.options.seed = seed;
  options.max_samples = 20000;
  return options;
}

// Whether the path leads from `start` to `goal` through configurations that the verifier, which
// shares no code with the proofs, calls free: a thousand an edge, twenty where it bends.
inline void ExpectFree(const Scene& scene, const Path& path, const std::vector<double>& start,
                       const std::vector<double>& goal) {
  ASSERT_TRUE(path.found) << path.reason;
  EXPECT_TRUE(path.certified);
  EXPECT_EQ(path.q.front(), start);
  EXPECT_EQ(path.q.back(), goal);
  Solver verifier(scene);
  const SceneTables& tables = scene.tables();
  VectorXd dq(tables.n);
  std::vector<double> q(path.q.front().size());
  double length = 0.0;
  for (std::size_t k = 1; k < path.q.size(); ++k) {
    const VectorXd from = ToEigen(path.q[k - 1]), to = ToEigen(path.q[k]);
    length += std::sqrt(ObjectNorm(scene, Metric::kSequential, path.q[k - 1]).Sigma(path.q[k]));
    const int kSteps = path.q.size() > 50 ? 20 : 1000;
    for (int step = 0; step <= kSteps; ++step) {
      Difference(tables, from, to, dq);
      dq *= static_cast<double>(step) / kSteps;
      VectorXd at = from;
      Integrate(tables, at, dq, at);
      q.assign(at.data(), at.data() + at.size());
      ASSERT_TRUE(verifier.IsFree(q)) << "edge " << k << ", step " << step;
    }
  }
  EXPECT_NEAR(path.length, length, 1e-9);
}

// A disc of radius 0.2 m on two slides, and a gap in a wall that is wider than the disc by `slack`
// (a share of its diameter).
inline std::string DiscAndGap(double slack) {
  const double y = 2.0 + 0.2 * (1.0 + slack);
  return R"(<mujoco><worldbody>
    <geom name="lower" type="box" size=".1 2 .5" pos="0 )" +
         std::to_string(-y) + R"( 0"/>
    <geom name="upper" type="box" size=".1 2 .5" pos="0 )" +
         std::to_string(y) + R"( 0"/>
    <body name="disc">
      <joint type="slide" axis="1 0 0" range="-2 2" limited="true"/>
      <joint type="slide" axis="0 1 0" range="-2 2" limited="true"/>
      <geom type="cylinder" size=".2 .1"/>
    </body></worldbody></mujoco>)";
}

// A bar of 0.6 × 0.2 m in the plane and a gap of `gap` m in a wall that is as thick as the bar is
// wide.
inline Scene BarAndGap(double gap) {
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

class EveryPlanner : public testing::TestWithParam<const char*> {};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_TESTS_PLAN_PLAN_TEST_SUPPORT_H_
