// How a configuration is brought onto its constraints: by the least change, inside its limits, and
// never away from them.
#include <algorithm>
#include <cmath>
#include <string>

#include "equality/equality_constraints.h"
#include "tests/equality/equality_models.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

class ProjectionTest : public MujocoTest {
 protected:
  Random rng_{21};
};

// A row's size: a rotation counts as the arc at the scene's size.
VectorXd Arms(const SceneTables& tables) {
  VectorXd arms(tables.n);
  for (const JointEntry& joint : tables.joints) {
    for (int k = 0; k < joint.ndof; ++k) {
      arms[joint.col + k] = joint.Slides(k) ? 1.0 : tables.size;
    }
  }
  return arms;
}

bool NearLimit(const SceneTables& tables, const VectorXd& q) {
  return std::any_of(tables.joints.begin(), tables.joints.end(), [&q](const JointEntry& joint) {
    const double x = q[joint.qadr];
    return joint.limited && std::min(x - joint.lo, joint.hi - x) < 1e-3;
  });
}

// A slide that a hinge drives, far from the origin.
constexpr char kScrew[] = R"(<mujoco><compiler angle="radian"/><worldbody><geom size=".1"/>
    <body pos=".5 .1 0"><joint name="turn" axis="0 0 1"/><geom size=".03" pos=".1 0 0"/>
      <body pos="0 0 .2"><joint name="rise" type="slide" axis="0 0 1"/><geom size=".02"/></body>
    </body></worldbody><equality><joint joint1="rise" joint2="turn" polycoef="0 .04 .01 0 0"/>
    </equality></mujoco>)";

// Near the constraints, the change is the shortest of all that mend their linearization.
TEST_F(ProjectionTest, ItChangesTheConfigurationLeast) {
  int mended = 0;
  for (const char* xml : {kParallelJaw, kFourBar, kTwoArms, kCoupledFingers, kScrew}) {
    const Scene scene = Scene::FromString(xml);
    const SceneTables& tables = scene.tables();
    EqualityConstraints constraints(tables);
    const VectorXd arms = Arms(tables);
    for (int trial = 0; trial < 30; ++trial) {
      VectorXd on = RandomConfiguration(scene, rng_, 0.3), off, dq;
      if (!constraints.Project(on)) continue;
      Integrate(tables, on, 1e-4 * rng_.Normals(scene.dof()), off);
      if (NearLimit(tables, off)) continue;
      constraints.Linearize(off);
      const MatrixXd weighted = constraints.jacobian() * arms.cwiseInverse().asDiagonal();
      const Eigen::JacobiSVD<MatrixXd> svd(weighted, Eigen::ComputeThinU | Eigen::ComputeThinV);
      const VectorXd& values = svd.singularValues();
      if ((values.array() > 1e-9 && values.array() < 0.02).any()) continue;  // not linear enough
      const VectorXd least = arms.cwiseInverse().cwiseProduct(svd.solve(-constraints.residual()));
      if (least.norm() < 1e-5) continue;
      VectorXd q = off;
      ASSERT_TRUE(constraints.Project(q));
      EXPECT_LE(constraints.Violation(q), kEqualityTolerance);
      Difference(tables, off, q, dq);
      EXPECT_LT((dq - least).norm(), 0.02 * least.norm()) << Join(dq) << "\n" << Join(least);
      ++mended;
    }
  }
  EXPECT_GT(mended, 60);
}

// Two couplings of the same joints that contradict each other, with limits and without.
TEST_F(ProjectionTest, WhereTheyCannotHoldItComesNoFartherAway) {
  const auto model = [](const char* first, const char* second) {
    return std::string(R"(<mujoco><compiler angle="radian"/><worldbody><geom size=".1"/>
        <body pos=".5 .1 0"><joint name="a" axis="0 1 0" range="-1.2 .8"/>
          <geom size=".05" pos=".1 0 0"/>
          <body pos=".2 0 0"><joint name="b" axis="0 1 0" range="-.5 1.5"/>
            <geom size=".04" pos=".1 0 0"/>
            <body pos=".2 0 0"><joint name="c" axis="0 0 1"/><geom size=".04" pos=".1 0 0"/></body>
        </body></body></worldbody><equality>
        <joint joint1="b" joint2="a" polycoef=")") +
           first + R"("/><joint joint1="a" joint2="b" polycoef=")" + second +
           R"("/><joint joint1="c" joint2="a" polycoef="0 3 0 2 0"/></equality></mujoco>)";
  };
  int failed = 0;
  for (const std::string& xml :
       {model("0.4 1 0 0 0", "0.5 1 0 0 0"), model("0.9 0 1 0 0", "0.9 0 1 0 0"),
        model("3 0 4 0 0", "1 2 0 -1 0")}) {
    const Scene scene = Scene::FromString(xml);
    EqualityConstraints constraints(scene.tables());
    for (int trial = 0; trial < 60; ++trial) {
      VectorXd q = RandomConfiguration(scene, rng_);
      const double before = constraints.Violation(q);
      const bool holds = constraints.Project(q);
      EXPECT_EQ(holds, constraints.Violation(q) <= kEqualityTolerance);
      EXPECT_LE(constraints.Violation(q), before * (1 + 1e-9) + 1e-9);
      EXPECT_EQ(LimitExcess(scene.tables(), q), 0.0);
      failed += !holds;
    }
  }
  EXPECT_GT(failed, 60);
}

}  // namespace
}  // namespace mjcf_pdg::test
