#include "model/kinematics.h"

#include <cmath>

#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

class KinematicsTest : public MujocoTest {
 protected:
  const std::vector<std::string> scenes_ = {ArmXml(), BallChainXml(false), TwoTreesXml(),
                                            OffCentreXml()};
  Random rng_{21};
};

// MuJoCo's functions do the same arithmetic; only the order of normalizations differs.
constexpr double kRoundOff = 1e-13;

TEST_F(KinematicsTest, IntegrateIsMuJoCosWhenEverythingMoves) {
  for (const std::string& xml : scenes_) {
    const Scene scene = Scene::FromString(xml);
    for (int trial = 0; trial < 50; ++trial) {
      const VectorXd q = RandomConfiguration(scene, rng_), dq = 2.0 * rng_.Normals(scene.dof());
      VectorXd out, expected = q;
      Integrate(scene.tables(), q, dq, out);
      mj_integratePos(scene.model(), expected.data(), dq.data(), 1.0);
      EXPECT_LT((out - expected).lpNorm<Eigen::Infinity>(), kRoundOff);
    }
  }
}

TEST_F(KinematicsTest, DifferenceIsMuJoCosWhenEverythingMoves) {
  for (const std::string& xml : scenes_) {
    const Scene scene = Scene::FromString(xml);
    for (int trial = 0; trial < 50; ++trial) {
      const VectorXd from = RandomConfiguration(scene, rng_), to = RandomConfiguration(scene, rng_);
      VectorXd dq, expected(scene.dof());
      Difference(scene.tables(), from, to, dq);
      mj_differentiatePos(scene.model(), expected.data(), 1.0, from.data(), to.data());
      EXPECT_LT((dq - expected).lpNorm<Eigen::Infinity>(), kRoundOff);
    }
  }
}

TEST_F(KinematicsTest, IntegratingADifferenceArrives) {
  for (const std::string& xml : scenes_) {
    const Scene scene = Scene::FromString(xml);
    const SceneTables& tables = scene.tables();
    for (int trial = 0; trial < 50; ++trial) {
      const VectorXd from = RandomConfiguration(scene, rng_), to = RandomConfiguration(scene, rng_);
      VectorXd dq, out, back;
      Difference(tables, from, to, dq);
      Integrate(tables, from, dq, out);
      Difference(tables, out, to, back);  // q and -q are the same rotation
      EXPECT_LT(back.lpNorm<Eigen::Infinity>(), 1e-7) << Join(from) << "\n" << Join(to);
      Difference(tables, from, from, dq);
      EXPECT_EQ(dq.norm(), 0.0);
    }
  }
}

TEST_F(KinematicsTest, DifferenceUndoesIntegrateWithinHalfATurn) {
  for (const std::string& xml : scenes_) {
    const Scene scene = Scene::FromString(xml);
    for (int trial = 0; trial < 50; ++trial) {
      const VectorXd q = RandomConfiguration(scene, rng_);
      VectorXd dq = rng_.Normals(scene.dof()), out, back;
      dq *= rng_.Uniform(0.0, 3.0) / dq.norm();
      Integrate(scene.tables(), q, dq, out);
      Difference(scene.tables(), q, out, back);
      EXPECT_LT((back - dq).lpNorm<Eigen::Infinity>(), 1e-12);
    }
  }
}

TEST_F(KinematicsTest, FrozenJointsStayBitForBit) {
  const Scene all = Scene::FromString(TwoTreesXml());
  const Scene some = Scene::FromModel(all.model(), {.movable = {"b"}, .root = {}});
  const VectorXd q = 1.7 * RandomConfiguration(all, rng_);  // quaternions not unit on purpose
  VectorXd out;
  Integrate(some.tables(), q, VectorXd::Ones(some.dof()), out);
  EXPECT_EQ(out.head(8), q.head(8));
  EXPECT_NE(out[8], q[8]);
}

TEST_F(KinematicsTest, OutputMayBeTheInput) {
  const Scene scene = Scene::FromString(OffCentreXml());
  VectorXd q = RandomConfiguration(scene, rng_), out;
  const VectorXd dq = rng_.Normals(scene.dof());
  Integrate(scene.tables(), q, dq, out);
  Integrate(scene.tables(), q, dq, q);
  EXPECT_EQ(q, out);
}

TEST_F(KinematicsTest, UnnormalizedQuaternionsMeanTheirRotation) {
  const Scene scene = Scene::FromString(TwoTreesXml());
  const VectorXd q = RandomConfiguration(scene, rng_), to = RandomConfiguration(scene, rng_);
  VectorXd scaled = q;
  for (const int address : {3, 11, 15}) scaled.segment<4>(address) *= 2.5;
  VectorXd from_q, from_scaled;
  Difference(scene.tables(), q, to, from_q);
  Difference(scene.tables(), scaled, to, from_scaled);
  EXPECT_LT((from_q - from_scaled).norm(), 1e-12);
  EXPECT_LT((Normalized(scene.tables(), scaled) - q).norm(), 1e-14);
  VectorXd moved;
  Integrate(scene.tables(), scaled, from_scaled, moved);
  for (const int address : {3, 11, 15}) EXPECT_NEAR(moved.segment<4>(address).norm(), 1, 1e-15);
}

TEST_F(KinematicsTest, WholeTurnsAreMadeIntoTheLimitsAndTakenBack) {
  const Scene scene = Scene::FromString(
      "<mujoco><compiler angle='radian' autolimits='true'/><worldbody><body>"
      "<joint axis='0 0 1' range='-1 2'/><joint axis='0 1 0'/><joint type='slide' range='-1 2'/>"
      "<geom size='.1'/></body></worldbody></mujoco>");
  auto turned = [&](double angle) {
    VectorXd q = Vector3d(angle, 9.0, 3.0);
    TurnInsideLimits(scene.tables(), q);
    EXPECT_EQ(q[1], 9.0);
    EXPECT_EQ(q[2], 2.0);
    return q[0];
  };
  EXPECT_EQ(turned(1.5), 1.5);
  EXPECT_NEAR(turned(1.5 + 6.0 * mjPI), 1.5, 1e-12);
  EXPECT_NEAR(turned(-0.5 - 2.0 * mjPI), -0.5, 1e-12);
  EXPECT_EQ(turned(3.0), 2.0);
  EXPECT_EQ(turned(4.5), -1.0);  // -1.78 within a turn
  EXPECT_EQ(turned(-3.0), 2.0);  // 3.28 within a turn
  EXPECT_EQ(turned(-2.0), -1.0);
  const VectorXd q_in = Vector3d(0.5, 1.0, 0.0);
  VectorXd q = Vector3d(0.5 + 2.0 * mjPI, 2.0 - 4.0 * mjPI, 7.0);
  Unwind(scene.tables(), q_in, q);
  EXPECT_LT((q - Vector3d(0.5, 2.0, 7.0)).norm(), 1e-12);
  const VectorXd outside = Vector3d(4.8, 1.0, 0.0), wanted = Vector3d(4.8 - 2.0 * mjPI, 1.0, 0.0);
  q = wanted;
  Unwind(scene.tables(), outside, q);
  EXPECT_EQ(q, wanted);
}

TEST_F(KinematicsTest, BallAngleIsTheTotalRotationOfEitherSign) {
  for (int trial = 0; trial < 100; ++trial) {
    const double angle = rng_.Uniform(0, mjPI);
    const Vector3d axis = rng_.UnitVector();
    double quat[4];
    mju_axisAngle2Quat(quat, axis.data(), angle);
    EXPECT_NEAR(BallAngle(quat), angle, 1e-13);
    for (double& entry : quat) entry *= -3.0;  // the same rotation, not unit
    EXPECT_NEAR(BallAngle(quat), angle, 1e-13);
  }
  const double identity[4] = {1, 0, 0, 0}, half_turn[4] = {0, 0, 1, 0};
  EXPECT_EQ(BallAngle(identity), 0.0);
  EXPECT_DOUBLE_EQ(BallAngle(half_turn), mjPI);
}

TEST_F(KinematicsTest, LimitExcessIsTheLargestViolationAmongMovableJoints) {
  const Scene arm = Scene::FromString(ArmXml());  // yaw ±170°, shoulder ±100°, reach -.05 .2
  VectorXd q = VectorXd::Zero(4);
  EXPECT_EQ(LimitExcess(arm.tables(), q), 0.0);
  q << 0, -100 * mjPI / 180 - 0.3, 0.25, 99;
  EXPECT_NEAR(LimitExcess(arm.tables(), q), 0.3, 1e-14);
  q[1] = 0;
  EXPECT_NEAR(LimitExcess(arm.tables(), q), 0.05, 1e-14);
  const Scene tool = Scene::FromModel(arm.model(), {.movable = {"tool"}, .root = {}});
  EXPECT_EQ(LimitExcess(tool.tables(), q), 0.0);
}

TEST_F(KinematicsTest, TwistCountsInABallJointsLimit) {
  const Scene chain = Scene::FromString(BallChainXml(true));  // 60°
  for (int trial = 0; trial < 50; ++trial) {
    VectorXd q = RandomConfiguration(chain, rng_);
    EXPECT_LE(LimitExcess(chain.tables(), q), 1e-14);
    const Vector3d axis = trial % 2 ? Vector3d(1, 0, 0) : rng_.UnitVector();
    mju_axisAngle2Quat(q.data() + 4, axis.data(), mjPI / 3 + 0.4);
    if (trial % 3 == 0) q.segment<4>(4) *= -1.0;
    EXPECT_NEAR(LimitExcess(chain.tables(), q), 0.4, 1e-12);
  }
}

TEST_F(KinematicsTest, ClampingMovesInsideAlongTheShortestWayAndNoFurther) {
  for (const Scene& scene : {Scene::FromString(BallChainXml(true)), Scene::FromString(ArmXml())}) {
    for (int trial = 0; trial < 50; ++trial) {
      VectorXd q;
      Integrate(scene.tables(), RandomConfiguration(scene, rng_), rng_.Normals(scene.dof()), q);
      if (trial % 2) q.head(4) *= -1.0;
      VectorXd clamped = q, dq, again;
      ClampToLimits(scene.tables(), clamped);
      EXPECT_LT(LimitExcess(scene.tables(), clamped), 1e-12);
      Difference(scene.tables(), q, clamped, dq);
      // Joint by joint, the way moved is the violation.
      for (const JointEntry& joint : scene.tables().joints) {
        double excess = 0.0;
        if (joint.limited && joint.type == mjJNT_BALL) {
          excess = std::max(0.0, BallAngle(q.data() + joint.qadr) - joint.hi);
        } else if (joint.limited) {
          excess = std::max({0.0, joint.lo - q[joint.qadr], q[joint.qadr] - joint.hi});
        }
        EXPECT_NEAR(dq.segment(joint.col, joint.ndof).norm(), excess, 1e-12);
      }
      again = clamped;
      ClampToLimits(scene.tables(), again);
      EXPECT_LT((again - clamped).norm(), 1e-12);
    }
  }
}

TEST_F(KinematicsTest, PosedModelAgreesWithMjForward) {
  for (const std::string& xml : scenes_) {
    const Scene scene = Scene::FromString(xml);
    PosedModel posed(&scene.tables().query_model);
    const DataPtr d(mj_makeData(scene.model()));
    const VectorXd q = RandomConfiguration(scene, rng_);
    posed.Pose(RandomConfiguration(scene, rng_));  // a pose must not leave anything behind
    posed.Pose(q);
    mju_copy(d->qpos, q.data(), scene.nq());
    mj_forward(scene.model(), d.get());
    const int nbody = static_cast<int>(scene.model()->nbody);
    EXPECT_EQ(ToVector(Eigen::Map<VectorXd>(posed.data()->xipos, 3 * nbody)),
              ToVector(Eigen::Map<VectorXd>(d->xipos, 3 * nbody)));
    EXPECT_EQ(ToVector(Eigen::Map<VectorXd>(posed.data()->cdof, 6 * scene.model()->nv)),
              ToVector(Eigen::Map<VectorXd>(d->cdof, 6 * scene.model()->nv)));
  }
}

TEST_F(KinematicsTest, BodyJacobiansAreFiniteDifferencesOfPointsAndRotations) {
  const Scene all = Scene::FromString(OffCentreXml());
  const Scene some = Scene::FromModel(all.model(), {.movable = {"arm"}, .root = {}});
  for (const Scene* scene : {&all, &some}) {
    const SceneTables& tables = scene->tables();
    PosedModel posed(&tables.query_model);
    const int body = mj_name2id(scene->model(), mjOBJ_BODY, "tip");
    const VectorXd q = RandomConfiguration(*scene, rng_);
    const Vector3d p_B = rng_.InBox(0.2);
    auto point = [&](const VectorXd& at) {
      posed.Pose(at);
      return Vector3d(AsVector(posed.data()->xpos + 3 * body) +
                      AsMatrix(posed.data()->xmat + 9 * body) * p_B);
    };
    auto rotation = [&](const VectorXd& at) {
      posed.Pose(at);
      return AsMatrix(posed.data()->xmat + 9 * body);
    };
    BodyJacobians jacobians;
    const Vector3d p_W = point(q);
    const Matrix3d R = rotation(q);
    jacobians.Fill(tables, posed, body, p_W);
    constexpr double kStep = 1e-6;
    for (int i = 0; i < scene->dof(); ++i) {
      VectorXd plus, minus;
      Integrate(tables, q, kStep * VectorXd::Unit(scene->dof(), i), plus);
      Integrate(tables, q, -kStep * VectorXd::Unit(scene->dof(), i), minus);
      EXPECT_LT((jacobians.point.col(i) - (point(plus) - point(minus)) / (2 * kStep)).norm(), 1e-9);
      const Matrix3d W = (rotation(plus) - rotation(minus)) / (2 * kStep) * R.transpose();
      EXPECT_LT((jacobians.rotation.col(i) - Vector3d(W(2, 1), W(0, 2), W(1, 0))).norm(), 1e-9);
    }
  }
}

}  // namespace
}  // namespace mjcf_pdg::test
