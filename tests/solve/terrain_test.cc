// Solves and motions over height fields: closed forms, a plane to compare with, scales.
#include "tests/support/terrain.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstdio>

#include "mjcf_pdg/pdg.h"
#include "model/kinematics.h"
#include "tests/support/scaled_model.h"

namespace mjcf_pdg::test {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

class TerrainTest : public MujocoTest {};

using Q = std::vector<double>;

Q At(const Vector3d& p, const Quaterniond& turn = Quaterniond::Identity()) {
  return {p.x(), p.y(), p.z(), turn.w(), turn.x(), turn.y(), turn.z()};
}

Field Slope(double slope) {
  return MakeField(30, 30, 2, 2, [&](double x, double) { return slope * x; });
}

Field Stairs() {
  return MakeField(3, 101, 0.5, 0.5,
                   [](double x, double) { return 0.1 * std::floor((x + 0.5 + 1e-9) / 0.2); });
}

Field Waves() {
  return MakeField(40, 40, 1, 1, [](double x, double y) {
    return 0.05 * std::sin(9 * x) * std::cos(7 * y) + 0.03 * x;
  });
}

void ExpectSolved(const Result& result) {
  ASSERT_EQ(result.status, Status::kSolved) << result.reason;
  EXPECT_TRUE(result.certified);
  EXPECT_LE(result.sigma_lower_bound, result.sigma);
}

TEST_F(TerrainTest, ASphereInASlopeGoesOutAlongItsNormal) {
  const double slope = 0.4, deep = 0.06;
  const Scene scene = Scene::FromString(FieldXml(Slope(slope), {mjGEOM_SPHERE, {0.1, 0, 0}}));
  const Vector3d n = Vector3d(-slope, 0, 1).normalized();
  const Vector3d on_slope(0.21, 0.13, slope * 2.21);
  const Result result = Solver(scene).Solve(At(on_slope + (0.1 - deep) * n));
  ExpectSolved(result);
  EXPECT_NEAR(std::sqrt(result.sigma), deep, 2e-6);
  EXPECT_NEAR(result.depth_in, -deep, 1e-8);
  const Vector3d moved(result.q[0], result.q[1], result.q[2]);
  EXPECT_NEAR((moved - on_slope - 0.1 * n).norm(), 0.0, 2e-3);
}

TEST_F(TerrainTest, ABoxInStairsGoesTheNearerWay) {
  const Scene scene = Scene::FromString(FieldXml(Stairs(), {mjGEOM_BOX, {0.05, 0.1, 0.05}}));
  Solver solver(scene);
  // 8 cm deep in the next step, but 2 cm behind its edge: back; and the other way round.
  const Result back = solver.Solve(At({-0.11 - 0.05 + 0.02, 0, 0.12 + 0.05}));
  ExpectSolved(back);
  // Without turning it would be (0.02 - 0.002) / √1.01.
  EXPECT_LT(std::sqrt(back.sigma), 0.018);
  EXPECT_LT(back.q[0], -0.14 - 0.012);
  EXPECT_NEAR(back.q[2], 0.17, 0.005);
  const Result up = solver.Solve(At({-0.03, 0, 0.18 + 0.05}));
  ExpectSolved(up);
  EXPECT_NEAR(std::sqrt(up.sigma), 0.02, 2e-6);
}

// The fix, made a little smaller, collides again; nothing near it is free and nearer.
TEST_F(TerrainTest, AnswersTouchAndNothingCloseByIsNearer) {
  Random rng(12);
  const Field field = Waves();
  int solved = 0;
  for (int trial = 0; trial < 30; ++trial) {
    const int type = std::array{mjGEOM_CAPSULE, mjGEOM_BOX,       mjGEOM_CYLINDER,
                                mjGEOM_MESH,    mjGEOM_ELLIPSOID, mjGEOM_SPHERE}[trial % 6];
    const Scene scene = Scene::FromString(FieldXml(field, RandomShape(type, rng)));
    const Q q_in = At({rng.Uniform(-0.5, 0.5), rng.Uniform(-0.5, 0.5), rng.Uniform(0.05, 0.2)},
                      rng.UnitQuat());
    Solver solver(scene);
    const Result result = solver.Solve(q_in);
    if (result.status == Status::kAlreadyFree) continue;
    ExpectSolved(result);
    ++solved;
    ObjectNorm norm(scene, Metric::kSequential, q_in);
    Q less = q_in;
    for (int i = 0; i < 3; ++i) less[i] += 0.99 * (result.q[i] - q_in[i]);
    Eigen::Vector4d from(q_in.data() + 3), to(result.q.data() + 3);
    if (from.dot(to) < 0) to = -to;
    const Eigen::Vector4d turn = (from + 0.99 * (to - from)).normalized();
    std::copy(turn.data(), turn.data() + 4, less.begin() + 3);
    EXPECT_FALSE(Verify(scene, less).free) << Join(ToEigen(q_in));
    for (int k = 0; k < 200; ++k) {
      VectorXd near, step = VectorXd::Zero(6);
      step.head<3>() = 0.2 * std::sqrt(result.sigma) * rng.InBox(1.0);
      step.tail<3>() = 2.0 * std::sqrt(result.sigma) * rng.InBox(1.0);
      Integrate(scene.tables(), ToEigen(result.q), step, near);
      if (norm.Sigma(ToVector(near)) > 0.97 * result.sigma) continue;
      EXPECT_FALSE(solver.IsFree(ToVector(near))) << TypeName(type) << " " << Join(ToEigen(q_in));
    }
  }
  EXPECT_GT(solved, 15);
}

TEST_F(TerrainTest, AFlatFieldIsSolvedAsAPlaneIs) {
  const std::string robot = R"(<body pos="0 0 .25"><freejoint/><geom type="box" size=".2 .1 .05"/>
      <body pos=".2 .1 0"><joint axis="0 1 0"/><geom type="capsule" size=".03"
      fromto=".05 .05 0 .05 .05 -.3"/></body><body pos="-.2 -.1 0"><joint axis="1 0 0"/><geom
      type="capsule" size=".03" fromto="-.05 -.05 0 -.05 -.05 -.3"/></body></body>)";
  const Scene plane = Scene::FromString("<mujoco><worldbody><geom type='plane' size='0 0 1'/>" +
                                        robot + "</worldbody></mujoco>");
  const Scene field = Scene::FromString(
      "<mujoco><asset><hfield name='flat' nrow='40' ncol='40' size='4 4 1 1'/></asset><worldbody>"
      "<geom type='hfield' hfield='flat'/>" +
      robot + "</worldbody></mujoco>");
  Random rng(8);
  int same = 0, compared = 0;
  for (int trial = 0; trial < 40; ++trial) {
    const Q q = ToVector(RandomConfiguration(plane, rng, 0.15));
    const Result a = Solver(plane).Solve(q), b = Solver(field).Solve(q);
    ASSERT_EQ(a.status == Status::kAlreadyFree, b.status == Status::kAlreadyFree);
    if (a.status == Status::kAlreadyFree) continue;
    ExpectSolved(a);
    ExpectSolved(b);
    ++compared;
    same += b.sigma < 1.001 * a.sigma;
    EXPECT_GT(b.sigma, (1.0 - 1e-3) * a.sigma_lower_bound);
  }
  EXPECT_GT(compared, 20);
  EXPECT_GE(same, 0.95 * compared);
}

TEST_F(TerrainTest, AThousandTimesSmallerOrLargerIsTheSame) {
  Random rng(6);
  const Scene scene = Scene::FromString(FieldXml(Waves(), {mjGEOM_BOX, {0.1, 0.07, 0.05}}));
  for (int trial = 0; trial < 8; ++trial) {
    const Q q = At({rng.Uniform(-0.5, 0.5), rng.Uniform(-0.5, 0.5), 0.08}, rng.UnitQuat());
    const Result one = Solver(scene).Solve(q);
    for (const double scale : {std::ldexp(1.0, -10), std::ldexp(1.0, 10)}) {
      const ModelPtr model = Scaled(*scene.model(), scale);
      const Scene scaled = Scene::FromModel(model.get());
      Options options;
      options.tolerance *= scale;
      const Result other = Solver(scaled, options).Solve(Scaled(*scene.model(), q, scale));
      EXPECT_EQ(one.status, other.status) << other.reason;
      EXPECT_NEAR(other.sigma / (scale * scale), one.sigma, 1e-3 * one.sigma);
    }
  }
}

TEST_F(TerrainTest, HeightsOutsideTheFieldsBoundsAreRefused) {
  const ModelPtr model = LoadModel(FieldXml(Waves(), {mjGEOM_SPHERE, {0.1, 0, 0}}));
  for (const float bad : {1.5f, -0.1f, std::nanf("")}) {
    model->hfield_data[7] = bad;
    EXPECT_EQ(ErrorOf([&] { Scene::FromModel(model.get()); }),
              "height field 'field' has a height that is not between 0 and 1 (hfield_data)");
  }
}

// ---- Motions ----

TEST_F(TerrainTest, MotionsAreProvenFreeAndStopAtTheSurface) {
  const Scene scene = Scene::FromString(FieldXml(Waves(), {mjGEOM_BOX, {0.1, 0.07, 0.05}}));
  Random rng(14);
  int free = 0, stopped = 0;
  for (int trial = 0; trial < 40; ++trial) {
    const Q q0 =
        At({rng.Uniform(-0.7, 0.7), rng.Uniform(-0.7, 0.7), rng.Uniform(0.2, 0.4)}, rng.UnitQuat());
    const Q q1 =
        At({rng.Uniform(-0.7, 0.7), rng.Uniform(-0.7, 0.7), rng.Uniform(0.1, 0.3)}, rng.UnitQuat());
    const Motion motion = CheckMotion(scene, q0, q1);
    if (motion.outcome == MotionOutcome::kStartInCollision) continue;
    EXPECT_TRUE(motion.certified);
    EXPECT_TRUE(Verify(scene, motion.q).free);
    VectorXd dq, q;
    Difference(scene.tables(), ToEigen(q0), ToEigen(q1), dq);
    for (int k = 0; k <= 50; ++k) {  // dense sampling of what is called free
      Integrate(scene.tables(), ToEigen(q0), motion.t * k / 50.0 * dq, q);
      EXPECT_TRUE(Verify(scene, ToVector(q)).free);
    }
    if (motion.outcome == MotionOutcome::kFree) {
      ++free;
    } else {
      ++stopped;
      EXPECT_EQ(motion.outcome, MotionOutcome::kContact);
      EXPECT_LT(Verify(scene, motion.q).min_distance, 1e-4);
    }
  }
  EXPECT_GT(free, 8);
  EXPECT_GT(stopped, 8);
}

TEST_F(TerrainTest, ABoxSlidesOverAFlatFieldProven) {
  Field flat = Slope(0.0);
  flat.heights[0] = 1e-9;
  const Scene scene = Scene::FromString(FieldXml(flat, {mjGEOM_BOX, {0.1, 0.1, 0.1}}));
  const Motion slide = CheckMotion(scene, At({-0.5, 0, 0.1}), At({0.5, 0.3, 0.1}));
  EXPECT_EQ(slide.outcome, MotionOutcome::kFree);
  EXPECT_TRUE(slide.certified);
}

}  // namespace
}  // namespace mjcf_pdg::test
