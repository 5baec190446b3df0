// Tendon limits are held when the options ask for it. Lengths are computed here by their
// definition, or by MuJoCo at the answer.
#include "equality/tendon_limits.h"

#include <gmock/gmock.h>
#include <mujoco/mujoco.h>

#include <cmath>

#include "equality/equality_constraints.h"
#include "mjcf_pdg/gradient.h"
#include "mjcf_pdg/pdg.h"
#include "mjcf_pdg/tracker.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

using ::testing::HasSubstr;
using Q = std::vector<double>;

Scene Holding(const std::string& xml, SceneOptions options = {}) {
  options.hold_tendon_limits = true;
  return Scene::FromString(xml, options);
}

// How far any limited tendon is outside its range, by MuJoCo.
double Excess(const mjModel& m, const Q& q) {
  const std::unique_ptr<mjData, void (*)(mjData*)> d(mj_makeData(&m), mj_deleteData);
  mju_copy(d->qpos, q.data(), static_cast<int>(m.nq));
  mj_fwdPosition(&m, d.get());
  double largest = 0.0;
  for (int t = 0; t < m.ntendon; ++t) {
    if (!m.tendon_limited[t]) continue;
    const double length = d->ten_length[t], *range = m.tendon_range + 2 * t;
    largest = std::max({largest, range[0] - length, length - range[1]});
  }
  return largest;
}

// A ball of radius 0.1 in a plane, on a string of at most a metre from the origin; a ball of radius
// 0.2 stands at (0.7, 0.3).
constexpr char kOnAString[] = R"(<mujoco><worldbody>
  <site name="anchor"/><geom name="stone" size=".2" pos=".7 .3 0"/>
  <body name="kite"><joint name="x" type="slide" axis="1 0 0"/><joint name="y" type="slide" axis="0 1 0"/>
    <geom name="kite" size=".1"/><site name="end"/></body></worldbody>
  <tendon><spatial name="string" limited="true" range="0 1"><site site="anchor"/><site site="end"/>
  </spatial></tendon></mujoco>)";

// An arm of three hinges with a fixed tendon over all and a cable that wraps around a cylinder and
// through a pulley; beside it a free body that hangs on the arm's end.
constexpr char kCables[] = R"(<mujoco><compiler angle="radian"/><worldbody>
  <geom name="wall" type="box" size=".05 1 1" pos=".75 0 0"/><site name="base" pos="-.2 .15 0"/>
  <geom name="drum" type="cylinder" size=".06 .1" pos="0 .05 0" contype="0" conaffinity="0"/>
  <site name="outside" pos="0 .2 0"/>
  <body><joint name="a" axis="0 0 1" range="-1.5 1.5"/><geom type="capsule" fromto=".05 0 0 .25 0 0" size=".03"/>
    <site name="s1" pos=".2 .06 0"/>
    <body pos=".3 0 0"><joint name="b" axis="0 0 1" range="-1.5 1.5"/><geom type="capsule" fromto=".05 0 0 .25 0 0" size=".03"/>
      <site name="s2" pos=".2 .06 0"/>
      <body pos=".3 0 0"><joint name="c" axis="0 1 0" range="-1.5 1.5"/><geom type="capsule" fromto=".05 0 0 .15 0 0" size=".03"/>
        <site name="tip" pos=".18 0 0"/></body></body></body>
  <body name="load" pos=".6 0 -.5"><freejoint/><geom size=".07"/><site name="hook" pos="0 0 .07"/></body>
  </worldbody>
  <tendon>
    <fixed name="sum" limited="true" range="-.6 .8"><joint joint="a" coef="1"/><joint joint="b" coef="-.7"/><joint joint="c" coef=".3"/></fixed>
    <spatial name="cable" limited="true" range=".3 .62"><site site="base"/><geom geom="drum" sidesite="outside"/>
      <site site="s1"/><site site="s2"/><pulley divisor="2"/><site site="s2"/><site site="tip"/></spatial>
    <spatial name="rope" limited="true" range="0 .55"><site site="tip"/><site site="hook"/></spatial>
  </tendon></mujoco>)";

Q RandomPose(const mjModel& m, Random& random, double reach) {
  Q q(m.qpos0, m.qpos0 + m.nq);
  for (int j = 0; j < m.njnt; ++j) {
    double* pose = q.data() + m.jnt_qposadr[j];
    const int count = m.jnt_type[j] == mjJNT_FREE ? 7 : 1;
    for (int k = 0; k < count; ++k) pose[k] += random.Uniform(-reach, reach);
  }
  return q;
}

TEST(TendonLimitsTest, JacobiansAreThoseOfTheSlacks) {
  const Scene scene = Holding(kCables);
  EqualityConstraints constraints(scene.tables());
  const TendonLimits& limits = constraints.tendon_limits();
  ASSERT_TRUE(constraints.any());
  Random random(3);
  constexpr double kStep = 1e-6;
  for (int k = 0; k < 30; ++k) {
    const VectorXd q = ToEigen(RandomPose(*scene.model(), random, 0.5));
    constraints.Linearize(q);
    const MatrixXd jacobian = limits.jacobian();
    ASSERT_EQ(jacobian.rows(), 6);
    EXPECT_EQ(constraints.residual().size(), 0);
    for (int i = 0; i < scene.dof(); ++i) {
      VectorXd moved, dq = VectorXd::Zero(scene.dof());
      dq[i] = kStep;
      Integrate(scene.tables(), q, dq, moved);
      constraints.Linearize(moved);
      const VectorXd ahead = limits.slack();
      Integrate(scene.tables(), q, -dq, moved);
      constraints.Linearize(moved);
      const VectorXd slope = (ahead - limits.slack()) / (2 * kStep);
      EXPECT_LT((slope - jacobian.col(i)).lpNorm<Eigen::Infinity>(), 1e-7) << k << " " << i;
    }
  }
}

TEST(TendonLimitsTest, AreNoPartOfFreeUnlessAsked) {
  const Q out = {3, 4};
  const Scene usual = Scene::FromString(kOnAString);
  EXPECT_FALSE(usual.HoldsTendonLimits());
  EXPECT_EQ(Solver(usual).Solve(out).status, Status::kAlreadyFree);
  EXPECT_EQ(Verify(usual, out).tendon_excess, 0.0);

  const Scene held = Holding(kOnAString);
  EXPECT_TRUE(held.HoldsTendonLimits());
  const Verdict verdict = Verify(held, out);
  EXPECT_FALSE(verdict.free);
  EXPECT_NEAR(verdict.tendon_excess, 4.0, 1e-12);
  EXPECT_THAT(verdict.reason, HasSubstr("tendon 'string' has length 5, outside its range 0 ... 1"));
}

// The nearest point of a disc.
TEST(TendonLimitsTest, AStringPullsStraightBack) {
  const Scene scene = Holding(kOnAString);
  const Result result = Solver(scene).Solve(Q{-3, 4});
  ASSERT_EQ(result.status, Status::kSolved) << result.reason;
  EXPECT_NEAR(result.q[0], -0.6, 2e-6);
  EXPECT_NEAR(result.q[1], 0.8, 2e-6);
  EXPECT_NEAR(result.sigma, 16.0, 2e-5);
  EXPECT_NEAR(result.tendon_excess_in, 4.0, 1e-12);
  EXPECT_LE(result.tendon_excess, 1e-6);
}

// Around a stone: against the nearest of a fine grid of points inside the string's reach and
// outside the stone, which is as near as the grid is fine.
TEST(TendonLimitsTest, AnswersAreTheNearestOfAGrid) {
  const Scene scene = Holding(kOnAString);
  Solver solver(scene);
  Random random(8);
  constexpr double kCell = 0.002, kHalf = 1.0;
  int of_both = 0;
  for (int k = 0; k < 30; ++k) {
    const Q q = {random.Uniform(0.2, 1.4), random.Uniform(-0.5, 1.1)};
    const Result result = solver.Solve(q);
    ASSERT_NE(result.status, Status::kUnsolved) << result.reason;
    EXPECT_LE(std::hypot(result.q[0], result.q[1]), 1.0 + 1e-6);
    EXPECT_GE(std::hypot(result.q[0] - 0.7, result.q[1] - 0.3), 0.3 - 1e-6);
    double nearest = 1e9;
    for (double x = -kHalf; x <= kHalf; x += kCell) {
      for (double y = -kHalf; y <= kHalf; y += kCell) {
        if (std::hypot(x, y) > 1.0 || std::hypot(x - 0.7, y - 0.3) < 0.3) continue;
        nearest = std::min(nearest, std::hypot(x - q[0], y - q[1]));
      }
    }
    EXPECT_LE(std::sqrt(result.sigma), nearest + 1e-6) << k;
    EXPECT_LE(result.sigma_lower_bound, result.sigma * (1 + 1e-9));
    of_both += std::hypot(q[0], q[1]) > 1.0 && result.depth_in < 0.0;
  }
  EXPECT_GT(of_both, 2);
}

// Two carts on one line whose sum is limited, masses 1 and 3: the lighter one goes three times as
// far. They are two trees, and nothing else joins them.
TEST(TendonLimitsTest, TreesThatATendonJoinsShareTheMotion) {
  const Scene scene = Holding(R"(<mujoco><worldbody>
      <body><joint name="a" type="slide" axis="1 0 0"/><geom size=".1" mass="1"/></body>
      <body pos="0 5 0"><joint name="b" type="slide" axis="1 0 0"/><geom size=".1" mass="3"/></body>
      <body pos="0 9 0"><joint name="c" type="slide" axis="1 0 0"/><geom size=".1" mass="3"/></body>
      </worldbody><tendon><fixed name="sum" limited="true" range="-9 1"><joint joint="a" coef="1"/>
      <joint joint="b" coef="1"/></fixed></tendon></mujoco>)");
  const Result result = Solver(scene).Solve(Q{1, 0.8, 0.3});
  ASSERT_EQ(result.status, Status::kSolved) << result.reason;
  EXPECT_NEAR(result.q[0], 1 - 0.6, 1e-5);
  EXPECT_NEAR(result.q[1], 0.8 - 0.2, 1e-5);
  EXPECT_EQ(result.q[2], 0.3);
  EXPECT_NEAR(result.tendon_excess_in, 0.8, 1e-12);
}

// A cart that must leave a wall by 0.2 drags another along by a string that is taut.
TEST(TendonLimitsTest, ATreeIsDraggedAlong) {
  const Scene scene = Holding(R"(<mujoco><worldbody>
      <geom type="plane" size="9 9 1" zaxis="1 0 0"/>
      <body><joint type="slide" axis="1 0 0"/><geom size=".1" mass="1"/><site name="a"/></body>
      <body pos="-.6 0 2"><joint type="slide" axis="1 0 0" range="0 9" limited="true"/>
        <geom size=".1" mass="2" contype="0" conaffinity="0"/><site name="b"/></body></worldbody>
      <tendon><spatial limited="true" range="0 2.1"><site site="a"/><site site="b"/></spatial></tendon>
      </mujoco>)");
  const double reach = std::sqrt(2.1 * 2.1 - 4.0);  // of the string along the rails
  const Result result = Solver(scene).Solve(Q{-0.1, 0.0});
  ASSERT_EQ(result.status, Status::kSolved) << result.reason;
  EXPECT_NEAR(result.q[0], 0.1, 1e-5);
  EXPECT_NEAR(result.q[1] - 0.6, 0.1 - reach, 1e-5);
}

TEST(TendonLimitsTest, RandomPosesAreBroughtInsideAndFree) {
  const Scene scene = Holding(kCables);
  Solver solver(scene);
  EqualityConstraints constraints(scene.tables());
  Random random(5);
  int outside = 0, compared = 0;
  for (int k = 0; k < 40; ++k) {
    const Q q = RandomPose(*scene.model(), random, 0.7);
    const Result result = solver.Solve(q);
    ASSERT_NE(result.status, Status::kUnsolved) << k << ": " << result.reason;
    EXPECT_LE(Excess(*scene.model(), result.q), 1e-6);
    EXPECT_NEAR(result.tendon_excess_in, Excess(*scene.model(), q), 1e-9);
    EXPECT_TRUE(Verify(scene, result.q).free);
    outside += result.tendon_excess_in > 1e-3;
    // A little before the end of the repair something is still violated.
    if (result.sigma < 1e-6) continue;
    VectorXd dq, before;
    Difference(scene.tables(), ToEigen(q), ToEigen(result.q), dq);
    Integrate(scene.tables(), ToEigen(q), 0.97 * dq, before);
    const Q shorter(before.data(), before.data() + before.size());
    if (ObjectNorm(scene, Metric::kSequential, q).Sigma(shorter) >= result.sigma) continue;
    ++compared;
    EXPECT_FALSE(Verify(scene, shorter).free) << k;
  }
  EXPECT_GT(outside, 15);
  EXPECT_GT(compared, 15);
}

TEST(TendonLimitsTest, FollowedCommandsStayInside) {
  const Scene scene = Holding(kOnAString);
  Tracker tracker(scene);
  Result result;
  int cut = 0;
  for (int k = 0; k < 400; ++k) {
    const double angle = 0.02 * k;
    const double radius = 0.8 + 0.5 * std::sin(3 * angle);
    const Q command = {radius * std::cos(angle), radius * std::sin(angle)};
    ASSERT_NE(tracker.Step(command, result), Status::kUnsolved) << k << ": " << result.reason;
    EXPECT_LE(Excess(*scene.model(), result.q), 1e-6) << k;
    cut += radius > 1.0;
  }
  EXPECT_GT(cut, 100);
}

// From outside the disc, σ = (|q| - 1)².
TEST(TendonLimitsTest, GradientsKnowThem) {
  const Scene scene = Holding(kOnAString);
  const Q q = {-3, 4};
  Solver solver(scene);
  Result result = solver.Solve(q);
  ASSERT_EQ(result.status, Status::kSolved);
  const Gradient gradient = Differentiator(scene).At(q, result);
  ASSERT_EQ(gradient.sigma.size(), 2u);
  EXPECT_NEAR(gradient.sigma[0], 2 * 4.0 * -0.6, 1e-4);
  EXPECT_NEAR(gradient.sigma[1], 2 * 4.0 * 0.8, 1e-4);
}

TEST(TendonLimitsTest, WhatCannotBeHeldIsSaid) {
  const Scene scene = Holding(R"(<mujoco><worldbody>
      <body><joint name="a" type="slide" range="0 1" limited="true"/><geom size=".1"/></body></worldbody>
      <tendon><fixed name="far" limited="true" range="2 3"><joint joint="a" coef="1"/></fixed></tendon>
      </mujoco>)");
  const Result result = Solver(scene).Solve(Q{0.5});
  EXPECT_EQ(result.status, Status::kUnsolved);
  EXPECT_EQ(result.cause, Cause::kEquality);
  EXPECT_THAT(result.reason, HasSubstr("tendon 'far'"));
  EXPECT_NEAR(result.tendon_excess, 1.0, 1e-6) << "as near as the joint comes";
}

TEST(TendonLimitsTest, FlagsOfTheModelAndMethods) {
  std::string disabled = kOnAString;
  disabled.insert(8, R"(<option><flag limit="disable"/></option>)");
  EXPECT_FALSE(Verify(Holding(disabled), Q{3, 4}).free);
  SceneOptions honour;
  honour.model_flags = true;
  const Scene honoured = Holding(disabled, honour);
  EXPECT_FALSE(honoured.HoldsTendonLimits());
  EXPECT_TRUE(Verify(honoured, Q{3, 4}).free);
  Options paper;
  paper.method = Method::kPaper;
  EXPECT_THAT(ErrorOf([&] { Solver(Holding(kOnAString), paper); }), HasSubstr("tendon limits"));
  Solver(Scene::FromString(kOnAString), paper);
}

}  // namespace
}  // namespace mjcf_pdg::test
