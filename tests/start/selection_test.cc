#include "start/selection.h"

#include <algorithm>
#include <cmath>

#include "tests/start/selector.h"

namespace mjcf_pdg::test {
namespace {

using Eigen::Vector2d;

class SelectionTest : public MujocoTest {};

// A free box inside another: spheres of radius .3 (half diagonal of .2 .2 .1) and √3 · .4.
std::string BoxInBox(const std::string& pos) {
  return World(R"(<geom type="box" size=".4 .4 .4"/>
      <body pos=")" +
               pos + R"("><freejoint/><geom type="box" size=".2 .2 .1"/></body>)");
}

TEST_F(SelectionTest, AFreeBodyIsCarriedAwayFromTheCentreByBothRadii) {
  Selector p(BoxInBox("0.03 0 .04"));
  const double radii = 0.3 + 0.4 * std::sqrt(3.0);
  const std::vector<VectorXd> starts = p.Translations();
  ASSERT_EQ(starts.size(), 7u);  // away from the centre, then ± three axes
  const Vector3d o_A(0.03, 0, 0.04);
  EXPECT_LT((starts[0].head<3>() - (o_A + radii * Vector3d(0.6, 0, 0.8))).norm(), 1e-12);
  for (int k = 0; k < 6; ++k) {
    const Vector3d axis = (k % 2 ? -1.0 : 1.0) * Vector3d::Unit(k / 2);
    EXPECT_LT((starts[1 + k].head<3>() - (o_A + radii * axis)).norm(), 1e-12) << k;
  }
  for (const VectorXd& q : starts) EXPECT_EQ(q.tail<4>(), p.work.problem().q_in.tail<4>());
}

TEST_F(SelectionTest, TheBodyThatCanBeCarriedAwayIsFoundInAnyOrderAndOnAStand) {
  const std::string arm = "<body><joint axis='0 1 0'/><geom type='box' size='.5 .1 .1'/></body>";
  const std::string object = "<body pos='.3 0 .1'><freejoint/><geom size='.1'/></body>";
  EXPECT_EQ(Selector(World(arm + object)).Translations().size(), 7u);
  EXPECT_EQ(Selector(World(object + arm)).Translations().size(), 7u);
  const std::string cart =
      "<body pos='0 0 .1'><joint type='slide' axis='1 0 0'/><joint type='slide'"
      " axis='0 1 0'/><geom size='.1'/></body>";
  const std::string wall = "<geom type='box' size='.1 .1 .1' pos='.15 0 .1'/>";
  EXPECT_EQ(Selector(World(wall + cart)).Translations().size(), 5u);
  EXPECT_EQ(Selector(World(wall + "<body>" + cart + "</body>")).Translations().size(), 5u);
}

TEST_F(SelectionTest, WhatOverlappedIsLeftBehindEntirely) {
  Random rng(1);
  int first_clear = 0;
  for (int k = 0; k < 40; ++k) {
    const Vector3d pos = rng.InBox(0.3);
    Selector p(BoxInBox(Join(pos)));
    const std::vector<VectorXd> starts = p.Translations();
    ASSERT_EQ(starts.size(), 7u);
    first_clear += p.Nearest(starts[0]) > 0.0;
  }
  EXPECT_EQ(first_clear, 40);
}

// A cart that cannot rise, inside a car: hinged mast on x and y slides.
const std::string kCartInCar = World(R"(<body name="car" pos="1 0 0">
      <geom name="car" type="box" size=".8 .4 .3"/></body>
    <body name="cart" pos=".6 .3 .4"><joint name="x" type="slide" axis="1 0 0"/>
      <joint name="y" type="slide" axis="0 1 0"/><joint name="turn" axis="0 0 1"/>
      <geom name="cart" type="box" size=".1 .1 .15"/>
      <body pos="0 0 .2"><joint name="mast" axis="0 1 0"/><geom size=".05"/></body></body>)");

TEST_F(SelectionTest, APlanarCartLeavesTheCarAlongTheProjectedDirection) {
  Selector p(kCartInCar);
  const std::vector<VectorXd> starts = p.Translations();
  ASSERT_EQ(starts.size(), 5u);
  // A: about the mean of the cart's two geoms (z = .5), B: the car; lifting is not possible.
  const double rA = 0.1 + std::sqrt(0.01 + 0.01 + 0.0225), rB = std::sqrt(0.64 + 0.16 + 0.09);
  const Vector2d away = Vector2d(-0.4, 0.3) / 0.5;
  EXPECT_LT((starts[0].head<2>() - (rA + rB) * away).norm(), 1e-12) << Join(starts[0]);
  for (const VectorXd& q : starts) {
    EXPECT_NEAR(q.head<2>().norm(), rA + rB, 1e-12);
    EXPECT_EQ(q[2], 0.0);
    EXPECT_EQ(q[3], 0.0);
  }
  EXPECT_GT(p.Nearest(starts[0]), 0.0);
}

TEST_F(SelectionTest, ADirectionTheBaseDoesNotHaveLeavesTheFreeDirectionsAlone) {
  // The cart is right above the car's centre: the projection of "up" is zero.
  Selector p(kCartInCar, Eigen::Vector4d(0.4, -0.3, 0, 0));
  const std::vector<VectorXd> starts = p.Translations();
  ASSERT_EQ(starts.size(), 4u);
  const double reach = (starts[0] - p.work.problem().q_in).norm();
  EXPECT_GT(reach, 1.0);
  for (int k = 0; k < 4; ++k) {
    const VectorXd moved = starts[k] - p.work.problem().q_in;
    EXPECT_NEAR(moved[k / 2], k % 2 ? -reach : reach, 1e-12);
    EXPECT_NEAR(moved[1 - k / 2], 0.0, 1e-12);
  }
}

TEST_F(SelectionTest, AFixedBaseHasNoTranslation) {
  Selector p(World(R"(<geom type="box" size=".1 .1 .1" pos=".4 0 0"/><body><joint axis="0 1 0"/>
      <geom type="capsule" size=".02" fromto="0 0 0 .5 0 0"/></body>)"));
  EXPECT_TRUE(p.Translations().empty());
}

TEST_F(SelectionTest, SelfOverlapAloneHasNoTranslation) {
  Selector p(World(R"(<geom size=".1" pos="0 0 5"/><body><freejoint/><geom size=".1"/>
      <body pos=".15 0 0"><joint axis="0 1 0"/><geom size=".02"/>
      <body pos="-.12 0 0"><joint axis="0 1 0"/><geom size=".1"/></body></body></body>)"));
  EXPECT_TRUE(p.Translations().empty());
}

TEST_F(SelectionTest, TheTreeThatOverlapsMostMovesAndTheOthersStay) {
  Selector p(World(R"(<geom type="box" size=".2 .2 .2"/>
      <body pos=".25 0 0"><freejoint/><geom size=".1"/></body>
      <body pos="0 .2 0"><freejoint/><geom size=".1"/></body>)"));
  const std::vector<VectorXd> starts = p.Translations();
  ASSERT_EQ(starts.size(), 7u);
  for (const VectorXd& q : starts) EXPECT_EQ(q.head<7>(), p.work.problem().q_in.head<7>());
  EXPECT_GT(starts[0][8], 0.5);
  EXPECT_NEAR(starts[0][7], 0.0, 1e-12);
}

TEST_F(SelectionTest, TranslationsStayInsideTheLimits) {
  Selector p(World(R"(<geom type="box" size=".4 .4 .4"/><body pos=".1 .2 0">
      <joint type="slide" axis="1 0 0" range="-.3 .5"/><joint type="slide" axis="0 1 0"/>
      <geom size=".1"/></body>)"));
  const std::vector<VectorXd> starts = p.Translations();
  ASSERT_EQ(starts.size(), 5u);
  for (const VectorXd& q : starts) EXPECT_EQ(LimitExcess(p.scene.tables(), q), 0.0) << Join(q);
  EXPECT_EQ(starts[1][0], 0.5);
  EXPECT_EQ(starts[2][0], -0.3);
}

// ---- Mirror ----

TEST_F(SelectionTest, TheMirroredStartIsAsFarOnTheOtherSide) {
  Random rng(2);
  for (const std::string& xml : {BallChainXml(false), TwoTreesXml(), OffCentreXml()}) {
    Selector p(xml);
    p.work.Begin(RandomConfiguration(p.scene, rng));
    for (int k = 0; k < 10; ++k) {
      VectorXd there, back, q;
      const VectorXd dq = 0.5 * rng.Normals(p.scene.dof()).cwiseMin(2.0).cwiseMax(-2.0);
      Integrate(p.scene.tables(), p.work.problem().q_in, dq, q);
      Difference(p.scene.tables(), p.work.problem().q_in, q, there);
      const VectorXd mirrored = p.Mirrored(q);
      Difference(p.scene.tables(), p.work.problem().q_in, mirrored, back);
      EXPECT_LT((there + back).norm(), 1e-9);
      EXPECT_GT(there.norm(), 0.1);
    }
  }
}

TEST_F(SelectionTest, MirroredAndNoisyStartsStayInsideTheLimits) {
  Random rng(3);
  mjcf_pdg::Random noise(4);
  int at_limit = 0;
  for (const std::string& xml : {BallChainXml(true), ArmXml(), RandomRobotXml(rng)}) {
    Selector p(xml);
    const SceneTables& tables = p.scene.tables();
    for (int k = 0; k < 60; ++k) {
      p.work.Begin(RandomConfiguration(p.scene, rng));
      p.work.norm.SetReference(p.work.problem().q_in);
      const VectorXd q = RandomConfiguration(p.scene, rng);
      EXPECT_LE(LimitExcess(tables, p.Mirrored(q)), 1e-12);
      const VectorXd start = p.Gaussian(q, 0.1, 12.0, noise);
      EXPECT_LE(LimitExcess(tables, start), 1e-12);
      for (const JointEntry& joint : tables.joints) {
        if (!joint.limited || joint.type == mjJNT_BALL) continue;
        at_limit += start[joint.qadr] == joint.lo || start[joint.qadr] == joint.hi;
      }
      EXPECT_TRUE(start.allFinite());
    }
  }
  EXPECT_GT(at_limit, 20);
}

// ---- Noise ----

TEST_F(SelectionTest, NoiseIsAsLargeAsAskedInObjectNormUnits) {
  // Slides at right angles: the norm is linear and the parts add up.
  Selector p(World(R"(<body><joint type="slide" axis="1 0 0"/><geom size=".1"/>
      <body><joint type="slide" axis="0 1 0"/><geom size=".05"/>
      <body><joint type="slide" axis="0 0 1"/><geom size=".02"/></body></body></body>)"));
  mjcf_pdg::Random noise(5);
  for (const double spread : {1.0, 3.0}) {
    double sum = 0.0;
    int moved = 0;
    for (int k = 0; k < 2000; ++k) {
      const VectorXd q = p.Gaussian(p.work.problem().q_in, 0.04, spread, noise);
      sum += p.work.norm.Sigma(q);
      for (int i = 0; i < 3; ++i) moved += q[i] != p.work.problem().q_in[i];
    }
    EXPECT_NEAR(sum / moved / (0.04 * spread * spread / 3), 1.0, 0.1);
    EXPECT_NEAR(moved / 6000.0, 0.75, 0.03);  // half of the dofs stay in half of the draws
  }
}

TEST_F(SelectionTest, NoiseNeverTurnsAJointMoreThanHalfARound) {
  Selector p(OffCentreXml());
  mjcf_pdg::Random noise(6);
  double most = 0.0;
  for (int k = 0; k < 100; ++k) {
    const VectorXd q = p.Gaussian(p.work.problem().q_in, 100.0, 50.0, noise);
    for (const JointEntry& joint : p.scene.tables().joints) {
      if (joint.type != mjJNT_HINGE) continue;
      most = std::max(most, std::abs(q[joint.qadr] - p.work.problem().q_in[joint.qadr]));
    }
  }
  EXPECT_LE(most, M_PI + 1e-12);
  EXPECT_GT(most, 3.0);
}

TEST_F(SelectionTest, TheSameSeedGivesTheSameNoise) {
  Selector p(OffCentreXml());
  auto draw = [&p](std::uint64_t seed) {
    mjcf_pdg::Random noise(seed);
    return p.Gaussian(p.work.problem().q_in, 0.1, 2.0, noise);
  };
  EXPECT_EQ(draw(7), draw(7));
  EXPECT_NE(draw(7), draw(8));
}

// ---- Rays ----

// Of x, -x and z the last way out is shorter; y does not lead out.
TEST_F(SelectionTest, TheFirstFreeConfigurationsOfSeveralRaysAreTheNearestOnThem) {
  auto box = [](const char* half_size) {
    return World(std::string("<geom type='box' size='") + half_size + R"('/>
      <body><freejoint/><geom type="box" size=".1 .1 .1"/></body>)");
  };
  auto on_rays = [](Selector& p, double largest_sigma, std::vector<Vector3d> ends) {
    std::vector<VectorXd> far;
    for (const Vector3d& end : ends) {
      far.push_back(p.work.problem().q_in);
      far.back().head<3>() = end;
    }
    const auto found = p.starts.FirstFree(p.work.problem().q_in, far, largest_sigma);
    return std::vector<FreeOnRay>(found.begin(), found.end());
  };
  const std::vector<Vector3d> ends = {{2, 0, 0}, {-2, 0, 0}, {0, 0, 2}, {0, 2, 0}};
  Selector p(box(".3 9 .2"));
  const std::vector<FreeOnRay> all = on_rays(p, 100.0, ends);
  ASSERT_EQ(all.size(), 3u);
  EXPECT_NEAR(all[0].q[2], 0.3, 0.3 * 0.05);
  for (int k : {1, 2}) EXPECT_NEAR(std::abs(all[k].q[0]), 0.4, 0.4 * 0.05);
  for (const FreeOnRay& free : all) {
    EXPECT_TRUE(p.work.Free(free.q));
    EXPECT_EQ(free.sigma, p.work.norm.Sigma(free.q));
    EXPECT_LT(free.q.head<3>().norm(), 0.45);
  }
  EXPECT_EQ(on_rays(p, 0.38 * 0.38, ends).size(), 1u) << "the others are beyond the largest σ";
  EXPECT_TRUE(on_rays(p, 0.25 * 0.25, ends).empty());
  EXPECT_TRUE(on_rays(p, 100.0, {ends[3]}).empty());
  Selector wide(box(".4 9 .2"));
  EXPECT_EQ(on_rays(wide, 100.0, ends).size(), 1u) << "σ (5/3)² times as large is no match";
}

}  // namespace
}  // namespace mjcf_pdg::test
