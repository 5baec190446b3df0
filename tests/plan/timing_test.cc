// Times of paths: limits are kept at every sample, the path stays the one that was given, it takes
// as long as the closed form says, and no less.
#include "plan/timing.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include "mjcf_pdg/motion.h"
#include "model/kinematics.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

// A free body with a ball, a hinge and a slide on it; the hinge is the last but one joint.
constexpr char kEveryJoint[] = R"(<mujoco><worldbody>
  <body name="base"><freejoint name="base"/><geom size=".1" contype="0" conaffinity="0"/>
    <body name="b"><joint name="ball" type="ball"/><geom size=".1" pos=".2 0 0" contype="0" conaffinity="0"/>
    <body name="h"><joint name="hinge"/><geom size=".1" pos=".4 0 0" contype="0" conaffinity="0"/>
    <body name="s"><joint name="slide" type="slide"/><geom size=".1" pos=".6 0 0" contype="0" conaffinity="0"/>
  </body></body></body></body></worldbody></mujoco>)";

TimingLimits Limits(const Scene& scene, const JointRate& speed, const JointRate& acceleration,
                    double step) {
  const auto joints = static_cast<std::size_t>(scene.model()->njnt);
  return {std::vector(joints, speed), std::vector(joints, acceleration), step};
}

// Where no path bends.
TimedPath TimeStraight(const Scene& scene, const std::vector<std::vector<double>>& path,
                       const TimingLimits& limits) {
  std::vector<int> corners(path.size());
  std::iota(corners.begin(), corners.end(), 0);
  return TimePath(scene, path, corners, limits);
}

TEST(TimingTest, ASlideTakesAsLongAsTheClosedFormSays) {
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody>
    <body><joint type="slide"/><geom size=".1"/></body></worldbody></mujoco>)");
  const auto duration = [&](double length, double speed, double acceleration) {
    const TimedPath timed = TimeStraight(scene, {{0.0}, {length}},
                                         Limits(scene, {speed, 1.0}, {acceleration, 1.0}, 1e-4));
    EXPECT_EQ(timed.times.back(), timed.samples.back().time);
    return timed.times.back();
  };
  // To full speed, on, and to rest: L/v + v/a. Shorter ones stay below full speed: 2 √(L/a).
  EXPECT_NEAR(duration(2.0, 0.5, 0.25), 2.0 / 0.5 + 0.5 / 0.25, 1.1e-4);
  EXPECT_NEAR(duration(-2.0, 0.5, 0.25), 6.0, 1.1e-4);
  EXPECT_NEAR(duration(0.01, 0.5, 4.0), 2.0 * std::sqrt(0.01 / 4.0), 1.1e-4);
  EXPECT_NEAR(duration(2.0, 0.5, kInfinite), 4.0, 1.1e-4);
}

// As slow as a glacier and as fast as a bullet: the unit of time does not matter.
TEST(TimingTest, SlowAndFastEdgesAreTimedAlike) {
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody>
    <body><joint type="slide"/><geom size=".1"/></body></worldbody></mujoco>)");
  const auto durations = [&](double unit) {  // [unit]
    const TimedPath timed =
        TimeStraight(scene, {{0.0}, {2.0}, {1.999}, {2.0 + 1e-9}},
                     Limits(scene, {0.47 / unit, 1.0}, {0.25 / (unit * unit), 1.0}, 1e-3 * unit));
    std::vector<double> out;
    for (const double time : timed.times) out.push_back(time / unit);
    return out;
  };
  const std::vector<double> seconds = durations(1.0);
  EXPECT_NEAR(seconds[1], 2.0 / 0.47 + 0.47 / 0.25, 1.1e-3);
  EXPECT_NEAR(seconds[2] - seconds[1], 2.0 * std::sqrt(1e-3 / 0.25), 1.1e-3);
  for (const double unit : {1e-6, 1e3, 1e8}) {
    EXPECT_THAT(durations(unit), testing::Pointwise(testing::DoubleNear(1e-9), seconds)) << unit;
  }
  // An edge may be much shorter than a time step.
  const TimedPath timed =
      TimeStraight(scene, {{0.0}, {1e-12}}, Limits(scene, {1.0, 1.0}, {1.0, 1.0}, 1e3));
  EXPECT_EQ(timed.times.back(), 1e3);
}

// Each limit is kept at every sample, and on each edge one of them is reached.
TEST(TimingTest, RandomPathsKeepTheLimitsOfAllJointsAndReachOne) {
  const Scene scene = Scene::FromString(kEveryJoint);
  const mjModel& m = *scene.model();
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> log_rate(-2.0, 2.0);
  const auto draw = [&] {
    std::vector<double> q(static_cast<std::size_t>(m.nq));
    for (double& value : q) value = normal(random);
    const VectorXd unit = Normalized(scene.tables(), ToEigen(q));
    return std::vector<double>(unit.data(), unit.data() + unit.size());
  };
  int edges = 0;
  for (int trial = 0; trial < 20; ++trial) {
    TimingLimits limits = Limits(scene, {}, {}, 0.0);
    for (std::vector<JointRate>* rates : {&limits.speed, &limits.acceleration}) {
      for (JointRate& rate : *rates)
        rate = {std::exp(log_rate(random)), std::exp(log_rate(random))};
    }
    limits.step = 0.02;
    std::vector<std::vector<double>> path(4);
    for (std::vector<double>& q : path) q = draw();
    const TimedPath timed = TimeStraight(scene, path, limits);
    ASSERT_EQ(timed.times.size(), path.size());

    // The largest share of a limit, from the samples' own qvel: of the speed, and of the change of
    // speed in a step.
    const auto share = [&](const std::vector<JointRate>& rates, const VectorXd& v) {
      return std::max({v.segment(0, 3).norm() / rates[0].slide,
                       v.segment(3, 3).norm() / rates[0].turn,
                       v.segment(6, 3).norm() / rates[1].turn, std::abs(v[9]) / rates[2].turn,
                       std::abs(v[10]) / rates[3].slide});
    };
    std::size_t corner = 0;
    double reached = 0.0;
    for (std::size_t k = 1; k < timed.samples.size(); ++k) {
      const TimedPath::Sample &before = timed.samples[k - 1], &now = timed.samples[k];
      EXPECT_NEAR(now.time - before.time, limits.step, 1e-9);
      const double speed = share(limits.speed, ToEigen(now.v));
      const double acceleration =
          share(limits.acceleration, (ToEigen(now.v) - ToEigen(before.v)) / limits.step);
      EXPECT_LE(speed, 1.0 + 1e-6);
      EXPECT_LE(acceleration, 1.0 + 1e-6);
      reached = std::max({reached, speed, acceleration});
      // MuJoCo takes the mean velocity from one sample to the next.
      VectorXd mean = 0.5 * (ToEigen(now.v) + ToEigen(before.v));
      std::vector<double> q = before.q;
      mj_integratePos(&m, q.data(), mean.data(), limits.step);
      VectorXd error(m.nv);
      mj_differentiatePos(&m, error.data(), 1.0, q.data(), now.q.data());
      // Off by what the speed changes within the step where the acceleration does.
      EXPECT_LT(share(limits.acceleration, error), 0.5 * limits.step * limits.step);
      if (now.time < timed.times[corner + 1] - 1e-9) continue;
      ++corner;
      EXPECT_EQ(now.q, path[corner]);
      EXPECT_EQ(now.v, std::vector<double>(now.v.size(), 0.0));
      EXPECT_GT(reached, 0.9) << "edge " << corner;
      reached = 0.0;
      ++edges;
    }
    EXPECT_EQ(corner + 1, path.size());
  }
  EXPECT_EQ(edges, 60);
}

// Every sample lies on its edge, and they follow each other.
TEST(TimingTest, SamplesFollowTheEdges) {
  const Scene scene = Scene::FromString(kEveryJoint);
  const SceneTables& tables = scene.tables();
  const std::vector<std::vector<double>> path = {
      {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 0},
      {1, 0, 2, std::sqrt(0.5), std::sqrt(0.5), 0, 0, std::sqrt(0.5), 0, 0, -std::sqrt(0.5), 2, -1},
      {1, 0, 2, std::sqrt(0.5), std::sqrt(0.5), 0, 0, 1, 0, 0, 0, 0, 0}};
  const TimedPath timed = TimeStraight(scene, path, Limits(scene, {1, 1}, {2, 2}, 0.01));
  std::size_t edge = 0;
  double before = 0.0;
  for (const TimedPath::Sample& sample : timed.samples) {
    if (edge + 2 < path.size() && sample.time > timed.times[edge + 1]) ++edge, before = 0.0;
    VectorXd whole, part;
    Difference(tables, ToEigen(path[edge]), ToEigen(path[edge + 1]), whole);
    Difference(tables, ToEigen(path[edge]), ToEigen(sample.q), part);
    const double t = part.dot(whole) / whole.squaredNorm();
    EXPECT_LT((part - t * whole).norm(), 1e-9);
    EXPECT_GE(t, before - 1e-12);
    EXPECT_LE(t, 1.0 + 1e-12);
    before = t;
  }
  EXPECT_EQ(edge, 1u);
}

// A quarter turn of two slides, in chords of a circle of 1 m, beside the closed form: with the rate
// of s held to v, bends take v² of the acceleration, of which half is theirs.
TEST(TimingTest, ABendIsGoneThroughWithoutAStop) {
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody><body>
    <joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/><geom size=".1"/>
    </body></worldbody></mujoco>)");
  constexpr int kEdges = 400;
  std::vector<std::vector<double>> path;
  for (int k = 0; k <= kEdges; ++k) {
    const double angle = 0.5 * std::numbers::pi * k / kEdges;
    path.push_back({std::sin(angle), 1.0 - std::cos(angle)});
  }
  path.push_back({1.0, 2.0});
  const std::vector<int> corners = {0, kEdges, kEdges + 1};
  constexpr double kSpeed = 2.0, kAcceleration = 1.0;
  const TimingLimits limits = Limits(scene, {kSpeed, 1.0}, {kAcceleration, 1.0}, 0.001);
  const TimedPath timed = TimePath(scene, path, corners, limits);
  ASSERT_EQ(timed.times.size(), path.size());
  EXPECT_TRUE(std::is_sorted(timed.times.begin(), timed.times.end()));
  // Each joint's speed is at most 1.4 times that along the arc, which the bend holds to √½ m/s.
  const double arc = timed.times[kEdges], straight = timed.times.back() - arc;
  EXPECT_NEAR(straight, 2.0, 0.01);  // 1 m from rest to rest at 1 m/s²
  EXPECT_GT(arc, 0.5 * std::numbers::pi);
  EXPECT_LT(arc, 5.0);  // from rest to rest in every edge it would be 400 · 2 √0.004 = 50 s
  std::size_t rests = 0;
  for (std::size_t k = 1; k < timed.samples.size(); ++k) {
    const TimedPath::Sample &before = timed.samples[k - 1], &now = timed.samples[k];
    const double x = now.q[0], y = now.q[1];
    if (now.time < arc) {
      EXPECT_NEAR(std::hypot(x, 1.0 - y), 1.0, 3e-6);  // on a chord
    }
    rests += now.v[0] == 0.0 && now.v[1] == 0.0;
    for (const std::size_t joint : {0u, 1u}) {
      EXPECT_LE(std::abs(now.v[joint]), kSpeed);
      EXPECT_LE(std::abs(now.v[joint] - before.v[joint]), 1.02 * kAcceleration * limits.step);
      EXPECT_NEAR(now.q[joint] - before.q[joint],
                  0.5 * (now.v[joint] + before.v[joint]) * limits.step, 3e-6);
    }
  }
  EXPECT_EQ(rests, 2u);
  // Between corners, times say when the samples pass.
  for (const int k : {1, 100, 399}) {
    const double time = timed.times[static_cast<std::size_t>(k)];
    const TimedPath::Sample& near =
        timed.samples[static_cast<std::size_t>(std::lround(time / limits.step))];
    EXPECT_NEAR(near.q[0], path[static_cast<std::size_t>(k)][0], 0.001);
  }
}

TEST(TimingTest, FrozenJointsNeedNoSpeed) {
  const Scene scene = Scene::FromString(kEveryJoint, {.movable = {"s"}});
  TimingLimits limits = Limits(scene, {}, {}, 0.1);
  limits.speed[3].slide = 2.0;
  std::vector<double> from = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0.5, 0}, to = from;
  to[12] = 1.0;
  const TimedPath timed = TimeStraight(scene, {from, to}, limits);
  EXPECT_NEAR(timed.times.back(), 0.5, 1e-12);
  EXPECT_EQ(timed.samples.size(), 6u);
  EXPECT_NEAR(timed.samples[2].v[10], 2.0, 1e-9);
  EXPECT_NEAR(timed.samples[2].q[12], 0.4, 1e-9);
}

TEST(TimingTest, EdgesOfNoLengthAndPathsOfOneConfiguration) {
  const Scene scene = Scene::FromString(kEveryJoint);
  const std::vector<double> q = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0.5, 0};
  const TimingLimits limits = Limits(scene, {1, 1}, {1, 1}, 0.1);
  EXPECT_EQ(TimeStraight(scene, {q}, limits).times, std::vector<double>{0.0});
  EXPECT_EQ(TimeStraight(scene, {q, q}, limits).times, (std::vector<double>{0.0, 0.1}));
}

TEST(TimingTest, WhatCannotBeTimedIsRefused) {
  const Scene scene = Scene::FromString(kEveryJoint);
  const std::vector<double> from = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 0};
  std::vector<double> to = from;
  to[11] = 1.0;
  const auto message = [&](const JointRate& speed, double step) {
    try {
      TimeStraight(scene, {from, to}, Limits(scene, speed, {}, step));
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_THAT(message({1.0, kInfinite}, 0.1), testing::HasSubstr("'hinge'"));
  EXPECT_THAT(message({1.0, 1e-9}, 0.1), testing::HasSubstr("million"));
  EXPECT_THAT(message({1.0, 1.0}, 1e-9), testing::HasSubstr("million"));
  EXPECT_EQ(message({1.0, 1.0}, 0.1), "");
}

}  // namespace
}  // namespace mjcf_pdg
