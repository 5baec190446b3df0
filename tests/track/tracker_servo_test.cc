// Tracker: what people report of filters between planner and servo, as tests.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mjcf_pdg/pdg.h"
#include "model/kinematics.h"
#include "tests/support/allocation_counter.h"
#include "tests/support/test_support.h"
#include "tests/support/trials.h"

namespace mjcf_pdg::test {
namespace {

using Q = std::vector<double>;

// An arm of two links in the plane before a wall.
constexpr char kArmAtWall[] = R"(<mujoco><compiler angle="radian"/><worldbody>
  <geom name="wall" type="box" pos="0 .9 0" size="2 .3 .5"/>
  <body><joint axis="0 0 1" range="-2.5 2.5" limited="true"/>
    <geom type="capsule" fromto="0 0 0 .5 0 0" size=".04"/>
    <body pos=".5 0 0"><joint axis="0 0 1" range="-2.5 2.5" limited="true"/>
      <geom type="capsule" fromto="0 0 0 .4 0 0" size=".04"/></body></body>
  </worldbody></mujoco>)";

// A blade that turns without limits, and a thin post that it passes at angle 0.
constexpr char kBlade[] = R"(<mujoco><compiler angle="radian"/><worldbody>
  <geom name="post" type="cylinder" pos=".25 0 0" size=".005 .2"/>
  <body><joint axis="0 0 1"/><geom type="box" pos=".2 0 0" size=".1 .001 .05"/></body>
  </worldbody></mujoco>)";

double Step(const Q& a, const Q& b) {
  double largest = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) largest = std::max(largest, std::abs(a[k] - b[k]));
  return largest;
}

class TrackerServoTest : public MujocoTest {};

// moveit2, pull request 3027: "if you servo into collision then try to servo out, the arm jumps,
// seemingly randomly, either out of collision or into collision".
TEST_F(TrackerServoTest, ServoingIntoCollisionAndOutAgainDoesNotJump) {
  const Scene scene = Scene::FromString(kArmAtWall);
  Random rng(3027);
  int held = 0, pressed = 0;
  for (int jog = 0; jog < Trials(12); ++jog) {
    const double speed = 0.5e-3;  // [rad] a tick, 0.5 rad/s
    Q home = {1.57, 0.0};         // in the wall
    while (!Verify(scene, home).free) home = {rng.Uniform(-0.2, 0.5), rng.Uniform(-1.0, 1.0)};
    const Q direction = {1.0, rng.Uniform(-0.8, 0.8)};
    Tracker tracker(scene);
    Result result;
    Q last = home, command = home, last_command = home;
    tracker.Reset(home);
    const int into = 2400, hold = 400;
    for (int k = 0; k < 2 * into + hold; ++k) {
      const double way = k < into ? 1.0 : k < into + hold ? 0.0 : -1.0;
      for (int j : {0, 1}) command[j] += way * speed * direction[j];
      ASSERT_NE(tracker.Step(command, result), Status::kUnsolved) << jog << " " << k;
      ASSERT_TRUE(Verify(scene, result.q).free) << jog << " " << k;
      const double moved =
          std::sqrt(ObjectNorm(scene, Metric::kSequential, last_command).Sigma(command));
      const double answer = std::sqrt(ObjectNorm(scene, Metric::kSequential, last).Sigma(result.q));
      ASSERT_FALSE(result.under_way) << "nothing limits its steps";
      if (!result.switched) {
        ASSERT_LE(answer, 10.0 * moved + 1e-5) << jog << " " << k << " jumped";
      }
      pressed += result.status == Status::kSolved;
      if (way == 0.0 && k > into + hold / 2) {
        EXPECT_LE(Step(result.q, last), 1e-5) << jog << " " << k << ": the command stands";
        ++held;
      }
      last = result.q;
      last_command = command;
    }
    EXPECT_LE(Step(result.q, home), 1e-9) << "back where it came from";
  }
  EXPECT_GT(pressed, Trials(5000));
  EXPECT_GT(held, Trials(1000));
}

// Between two ticks the blade turns by 40 to 130 degrees; every command is free by itself.
TEST_F(TrackerServoTest, ASpinningBladeDoesNotPassAPostBetweenTicks) {
  const Scene scene = Scene::FromString(kBlade);
  Random rng(27);
  for (int spin = 0; spin < 20; ++spin) {
    TrackOptions options;
    options.certify_motion = true;
    Tracker tracker(scene, options);
    Result result;
    Q command = {std::numbers::pi}, last = command;
    const double turn = rng.Uniform(0.7, 2.3) * (rng.Chance(0.5) ? 1.0 : -1.0);
    int passes = 0;  // of the command
    for (int k = 0; k < 60; ++k) {
      ASSERT_NE(tracker.Step(command, result), Status::kUnsolved) << spin << " " << k;
      ASSERT_TRUE(Verify(scene, result.q).free) << spin << " " << k;
      ASSERT_GT(result.q[0], 0.0) << spin << " " << k << ": it has passed the post";
      ASSERT_LT(result.q[0], 2.0 * std::numbers::pi) << spin << " " << k;
      const Motion motion = CheckMotion(scene, last, result.q);
      EXPECT_LT((1.0 - motion.t) * Step(last, result.q), 1e-4) << spin << " " << k;
      last = result.q;
      passes += std::floor((command[0] + turn) / (2.0 * std::numbers::pi)) !=
                std::floor(command[0] / (2.0 * std::numbers::pi));
      command[0] += turn;
    }
    EXPECT_GT(passes, 5);
  }
}

// Robots at random: max_step at three times what the fastest joint of the command moves.
TEST_F(TrackerServoTest, NoJointIsEverFasterThanMaxStepAndAnswersStayFree) {
  Random rng(2703);
  int ticks = 0, limited = 0;
  for (int robot = 0; robot < 6; ++robot) {
    RobotOptions shape;
    shape.bodies = 5;
    const Scene scene = Scene::FromString(RandomRobotXml(rng, shape));
    const VectorXd first = RandomConfiguration(scene, rng), other = RandomConfiguration(scene, rng);
    VectorXd dq, q;
    Difference(scene.tables(), first, other, dq);
    const auto command_at = [&](int k) {
      const double share = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * k / 1000);
      Integrate(scene.tables(), first, share * dq, q);
      return ToVector(q);
    };
    TrackOptions options;  // the cosine's steepest place
    options.max_step = 3.0 * std::numbers::pi / 1000.0 * dq.cwiseAbs().maxCoeff();
    Tracker tracker(scene, options);
    Result result;
    Q last;
    for (int k = 0; k < 1000; ++k) {
      const Status status = tracker.Step(command_at(k), result);
      if (k == 0 && status == Status::kUnsolved) break;
      ASSERT_NE(status, Status::kUnsolved) << robot << " " << k << ": " << result.reason;
      ASSERT_TRUE(Verify(scene, result.q).free) << robot << " " << k;
      ++ticks;
      if (k > 0) {
        ASSERT_LE(result.stats.collision_queries, options.queries) << robot << " " << k;
        const double sigma = ObjectNorm(scene, Metric::kSequential, command_at(k)).Sigma(result.q);
        ASSERT_NEAR(result.sigma, sigma, 1e-9 + 1e-6 * sigma) << "from the command";
        VectorXd step;
        Difference(scene.tables(), ToEigen(last), ToEigen(result.q), step);
        ASSERT_LE(step.cwiseAbs().maxCoeff(), options.max_step * (1.0 + 1e-9)) << robot << " " << k;
        limited += step.cwiseAbs().maxCoeff() > 0.99 * options.max_step;
      }
      last = result.q;
    }
  }
  EXPECT_GT(ticks, 3000);
  EXPECT_GT(limited, 20);
}

// The command jumps behind the wall of a pocket: neither straight on nor along the wall does a ball
// get there that may not pass it.
TEST_F(TrackerServoTest, AWayRoundAPocketIsFound) {
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody>
    <geom type="box" pos=".5 0 0" size=".05 .5 1"/>
    <geom type="box" pos=".2 .5 0" size=".35 .05 1"/>
    <geom type="box" pos=".2 -.5 0" size=".35 .05 1"/>
    <body><joint type="slide" axis="1 0 0" range="-2 2" limited="true"/>
      <joint type="slide" axis="0 1 0" range="-2 2" limited="true"/><geom size=".1"/></body>
    </worldbody></mujoco>)");
  for (const bool certify : {false, true}) {
    TrackOptions options;
    options.max_step = 0.01;
    options.certify_motion = certify;
    Tracker tracker(scene, options);
    Result result;
    tracker.Reset(Q{0.0, 0.0});
    Q last = {0.0, 0.0};
    const Q command = {1.0, 0.1};
    int ticks = 0, under_way = 0;
    for (; ticks < 3000 && last != command; ++ticks) {
      ASSERT_NE(tracker.Step(command, result), Status::kUnsolved) << ticks << result.reason;
      ASSERT_TRUE(Verify(scene, result.q).free) << ticks;
      ASSERT_LE(Step(last, result.q), options.max_step * (1.0 + 1e-9)) << ticks;
      ASSERT_LE(result.stats.collision_queries, options.queries) << ticks;
      under_way += result.under_way;
      last = result.q;
    }
    EXPECT_EQ(last, command) << certify;
    EXPECT_GT(under_way, 200) << certify;
    EXPECT_LT(under_way, ticks) << "before a way is known it follows the optimum on its own side";
    EXPECT_TRUE(result.under_way) << "with the tick that arrives";
    tracker.Step(command, result);
    EXPECT_FALSE(result.under_way) << "where it has arrived";
    EXPECT_LT(ticks, 1000) << "the shortest way takes 250 or so";
  }
}

// Reset may say that it stands in an obstacle, from which it cannot go in one tick.
TEST_F(TrackerServoTest, FromAnObstacleItGoesToWhereItIsFree) {
  const Scene scene = Scene::FromString(kArmAtWall);
  TrackOptions options;
  options.max_step = 0.005;
  Tracker tracker(scene, options);
  const Q inside = {1.3, 0.2};
  ASSERT_FALSE(Verify(scene, inside).free);
  tracker.Reset(inside);
  Result result;
  Q last = inside;
  int unsolved = 0;
  for (int k = 0; k < 300; ++k) {
    const bool solved = tracker.Step(inside, result) != Status::kUnsolved;
    ASSERT_EQ(solved, Verify(scene, result.q).free) << k;
    ASSERT_LE(Step(last, result.q), options.max_step * (1.0 + 1e-9)) << k;
    unsolved += !solved;
    last = result.q;
  }
  EXPECT_GT(unsolved, 10);
  EXPECT_LT(unsolved, 250);
}

// A ball that posts jump around: the last answer is often not free, and at times nothing is found.
TEST_F(TrackerServoTest, NoTickTakesMoreQueriesThanItsBudget) {
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody>
    <body mocap="true"><geom type="box" size=".3 .3 1"/></body>
    <body mocap="true"><geom type="cylinder" size=".3 1"/></body>
    <geom type="box" pos="0 .75 0" size="1 .1 1"/><geom type="box" pos="0 -.75 0" size="1 .1 1"/>
    <body><joint type="slide" axis="1 0 0" range="-1 1" limited="true"/>
      <joint type="slide" axis="0 1 0" range="-1 1" limited="true"/><geom size=".1"/>
      <body><joint axis="0 0 1"/><geom type="capsule" fromto="0 0 0 .4 0 0" size=".05"/></body>
    </body></worldbody></mujoco>)");
  const DataPtr d(mj_makeData(scene.model()));
  Random rng(2704);
  int spent = 0, unsolved = 0, solved = 0;
  for (int run = 0; run < 24; ++run) {
    TrackOptions options;
    options.queries = 6 + 2 * (run % 4);
    if (run % 3 > 0) options.max_step = 0.02;
    options.certify_motion = run % 3 == 2;
    options.lower_bound = run % 5 == 0;
    options.options.report_contacts = run % 7 == 0;
    Tracker tracker(scene, options);
    Result result;
    for (int k = 0; k < 400; ++k) {
      if (k % 20 == 0) {
        for (int p = 0; p < 6; ++p) d->mocap_pos[p] = p % 3 == 2 ? 0.0 : rng.Uniform(-0.8, 0.8);
      }
      const Q command = {0.9 * std::sin(0.011 * k), 0.5 * std::sin(0.017 * k), 0.01 * k};
      const Status status = tracker.Step(d.get(), command, result);
      if (k == 0) continue;
      ASSERT_LE(result.stats.collision_queries, options.queries) << run << " " << k;
      spent += result.stats.collision_queries == options.queries;
      unsolved += status == Status::kUnsolved;
      solved += status == Status::kSolved;
    }
  }
  EXPECT_GT(spent, 100);
  EXPECT_GT(unsolved, 50);
  EXPECT_GT(solved, 1000);
}

// A ball in a pit that a lid closes: nothing is free, in this tick and in all after it until the
// lid opens again.
TEST_F(TrackerServoTest, WhatIsNotFreeIsNotCalledFreeInALaterTick) {
  const Scene scene = Scene::FromString(R"(<mujoco><compiler angle="radian"/><worldbody>
    <geom type="box" pos="0 0 -.1" size="1 1 .1"/>
    <body mocap="true" pos="0 0 1"><geom type="box" size="1 1 .1"/></body>
    <body pos="0 0 .1"><joint type="slide" axis="0 0 1" range="-.1 .1" limited="true"/>
      <geom size=".1"/></body></worldbody></mujoco>)");
  const DataPtr d(mj_makeData(scene.model()));
  TrackOptions options;
  options.options.report_lower_bound = false;
  Tracker tracker(scene, options);
  Result result;
  for (int k = 0; k < 30; ++k) {
    const bool closed = k >= 10 && k < 20;
    d->mocap_pos[2] = closed ? 0.2 : 1.0;
    const Q command = {k == 0 ? -0.05 : -0.05 + 1e-4 * k};
    const Status status = tracker.Step(d.get(), command, result);
    EXPECT_EQ(status, closed ? Status::kUnsolved : Status::kSolved) << k;
    Options here;
    here.mocap_pos.assign(d->mocap_pos, d->mocap_pos + 3);
    here.mocap_quat.assign(d->mocap_quat, d->mocap_quat + 4);
    EXPECT_EQ(Verify(scene, result.q, here).free, !closed) << k;
  }
}

// A ball on its way up to a free command, on which a clamp closes that leaves no room there.
TEST_F(TrackerServoTest, WhatStandsFreeStaysFreeThoughItsAimIsLost) {
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody>
    <body mocap="true" pos="5 0 1"><geom type="box" pos="0 0 -.55" size=".5 .5 .5"/>
      <geom type="box" pos="0 0 .55" size=".5 .5 .5"/></body>
    <body><joint type="slide" axis="0 0 1" range="-1 1" limited="true"/>
      <geom size=".1"/></body></worldbody></mujoco>)");
  const DataPtr d(mj_makeData(scene.model()));
  TrackOptions options;
  options.queries = 6;
  options.max_step = 0.001;
  Tracker tracker(scene, options);
  tracker.Reset(Q{-0.8});
  Result result;
  int held = 0;
  for (int k = 0; k < 60; ++k) {
    d->mocap_pos[0] = k < 30 ? 5.0 : 0.0;
    const Status status = tracker.Step(d.get(), Q{0.9}, result);
    ASSERT_NE(status, Status::kUnsolved) << k << ": " << result.reason;
    Options here;
    here.mocap_pos.assign(d->mocap_pos, d->mocap_pos + 3);
    here.mocap_quat.assign(d->mocap_quat, d->mocap_quat + 4);
    ASSERT_TRUE(Verify(scene, result.q, here).free) << k;
    held += k >= 30;
  }
  EXPECT_GT(held, 20);
}

TEST_F(TrackerServoTest, ProvenMotionsTakeNothingFromTheHeap) {
  if (!AllocationCounter::Works()) GTEST_SKIP() << "no hook into this C library's malloc";
  const Scene scene = Scene::FromString(kArmAtWall);
  for (const bool certify : {false, true}) {
    TrackOptions options;
    options.certify_motion = certify;
    options.options.report_lower_bound = false;
    Tracker tracker(scene, options);
    Result result;
    tracker.Reset(Q{0.0, 0.0});
    int pressed = 0;
    std::int64_t allocations = 0;
    for (int k = 0; k < 1500; ++k) {
      const double angle = 1.6 * std::sin(0.01 * k);
      const Q command = {angle, 1.1 * std::sin(0.013 * k)};
      const AllocationCounter counter;
      pressed += tracker.Step(command, result) == Status::kSolved;
      if (k > 700) allocations += counter.count();
    }
    EXPECT_EQ(allocations, 0) << certify;
    EXPECT_GT(pressed, 300);
  }
}

}  // namespace
}  // namespace mjcf_pdg::test
