// The space of configurations: its distance is the object norm up to half a turn, and falls along
// motions.
#include "plan/configuration_space.h"

#include <gtest/gtest.h>
#include <ompl/util/RandomNumbers.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "mjcf_pdg/object_norm.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg {
namespace {

Scene OneJointOfEachKind() {
  return Scene::FromString(R"(<mujoco><worldbody>
    <body><freejoint/><geom size=".1"/><geom size=".05" pos=".4 .1 0"/>
      <body pos=".3 0 0"><joint type="ball"/><geom type="capsule" size=".03" fromto="0 0 0 .2 0 .1"/>
        <body pos=".2 0 .1"><joint axis="0 1 0"/><geom type="box" size=".1 .05 .02" pos=".1 0 0"/>
          <body pos=".2 0 0"><joint type="slide" axis="1 0 1"/><geom size=".04"/>
      </body></body></body></body></worldbody></mujoco>)");
}

TEST(ConfigurationSpaceTest, TheDistanceIsTheObjectNormUpToHalfATurn) {
  const Scene scene = OneJointOfEachKind();
  const int hinge = scene.model()->jnt_qposadr[2];
  const VectorXd q0 = ToEigen(scene.DefaultQpos());
  const ConfigurationSpace space(scene, {}, q0, q0);
  ompl::RNG rng(5);
  VectorXd from, to;
  int within = 0;
  for (int trial = 0; trial < 200; ++trial) {
    space.Sample(rng, from);
    space.Sample(rng, to);
    if (std::abs(to[hinge] - from[hinge]) > std::numbers::pi) continue;
    ++within;
    ObjectNorm norm(scene, Metric::kSequential, {from.begin(), from.end()});
    const double rms = std::sqrt(norm.Sigma({to.begin(), to.end()}));
    EXPECT_NEAR(space.Distance(from, to), rms, 1e-12 * rms);
  }
  EXPECT_GT(within, 100);
}

// What a tree relies on that grows towards a sample: each part of the way brings it nearer. √σ
// alone does not promise that: a hinge that is a whole turn off is at no distance.
TEST(ConfigurationSpaceTest, TheDistanceFallsAllAlongAMotion) {
  const Scene scene = OneJointOfEachKind();
  const VectorXd q0 = ToEigen(scene.DefaultQpos());
  const ConfigurationSpace space(scene, {}, q0, q0);
  ompl::RNG rng(5);
  VectorXd from, to, part;
  for (int trial = 0; trial < 100; ++trial) {
    space.Sample(rng, from);
    space.Sample(rng, to);
    double left = space.Distance(to, from);
    for (int k = 1; k <= 20; ++k) {
      space.Interpolate(from, to, k / 20.0, part);
      const double now = space.Distance(to, part);
      EXPECT_LT(now, left);
      left = now;
    }
    EXPECT_NEAR(left, 0.0, 1e-12);
  }
}

TEST(ConfigurationSpaceTest, AWholeTurnIsTwiceAsFarAsHalfATurn) {
  const Scene scene = OneJointOfEachKind();
  const int hinge = scene.model()->jnt_qposadr[2];
  const VectorXd q0 = ToEigen(scene.DefaultQpos());
  const ConfigurationSpace space(scene, {}, q0, q0);
  const auto turned = [&](double angle) {
    VectorXd q = q0;
    q[hinge] += angle;
    return space.Distance(q0, q);
  };
  const double half = turned(std::numbers::pi);
  EXPECT_GT(half, 0.0);
  EXPECT_NEAR(turned(2.0 * std::numbers::pi), 2.0 * half, 1e-12);
  EXPECT_NEAR(turned(-3.0 * std::numbers::pi), 3.0 * half, 1e-12);
  EXPECT_NEAR(turned(std::numbers::pi + 1e-9), half, 1e-8 * half);
}

// A free body beside a slide that has limits and one that has none. The model's extent is 8 m.
TEST(ConfigurationSpaceTest, ACopyMayDrawFromASmallerBox) {
  const Scene scene = Scene::FromString(R"(<mujoco><statistic extent="8"/><worldbody>
      <body pos="0 0 9"><freejoint/><geom type="box" size=".1 .1 .1"/></body>
      <body><joint type="slide" range="-9 9" limited="true"/><geom type="box" size=".1 .1 .1"/></body>
      <body><joint type="slide"/><geom type="box" size=".1 .1 .1"/></body>
      </worldbody></mujoco>)");
  const VectorXd start{{0.0, 0.0, 9.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0}};
  VectorXd goal = start;
  goal[0] = 1.0;
  const ConfigurationSpace whole(scene, {}, start, goal);
  const ConfigurationSpace quarter(whole, 1, 0.25);
  EXPECT_EQ(quarter.samples(), 0);
  EXPECT_LT(quarter.extent(), whole.extent());
  const auto reach = [](const ConfigurationSpace& space) {
    ompl::RNG rng(1);
    VectorXd q, low = VectorXd::Constant(9, 1e9), high = -low;
    for (int k = 0; k < 2000; ++k) {
      space.Sample(rng, q);
      low = low.cwiseMin(q);
      high = high.cwiseMax(q);
    }
    return std::pair{low, high};
  };
  const auto expect_reaches = [&](const ConfigurationSpace& space, double margin) {
    const auto [low, high] = reach(space);
    const auto expect_between = [&](int k, double least, double most) {
      EXPECT_GE(low[k], least) << k;
      EXPECT_LE(high[k], most) << k;
      EXPECT_NEAR(low[k], least, 0.05) << k;
      EXPECT_NEAR(high[k], most, 0.05) << k;
    };
    expect_between(0, -margin, 1.0 + margin);
    expect_between(1, -margin, margin);
    expect_between(2, 9.0 - margin, 9.0 + margin);
    expect_between(7, -9.0, 9.0);
    expect_between(8, -margin, margin);
  };
  expect_reaches(whole, 4.0);
  expect_reaches(quarter, 1.0);
  VectorXd far = start;
  far[8] = 3.0;
  EXPECT_TRUE(quarter.Covers(far));  // the space is as large as ever
}

}  // namespace
}  // namespace mjcf_pdg
