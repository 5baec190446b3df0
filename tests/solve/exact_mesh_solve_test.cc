// Repairing scenes of meshes that collide as their triangles.
#include <cmath>
#include <map>

#include "mjcf_pdg/pdg.h"
#include "optimize/local_optimization.h"
#include "tests/support/mesh_shapes.h"
#include "tests/support/oracle_check.h"
#include "tests/support/test_support.h"
#include "tests/support/trials.h"

namespace mjcf_pdg {
namespace {

using Eigen::Vector3d;
using test::MeshShape;
using test::Random;

class ExactMeshSolveTest : public test::MujocoTest {};

using test::Exact;
using test::FreePose;

// A convex mesh is its hull: the same answer, and CGAL agrees that its triangles are free.
TEST_F(ExactMeshSolveTest, ConvexMeshesComeOutAsTheirHullsDo) {
  Random rng(21);
  int overlapping = 0;
  for (const int type : test::ConvexTypes()) {
    for (int k = 0; k < 6; ++k) {
      test::TwoGeoms two;
      two.first = test::RandomShape(mjGEOM_MESH, rng);
      two.second = test::RandomShape(type, rng);
      const std::string xml = test::TwoGeomXml(two);
      const Scene hull = Scene::FromString(xml), exact = Scene::FromString(xml, Exact());
      EXPECT_TRUE(exact.HasExactMeshes());
      const Vector3d p = rng.InBox(0.15);
      const std::vector<double> q = FreePose(p, rng.UnitQuat());
      const Result expected = Solver(hull).Solve(q), result = Solver(exact).Solve(q);
      ASSERT_NE(expected.status, Status::kUnsolved);
      EXPECT_EQ(result.status, expected.status) << test::TypeName(type) << " " << k;
      EXPECT_EQ(result.q, expected.q) << test::TypeName(type) << " " << k;
      EXPECT_TRUE(test::FreeByBoth(exact, result.q)) << test::TypeName(type) << " " << k;
      overlapping += result.status == Status::kSolved;
    }
  }
  EXPECT_GT(overlapping, 25);
}

// A ball in the middle of two cubes that overlap: 0.8 m out along each of six axes, alike by
// symmetry, and 0.42 m into a notch between them.
TEST_F(ExactMeshSolveTest, WaysOutThatSymmetryMakesAlikeDoNotAgree) {
  MeshShape cubes = test::BoxMesh({0.5, 0.5, 0.5});
  cubes.Append(
      test::BoxMesh({0.5, 0.5, 0.5}).Move(Eigen::Matrix3d::Identity(), Vector3d::Constant(0.5)));
  const Scene scene = test::MeshScene(cubes, "type='sphere' size='.05'");
  const Result result = Solver(scene).Solve(FreePose(Vector3d::Constant(0.25)));
  ASSERT_EQ(result.status, Status::kSolved) << result.reason;
  EXPECT_NEAR(std::sqrt(result.sigma), 0.3 * std::sqrt(2.0), 1e-3);
}

std::string SceneXml(const std::string& assets, const std::string& world, const std::string& body) {
  return "<mujoco><asset>" + assets + "</asset><worldbody>" + world +
         "<body name='b1'><freejoint/><inertial pos='0 0 0' mass='1' diaginertia='.01 .01 .01'/>" +
         body + "</body></worldbody></mujoco>";
}

const Method kMethods[] = {Method::kAuto, Method::kPaper};

// Two cups that cross in many places, most of them shallow: the deepest says whether they rest.
TEST_F(ExactMeshSolveTest, RestIsAPairsDeepestPlace) {
  const MeshShape cup = test::Cup(0.05, 0.1, 0.005, 24);
  const Scene scene = test::MeshScene(cup, "type='mesh' mesh='moving'", cup);
  const std::vector<double> q_in = FreePose({0.03, 0.0, 0.02});
  const double depth = -Verify(scene, q_in).min_distance;
  ASSERT_GT(depth, 0.004);
  for (const double rest : {0.0, 0.001, 0.002, 0.004}) {
    Options options;
    options.rest = rest;
    const Result result = Solver(scene, options).Solve(q_in);
    EXPECT_EQ(result.status, Status::kSolved) << rest << ": " << result.reason;
    EXPECT_TRUE(test::FreeByBoth(scene, result.q)) << rest;
  }
  Options options;
  options.rest = 1.01 * depth;
  EXPECT_EQ(Solver(scene, options).Solve(q_in).status, Status::kAlreadyFree);
}

// The ring hangs on the post, 5 mm into it: it has to move by no more, and stays on the post.
TEST_F(ExactMeshSolveTest, ARingStaysOnItsPost) {
  const Scene scene =
      Scene::FromString(SceneXml(test::MeshXml("ring", test::Torus(0.1, 0.02, 48, 16)),
                                 "<geom name='post' type='capsule' size='0.05 0.3'/>",
                                 "<geom name='ring' type='mesh' mesh='ring'/>"),
                        Exact());
  for (const Method method : kMethods) {
    Options options;
    options.method = method;
    const Result result = Solver(scene, options).Solve(FreePose({0.035, 0.0, 0.0}));
    ASSERT_EQ(result.status, Status::kSolved) << result.reason;
    EXPECT_TRUE(test::FreeByBoth(scene, result.q));
    EXPECT_LT(std::sqrt(result.sigma), method == Method::kAuto ? 0.0052 : 1.0);
    EXPECT_GT(std::sqrt(result.sigma), 0.001);
    EXPECT_LE(result.sigma_lower_bound, result.sigma);
    EXPECT_TRUE(result.certified);
  }
  EXPECT_EQ(Solver(scene).Solve(FreePose({0.01, 0.0, 0.0})).status, Status::kAlreadyFree);
  const Scene hull =
      Scene::FromString(SceneXml(test::MeshXml("ring", test::Torus(0.1, 0.02, 48, 16)),
                                 "<geom name='post' type='capsule' size='0.05 0.3'/>",
                                 "<geom name='ring' type='mesh' mesh='ring'/>"));
  EXPECT_GT(std::sqrt(Solver(hull).Solve(FreePose({0.01, 0.0, 0.0})).sigma), 0.05);
}

TEST_F(ExactMeshSolveTest, APegIsCentredInItsHole) {
  const MeshShape block =
      test::Revolution({{0.05, -0.1}, {0.15, -0.1}, {0.15, 0.1}, {0.05, 0.1}}, 48);
  for (const char* peg : {"type='cylinder' size='0.048 0.05'", "type='box' size='0.03 0.03 0.05'",
                          "type='mesh' mesh='peg'"}) {
    const Scene scene = Scene::FromString(
        SceneXml(
            test::MeshXml("block", block) +
                test::MeshXml(
                    "peg", test::Revolution(
                               {{0.02, -0.05}, {0.047, -0.05}, {0.047, 0.05}, {0.02, 0.05}}, 32)),
            "<geom name='block' type='mesh' mesh='block'/>",
            std::string("<geom name='peg' ") + peg + "/>"),
        Exact());
    for (const Method method : kMethods) {
      Options options;
      options.method = method;
      const Result result =
          Solver(scene, options)
              .Solve(FreePose({0.011, 0.004, 0.0},
                              Eigen::Quaterniond(Eigen::AngleAxisd(0.02, Vector3d::UnitX()))));
      ASSERT_EQ(result.status, Status::kSolved) << peg << result.reason;
      EXPECT_TRUE(test::FreeByBoth(scene, result.q));
      if (method == Method::kAuto) {
        EXPECT_LT(std::sqrt(result.sigma), 0.013) << peg;
      }
    }
  }
}

TEST_F(ExactMeshSolveTest, ABallInsideASolidComesOutAndOneInACupStays) {
  const Scene scene = Scene::FromString(
      SceneXml(test::MeshXml("cup", test::Cup(0.1, 0.2, 0.04, 32)),
               "<geom name='cup' type='mesh' mesh='cup'/>", "<geom name='ball' size='0.01'/>"),
      Exact());
  EXPECT_EQ(Solver(scene).Solve(FreePose({0.0, 0.0, 0.1})).status, Status::kAlreadyFree);
  const Result result = Solver(scene).Solve(FreePose({0.02, 0.0, 0.03}));
  ASSERT_EQ(result.status, Status::kSolved) << result.reason;
  EXPECT_TRUE(test::FreeByBoth(scene, result.q));
  EXPECT_NEAR(std::sqrt(result.sigma), 0.02, 1e-5);  // up into the hollow, not out
  EXPECT_NEAR(result.q[2], 0.05, 1e-5);
}

// A disc on a turntable, resting on it at z = 0.1, with an arm that meets a post.
Scene Turntable(const std::string& euler, const std::string& z) {
  const auto ring = [](double inner, double outer) {
    return test::Revolution({{inner, -0.05}, {outer, -0.05}, {outer, 0.05}, {inner, 0.05}}, 6);
  };
  return Scene::FromString(
      "<mujoco><asset>" + test::MeshXml("table", ring(0.05, 0.2)) +
          test::MeshXml("disc", ring(0.06, 0.18)) + "</asset><worldbody><body euler='" + euler +
          "'><geom type='mesh' mesh='table'/><geom size='.05' pos='.3 .05 .14'/><body pos='0 0 " +
          z + R"('><joint axis='0 0 1' range='-150 150'/>
          <geom type='mesh' mesh='disc'/><geom type='capsule' size='.03' fromto='.2 0 .05 .4 0 .05'/>
          </body></body></worldbody></mujoco>)",
      Exact());
}

// Triangles of faces that rest on each other cross or not, by rounding.
TEST_F(ExactMeshSolveTest, FacesThatRestOnEachOtherAreFreeToTurn) {
  for (const char* euler : {"0 0 0", "10 0 0", "30 20 10", "5 77 31"}) {
    const Scene scene = Turntable(euler, "0.1");
    EXPECT_EQ(Solver(scene).Solve({1.0}).status, Status::kAlreadyFree) << euler;
    const Result result = Solver(scene).Solve({0.05});
    const Result lifted = Solver(Turntable(euler, "0.101")).Solve({0.05});
    ASSERT_EQ(result.status, Status::kSolved) << euler << ": " << result.reason;
    ASSERT_EQ(lifted.status, Status::kSolved) << euler << ": " << lifted.reason;
    EXPECT_NEAR(result.q[0], lifted.q[0], 1e-3) << euler;
    EXPECT_TRUE(test::FreeByBoth(scene, result.q)) << euler;
  }
}

// Deeper than what the search takes for rest, but by no more than the verifier permits.
TEST_F(ExactMeshSolveTest, WhatTheVerifierCallsFreeIsSolved) {
  const Scene scene = Turntable("30 20 10", "0.0999995");
  const Result result = Solver(scene).Solve({0.05});
  EXPECT_EQ(result.status, Status::kSolved) << result.reason;
  EXPECT_TRUE(test::FreeByBoth(scene, result.q));
}

// A box in a cup that leaves it little more.
TEST_F(ExactMeshSolveTest, ClearancesAreKeptExactly) {
  Random rng(83);
  Options options;
  options.clearance = 6e-3;
  const Scene scene =
      test::MeshScene(test::Cup(0.05, 0.1, 0.004, 32), "type='box' size='.02 .03 .02'");
  int solved = 0;
  for (int k = 0; k < 40; ++k) {
    const std::vector<double> q = FreePose(Vector3d(0, 0, 0.05) + rng.InBox(0.02), rng.UnitQuat());
    for (const Effort effort : {Effort::kFast, Effort::kDefault}) {
      options.effort = effort;
      const Result result = Solver(scene, options).Solve(q);
      EXPECT_NE(result.status, Status::kUnsolved) << k << ": " << result.reason;
      EXPECT_GE(result.min_distance, options.clearance - options.tolerance);
      solved += result.status == Status::kSolved;
    }
  }
  EXPECT_GT(solved, 60);
}

// What a clearance lacks counts as depth: an answer that far is not far, and ends the search.
TEST_F(ExactMeshSolveTest, WhatIsTooNearIsNoLongSearch) {
  Options options;
  options.clearance = 6e-3;
  const MeshShape cup = test::Cup(0.05, 0.1, 0.004, 32);
  const Scene scene = test::MeshScene(cup, "type='mesh' mesh='moving'", cup);
  const Result result = Solver(scene, options).Solve(FreePose({0.101, 0.0, 0.0}));
  ASSERT_EQ(result.status, Status::kSolved) << result.reason;
  EXPECT_LT(std::sqrt(result.sigma), 6e-3);
  EXPECT_LE(result.stats.starts, 8);
}

// Whatever a solver did before: rows may be shared out among threads in any way.
TEST_F(ExactMeshSolveTest, TheSameInputGivesTheSameBits) {
  Random rng(29);
  const Scene scene =
      Scene::FromString(SceneXml(test::MeshXml("ring", test::Torus(0.1, 0.02, 16, 8)),
                                 "<geom name='box' type='box' size='0.05 0.05 0.3'/>",
                                 "<geom name='ring' type='mesh' mesh='ring'/>"),
                        Exact());
  Solver used(scene);
  for (int i = 0; i < 5; ++i) {
    const std::vector<double> q = FreePose(rng.InBox(0.05), rng.UnitQuat());
    const Result fresh = Solver(scene).Solve(q), again = used.Solve(q);
    EXPECT_EQ(fresh.status, Status::kSolved) << fresh.reason;
    EXPECT_TRUE(test::FreeByBoth(scene, fresh.q));
    EXPECT_EQ(fresh.q, again.q);
    EXPECT_EQ(fresh.sigma, again.sigma);
  }
}

// Deep tangles of curved meshes: whatever comes out is free or says that it is not.
TEST_F(ExactMeshSolveTest, TangledKnotsAreNeverFalselyFree) {
  Random rng(23);
  const MeshShape knot = test::TorusKnot(0.1, 0.03, 60, 8);
  const Scene scene = Scene::FromString(
      SceneXml(test::MeshXml("knot", knot), "<geom name='g2' type='mesh' mesh='knot'/>",
               "<geom name='g1' type='mesh' mesh='knot'/>"),
      Exact());
  for (const Method method : kMethods) {
    int solved = 0;
    const int count = method == Method::kAuto ? 6 : 2;
    for (int i = 0; i < count; ++i) {
      Options options;
      options.method = method;
      options.effort = Effort::kFast;
      const Result result = Solver(scene, options).Solve(FreePose(rng.InBox(0.1), rng.UnitQuat()));
      EXPECT_EQ(bool(test::FreeByBoth(scene, result.q)), result.status != Status::kUnsolved);
      solved += result.status != Status::kUnsolved;
    }
    EXPECT_EQ(solved, count);
  }
}

// What a descent calls free neither crosses nor contains anything, however shallow its depth seems.
TEST_F(ExactMeshSolveTest, NoDescentEndsInACrossing) {
  const Scene scene = Scene::FromFile(MJCF_PDG_MODEL_DIR "/rigid/spoon_cup.xml", Exact());
  Options options;
  options.tolerance = 1e-5;
  Workspace work(scene.tables(), options);
  LocalOptimization local(work);
  std::map<Depths, int> free;
  for (double t = 0.3; t < 0.55; t += 0.001 * test::kFewer) {
    const Eigen::Quaterniond turn(
        Eigen::AngleAxisd(2.0 * M_PI * t, Vector3d(1, 1, 2).normalized()));
    const std::vector<double> q =
        FreePose({-0.1 + 0.2 * t, 0.01 - 0.01 * t, 0.07 - 0.02 * t}, turn);
    work.Begin(ToEigen(q));
    for (const Depths depths : {Depths::kMeasured, Depths::kSearched}) {
      const LocalResult result = local.Run(work.problem().q_in, {.depths = depths});
      if (!result.free) continue;
      ++free[depths];
      EXPECT_TRUE(work.Free(result.q)) << t;
    }
  }
  EXPECT_GT(free[Depths::kMeasured], test::Trials(2));
  EXPECT_GT(free[Depths::kSearched], test::Trials(125));
}

// An answer touches. From there to the next frame's, steps along what curves end in overlaps,
// unless they are short and stand off.
TEST_F(ExactMeshSolveTest, DescentsLeaveTouchingStarts) {
  const Scene scene = Scene::FromFile(MJCF_PDG_MODEL_DIR "/rigid/spoon_cup.xml", Exact());
  Options options;
  options.tolerance = 1e-5;
  options.effort = Effort::kFast;
  Solver solver(scene, options);
  Workspace work(scene.tables(), options);
  LocalOptimization local(work);
  std::vector<double> last;
  int frames = 0, stuck = 0;
  for (double t = 0.0; t < 1.0; t += 0.0125) {
    const Eigen::Quaterniond turn(
        Eigen::AngleAxisd(2.0 * M_PI * t, Vector3d(1, 1, 2).normalized()));
    const std::vector<double> q = FreePose({-0.1 + 0.2 * t, 0.005, 0.06}, turn);
    if (!last.empty()) {
      work.Begin(ToEigen(q));
      const VectorXd start = Eigen::Map<const VectorXd>(last.data(), 7);
      const LocalResult result = local.Run(start, {});
      ASSERT_TRUE(result.free) << t;
      ++frames;
      stuck += result.q == start;
    }
    const Result answer = solver.Solve(q);
    last.clear();
    if (answer.status == Status::kSolved) last = answer.q;
  }
  EXPECT_GT(frames, 50);
  EXPECT_LE(stuck, frames / 8);
}

// What a step learnt where meshes overlapped must not hold a later one back in the air.
TEST_F(ExactMeshSolveTest, AnswersOfOneDescentHardlyEverEndInTheAir) {
  const MeshShape star = test::Globe(
      7, 10, [](const Vector3d& d) { return 0.015 + 0.06 * std::pow(d.cwiseAbs().maxCoeff(), 8); });
  const Scene scene =
      test::MeshScene(test::Cup(0.09, 0.08, 0.02, 10), "type='mesh' mesh='moving'", star);
  Options options;
  options.effort = Effort::kFast;
  Solver solver(scene, options);
  Random rng(91);
  int solved = 0, unsolved = 0, in_the_air = 0;
  for (int i = 0; i < 1500; ++i) {
    const Result result = solver.Solve(FreePose(rng.InBox(0.08), rng.UnitQuat()));
    unsolved += result.status == Status::kUnsolved;
    if (result.status != Status::kSolved) continue;
    ++solved;
    in_the_air += result.min_distance > 2e-4;
  }
  EXPECT_GT(solved, 500);
  EXPECT_EQ(unsolved, 0) << "a free body can leave a cup";
  EXPECT_LE(in_the_air, 5);
}

// The frames of a trajectory drag the answers along: followed for most frames, but not for long.
TEST_F(ExactMeshSolveTest, ATrajectoryIsFollowedAndStaysNear) {
  const Scene scene = Scene::FromFile(MJCF_PDG_MODEL_DIR "/rigid/spoon_cup.xml", Exact());
  for (const Effort effort : {Effort::kFast, Effort::kDefault}) {
    Options options;
    options.effort = effort;
    Solver alone(scene, options);
    options.trajectory = true;
    Solver following(scene, options);
    int frames = 0, searched = 0;
    double sum = 0.0;  // of the logarithms of the ratios
    for (double t = 0.0; t < 1.0; t += 0.0125) {
      const Eigen::Quaterniond turn(
          Eigen::AngleAxisd(2.0 * M_PI * t, Vector3d(1, 1, 2).normalized()));
      const std::vector<double> q = FreePose({-0.1 + 0.2 * t, 0.005, 0.06}, turn);
      const Result ours = following.Solve(q), single = alone.Solve(q);
      ASSERT_EQ(ours.status, single.status) << t;
      if (ours.status != Status::kSolved) continue;
      EXPECT_TRUE(test::FreeByBoth(scene, ours.q)) << t;
      ++frames;
      searched += ours.stats.starts > 1;
      sum += std::log(ours.sigma / single.sigma);
    }
    EXPECT_GT(frames, 30);
    EXPECT_GT(searched, frames / 5);
    EXPECT_LT(searched, 2 * frames / 3);
    EXPECT_LT(sum / frames, effort == Effort::kFast ? 0.3 : 0.1);
  }
}

}  // namespace
}  // namespace mjcf_pdg
