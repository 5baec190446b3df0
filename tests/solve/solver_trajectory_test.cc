// Consecutive frames, and what must stay as it is meanwhile: frozen joints, obstacles that move.
#include <cmath>

#include "mjcf_pdg/pdg.h"
#include "model/kinematics.h"
#include "tests/support/mesh_shapes.h"
#include "tests/support/test_support.h"
#include "tests/support/witness.h"

namespace mjcf_pdg::test {
namespace {

using Eigen::Vector3d;
using Q = std::vector<double>;

class SolverTrajectoryTest : public MujocoTest {};

std::string World(const std::string& inside, const std::string& assets = "") {
  return "<mujoco>" + assets + "<worldbody>" + inside + "</worldbody></mujoco>";
}

// A slab with a knob on top, no convex mesh: 1 m thick along x, 2 m along y and z.
MeshShape Slab() {
  MeshShape knob = BoxMesh({0.1, 0.1, 0.2});
  knob.Move(Eigen::Matrix3d::Identity(), {0, 0, 1});
  return BoxMesh({0.5, 1, 1}).Append(knob);
}

TEST_F(SolverTrajectoryTest, FrozenJointsStayBitForBit) {
  SceneOptions wrist_and_reach;
  wrist_and_reach.movable = {"fore"};
  const Scene scene = Scene::FromString(ArmXml(), wrist_and_reach);
  const Q q_in = {0.1234567891, 0.3000000001, 0.19, 0.7};
  ASSERT_LT(Witness(scene).Least(q_in), -0.01);
  const Result result = Solver(scene).Solve(q_in);
  ASSERT_EQ(result.status, Status::kSolved) << result.reason;
  EXPECT_EQ(result.q[0], q_in[0]);
  EXPECT_EQ(result.q[1], q_in[1]);
  EXPECT_NE(result.q[2], q_in[2]);
}

TEST_F(SolverTrajectoryTest, FrozenQuaternionsStayAsTheyWereGiven) {
  SceneOptions only;
  only.movable = {"s"};
  const Scene scene = Scene::FromString(
      World("<body name='f'><freejoint/><geom size='.1'/></body>"
            "<body name='s'><joint type='slide' axis='1 0 0'/><geom size='.1'/></body>"),
      only);
  const Q q_in = {3, 0, 0, 2, 0, 0, 0.1, 2.9};
  const Result result = Solver(scene).Solve(q_in);
  ASSERT_EQ(result.status, Status::kSolved) << result.reason;
  for (int k = 0; k < 7; ++k) EXPECT_EQ(result.q[k], q_in[k]);
}

// Two boxes on rails, only the second may move.
Scene BoxesOnRails() {
  SceneOptions second;
  second.movable = {"b"};
  return Scene::FromString(World("<body name='a'><joint type='slide' axis='1 0 0'/><geom "
                                 "type='box' size='.5 .5 .5'/></body>"
                                 "<body name='b'><joint type='slide' axis='0 1 0'/><geom "
                                 "type='box' size='.1 .1 .1'/></body>"),
                           second);
}

TEST_F(SolverTrajectoryTest, EarlierFramesDoNotMoveWhatIsFrozen) {
  const Scene scene = BoxesOnRails();
  for (const Method method : {Method::kAuto, Method::kPaper}) {
    Options options;
    options.method = method;
    options.trajectory = true;
    Solver solver(scene, options);
    EXPECT_EQ(solver.Solve({5, 0}).status, Status::kAlreadyFree);
    for (const double x : {0.1, 0.2, -0.3}) {
      const Result result = solver.Solve({x, 0});
      ASSERT_EQ(result.status, Status::kSolved) << result.reason;
      EXPECT_EQ(result.q[0], x);
      EXPECT_NEAR(std::abs(result.q[1]), 0.6, 1e-5);
      EXPECT_LE(result.sigma_lower_bound, result.sigma);
    }
  }
}

TEST_F(SolverTrajectoryTest, AHintDoesNotMoveWhatIsFrozen) {
  const Result result = Solver(BoxesOnRails()).Solve({0, 0}, Q{5, 0});
  ASSERT_EQ(result.status, Status::kSolved) << result.reason;
  EXPECT_EQ(result.q[0], 0.0);
  EXPECT_LE(result.sigma_lower_bound, result.sigma);
}

// A trajectory whose obstacle moves, too: what was free stays a start, if it still is.
TEST_F(SolverTrajectoryTest, MotionCoherenceOutlivesMovingObstacles) {
  const Scene scene = Scene::FromString(World(R"(
      <body name="tray" mocap="true" pos="0 0 -1"><geom type="box" size=".5 .5 .05"/></body>
      <body><freejoint/><geom type="box" size=".1 .1 .1"/></body>)"));
  Options options;
  options.method = Method::kPaper;
  options.trajectory = true;
  Solver solver(scene, options);
  std::vector<std::string> starts;
  for (const double z : {-0.100, -0.101, -0.102, 0.1}) {
    solver.SetMocap({0, 0, z}, {});
    const Result result = solver.Solve({0, 0, 0, 1, 0, 0, 0});
    ASSERT_EQ(result.status, Status::kSolved) << result.reason;
    starts.push_back(result.start);
  }
  EXPECT_EQ(starts, (std::vector<std::string>{"centroid_difference", "motion_coherence",
                                              "motion_coherence", "centroid_difference"}));
}

// Exact meshes: a frame may end where the last one's answer leads if a free body is all that moves.
TEST_F(SolverTrajectoryTest, OnlyFreeBodiesFollow) {
  Options options;
  options.trajectory = true;
  for (const std::string joint : {"<freejoint/>", "<joint type='slide' axis='1 0 0'/>"}) {
    const Scene scene =
        Scene::FromString(World("<body><geom type='mesh' mesh='slab'/></body><body>" + joint +
                                    "<geom type='box' size='.1 .1 .1'/></body>",
                                "<asset>" + MeshXml("slab", Slab()) + "</asset>"),
                          Exact());
    Solver solver(scene, options);
    Q q = scene.DefaultQpos();
    q[0] = 0.1;
    for (int frame = 0; frame < 3; ++frame) {
      const Result result = solver.Solve(q);
      ASSERT_EQ(result.status, Status::kSolved) << result.reason;
      const bool follows = frame > 0 && joint == "<freejoint/>";
      EXPECT_EQ(result.start == "motion_coherence" && result.stats.starts == 1, follows) << joint;
      EXPECT_NEAR(result.q[0], 0.6, 1e-5);
    }
  }
}

TEST_F(SolverTrajectoryTest, AnEarlierFrameIsNotTheOnlyStart) {
  const Scene scene = Scene::FromString(
      World("<body><geom type='mesh' mesh='slab'/></body>"
            "<body><joint type='slide' axis='1 0 0'/><geom type='box' size='.1 .1 .1'/></body>",
            "<asset>" + MeshXml("slab", Slab()) + "</asset>"),
      Exact());
  Options options;
  options.effort = Effort::kFast;
  options.trajectory = true;
  options.without = {"pair_by_pair", "constrained_translation"};  // but for the direct one
  Solver solver(scene, options);
  for (const double x : {0.1, -0.1, 0.2}) {
    EXPECT_NEAR(solver.Solve({x}).q[0], std::copysign(0.6, x), 1e-5);
  }
}

TEST_F(SolverTrajectoryTest, NoFrameFollowsWhereAnObstacleMoved) {
  const Scene scene =
      Scene::FromString(World("<body mocap='true'><geom type='mesh' mesh='slab'/></body>"
                              "<body><freejoint/><geom type='box' size='.1 .1 .1'/></body>",
                              "<asset>" + MeshXml("slab", Slab()) + "</asset>"),
                        Exact());
  Options options;
  options.trajectory = true;
  Solver solver(scene, options);
  for (const double x : {-0.05, 0.1, 0.2}) {  // the short way out changes sides
    solver.SetMocap({x, 0, 0}, {});
    const Result result = solver.Solve(FreePose({0, 0, 0}));
    ASSERT_EQ(result.status, Status::kSolved) << result.reason;
    EXPECT_NEAR(std::sqrt(result.sigma), 0.6 - std::abs(x), 1e-4);
  }
}

}  // namespace
}  // namespace mjcf_pdg::test
