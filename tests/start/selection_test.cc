#include "start/selection.h"

#include <algorithm>
#include <cmath>

#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

using Eigen::Vector2d;

class SelectionTest : public MujocoTest {};

struct Selector {
  Selector(const std::string& xml, const VectorXd& q_in = {})
      : scene(Scene::FromString(xml)), work(scene.tables(), options) {
    work.Begin(q_in.size() > 0 ? q_in : ToEigen(scene.DefaultQpos()));
  }

  std::vector<VectorXd> Translations() {
    work.finder.Pose(work.problem().q_in);
    std::vector<NearPair> overlaps;
    for (const NearPair& near : work.finder.Find(0.0)) {
      if (near.distance < 0.0) overlaps.push_back(near);
    }
    EXPECT_FALSE(overlaps.empty());
    const auto found = starts.ConstrainedTranslation(overlaps, work.problem().q_in);
    return {found.begin(), found.end()};
  }
  VectorXd Mirrored(const VectorXd& q) {
    VectorXd start;
    starts.Mirrored(q, start);
    return start;
  }
  VectorXd Gaussian(const VectorXd& center, double sigma, double spread, mjcf_pdg::Random& noise) {
    VectorXd start;
    starts.Gaussian(center, sigma, spread, noise, start);
    return start;
  }
  VectorXd ContactHop(const VectorXd& best, double sigma, Hop hop, mjcf_pdg::Random& noise) {
    VectorXd start;
    starts.ContactHop(best, sigma, hop, noise, start);
    return start;
  }
  double Nearest(const VectorXd& q) {  // at most 10 m
    work.finder.Pose(q);
    double least = 10.0;
    for (const NearPair& near : work.finder.Find(10.0)) least = std::min(least, near.distance);
    return least;
  }

  Scene scene;
  Options options;
  Workspace work;
  StartSelection starts{work};
};

std::string World(const std::string& inside) {
  return "<mujoco><worldbody>" + inside + "</worldbody></mujoco>";
}

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

// ---- Hops ----

constexpr Hop kAllHops[] = {Hop::kFromBest, Hop::kFromInput, Hop::kMirrored};

// In `best`, two fingers touch each other and a ball the floor. The bob touches nothing.
const std::string kThreeThings = World(R"(<geom type="plane" size="0 0 1"/>
    <body pos="0 0 1"><freejoint/><geom size=".02"/>
      <body pos="-.1 0 0"><joint axis="0 1 0"/><geom size=".1" pos="0 0 .3"/></body>
      <body pos=".1 0 0"><joint axis="0 1 0" range="-30 5"/><geom size=".1" pos="0 0 .3"/></body>
    </body>
    <body pos="3 0 .1"><joint type="slide" axis="1 0 0" range="-.5 .5"/>
      <joint type="slide" axis="0 0 1"/><geom size=".1"/></body>
    <body pos="6 0 3"><joint type="ball"/><geom size=".1" pos=".3 0 0"/></body>)");
constexpr int kFinger = 6, kBall = 8, kBob = 10, kDofs = 13;  // first dofs

struct Hopper : Selector {
  Hopper() : Selector(kThreeThings), best(work.problem().q_in) {
    VectorXd q_in, dq = VectorXd::Zero(kDofs);
    dq << 0.1, 0.2, -0.1, 0.1, -0.2, 0.3, 0.4, -0.1, 0.25, -0.05, 0.1, 0.2, 0.3;
    Integrate(scene.tables(), best, dq, q_in);
    work.Begin(q_in);
    Difference(scene.tables(), work.problem().q_in, best, to_best);
  }
  // The hop as a tangent at q_in.
  VectorXd Hopped(Hop hop, double sigma, mjcf_pdg::Random& noise) {
    VectorXd dq;
    const VectorXd q = ContactHop(best, sigma, hop, noise);
    EXPECT_LE(LimitExcess(scene.tables(), q), 1e-12);
    Difference(scene.tables(), work.problem().q_in, q, dq);
    return dq;
  }

  VectorXd best;
  VectorXd to_best;  // best ⊖ q_in
};

// A wrist may have turned by more than half a turn; what hops, turns back by twice as much as it
// has.
TEST_F(SelectionTest, AHopLeavesFarTurnsOfOtherJointsAlone) {
  Selector p(World(R"(<geom type="box" size=".1 .1 .1"/>
      <body pos=".15 0 0"><joint type="slide" axis="1 0 0"/><joint axis="1 0 0"/>
        <geom size=".06"/></body>
      <body pos="2 0 0"><joint axis="0 0 1"/><geom size=".1"/></body>)"));
  VectorXd q_in = p.work.problem().q_in;
  q_in[2] = -3.0;
  p.work.Begin(q_in);
  VectorXd best = p.work.problem().q_in;
  best[0] = 0.01;
  best[1] = 2.0;
  best[2] = 2.5;
  mjcf_pdg::Random noise(3);
  int mirrored = 0;
  for (const Hop hop : kAllHops) {
    for (int k = 0; k < 20; ++k) {
      const VectorXd q = p.ContactHop(best, 0.01, hop, noise);
      EXPECT_NEAR(q[2], 2.5, 1e-12);
      if (hop != Hop::kMirrored) continue;
      EXPECT_NEAR(std::abs(q[1]), 2.0, 1e-12);
      mirrored += q[1] < 0.0;
    }
  }
  EXPECT_GT(mirrored, 5);
}

TEST_F(SelectionTest, AHopMovesNothingButTheJointsBetweenTheBodiesOfOneContact) {
  Hopper p;
  VectorXd q_unchanged;
  Integrate(p.scene.tables(), p.work.problem().q_in, p.to_best, q_unchanged);
  EXPECT_LT((q_unchanged - p.best).norm(), 1e-12);
  mjcf_pdg::Random noise(8);
  for (const Hop hop : kAllHops) {
    int fingers = 0, ball = 0;
    for (int k = 0; k < 200; ++k) {
      const VectorXd q = p.ContactHop(p.best, 0.1, hop, noise);
      EXPECT_EQ(q.head<7>(), q_unchanged.head<7>()) << "the palm carries both fingers";
      EXPECT_EQ(q.tail<4>(), q_unchanged.tail<4>()) << "the bob touches nothing";
      const bool finger_moved = q.segment<2>(7) != q_unchanged.segment<2>(7);
      const bool ball_moved = q.segment<2>(9) != q_unchanged.segment<2>(9);
      EXPECT_FALSE(finger_moved && ball_moved) << "one contact at a time";
      fingers += finger_moved;
      ball += ball_moved;
    }
    EXPECT_GT(fingers, 50);
    EXPECT_GT(ball, 50);
  }
}

TEST_F(SelectionTest, HopsStartFromTheBestFromTheInputOrFromItsOtherSide) {
  Hopper p;
  mjcf_pdg::Random noise(9);
  for (const Hop hop : kAllHops) {
    int moved = 0;
    for (int k = 0; k < 100; ++k) {
      const VectorXd dq = p.Hopped(hop, 1e-7, noise);
      for (int i = kFinger; i < kBob; ++i) {
        if (dq[i] == p.to_best[i]) continue;
        ++moved;
        const double from = hop == Hop::kFromBest    ? p.to_best[i]
                            : hop == Hop::kFromInput ? 0.0
                                                     : -p.to_best[i];
        // The right finger's limit is nearer than its mirrored place.
        const double limit = 5.0 * M_PI / 180.0 - p.work.problem().q_in[kFinger + 2];
        const double expected = i == kFinger + 1 ? std::min(from, limit) : from;
        EXPECT_NEAR(dq[i], expected, hop == Hop::kMirrored ? 1e-12 : 0.02) << i;
      }
    }
    EXPECT_GT(moved, 80);
  }
}

TEST_F(SelectionTest, HopsStayInsideTheLimits) {
  Hopper p;
  mjcf_pdg::Random noise(10);
  int at_limit = 0;
  for (const Hop hop : kAllHops) {
    for (int k = 0; k < 100; ++k) {
      const VectorXd q = p.ContactHop(p.best, 10.0, hop, noise);
      EXPECT_LE(LimitExcess(p.scene.tables(), q), 1e-12);
      at_limit += std::abs(q[9]) == 0.5 || q[8] == p.scene.tables().joints[2].hi;
    }
  }
  EXPECT_GT(at_limit, 30);
}

TEST_F(SelectionTest, WhereNothingTouchesAHopMayMoveEveryJoint) {
  Hopper p;
  p.best[7] = -0.3;  // the fingers part, the ball rises
  p.best[10] = 0.2;
  Difference(p.scene.tables(), p.work.problem().q_in, p.best, p.to_best);
  mjcf_pdg::Random noise(11);
  std::vector<int> moved(kDofs, 0);
  for (int k = 0; k < 100; ++k) {
    const VectorXd dq = p.Hopped(Hop::kFromBest, 0.01, noise);
    for (int i = 0; i < kDofs; ++i) moved[i] += std::abs(dq[i] - p.to_best[i]) > 1e-9;
  }
  for (int i = 0; i < kDofs; ++i) EXPECT_NEAR(moved[i], 75, 20) << i;  // half stay in half
}

TEST_F(SelectionTest, TheSameSeedGivesTheSameHop) {
  Hopper p;
  for (const Hop hop : kAllHops) {
    auto draw = [&](std::uint64_t seed) {
      mjcf_pdg::Random noise(seed);
      VectorXd all(3 * kDofs);
      for (int k = 0; k < 3; ++k) all.segment(k * kDofs, kDofs) = p.Hopped(hop, 0.1, noise);
      return all;
    };
    EXPECT_EQ(draw(12), draw(12));
    EXPECT_NE(draw(12), draw(13));
  }
}

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
