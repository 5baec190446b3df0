// What limit_reach.h promises, by looking at every joint at many poses of the motion.
#include <algorithm>
#include <cmath>

#include "ccd/limit_reach.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

using Eigen::Quaterniond;

class LimitReachContractTest : public MujocoTest {};

// Joints of all kinds, with and without limits and with frozen ones between them, so that indices
// of joints, of qpos and of dq differ.
Scene JointsScene() {
  SceneOptions options;
  options.fixed = {"still"};
  return Scene::FromString(R"(<mujoco><compiler angle="radian" autolimits="true"/><worldbody>
    <body><freejoint/><geom size=".1"/></body>
    <body name="still" pos="0 1 0"><joint type="hinge" range="-1 1"/><geom size=".1"/></body>
    <body pos="1 0 0"><joint type="hinge"/><geom size=".1"/>
      <body pos=".3 0 0"><joint type="slide" range="-.3 .5"/><geom size=".1"/>
        <body pos=".3 0 0"><joint type="ball" range="0 1.2"/><geom size=".1"/>
          <body pos=".3 0 0"><joint type="hinge" range="-2 .7"/><geom size=".1"/>
            <body pos=".3 0 0"><joint type="ball"/><geom size=".1"/>
              <body pos=".3 0 0"><joint type="ball" range="0 2.9"/><geom size=".1"/>
    </body></body></body></body></body></body></worldbody></mujoco>)",
                           options);
}

// How far a joint is outside its limits; negative inside.
double Excess(const JointEntry& joint, const VectorXd& q) {
  if (!joint.limited) return -1.0;
  if (joint.type != mjJNT_BALL) return std::max(joint.lo - q[joint.qadr], q[joint.qadr] - joint.hi);
  const Quaterniond turn = QuatAt(q, joint.qadr);
  return Eigen::AngleAxisd(turn.w() < 0.0 ? Quaterniond(-turn.coeffs()) : turn).angle() - joint.hi;
}

double Largest(const SceneTables& tables, const VectorXd& q) {
  double largest = -1.0;
  for (const JointEntry& joint : tables.joints) largest = std::max(largest, Excess(joint, q));
  return largest;
}

VectorXd At(const SceneTables& tables, const VectorXd& q0, const VectorXd& dq, double t) {
  VectorXd q;
  Integrate(tables, q0, t * dq, q);
  return q;
}

TEST_F(LimitReachContractTest, TheMotionKeepsAllLimitsUpToThereAndNoFarther) {
  const Scene scene = JointsScene();
  const SceneTables& tables = scene.tables();
  ASSERT_LT(tables.joints.size(), static_cast<std::size_t>(scene.model()->njnt));
  Random rng(1);
  std::vector<int> ends(tables.joints.size() + 1, 0);  // the last: none
  for (int trial = 0; trial < 3000; ++trial) {
    VectorXd q0 = RandomConfiguration(scene, rng);
    for (const JointEntry& joint : tables.joints) {  // rotations of either sign and any length
      if (joint.type == mjJNT_BALL) q0.segment<4>(joint.qadr) *= rng.Uniform(-2.0, 2.0);
    }
    ASSERT_LE(Largest(tables, q0), 1e-12);
    const VectorXd dq = rng.Uniform(0.0, 2.0) * rng.Normals(tables.n);
    int joint = -2;
    const double reach = LimitReach(tables, q0, dq, 1e-7, joint);
    ASSERT_GE(reach, 0.0);
    for (int k = 0; k <= 40; ++k) {
      ASSERT_LE(Largest(tables, At(tables, q0, dq, reach * k / 40)), 2e-9) << trial;
    }
    ++ends[joint < 0 ? ends.size() - 1 : joint];
    if (joint < 0) {
      EXPECT_EQ(reach, 1.0);
      continue;
    }
    EXPECT_LT(reach, 1.0);
    EXPECT_NEAR(Excess(tables.joints[joint], At(tables, q0, dq, reach)), 0.0, 2e-9) << trial;
    EXPECT_GT(Excess(tables.joints[joint], At(tables, q0, dq, reach + 1e-4)), 1e-9) << trial;
  }
  for (std::size_t j = 0; j < tables.joints.size(); ++j) {
    EXPECT_EQ(ends[j] > 100, tables.joints[j].limited) << j;
  }
  EXPECT_GT(ends.back(), 100);
}

TEST_F(LimitReachContractTest, AnEndWithinTheSlackIsNotOutside) {
  const Scene scene = JointsScene();
  const SceneTables& tables = scene.tables();
  VectorXd rest(scene.nq());
  mju_copy(rest.data(), scene.model()->qpos0, scene.nq());
  int limited = 0;
  for (int j = 0; j < static_cast<int>(tables.joints.size()); ++j) {
    const JointEntry& entry = tables.joints[j];
    if (!entry.limited) continue;
    ++limited;
    const double slack = entry.type == mjJNT_SLIDE ? 1e-4 : 1e-9;
    for (const bool to_high : {true, false}) {
      const double way = to_high || entry.type == mjJNT_BALL ? entry.hi : entry.lo;
      for (const double share : {-1.0, 0.4, 1.1}) {
        VectorXd dq = VectorXd::Zero(tables.n);
        dq[entry.col] = way + share * std::copysign(slack, way);
        int joint = -2;
        const double reach = LimitReach(tables, rest, dq, 1e-4, joint);
        EXPECT_EQ(joint, share > 1.0 ? j : -1) << j << " " << share;
        EXPECT_EQ(reach < 1.0, share > 1.0) << j << " " << share;
        // From its limit it goes no farther, but back.
        const VectorXd end = At(tables, rest, dq * (way / dq[entry.col]), 1.0);
        dq[entry.col] = std::copysign(0.1, way);
        EXPECT_NEAR(LimitReach(tables, end, dq, 1e-4, joint), 0.0, 1e-7) << j;
        EXPECT_EQ(joint, j);
        EXPECT_EQ(LimitReach(tables, end, -dq, 1e-4, joint), 1.0) << j;
        EXPECT_EQ(joint, -1);
      }
    }
  }
  EXPECT_EQ(limited, 4);
}

TEST_F(LimitReachContractTest, TheJointOutsideLimitsIsTheFarthestOfAll) {
  const Scene scene = JointsScene();
  const SceneTables& tables = scene.tables();
  Random rng(2);
  int outside = 0, inside = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    const VectorXd q = At(tables, RandomConfiguration(scene, rng),
                          rng.Uniform(0.0, 0.5) * rng.Normals(tables.n), 1.0);
    const double largest = Largest(tables, q), slack = rng.Uniform(0.0, 0.3);
    if (std::abs(largest - slack) < 1e-9) continue;
    const int joint = JointOutsideLimits(tables, q, slack);
    EXPECT_EQ(joint >= 0, largest > slack);
    ++(joint >= 0 ? outside : inside);
    if (joint >= 0) {
      EXPECT_NEAR(Excess(tables.joints[joint], q), largest, 1e-12);
    }
  }
  EXPECT_GT(outside, 100);
  EXPECT_GT(inside, 100);
}

}  // namespace
}  // namespace mjcf_pdg::test
