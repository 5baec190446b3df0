// What may be asked for beside "free", and hard cases: deep, pinched, not seen by MuJoCo.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "mjcf_pdg/pdg.h"
#include "model/kinematics.h"
#include "tests/support/test_support.h"
#include "tests/support/witness.h"

namespace mjcf_pdg::test {
namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using ::testing::HasSubstr;

class SolverHardCasesTest : public MujocoTest {};

using Q = std::vector<double>;

// Everything a solved result must keep to, by other means than the solver's.
void ExpectSolved(const Scene& scene, const Q& q_in, const Result& result) {
  ASSERT_EQ(result.status, Status::kSolved) << result.reason << "\n" << Join(ToEigen(q_in));
  EXPECT_GE(Witness(scene).Least(result.q), -1.1e-6) << Join(ToEigen(q_in));
  EXPECT_LE(LimitExcess(scene.tables(), ToEigen(result.q)), 1e-9);
  EXPECT_LE(result.sigma_lower_bound, result.sigma);
  EXPECT_TRUE(result.reason.empty()) << result.reason;
}

std::string World(const std::string& inside, const std::string& assets = "") {
  return "<mujoco>" + assets + "<worldbody>" + inside + "</worldbody></mujoco>";
}

// Solves from q_in moved by noise, a few times; every answer is checked.
void ExpectAllSolved(const std::string& xml, const Q& q_in, double noise, std::uint64_t seed) {
  const Scene scene = Scene::FromString(xml);
  Solver solver(scene);
  Random rng(seed);
  for (int k = 0; k < 12; ++k) {
    VectorXd q;
    Integrate(scene.tables(), ToEigen(q_in), (k ? noise : 0.0) * rng.Normals(scene.dof()), q);
    ClampToLimits(scene.tables(), q);
    EXPECT_LT(Witness(scene).Least(ToVector(q)), -0.002);
    ExpectSolved(scene, ToVector(q), solver.Solve(ToVector(q)));
  }
}

// ---- What else may be asked for ----

// A block whose feet stand `depth` in the floor, with an arm that reaches into a wall.
std::string Standing(double depth) {
  return World(R"(<geom name="floor" type="plane" size="0 0 1"/>
      <geom name="wall" type="box" size=".05 1 1" pos=".35 0 0"/>
      <body name="torso" pos="0 0 )" +
               std::to_string(0.1 - depth) + R"("><freejoint/>
      <geom name="torso" type="box" size=".1 .1 .1"/>
      <body name="arm" pos="0 0 .2"><joint name="lift" axis="0 1 0"/>
      <geom name="arm" type="capsule" size=".02" fromto="0 0 0 .35 0 0"/></body></body>)");
}

TEST_F(SolverHardCasesTest, RestLetsAStandingRobotStandAsDeepAsItDid) {
  const Scene scene = Scene::FromString(Standing(0.0005));
  const Q q_in = scene.DefaultQpos();
  Options resting;
  resting.rest = 0.001;
  const Result rested = Solver(scene, resting).Solve(q_in), lifted = Solver(scene).Solve(q_in);
  ASSERT_EQ(rested.status, Status::kSolved) << rested.reason;
  EXPECT_GE(Witness(scene).Least(rested.q), -0.0005 - 1.1e-6);
  EXPECT_LT(Witness(scene).Least(rested.q), -0.0004);
  EXPECT_LT(rested.sigma, lifted.sigma);
  ExpectSolved(scene, q_in, lifted);
  resting.rest = 0.0004;  // not for contacts that are deeper
  ExpectSolved(scene, q_in, Solver(scene, resting).Solve(q_in));
  const Scene floor_only = Scene::FromString(World(R"(<geom type="plane" size="0 0 1"/>
      <body pos="0 0 .0996"><freejoint/><geom size=".1"/></body>)"));
  resting.rest = 0.001;
  EXPECT_EQ(Solver(floor_only, resting).Solve(floor_only.DefaultQpos()).status,
            Status::kAlreadyFree);
}

TEST_F(SolverHardCasesTest, ClearanceIsKeptFromEverything) {
  Random rng(1);
  const Scene scene = Scene::FromString(RandomRobotXml(rng));
  Options options;
  options.clearance = 0.004;
  Solver solver(scene, options);
  Witness witness(scene);
  int solved = 0;
  for (int k = 0; k < 20; ++k) {
    const Result result = solver.Solve(ToVector(RandomConfiguration(scene, rng)));
    if (result.status == Status::kUnsolved) continue;
    EXPECT_GE(witness.Least(result.q), options.clearance - 1.1e-6);
    EXPECT_GE(result.min_distance, options.clearance - 1.1e-6);
    solved += result.status == Status::kSolved;
  }
  EXPECT_GT(solved, 10);
}

// A height field touches a box in many places: the way out of all of them says whether it rests.
TEST_F(SolverHardCasesTest, ShallowContactsOfADeepPairDoNotRest) {
  const Scene scene = Scene::FromString(R"(<mujoco>
      <asset><hfield name="flat" nrow="9" ncol="9" size="1 1 .1 .5"/></asset><worldbody>
      <geom type="hfield" hfield="flat"/>
      <body><freejoint/><geom type="box" size=".2 .2 .1"/></body></worldbody></mujoco>)");
  const double half_tilt = 0.005, z = 0.1 + 0.2 * std::sin(2 * half_tilt) - 0.0024;
  const Q q_in = {0, 0, z, std::cos(half_tilt), 0, std::sin(half_tilt), 0};
  for (const double rest : {0.0, 0.0005, 0.001}) {
    Options options;
    options.rest = rest;
    const Result result = Solver(scene, options).Solve(q_in);
    EXPECT_EQ(result.status, Status::kSolved) << rest << ": " << result.reason;
  }
}

TEST_F(SolverHardCasesTest, EveryRootAndBothMetricsSolve) {
  const Q standing = Scene::FromString(Standing(0.01)).DefaultQpos();
  double sigma[2][2];
  for (const std::string root : {"torso", "arm"}) {
    SceneOptions how;
    how.root = root;
    const Scene scene = Scene::FromString(Standing(0.01), how);
    for (const Metric metric : {Metric::kSequential, Metric::kDisplacement}) {
      Options options;
      options.metric = metric;
      const Result result = Solver(scene, options).Solve(standing);
      ExpectSolved(scene, standing, result);
      EXPECT_NEAR(ObjectNorm(scene, metric, standing).Sigma(result.q), result.sigma, 1e-12);
      sigma[root == "arm"][static_cast<int>(metric)] = result.sigma;
    }
  }
  EXPECT_NEAR(sigma[0][1], sigma[1][1], 1e-3 * sigma[0][1]);  // a displacement knows no root
  EXPECT_NE(sigma[0][0], sigma[1][0]);
}

TEST_F(SolverHardCasesTest, MocapBodiesAreObstaclesWhereTheOptionsPutThem) {
  const Scene scene = Scene::FromString(World(R"(
      <body name="tray" mocap="true" pos="0 0 -1"><geom type="box" size=".5 .5 .05"/></body>
      <body><joint type="slide" axis="0 0 1"/><geom size=".1"/></body>)"));
  EXPECT_EQ(Solver(scene).Solve({0.0}).status, Status::kAlreadyFree);
  Options raised;
  raised.mocap_pos = {0.2, 0, -0.1};
  const Result result = Solver(scene, raised).Solve({0.0});
  ASSERT_EQ(result.status, Status::kSolved) << result.reason;
  EXPECT_NEAR(result.q[0], 0.05, 2e-6);
  raised.mocap_quat = {std::sqrt(0.5), 0, std::sqrt(0.5), 0};  // on edge, below the sphere
  raised.mocap_pos = {0, 0, -0.55};
  EXPECT_NEAR(Solver(scene, raised).Solve({0.0}).q[0], 0.05, 2e-6);

  Solver moving(scene);
  for (const double z : {-0.1, -0.05, -0.12}) {
    moving.SetMocap({0.2, 0, z}, {});
    EXPECT_NEAR(moving.Solve({0.0}).q[0], z + 0.15, 2e-6);
  }
  moving.SetMocap({}, {});
  EXPECT_EQ(moving.Solve({0.0}).status, Status::kAlreadyFree) << "where the model has it";
}

TEST_F(SolverHardCasesTest, TreesShareTheWayByTheirMasses) {
  const Scene scene = Scene::FromString(World(R"(
      <body pos="0 0 0"><freejoint/><geom size=".1" mass="3"/></body>
      <body pos=".15 0 0"><freejoint/><geom size=".1" mass="1"/></body>)"));
  const Q q_in = scene.DefaultQpos();
  const Result result = Solver(scene).Solve(q_in);
  ExpectSolved(scene, q_in, result);
  EXPECT_NEAR(result.q[0], -0.05 / 4, 1e-5);
  EXPECT_NEAR(result.q[7], 0.15 + 0.05 * 3 / 4, 1e-5);
  EXPECT_NEAR(std::sqrt(result.sigma), 0.05 * std::sqrt(3.0) / 4, 1e-5);
  Random rng(2);
  const Scene trees = Scene::FromString(TwoTreesXml());
  Q sunk = trees.DefaultQpos();
  sunk[2] -= 0.5;
  ExpectSolved(trees, sunk, Solver(trees).Solve(sunk));
}

TEST_F(SolverHardCasesTest, TerrainIsSolvedAndCertifiedDistanceFieldsAreSolved) {
  const std::string assets = R"(<asset><hfield name="h" nrow="5" ncol="5" size="1 1 .3 .1"
      elevation="0 1 0 2 1 1 0 1 0 1 2 1 3 1 0 0 1 0 1 2 1 0 1 1 0"/>
      <mesh name="t" vertex="-.5 -.5 -.1 .5 -.5 -.1 -.5 .5 -.1 .5 .5 -.1 -.5 -.5 .1 .5 -.5 .1
      -.5 .5 .1 .5 .5 .1"/></asset>)";
  for (const std::string ground : {"type='hfield' hfield='h'", "type='sdf' mesh='t'"}) {
    const Scene scene = Scene::FromString(World("<geom " + ground + R"(/>
        <body pos=".1 .05 .12"><freejoint/><geom size=".1"/>
        <body pos=".1 0 0"><joint axis="0 1 0"/>
        <geom type="capsule" size=".02" fromto="0 0 0 .2 0 0"/></body></body>)",
                                                assets));
    const Q q_in = scene.DefaultQpos();
    ASSERT_LT(Witness(scene).Least(q_in), -0.01);
    const Result result = Solver(scene).Solve(q_in);
    ExpectSolved(scene, q_in, result);
    EXPECT_EQ(result.certified, ground.find("hfield") != std::string::npos);
    EXPECT_LT(std::sqrt(result.sigma), 0.5);
  }
}

// ---- Deep and pinched ----

TEST_F(SolverHardCasesTest, WhatFellThroughTheFloorComesStraightUp) {
  const Scene scene =
      Scene::FromString(World("<geom type='plane' size='0 0 1'/><body><freejoint/><geom type='box' "
                              "size='.1 .1 .1'/></body>"));
  Solver solver(scene);
  for (const double z : {-3.0, -30.0, -300.0, -3000.0}) {
    const Q q_in = {0, 0, z, 0.9, 0.1, 0.2, 0.1};
    const Result result = solver.Solve(q_in);
    ExpectSolved(scene, q_in, result);
    EXPECT_LT(std::sqrt(result.sigma), 1.01 * -result.depth_in) << z;
  }
}

// Whole turns of a hinge cost nothing under the norm.
TEST_F(SolverHardCasesTest, AHingeBeyondItsRangeTurnsTheShortWayRound) {
  const Scene scene = Scene::FromString(
      World("<body><joint axis='0 0 1' range='-3 3'/><geom size='.1' pos='1 0 0'/></body>",
            "<compiler angle='radian' autolimits='true'/>"));
  Solver solver(scene);
  for (const auto& [angle, inside] : {std::pair(3.2, -3.0),
                                      {-3.2, 3.0},
                                      {3.1, 3.0},
                                      {4.8, 4.8 - 2 * mjPI},
                                      {-14.0, -14.0 + 4 * mjPI}}) {
    const Result result = solver.Solve({angle});
    ExpectSolved(scene, {angle}, result);
    EXPECT_NEAR(result.q[0], inside, 1e-9);
    EXPECT_NEAR(result.sigma, ObjectNorm(scene, Metric::kSequential, {angle}).Sigma({inside}),
                1e-12);
  }
}

TEST_F(SolverHardCasesTest, MaxTriesLongestWhereNothingIsFree) {
  const Scene scene = Scene::FromString(
      World("<geom size='1'/><body><joint axis='0 0 1'/><geom size='.1' pos='.5 0 0'/></body>"));
  Options options;
  const Result hasty = Solver(scene, options).Solve({0.0});
  options.effort = Effort::kMax;
  const Result result = Solver(scene, options).Solve({0.0});
  EXPECT_EQ(hasty.status, Status::kUnsolved);
  EXPECT_EQ(result.status, Status::kUnsolved);
  EXPECT_GT(result.stats.starts, 2 * hasty.stats.starts);
}

TEST_F(SolverHardCasesTest, FingersOnBothSidesOfAPlateOpen) {
  ExpectAllSolved(World(R"(<geom name="plate" type="box" size=".004 .15 .15"/>
      <body name="palm" pos="0 0 .3"><joint type="slide" axis="1 0 0"/>
      <joint type="slide" axis="0 1 0"/><joint type="slide" axis="0 0 1" range="-.02 .3"/>
      <geom type="box" size=".06 .03 .02" mass="1"/>
      <body pos="-.03 0 -.02"><joint axis="0 1 0" range="-60 60"/>
        <geom type="capsule" size=".01" fromto="0 0 -.02 .012 0 -.2" mass=".1"/>
        <geom type="box" size=".01 .015 .03" pos=".024 0 -.2" mass=".1"/></body>
      <body pos=".03 0 -.02"><joint axis="0 1 0" range="-60 60"/>
        <geom type="capsule" size=".01" fromto="0 0 -.02 -.012 0 -.2" mass=".1"/>
        <geom type="box" size=".01 .015 .03" pos="-.024 0 -.2" mass=".1"/></body></body>)"),
                  {0, 0, 0, 0, 0}, 0.01, 3);
}

TEST_F(SolverHardCasesTest, ALimbThroughABenchComesOut) {
  ExpectAllSolved(World(R"(<geom name="bench" type="box" size=".2 .5 .02" pos=".35 0 0"/>
      <body pos="0 0 .3"><joint axis="0 1 0" range="-170 170"/><joint axis="0 0 1"/>
      <geom type="capsule" size=".04" fromto="0 0 0 .3 0 0"/>
      <body pos=".3 0 0"><joint axis="0 1 0" range="-10 150"/>
      <geom type="capsule" size=".03" fromto="0 0 0 .3 0 0"/>
      <body pos=".3 0 0"><joint type="ball" range="0 80"/>
      <geom type="capsule" size=".02" fromto="0 0 0 .15 0 0"/></body></body></body>)"),
                  {0.1, 0, 1.3, 1, 0, 0, 0}, 0.1, 4);
}

// Torso, two legs of two links, two arms.
std::string FigureXml() {
  std::string limbs;
  for (const std::string side : {"-", ""}) {
    limbs += "<body pos='0 " + side + R"(.1 -.1'><joint type="ball" range="0 100"/>
        <geom type="capsule" size=".06" fromto="0 0 -.05 0 0 -.4"/><body pos="0 0 -.45">
        <joint axis="0 1 0" range="-2 140"/>
        <geom type="capsule" size=".05" fromto="0 0 -.03 0 0 -.4"/>
        <geom type="box" size=".12 .04 .03" pos=".05 0 -.45"/></body></body><body pos="0 )" +
             side +
             R"(.25 .35"><joint type="ball" range="0 150"/>
        <geom type="capsule" size=".04" fromto="0 0 -.05 0 0 -.5"/></body>)";
  }
  return World(R"(<geom name="floor" type="plane" size="0 0 1"/><body name="torso" pos="0 0 1.1">
      <freejoint/><geom type="box" size=".1 .18 .2" pos="0 0 .2"/>
      <geom size=".1" pos="0 0 .55"/>)" +
               limbs + "</body>");
}

TEST_F(SolverHardCasesTest, AFigureSunkToTheWaistInTheFloorComesUp) {
  const Scene scene = Scene::FromString(FigureXml());
  Q q_in = scene.DefaultQpos();
  q_in[2] = 0.02;
  ExpectAllSolved(FigureXml(), q_in, 0.1, 5);
}

TEST_F(SolverHardCasesTest, ARobotSpawnedInsideACarGetsOut) {
  ExpectAllSolved(World(R"(<body name="car"><geom type="box" size="1.8 .7 .1" pos="0 0 .35"/>
      <geom type="box" size="1.8 .04 .3" pos="0 .7 .6"/>
      <geom type="box" size="1.8 .04 .3" pos="0 -.7 .6"/>
      <geom type="box" size=".9 .7 .03" pos="0 0 1.3"/>
      <geom type="box" size=".4 .7 .2" pos="-1.4 0 .6"/></body>
      <body name="cart" pos="0 0 .3"><joint type="slide" axis="1 0 0"/>
      <joint type="slide" axis="0 1 0"/><joint axis="0 0 1"/>
      <geom type="box" size=".3 .25 .2" mass="60"/>
      <body pos="0 0 .25"><joint axis="0 0 1"/>
      <geom type="cylinder" size=".08 .1" pos="0 0 .1" mass="10"/>
      <body pos="0 0 .25"><joint axis="0 1 0" range="-120 120"/>
      <geom type="capsule" size=".06" fromto="0 0 .08 0 0 .45" mass="8"/>
      <body pos="0 0 .5"><joint axis="0 1 0" range="-150 150"/>
      <geom type="capsule" size=".05" fromto="0 0 .08 0 0 .4" mass="4"/>
      </body></body></body></body>)"),
                  {0.1, 0.05, 0, 0, 0.3, 0.5}, 0.1, 6);
}

// On a fixed base at `pos`: upper arm, forearm and hand.
std::string Arm(const std::string& pos, const std::string& euler) {
  return "<body pos='" + pos + "' euler='" + euler + R"('><joint axis="0 0 1"/>
      <joint axis="0 1 0"/><geom type="capsule" size=".03" fromto=".05 0 0 .4 0 0"/>
      <body pos=".4 0 0"><joint axis="0 0 1" range="-20 160"/>
      <geom type="capsule" size=".03" fromto=".03 0 0 .3 0 0"/>
      <body pos=".3 0 0"><joint axis="0 1 0" range="-120 120"/>
      <geom type="capsule" size=".03" fromto=".03 0 0 .2 0 0"/></body></body></body>)";
}

TEST_F(SolverHardCasesTest, InterlockedArmsComeApart) {
  // Each elbow is past the other, the forearms bend away at right angles: two hooks, engaged.
  const std::string xml = World(Arm("-.38 0 0", "0 0 0") + Arm(".38 0 0", "90 0 180"));
  ExpectAllSolved(xml, {0, 0, 1.7, 1, 0, 0, 1.7, 1}, 0.05, 7);
}

TEST_F(SolverHardCasesTest, RodsThroughSlabsThatMujocoMayMissAreSeenAndSeparated) {
  const Scene scene = Scene::FromString(World(R"(<geom type="box" size=".3 .3 .02"/>
      <body><freejoint/><geom type="capsule" size=".01 .3"/></body>)"));
  Solver solver(scene);
  Random rng(8);
  int missed = 0;
  for (int k = 0; k < 150; ++k) {
    const Eigen::Vector3d at = rng.InBox(0.1), axis = rng.UnitVector();
    const Quaterniond turn(AngleAxisd(rng.Uniform(0, 0.9), axis));
    const Q q_in = {at.x(), at.y(), at.z(), turn.w(), turn.x(), turn.y(), turn.z()};
    const DataPtr d(mj_makeData(scene.model()));
    mju_copy(d->qpos, q_in.data(), 7);
    mj_forward(scene.model(), d.get());
    const Result result = solver.Solve(q_in);
    missed += d->ncon == 0;
    ExpectSolved(scene, q_in, result);
    EXPECT_LT(result.depth_in, -0.01);
  }
  std::printf("  %d of 150 rods are invisible to MuJoCo\n", missed);
}

TEST_F(SolverHardCasesTest, RandomRobotsInClutterAreSolvedWithEffortIfNeedBe) {
  Random rng(9), probe(10);
  Options patient;
  patient.effort = Effort::kMax;
  int runs = 0, at_once = 0;
  for (int model = 0; model < 10; ++model) {
    RobotOptions robot;
    robot.bodies = 12;
    robot.obstacles = 25;
    robot.free_base = model % 2 == 1;
    const Scene scene = Scene::FromString(RandomRobotXml(rng, robot));
    int can_be_free = 0;  // in some clutter a fixed base never is
    for (int k = 0; k < 300; ++k) {
      can_be_free += Verify(scene, ToVector(RandomConfiguration(scene, probe))).free;
    }
    Solver solver(scene);
    for (int k = 0; k < 8; ++k) {
      const Q q_in = ToVector(RandomConfiguration(scene, rng, 0.2));
      if (can_be_free == 0) continue;
      Result result = solver.Solve(q_in);
      if (result.status == Status::kAlreadyFree) continue;
      ++runs;
      at_once += result.status == Status::kSolved;
      if (result.status == Status::kUnsolved) result = Solver(scene, patient).Solve(q_in);
      ExpectSolved(scene, q_in, result);
    }
  }
  std::printf("  %d of %d solved with default effort\n", at_once, runs);
  EXPECT_GT(runs, 50);
  EXPECT_GE(at_once, runs * 9 / 10);
}

// ---- The project's own models ----

class ModelKeyframesTest : public SolverHardCasesTest,
                           public ::testing::WithParamInterface<const char*> {};

TEST_P(ModelKeyframesTest, EveryKeyframeIsSolved) {
  const Scene scene = Scene::FromFile(std::string(MJCF_PDG_MODEL_DIR "/") + GetParam());
  Solver solver(scene);
  const std::vector<std::string> names = scene.KeyNames();
  ASSERT_GE(names.size(), 11u);
  for (std::size_t k = 0; k < names.size(); ++k) {
    SCOPED_TRACE(names[k]);
    const Q q_in = scene.KeyQpos(static_cast<int>(k));
    const Result result = solver.Solve(q_in);
    if (names[k] == "home") {
      EXPECT_EQ(result.status, Status::kAlreadyFree);
      continue;
    }
    ExpectSolved(scene, q_in, result);
    EXPECT_TRUE(result.certified);
    EXPECT_GT(result.sigma_lower_bound, 0.0);
  }
}

// Of what is not free the same comes back whatever is to be reported: how far apart the others are
// does not count.
TEST_F(SolverHardCasesTest, WhatIsReportedDoesNotChangeWhatIsUnsolved) {
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody>
      <geom type="plane" size="2 2 .1"/>
      <body name="wall" mocap="true" pos="1 0 .5"><geom type="box" size=".05 .5 .5"/></body>
      <body name="arm" pos="0 0 .3"><joint axis="0 0 1"/><joint axis="0 1 0" range="-100 100"/>
        <geom type="capsule" size=".04" fromto="0 0 0 .4 0 0"/>
        <body name="fore" pos=".4 0 0"><joint axis="0 1 0" range="-140 140"/>
          <geom type="capsule" size=".03" fromto="0.05 0 0 .4 0 0"/></body></body></worldbody>
      <contact><exclude body1="arm" body2="fore"/></contact>
      <equality><weld body1="fore" body2="wall"/></equality></mujoco>)",
                                        {.equality = EqualityMode::kAll});
  Options reporting;  // the wall is a metre too far away
  reporting.mocap_pos = {2.0, 0.0, 0.5};
  reporting.mocap_quat = {1.0, 0.0, 0.0, 0.0};
  Options silent = reporting, far = reporting;
  reporting.report_contacts = true;
  silent.report_distances_to = 0.0;
  far.report_distances_to = 3.0;
  const Result told = Solver(scene, reporting).Solve(scene.DefaultQpos());
  ASSERT_EQ(told.status, Status::kUnsolved);
  EXPECT_EQ(told.cause, Cause::kEquality);
  EXPECT_LT(told.equality_residual, told.equality_residual_in);
  for (const Options& options : {silent, far}) {
    const Result result = Solver(scene, options).Solve(scene.DefaultQpos());
    EXPECT_EQ(result.q, told.q);
    EXPECT_EQ(result.start, told.start);
    EXPECT_EQ(result.equality_residual, told.equality_residual);
  }
}

INSTANTIATE_TEST_SUITE_P(Models, ModelKeyframesTest,
                         ::testing::Values("puma/puma_car.xml", "hand/hand_bottle.xml",
                                           "figure/figure_bench.xml"));

}  // namespace
}  // namespace mjcf_pdg::test
