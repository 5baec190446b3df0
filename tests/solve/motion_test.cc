// Are motions between two configurations free? Early, never late; what the public face adds.
#include "mjcf_pdg/motion.h"

#include <cmath>
#include <limits>

#include "mjcf_pdg/pdg.h"
#include "model/kinematics.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

class MotionTest : public MujocoTest {};

using Numbers = std::vector<double>;
using Ids = std::array<int, 2>;

// Two balls on slides along x and a wall between them: geoms 0, 1, 2, joints 0 and 1.
constexpr char kBalls[] = R"(<mujoco><worldbody>
    <geom name="wall" type="box" size=".1 1 1"/>
    <body pos="-1 0 0"><joint name="left" type="slide" axis="1 0 0" range="-1 2"/><geom size=".1"/></body>
    <body pos="1 0 0"><joint name="right" type="slide" axis="1 0 0"/><geom size=".1"/></body>
    </worldbody></mujoco>)";

TEST_F(MotionTest, AMotionIsFreeOrSaysWhatIsInTheWayAndWhere) {
  const Scene scene = Scene::FromString(kBalls);
  const Motion away = CheckMotion(scene, Numbers{0, 0}, Numbers{-0.5, 3});
  EXPECT_EQ(away.outcome, MotionOutcome::kFree);
  EXPECT_EQ(away.t, 1.0);
  EXPECT_EQ(away.q, (Numbers{-0.5, 3}));
  EXPECT_TRUE(away.certified);
  EXPECT_TRUE(away.pairs.empty());
  EXPECT_EQ(away.joint, -1);
  EXPECT_EQ(away.poses, 1);

  const Motion stopped = CheckMotion(scene, Numbers{0, 0}, Numbers{1.6, 0});
  EXPECT_EQ(stopped.outcome, MotionOutcome::kContact);
  EXPECT_EQ(stopped.pairs, (std::vector<Ids>{{1, 0}}));
  EXPECT_NEAR(stopped.t, 0.5, 1e-5);
  EXPECT_LT(stopped.t, 0.5);
  EXPECT_NEAR(stopped.q[0], 0.8, 1e-5);
  EXPECT_GT(stopped.poses, 0);
  EXPECT_GT(stopped.distance_queries, 0);
}

TEST_F(MotionTest, WhatOverlapsAtTheStartIsSaidMovedOrNot) {
  const Scene scene = Scene::FromString(kBalls);
  const Motion moved = CheckMotion(scene, Numbers{0.9, 0}, Numbers{0, 0});
  EXPECT_EQ(moved.outcome, MotionOutcome::kStartInCollision);
  EXPECT_EQ(moved.t, 0.0);
  ASSERT_EQ(moved.pairs.size(), 1u);
  const Motion still = CheckMotion(scene, Numbers{0.9, 0}, Numbers{0.9, 1});
  EXPECT_EQ(still.outcome, MotionOutcome::kStartInCollision);
  EXPECT_EQ(still.pairs, moved.pairs);
  EXPECT_EQ(CheckMotion(scene, Numbers{0.9, 0}, Numbers{0.9, 0}).outcome,
            MotionOutcome::kStartInCollision);
  const Motion nowhere = CheckMotion(scene, Numbers{0, 0}, Numbers{0, 0});
  EXPECT_EQ(nowhere.outcome, MotionOutcome::kFree);
  EXPECT_EQ(nowhere.t, 1.0);
}

TEST_F(MotionTest, LimitsEndAMotionAtTheJointThatReachesThem) {
  const Scene scene = Scene::FromString(kBalls);
  const Motion motion = CheckMotion(scene, Numbers{0, 0}, Numbers{-2, 1});
  EXPECT_EQ(motion.outcome, MotionOutcome::kLimit);
  EXPECT_EQ(motion.joint, 0);
  EXPECT_NEAR(motion.t, 0.5, 1e-12);
  EXPECT_NEAR(motion.q[1], 0.5, 1e-12);
  // From outside there is no way that keeps the limits, not even back in.
  const Motion outside = CheckMotion(scene, Numbers{-1.5, 0}, Numbers{0, 0});
  EXPECT_EQ(outside.outcome, MotionOutcome::kLimit);
  EXPECT_EQ(outside.joint, 0);
  EXPECT_EQ(outside.t, 0.0);
  EXPECT_EQ(outside.q, (Numbers{-1.5, 0}));
}

// The verifier has a constant of its own.
TEST_F(MotionTest, LimitsBeginToCountWhereTheVerifiersDo) {
  const Scene scene = Scene::FromString(kBalls);
  for (const double share : {0.5, 0.99, 1.01}) {
    const Numbers q = {-1 - share * kLimitTolerance, 0};
    EXPECT_EQ(Verify(scene, q).free, share < 1.0) << share;
    EXPECT_EQ(CheckMotion(scene, q, Numbers{0, 0}).outcome,
              share < 1.0 ? MotionOutcome::kFree : MotionOutcome::kLimit)
        << share;
  }
}

TEST_F(MotionTest, ClearanceRestAndToleranceAreThoseOfTheOptions) {
  const Scene scene = Scene::FromString(kBalls);
  Options options;
  options.clearance = 0.3;
  const Motion clear = CheckMotion(scene, Numbers{0, 0}, Numbers{1, 0}, options);
  EXPECT_EQ(clear.outcome, MotionOutcome::kContact);
  EXPECT_NEAR(clear.q[0], 0.5, 1e-5);
  EXPECT_LT(clear.q[0], 0.5);
  options = {};
  options.tolerance = 0.01;
  const Motion loose = CheckMotion(scene, Numbers{0, 0}, Numbers{1, 0}, options);
  EXPECT_NEAR(loose.q[0], 0.77, 0.02);
  options = {};
  options.rest = 0.05;
  const Numbers sunk = {0.82, 0}, deep = {0.86, 0};
  EXPECT_EQ(CheckMotion(scene, sunk, Numbers{0, 0}).outcome, MotionOutcome::kStartInCollision);
  EXPECT_EQ(CheckMotion(scene, sunk, Numbers{0, 0}, options).outcome, MotionOutcome::kFree);
  EXPECT_EQ(CheckMotion(scene, sunk, Numbers{1, 0}, options).outcome, MotionOutcome::kContact);
  EXPECT_EQ(CheckMotion(scene, deep, Numbers{0, 0}, options).outcome,
            MotionOutcome::kStartInCollision);
}

// The verifier's measure, rounding included, decides for both.
TEST_F(MotionTest, WhatRestsForTheSolverRestsForAMotion) {
  const Scene scene = Scene::FromString(kBalls);
  Options options;
  options.rest = 0.05;
  const Numbers just = {0.8 + options.rest * (1.0 + 5e-7), 0}, too_deep = {0.8501, 0};
  EXPECT_EQ(Solver(scene, options).Solve(just).status, Status::kAlreadyFree);
  EXPECT_EQ(CheckMotion(scene, just, Numbers{0, 0}, options).outcome, MotionOutcome::kFree);
  EXPECT_EQ(Solver(scene, options).Solve(too_deep).status, Status::kSolved);
  EXPECT_EQ(CheckMotion(scene, too_deep, Numbers{0, 0}, options).outcome,
            MotionOutcome::kStartInCollision);
}

TEST_F(MotionTest, MocapObstaclesStandWhereTheyArePut) {
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody>
      <body name="obstacle" mocap="true" pos="0 0 5"><geom size=".1"/></body>
      <body><joint type="slide" axis="1 0 0"/><geom size=".1"/></body></worldbody></mujoco>)");
  Options options;
  EXPECT_EQ(CheckMotion(scene, Numbers{0}, Numbers{1}).outcome, MotionOutcome::kFree);
  options.mocap_pos = {0.5, 0, 0};
  MotionChecker checker(scene, options);
  EXPECT_NEAR(checker.Check(Numbers{0}, Numbers{1}).t, 0.3, 1e-5);
  checker.SetMocap({0.7, 0, 0}, {});
  EXPECT_NEAR(checker.Check(Numbers{0}, Numbers{1}).t, 0.5, 1e-5);
  checker.SetMocap({}, {});
  EXPECT_EQ(checker.Check(Numbers{0}, Numbers{1}).outcome, MotionOutcome::kFree);
}

TEST_F(MotionTest, BadInputIsRefusedInWords) {
  const Scene scene = Scene::FromString(kBalls);
  auto error = [&](const Numbers& q0, const Numbers& q1, const Options& options = {}) {
    return ErrorOf([&] { CheckMotion(scene, q0, q1, options); });
  };
  EXPECT_NE(error({0}, {0, 0}).find("the model needs 2"), std::string::npos);
  EXPECT_NE(error({0, 0}, {0, 0, 0}).find("the model needs 2"), std::string::npos);
  EXPECT_NE(error({0, 0}, {0, std::nan("")}).find("qpos[1]"), std::string::npos);
  Options options;
  options.tolerance = -1.0;
  EXPECT_NE(error({0, 0}, {0, 0}, options).find("tolerance"), std::string::npos);
  options = {};
  options.mocap_pos = {1.0};
  EXPECT_NE(error({0, 0}, {0, 0}, options).find("mocap_pos"), std::string::npos);
  SceneOptions only_a;
  only_a.movable = {"a"};
  const Scene frozen = Scene::FromString(R"(<mujoco><worldbody>
      <body name="a"><joint name="ja" type="slide"/><geom size=".1"/></body>
      <body name="b" pos="1 0 0"><joint name="jb" type="ball"/><geom size=".1"/></body>
      </worldbody></mujoco>)",
                                         only_a);
  EXPECT_NE(ErrorOf([&] {
              CheckMotion(frozen, Numbers{0, 1, 0, 0, 0}, Numbers{1, 0, 1, 0, 0});
            }).find("jb"),
            std::string::npos);
  EXPECT_NE(ErrorOf([&] {
              CheckMotion(frozen, Numbers{0, 1, 0, 0, 0}, Numbers{1, 0, 0, 0, 0});
            }).find("zero"),
            std::string::npos);
  EXPECT_EQ(CheckMotion(frozen, Numbers{0, 1, 0, 0, 0}, Numbers{0, 1, 0, 0, 0}).outcome,
            MotionOutcome::kFree);
}

// A turn by a quaternion of any length and sign is the short one.
TEST_F(MotionTest, BallsTurnTheShortWay) {
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody>
      <body><joint type="ball"/><geom type="capsule" size=".01" fromto="0 0 0 1 0 0"/></body>
      <geom name="post" pos="-.7 -.7 0" size=".1"/></worldbody></mujoco>)");
  const double half = 0.5 * 2.0;
  EXPECT_EQ(CheckMotion(scene, Numbers{1, 0, 0, 0},
                        Numbers{-3 * std::cos(half), 0, 0, -3 * std::sin(half)})
                .outcome,
            MotionOutcome::kFree);
  EXPECT_EQ(CheckMotion(scene, Numbers{2, 0, 0, 0},
                        Numbers{std::cos(half + 0.6), 0, 0, std::sin(half + 0.6)})
                .outcome,
            MotionOutcome::kContact);
}

// Whole robots against the verifier, which shares no code with this.
TEST_F(MotionTest, WhatIsCalledFreeTheVerifierFindsFree) {
  Random rng(21);
  int contacts = 0, free = 0, starts = 0;
  for (int model = 0; model < 6; ++model) {
    RobotOptions robot;
    robot.free_base = model % 2 == 1;
    robot.bodies = 5;
    const Scene scene = Scene::FromString(RandomRobotXml(rng, robot));
    MotionChecker checker(scene);
    for (int i = 0; i < 40; ++i) {
      const VectorXd q0 = RandomConfiguration(scene, rng);
      VectorXd q1 = RandomConfiguration(scene, rng), dq, q;
      if (rng.Chance(0.4)) {  // a short way
        Difference(scene.tables(), q0, q1, dq);
        Integrate(scene.tables(), q0, 0.1 * dq, q1);
      }
      const Motion& motion = checker.Check(ToVector(q0), ToVector(q1));
      const bool starts_free = Verify(scene, ToVector(q0)).free;
      EXPECT_EQ(motion.outcome == MotionOutcome::kStartInCollision, !starts_free) << Join(q0);
      contacts += motion.outcome == MotionOutcome::kContact;
      free += motion.outcome == MotionOutcome::kFree;
      starts += !starts_free;
      if (!starts_free) continue;
      EXPECT_TRUE(motion.certified);
      Difference(scene.tables(), q0, q1, dq);
      for (int k = 0; k <= 100; ++k) {
        Integrate(scene.tables(), q0, (motion.t * k / 100) * dq, q);
        EXPECT_TRUE(Verify(scene, ToVector(q)).free) << Join(q0) << "\n" << Join(q1);
      }
    }
  }
  EXPECT_GT(contacts, 20);
  EXPECT_GT(free, 5);
  EXPECT_GT(starts, 20);
}

TEST_F(MotionTest, ACheckerForgetsItsMotions) {
  const Scene scene = Scene::FromString(ArmXml());
  MotionChecker used(scene);
  Random rng(22);
  for (int i = 0; i < 30; ++i) {
    const Numbers a = ToVector(RandomConfiguration(scene, rng));
    const Numbers b = ToVector(RandomConfiguration(scene, rng));
    used.Check(b, a);
    const Motion& again = used.Check(a, b);
    const Motion fresh = CheckMotion(scene, a, b);
    EXPECT_EQ(again.t, fresh.t);
    EXPECT_EQ(again.pairs, fresh.pairs);
    EXPECT_EQ(again.poses, fresh.poses);
    EXPECT_EQ(again.distance_queries, fresh.distance_queries);
  }
}

TEST_F(MotionTest, AMotionOverAHeightFieldIsCertified) {
  const Scene scene = Scene::FromString(R"(<mujoco><asset>
      <hfield name="hills" nrow="3" ncol="3" size="1 1 .2 .1" elevation="0 0 0 0 1 0 0 0 0"/>
      </asset><worldbody><geom type="hfield" hfield="hills"/>
      <body pos="0 0 1"><freejoint/><geom size=".1"/></body></worldbody></mujoco>)");
  const Numbers above = {0, 0, 0.5, 1, 0, 0, 0}, below = {0, 0, -0.5, 1, 0, 0, 0};
  const Numbers far = {0, 0, 9, 1, 0, 0, 0}, farther = {0, 3, 9, 1, 0, 0, 0};
  const Motion down = CheckMotion(scene, above, below);
  EXPECT_EQ(down.outcome, MotionOutcome::kContact);
  EXPECT_TRUE(down.certified);
  EXPECT_NEAR(down.q[2], 0.3, 1e-5);
  EXPECT_TRUE(CheckMotion(scene, far, farther).certified);
}

}  // namespace
}  // namespace mjcf_pdg::test
