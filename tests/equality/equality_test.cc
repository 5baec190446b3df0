// Equality constraints are held: closed loops, couplings of joints and of tendons, welds. Every
// answer is judged by MuJoCo's own residuals, which neither the solver's acceptance nor the
// verifier reads.
#include <gmock/gmock.h>
#include <mujoco/mujoco.h>

#include <cmath>

#include "equality/equality_constraints.h"
#include "mjcf_pdg/pdg.h"
#include "tests/equality/equality_models.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

using ::testing::HasSubstr;
using Q = std::vector<double>;

// The largest of MuJoCo's residuals at q, those of a weld's rotation as half angles.
double Residual(const mjModel& model, const Q& q) {
  mjModel m = model;
  m.opt.disableflags |= mjDSBL_CONTACT | mjDSBL_LIMIT;
  const std::unique_ptr<mjData, void (*)(mjData*)> d(mj_makeData(&m), mj_deleteData);
  mju_copy(d->qpos, q.data(), static_cast<int>(m.nq));
  mj_forward(&m, d.get());
  double largest = 0.0;
  for (int i = 0; i < d->ne; ++i) largest = std::max(largest, std::abs(d->efc_pos[i]));
  return largest;
}

// Joints that close loops are inside their limits or up to a radian and a half from qpos0, free
// bodies a few centimetres and a fifth of a radian from there: most poses violate the constraints.
Q RandomPose(const mjModel& m, Random& random) {
  Q q(m.qpos0, m.qpos0 + m.nq);
  for (int j = 0; j < m.njnt; ++j) {
    if (m.jnt_type[j] == mjJNT_FREE) {
      double* pose = q.data() + m.jnt_qposadr[j];
      for (int k = 0; k < 3; ++k) pose[k] += random.Uniform(-0.05, 0.05);
      for (int k = 4; k < 7; ++k) pose[k] = random.Uniform(-0.1, 0.1);
      continue;
    }
    const bool limited = m.jnt_limited[j];
    q[m.jnt_qposadr[j]] =
        random.Uniform(limited ? m.jnt_range[2 * j] : -1.5, limited ? m.jnt_range[2 * j + 1] : 1.5);
  }
  return q;
}

struct Named {
  const char* name;
  const char* model;  // MJCF, or a file in models/loops
};

Scene SceneOf(const Named& named) {
  const std::string model = named.model;
  if (model.front() == '<') return Scene::FromString(model);
  return Scene::FromFile(std::string(MJCF_PDG_MODEL_DIR) + "/loops/" + model);
}

class EqualityTest : public ::testing::TestWithParam<Named> {
 protected:
  const Scene scene_ = SceneOf(GetParam());
};

INSTANTIATE_TEST_SUITE_P(
    Models, EqualityTest,
    ::testing::Values(Named{"ParallelJaw", kParallelJaw}, Named{"FourBar", kFourBar},
                      Named{"TwoArms", kTwoArms}, Named{"CoupledFingers", kCoupledFingers},
                      Named{"Gripper", "gripper.xml"}, Named{"Differential", "differential.xml"},
                      Named{"MimicFinger", "mimic_finger.xml"}, Named{"Stewart", "stewart.xml"},
                      Named{"Leg", "leg.xml"}),
    [](const auto& p) { return p.param.name; });

TEST_P(EqualityTest, RandomPosesAreBroughtOntoTheConstraintsAndFree) {
  Random random(11);
  Solver solver(scene_);
  int solved = 0, penetrating = 0;
  for (int k = 0; k < 40; ++k) {
    const Q q = RandomPose(*scene_.model(), random);
    const Result result = solver.Solve(q);
    ASSERT_NE(result.status, Status::kUnsolved) << k << ": " << result.reason;
    solved += result.status == Status::kSolved;
    penetrating += result.depth_in < -1e-3;
    EXPECT_LE(Residual(*scene_.model(), result.q), 1e-6);
    EXPECT_LE(result.equality_residual, 1e-6);
    EXPECT_NEAR(result.equality_residual_in, Verify(scene_, q).equality_residual, 1e-12);
    EXPECT_TRUE(Verify(scene_, result.q).free);
    EXPECT_LE(result.sigma_lower_bound, result.sigma * (1 + 1e-9));
  }
  EXPECT_GT(solved, 20);
  EXPECT_GT(penetrating, 5);
}

// From an input on the constraints no shorter motion along them is free: a little before its end
// the repair still collides. (Where a loop snaps over to its other shape, the answer is the nearest
// pose of that shape, and what lies before it is farther.)
TEST_P(EqualityTest, ALittleLessThanTheRepairStillCollides) {
  Random random(12);
  Solver solver(scene_);
  EqualityConstraints equality(scene_.tables());
  int compared = 0;
  for (int k = 0; k < 60; ++k) {
    VectorXd q = ToEigen(RandomPose(*scene_.model(), random));
    if (!equality.Project(q)) continue;
    const Q q_in(q.data(), q.data() + q.size());
    const Result result = solver.Solve(q_in);
    if (result.status != Status::kSolved || result.sigma < 1e-6) continue;
    VectorXd dq, before;
    Difference(scene_.tables(), q, ToEigen(result.q), dq);
    Integrate(scene_.tables(), q, 0.95 * dq, before);
    if (!equality.Project(before)) continue;
    const Q shorter(before.data(), before.data() + before.size());
    ObjectNorm norm(scene_, Metric::kSequential, q_in);
    if (norm.Sigma(shorter) >= result.sigma) continue;
    ++compared;
    EXPECT_FALSE(Verify(scene_, shorter).free) << k;
  }
  EXPECT_GT(compared, 3);
}

TEST_P(EqualityTest, JacobiansAreThoseOfTheResiduals) {
  Random random(13);
  EqualityConstraints equality(scene_.tables());
  constexpr double kStep = 1e-6;
  for (int k = 0; k < 10; ++k) {
    VectorXd q = ToEigen(RandomPose(*scene_.model(), random));
    equality.Project(q);  // the Jacobian of a weld is that of small residuals
    equality.Linearize(q);
    const MatrixXd jacobian = equality.jacobian();
    for (int i = 0; i < scene_.dof(); ++i) {
      VectorXd moved, dq = VectorXd::Zero(scene_.dof());
      dq[i] = kStep;
      Integrate(scene_.tables(), q, dq, moved);
      equality.Linearize(moved);
      const VectorXd ahead = equality.residual();
      Integrate(scene_.tables(), q, -dq, moved);
      equality.Linearize(moved);
      const VectorXd slope = (ahead - equality.residual()) / (2 * kStep);
      EXPECT_LT((slope - jacobian.col(i)).lpNorm<Eigen::Infinity>(), 1e-6);
    }
  }
}

// Two sliders that are coupled one to one and overlap walls on opposite sides have one way out,
// whose length is known.
TEST(EqualityCases, ACouplingSharesTheMotion) {
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody>
      <geom name="wall" type="box" size=".1 1 1"/>
      <body name="a" pos=".15 0 0"><joint name="a" type="slide" axis="1 0 0"/><geom size=".1" mass="1"/></body>
      <body name="b" pos="5 0 0"><joint name="b" type="slide" axis="1 0 0"/><geom size=".1" mass="3"/></body>
      </worldbody><equality><joint joint1="b" joint2="a"/></equality></mujoco>)");
  const Result result = Solver(scene).Solve(Q{0, 0});
  ASSERT_EQ(result.status, Status::kSolved);
  EXPECT_NEAR(result.q[0], 0.05, 2e-6);
  EXPECT_NEAR(result.q[1], 0.05, 2e-6);
  EXPECT_NEAR(result.sigma, 0.0025, 2e-7);  // without the coupling it would be a quarter of it
}

// The nearest pose on the coupling b = a from (0, 0.4), masses 1 and 3: both at 0.3.
TEST(EqualityCases, AViolatingInputGoesToTheNearestPoseThatHolds) {
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody>
      <body name="a"><joint name="a" type="slide" axis="1 0 0"/><geom size=".1" mass="1"/></body>
      <body name="b" pos="5 0 0"><joint name="b" type="slide" axis="1 0 0"/><geom size=".1" mass="3"/></body>
      </worldbody><equality><joint joint1="b" joint2="a"/></equality></mujoco>)");
  const Result result = Solver(scene).Solve(Q{0, 0.4});
  ASSERT_EQ(result.status, Status::kSolved);
  EXPECT_NEAR(result.q[0], 0.3, 1e-4);
  EXPECT_NEAR(result.q[1], 0.3, 1e-4);
  EXPECT_NEAR(result.equality_residual_in, 0.4, 1e-12);
}

// The same loop closed twice is no harder; two pins that contradict each other are said.
TEST(EqualityCases, RedundantConstraintsHoldAndContradictionsAreSaid) {
  std::string twice = kFourBar;
  const std::string pin = R"(<connect body1="coupler" body2="rocker" anchor=".5 0 0"/>)";
  twice.insert(twice.find("</equality>"), pin);
  const Scene scene = Scene::FromString(twice);
  const Result result = Solver(scene).Solve(Q{0.9, 0.1, -0.4});
  EXPECT_EQ(result.status, Status::kSolved) << result.reason;
  EXPECT_LE(Residual(*scene.model(), result.q), 1e-6);

  const Scene torn = Scene::FromString(R"(<mujoco><worldbody>
      <body name="a"><joint name="a" type="slide"/><geom size=".1"/></body></worldbody>
      <equality><joint joint1="a" polycoef=".1"/><joint name="other" joint1="a" polycoef=".2"/>
      </equality></mujoco>)");
  const Result none = Solver(torn).Solve(Q{0});
  EXPECT_EQ(none.status, Status::kUnsolved);
  EXPECT_EQ(none.cause, Cause::kEquality);
  EXPECT_THAT(none.reason, HasSubstr("is violated by"));
}

constexpr char kDriven[] = R"(<mujoco><worldbody>
  <body name="hand" mocap="true" pos="0 0 1"/>
  <body name="tool"><joint name="z" type="slide" axis="0 0 1"/><geom size=".1"/></body></worldbody>
  <equality><connect name="drive" body1="tool" body2="hand" anchor="0 0 0"/></equality></mujoco>)";

TEST(EqualityCases, WhatJoinsAMocapBodyIsLeftOutAndSaidUnlessAllAreHeld) {
  const Scene scene = Scene::FromString(kDriven);
  EXPECT_THAT(scene.Warnings(), ::testing::ElementsAre(HasSubstr("mocap")));
  EXPECT_TRUE(scene.HeldEqualities().empty());
  EXPECT_EQ(Solver(scene).Solve(Q{0}).status, Status::kAlreadyFree);

  SceneOptions all;
  all.equality = EqualityMode::kAll;
  const Scene held = Scene::FromString(kDriven, all);
  const Result result = Solver(held).Solve(Q{0.25});
  ASSERT_EQ(result.status, Status::kSolved) << result.reason;
  EXPECT_NEAR(result.q[0], 0, 1e-6);  // the anchor of the hand is where the tool was at qpos0
}

// An evaluation is used again at the same q only while nothing else has changed.
TEST(EqualityCases, ResidualsFollowTheMocapBodyAndWhatIsActive) {
  SceneOptions all;
  all.equality = EqualityMode::kAll;
  const Scene held = Scene::FromString(kDriven, all);
  EqualityConstraints equality(held.tables());
  const VectorXd q = VectorXd::Constant(1, 0.25);
  EXPECT_NEAR(equality.Violation(q), 0.25, 1e-12);
  equality.SetMocap({{0, 0, 1.25}, {1, 0, 0, 0}});
  EXPECT_NEAR(equality.Violation(q), 0.0, 1e-12);
  equality.SetMocap({{0, 0, 1.5}, {1, 0, 0, 0}});
  EXPECT_NEAR(equality.Violation(q), 0.25, 1e-12);
  const mjtBool inactive[] = {0}, active[] = {1};
  equality.SetActive(inactive);
  EXPECT_EQ(equality.Violation(q), 0.0);
  equality.SetActive(active);
  EXPECT_NEAR(equality.Violation(q), 0.25, 1e-12);
}

TEST(EqualityCases, IgnoredMeansIgnoredAndInactiveIsNotHeld) {
  SceneOptions ignore;
  ignore.equality = EqualityMode::kIgnore;
  const Scene scene = Scene::FromString(kParallelJaw, ignore);
  EXPECT_EQ(Solver(scene).Solve(Q{-0.4, 0.2, 0, 0.02, 0.06}).status, Status::kAlreadyFree);
  EXPECT_EQ(Verify(scene, Q{-0.4, 0.2, 0, 0.02, 0.06}).equality_residual, 0.0);
}

// Which constraints are active is a matter of the data.
TEST(EqualityCases, TheDataSaysWhatIsActive) {
  const Scene scene = Scene::FromString(kParallelJaw);
  const std::unique_ptr<mjData, void (*)(mjData*)> d(mj_makeData(scene.model()), mj_deleteData);
  const Q q = {-0.4, 0.2, 0, 0.02, 0.06};
  std::copy(q.begin(), q.end(), d->qpos);
  Solver solver(scene);
  Result result;
  EXPECT_EQ(solver.Solve(d.get(), result), Status::kSolved);
  EXPECT_NEAR(result.q[3], result.q[4], 1e-6);
  d->eq_active[0] = false;
  EXPECT_EQ(solver.Solve(d.get(), result), Status::kAlreadyFree);
}

TEST(EqualityCases, MethodPaperRefusesThem) {
  Options options;
  options.method = Method::kPaper;
  EXPECT_THAT(ErrorOf([&] { Solver(Scene::FromString(kFourBar), options); }), HasSubstr("'pin'"));
}

}  // namespace
}  // namespace mjcf_pdg::test
