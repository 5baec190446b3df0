#include "bound/lower_bound.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "tests/bound/bound_check.h"
#include "tests/support/scaled_model.h"

namespace mjcf_pdg::test {
namespace {

class LowerBoundTest : public MujocoTest {};

std::string SliderAndWall(const std::string& geom = "type='box' size='.1 .1 .1'") {
  return "<mujoco><worldbody><geom type='box' size='.1 1 1'/><body pos='.1 0 0'>"
         "<joint type='slide' axis='1 0 0'/><geom " +
         geom + "/></body></worldbody></mujoco>";
}

TEST_F(LowerBoundTest, ASliderInAWallIsBoundExactly) {
  const AtStart at(Scene::FromString(SliderAndWall()), Configuration({0.07}));
  const double way_out = 0.03 - kTolerance;
  EXPECT_NEAR(std::sqrt(at.Bound()), way_out, 1e-7);
  EXPECT_LE(at.Bound(), way_out * way_out);
}

TEST_F(LowerBoundTest, WhatIsFreeIsBoundByZero) {
  const AtStart at(Scene::FromString(SliderAndWall()), Configuration({0.1001}));
  EXPECT_EQ(at.near.size(), 1u);
  EXPECT_EQ(at.Bound(), 0.0);
}

TEST_F(LowerBoundTest, AnOverlapThatTheModelAllowsIsTakenOff) {
  const AtStart at(Scene::FromString(SliderAndWall("type='box' size='.1 .1 .1' margin='-.01'")),
                   Configuration({0.07}));
  EXPECT_NEAR(std::sqrt(at.Bound()), 0.02 - kTolerance, 1e-7);
}

TEST_F(LowerBoundTest, AClearanceIsAdded) {
  Options options;
  options.clearance = 0.01;
  const AtStart at(Scene::FromString(SliderAndWall()), Configuration({0.106}), Metric::kSequential,
                   options);
  EXPECT_NEAR(std::sqrt(at.Bound()), 0.004 - kTolerance, 1e-7);
}

TEST_F(LowerBoundTest, ThreeSlidesCountAsOneVector) {
  const AtStart at(Scene::FromString(R"(<mujoco><worldbody><geom type="sphere" size=".2"/><body>
    <joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/>
    <joint type="slide" axis="0 0 1"/><geom type="sphere" size=".1"/></body></worldbody></mujoco>)"),
                   Configuration({0.17, 0.17, 0.13}));
  const double depth = 0.3 - std::sqrt(2 * 0.17 * 0.17 + 0.13 * 0.13);
  EXPECT_NEAR(std::sqrt(at.Bound(0)), depth - kTolerance, 1e-7);  // by moment arms alone
}

// The nearest points' direction is one that no joint moves along: the ways round it count.
TEST_F(LowerBoundTest, ADirectionThatNothingMovesAlongIsNoWayOut) {
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody><geom size=".1" pos="0 0 .15"/>
      <body><joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/>
      <geom size=".1"/></body></worldbody></mujoco>)");
  AtStart at(scene, VectorXd::Zero(2));
  EXPECT_GT(at.Bound(), 0.05 * 0.05 / 2) << "by moment arms alone";
  EXPECT_LT(at.Bound(), 0.2 * 0.2 - 0.15 * 0.15);
}

TEST_F(LowerBoundTest, TwoFreeSpheresShareTheWay) {
  const AtStart at(Scene::FromString(R"(<mujoco><worldbody>
    <body><freejoint/><geom size=".1"/></body><body><freejoint/><geom size=".1"/></body>
    </worldbody></mujoco>)"),
                   Configuration({0, 0, 0, 1, 0, 0, 0, 0.12, 0.12, 0.1, 1, 0, 0, 0}));
  const double depth = 0.2 - std::sqrt(0.0388) - kTolerance;
  EXPECT_LE(std::sqrt(at.Bound(1000)), 0.5 * depth);  // each goes half of it
  EXPECT_GE(std::sqrt(at.Bound(1000)), 0.9 * 0.5 * depth);
}

TEST_F(LowerBoundTest, AFreeBallInTheFloorIsBoundTightly) {
  const AtStart at(Scene::FromString(R"(<mujoco><worldbody><geom type="plane" size="1 1 1"/>
    <body><freejoint/><geom size=".1"/></body></worldbody></mujoco>)"),
                   Configuration({0, 0, 0.095, 1, 0, 0, 0}));
  EXPECT_LE(std::sqrt(at.Bound()), 0.005 - kTolerance);
  EXPECT_GE(std::sqrt(at.Bound()), 0.9 * 0.005);
}

// A rod on a hinge presses its tip into a wall: the arc is known.
TEST_F(LowerBoundTest, ARodThatTurnsOutOfAFloorIsBoundTightly) {
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody>
    <geom type="box" size="2 1 .5" pos="0 0 -.8"/><body><joint axis="0 1 0"/>
    <geom type="capsule" size=".01" fromto="0 0 0 1 0 0"/></body></worldbody></mujoco>)");
  const double angle = 0.3;  // the tip's sphere is at z = -sin(angle), touching at -0.29
  AtStart at(scene, Configuration({angle}));
  const double out = std::asin(0.29 + kTolerance);
  const double sigma = at.norm.Sigma(Configuration({out}));
  EXPECT_TRUE(at.Free(Configuration({out - 1e-9})));
  EXPECT_LE(at.Bound(), sigma);
  EXPECT_GE(std::sqrt(at.Bound()), 0.85 * std::sqrt(sigma));
}

TEST_F(LowerBoundTest, PairsOfDifferentTreesAddUp) {
  const std::string xml = R"(<mujoco><worldbody><geom type="box" size=".1 1 1"/>
    <body pos=".1 0 0"><joint type="slide" axis="1 0 0"/><geom type="box" size=".1 .1 .1"/></body>
    <body pos=".1 .5 0"><joint type="slide" axis="1 0 0"/><geom type="box" size=".1 .1 .1"/></body>
    </worldbody></mujoco>)";
  AtStart at(Scene::FromString(xml), Configuration({0.07, 0.06}));
  const double sigma = at.norm.Sigma(Configuration({0.1 - kTolerance, 0.1 - kTolerance}));
  EXPECT_LE(at.Bound(), sigma);
  EXPECT_NEAR(at.Bound(), sigma, 1e-6 * sigma);
}

TEST_F(LowerBoundTest, PairsOfOneJointDoNotAddUp) {
  const std::string xml = R"(<mujoco><worldbody><geom type="box" size=".1 1 1"/>
    <body pos=".1 0 0"><joint type="slide" axis="1 0 0"/><geom type="box" size=".1 .1 .1"/>
    <geom type="box" size=".1 .1 .1" pos="0 .5 0"/></body></worldbody></mujoco>)";
  const AtStart at(Scene::FromString(xml), Configuration({0.07}));
  EXPECT_EQ(at.near.size(), 2u);
  EXPECT_NEAR(std::sqrt(at.Bound()), 0.03 - kTolerance, 1e-7);
}

// A slider that grazes a wide wall: directions a little off the wall's normal are hardly deeper,
// but much harder to go. A bound that forgot how γ grows over a cell would claim too much.
TEST_F(LowerBoundTest, ASliderThatGrazesAWallIsBoundWhateverTheOrientation) {
  Random rng(15);
  const double way_out = (0.01 - kTolerance) / std::sin(0.2);
  for (int i = 0; i < 30; ++i) {
    const Eigen::Quaterniond r = rng.UnitQuat();
    const double wxyz[4] = {r.w(), r.x(), r.y(), r.z()};
    const Vector3d axis = r * Vector3d(std::sin(0.2), std::cos(0.2), 0.0);
    const Vector3d pos = r * Vector3d(0.19, 0.0, 0.0);
    const std::string quat = " quat='" + Join(wxyz, 4) + "'";
    const AtStart at(
        Scene::FromString("<mujoco><worldbody><geom type='box' size='.1 3 3'" + quat +
                          "/><body pos='" + Join(pos.data(), 3) + "'><joint type='slide' axis='" +
                          Join(axis.data(), 3) + "'/><geom type='box' size='.1 .1 .1'" + quat +
                          "/></body></worldbody></mujoco>"),
        Configuration({0.0}));
    for (const int cells : {54, 100, 2000}) {
      EXPECT_LE(std::sqrt(at.Bound(cells)), way_out) << cells << " " << Join(wxyz, 4);
    }
    EXPECT_GE(std::sqrt(at.Bound(2000)), 0.8 * way_out) << Join(wxyz, 4);
  }
}

TEST_F(LowerBoundTest, JointsOutsideTheirLimitsMustComeBack) {
  const Scene scene = Scene::FromString(R"(<mujoco><compiler angle="radian"/><worldbody><body>
    <joint type="slide" axis="1 0 0" range="0 .1"/><joint axis="0 1 .2" range="-.5 .5"/>
    <geom size=".1" pos=".3 0 0"/><body>
    <joint type="ball" range="0 .7"/><geom type="ellipsoid" size=".1 .2 .3" pos=".1 .1 0"/>
    </body></body></worldbody></mujoco>)");
  const double inside = 1e-6;
  auto bound = [&](double x, double angle, double ball) {
    const double s = std::sin(ball / 2);
    AtStart at(scene, Configuration({x, angle, std::cos(ball / 2), 0.6 * s, 0, 0.8 * s}));
    VectorXd q = at.q_in;
    ClampToLimits(scene.tables(), q);
    EXPECT_LE(at.Bound(), at.norm.Sigma(q));
    return std::pair(at.Bound(), at.norm.Sigma(q));
  };
  EXPECT_EQ(bound(0.05, 0.4, 0.6).first, 0.0);
  EXPECT_EQ(bound(0.1 + inside, 0.5 + inside, 0.7).first, 0.0);
  const auto slide = bound(0.2, 0.0, 0.0);
  EXPECT_NEAR(slide.first, slide.second, 1e-4 * slide.second);
  const auto hinge = bound(0.0, -0.8, 0.0);
  EXPECT_NEAR(hinge.first, hinge.second, 1e-4 * hinge.second);
  const auto ball = bound(0.0, 0.0, 1.0);
  EXPECT_GT(ball.first, 0.2 * ball.second);
  const auto all = bound(-0.1, 0.7, 0.9);
  EXPECT_GT(all.first, 0.5 * all.second);
}

// X = 2 sin(Δq/2) does not tell a turn from a turn more, so a whole turn costs nothing.
TEST_F(LowerBoundTest, AHingeAWholeTurnOutsideItsLimitsIsBoundByZero) {
  const Scene scene = Scene::FromString(R"(<mujoco><compiler angle="radian"/><worldbody><body>
    <joint range="-.5 .5"/><geom size=".1" pos=".2 0 0"/></body></worldbody></mujoco>)");
  EXPECT_EQ(AtStart(scene, Configuration({2 * mjPI})).Bound(), 0.0);
  AtStart at(scene, Configuration({2 * mjPI + 0.6}));
  EXPECT_NEAR(at.Bound(), at.norm.Sigma(Configuration({0.5})), 1e-6);
}

TEST_F(LowerBoundTest, HoldsOnRandomTwoBodyScenes) {
  Random rng(11);
  static constexpr const char* kJoints[] = {
      "<freejoint/>", "<joint type='ball' pos='.05 .2 -.1'/>", "<joint axis='1 2 3' pos='0 .3 0'/>",
      "<joint type='slide' axis='1 1 0'/><joint axis='1 0 1'/><joint type='slide' axis='0 1 2'/>"};
  Ratios ratios;
  for (int i = 0; i < 160; ++i) {
    TwoGeoms geoms;
    geoms.first = RandomShape(ConvexTypes()[1 + rng.Index(6)], rng);
    geoms.second = RandomShape(ConvexTypes()[rng.Index(7)], rng);
    geoms.joint1 = kJoints[i % 4];
    if (i % 3 == 0 && geoms.second.type != mjGEOM_PLANE) geoms.joint2 = kJoints[(i / 4) % 4];
    ratios.Try(Scene::FromString(TwoGeomXml(geoms)), rng, Metric::kSequential, 0.15);
  }
  EXPECT_GT(ratios.values.size(), 60u);
  EXPECT_GT(ratios.Median(), 0.4);
}

// In a scene this small, lengths that are taken for 0 in one of usual size are as large as geoms.
TEST_F(LowerBoundTest, ASceneOfTenthsOfNanometresHasTheSameBound) {
  constexpr double kScale = 0x1p-30;
  Options small;
  small.tolerance = kScale * kTolerance;
  Random rng(15);
  int compared = 0;
  for (int i = 0; i < 40; ++i) {
    TwoGeoms geoms;
    geoms.first = RandomShape(mjGEOM_BOX, rng);
    geoms.second = RandomShape(mjGEOM_BOX, rng);
    geoms.joint1 = "<joint axis='1 2 3' pos='0 .3 0'/>";
    geoms.joint2 = "<joint type='ball' pos='.05 .2 -.1'/>";
    const Scene scene = Scene::FromString(TwoGeomXml(geoms));
    const ModelPtr model = Scaled(*scene.model(), kScale);
    const VectorXd q = RandomConfiguration(scene, rng, 0.15);
    const double bound = AtStart(scene, q).Bound();
    const AtStart scaled(Scene::FromModel(model.get()), q, Metric::kSequential, small);
    if (!(bound > 0.0)) continue;
    ++compared;
    EXPECT_NEAR(scaled.Bound() / (kScale * kScale), bound, 1e-6 * bound);
  }
  EXPECT_GT(compared, 10);
}

TEST_F(LowerBoundTest, HoldsOnRandomRobots) {
  Random rng(12);
  Ratios ratios;
  for (int i = 0; i < 60; ++i) {
    RobotOptions options;
    options.free_base = i % 2 == 0;
    options.bodies = 2 + rng.Index(5);
    SceneOptions scene;
    scene.armature = i % 3 == 0 ? rng.Uniform(0.0, 1.0) : 0.0;
    ratios.Try(Scene::FromString(RandomRobotXml(rng, options), scene), rng, Metric::kSequential);
  }
  EXPECT_GT(ratios.values.size(), 10u);
  EXPECT_GT(ratios.Median(), 0.1);
}

TEST_F(LowerBoundTest, HoldsForTheDisplacementMetric) {
  Random rng(13);
  Ratios ratios;
  for (int i = 0; i < 40; ++i) {
    ratios.Try(Scene::FromString(TwoTreesXml(), {.armature = i % 2 ? 0.1 : 0.0}), rng,
               Metric::kDisplacement, 0.2);
    ratios.Try(Scene::FromString(OffCentreXml()), rng, Metric::kDisplacement, 0.3);
    ratios.Try(Scene::FromString(RandomRobotXml(rng)), rng, Metric::kDisplacement, 0.3);
  }
  EXPECT_GT(ratios.values.size(), 15u);
  EXPECT_GT(ratios.Median(), 0.1);
}

TEST_F(LowerBoundTest, HoldsForOtherRootLinks) {
  Random rng(14);
  Ratios ratios;
  for (int i = 0; i < 60; ++i) {
    SceneOptions options;
    for (const char* root : {"tip", "pad", "cart"}) {
      options.root = root;
      ratios.Try(Scene::FromString(OffCentreXml(), options), rng, Metric::kSequential, 0.3);
    }
    options.root = i % 2 ? "a2" : "b2";
    ratios.Try(Scene::FromString(TwoTreesXml(), options), rng, Metric::kSequential, 0.2);
    options.root = "b" + std::to_string(rng.Index(8));
    ratios.Try(Scene::FromString(RandomRobotXml(rng), options), rng, Metric::kSequential, 0.3);
  }
  EXPECT_GT(ratios.values.size(), 20u);
  EXPECT_GT(ratios.Median(), 0.1);
}

}  // namespace
}  // namespace mjcf_pdg::test
