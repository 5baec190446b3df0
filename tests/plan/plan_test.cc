// Planning: narrow passages of known width, paths held against the independent verifier at a
// thousand poses an edge (twenty where it bends), ends in collision, and that a seed repeats.
#include "plan/plan.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "plan/configuration_space.h"
#include "plan/planners.h"
#include "tests/support/test_support.h"
#include "tests/support/trials.h"

namespace mjcf_pdg {
namespace {

// A disc of radius 0.2 m on two slides, and a gap in a wall that is wider than the disc by `slack`
// (a share of its diameter).
std::string DiscAndGap(double slack) {
  const double y = 2.0 + 0.2 * (1.0 + slack);
  return R"(<mujoco><worldbody>
    <geom name="lower" type="box" size=".1 2 .5" pos="0 )" +
         std::to_string(-y) + R"( 0"/>
    <geom name="upper" type="box" size=".1 2 .5" pos="0 )" +
         std::to_string(y) + R"( 0"/>
    <body name="disc">
      <joint type="slide" axis="1 0 0" range="-2 2" limited="true"/>
      <joint type="slide" axis="0 1 0" range="-2 2" limited="true"/>
      <geom type="cylinder" size=".2 .1"/>
    </body></worldbody></mujoco>)";
}

// An arm of seven hinges, whose last link must come out of one slot of a grid and into the other.
constexpr char kArm[] = R"(<mujoco><worldbody>
  <geom name="shelf0" type="box" size=".3 .5 .01" pos=".75 0 .35"/>
  <geom name="shelf1" type="box" size=".3 .5 .01" pos=".75 0 .55"/>
  <geom name="shelf2" type="box" size=".3 .5 .01" pos=".75 0 .75"/>
  <body name="l1" pos="0 0 .2"><joint axis="0 0 1" range="-170 170"/><geom type="capsule" size=".05" fromto="0 0 0 0 0 .15"/>
  <body name="l2" pos="0 0 .2"><joint axis="0 1 0" range="-110 110"/><geom type="capsule" size=".04" fromto="0 0 .05 0 0 .25"/>
  <body name="l3" pos="0 0 .25"><joint axis="0 0 1" range="-170 170"/><geom type="capsule" size=".04" fromto="0 0 .05 0 0 .1"/>
  <body name="l4" pos="0 0 .1"><joint axis="0 1 0" range="-150 150"/><geom type="capsule" size=".04" fromto="0 0 .08 0 0 .2"/>
  <body name="l5" pos="0 0 .2"><joint axis="0 0 1" range="-170 170"/><geom type="capsule" size=".04" fromto="0 0 .07 0 0 .15"/>
  <body name="l6" pos="0 0 .15"><joint axis="0 1 0" range="-120 120"/><geom type="capsule" size=".035" fromto="0 0 .07 0 0 .1"/>
  <body name="l7" pos="0 0 .1"><joint axis="0 0 1" range="-170 170"/><geom type="box" size=".06 .03 .05" pos="0 0 .1"/>
  </body></body></body></body></body></body></body>
  </worldbody></mujoco>)";

PlanOptions With(const std::string& planner, std::uint64_t seed = 1) {
  PlanOptions options;
  options.planner = planner;
  options.options.seed = seed;
  options.max_samples = 20000;
  return options;
}

// Whether the path leads from `start` to `goal` through configurations that the verifier, which
// shares no code with the proofs, calls free.
void ExpectFree(const Scene& scene, const Path& path, const std::vector<double>& start,
                const std::vector<double>& goal) {
  ASSERT_TRUE(path.found) << path.reason;
  EXPECT_TRUE(path.certified);
  EXPECT_EQ(path.q.front(), start);
  EXPECT_EQ(path.q.back(), goal);
  Solver verifier(scene);
  const SceneTables& tables = scene.tables();
  VectorXd dq(tables.n);
  std::vector<double> q(path.q.front().size());
  double length = 0.0;
  for (std::size_t k = 1; k < path.q.size(); ++k) {
    const VectorXd from = ToEigen(path.q[k - 1]), to = ToEigen(path.q[k]);
    length += std::sqrt(ObjectNorm(scene, Metric::kSequential, path.q[k - 1]).Sigma(path.q[k]));
    const int kSteps = path.q.size() > 50 ? 20 : 1000;
    for (int step = 0; step <= kSteps; ++step) {
      Difference(tables, from, to, dq);
      dq *= static_cast<double>(step) / kSteps;
      VectorXd at = from;
      Integrate(tables, at, dq, at);
      q.assign(at.data(), at.data() + at.size());
      ASSERT_TRUE(verifier.IsFree(q)) << "edge " << k << ", step " << step;
    }
  }
  EXPECT_NEAR(path.length, length, 1e-9);
}

class EveryPlanner : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Three, EveryPlanner, testing::Values("birrt", "birrt-r", "birrt-pdg"),
                         [](const auto& planner) {
                           std::string name = planner.param;
                           std::erase(name, '-');
                           return name;
                         });

TEST_P(EveryPlanner, GoesThroughAGapThatIsWiderByThreePercent) {
  const Scene scene = Scene::FromString(DiscAndGap(0.03));
  const std::vector<double> start = {-1.0, 0.7}, goal = {1.0, -0.7};
  const Path path = Plan(scene, start, goal, With(GetParam()));
  ExpectFree(scene, path, start, goal);
  EXPECT_GE(path.q.size(), 4u);
  EXPECT_EQ(path.start.status, Status::kAlreadyFree);
  EXPECT_GT(path.nodes, 2);
  EXPECT_GT(path.collision_queries, 10);
}

TEST_P(EveryPlanner, DoesNotGoThroughAGapThatIsNarrower) {
  const Scene scene = Scene::FromString(DiscAndGap(-0.01));
  PlanOptions options = With(GetParam());
  options.max_samples = 500;
  const Path path = Plan(scene, {-1.0, 0.7}, {1.0, -0.7}, options);
  EXPECT_FALSE(path.found);
  EXPECT_TRUE(path.q.empty());
  EXPECT_NE(path.reason, "");
  EXPECT_GE(path.samples, 500);
}

TEST_P(EveryPlanner, MovesAnArmFromSlotToSlot) {
  const Scene scene = Scene::FromString(kArm);
  // The hand in the lower and in the upper slot, the elbow up.
  const std::vector<double> below = {0, 0.6, 0, 1.6, 0, -0.63, 0},
                            above = {0, 0.1, 0, 1.47, 0, 0, 0};
  Solver solver(scene);
  const Result first = solver.Solve(below), last = solver.Solve(above);
  ASSERT_NE(first.status, Status::kUnsolved);
  ASSERT_NE(last.status, Status::kUnsolved);
  const Path path = Plan(scene, first.q, last.q, With(GetParam()));
  ExpectFree(scene, path, first.q, last.q);
}

// A hand whose fingers open together must close them to pass a gap; a dial turns as it goes.
std::string CoupledHand(const std::string& coupling = "0 -1 0 0 0") {
  return R"(<mujoco><worldbody>
    <geom type="box" size=".1 2 .5" pos="0 -2.24 0"/><geom type="box" size=".1 2 .5" pos="0 2.24 0"/>
    <body name="dial" pos="0 5 0"><joint name="dial" axis="0 0 1"/><geom size=".1"/></body>
    <body name="hand">
      <joint name="x" type="slide" axis="1 0 0" range="-2 2" limited="true"/>
      <joint name="y" type="slide" axis="0 1 0" range="-1 1" limited="true"/>
      <geom type="cylinder" size=".1 .1"/>
      <body pos="0 .1 0"><joint name="left" axis="0 0 1" range="-90 90" limited="true"/>
        <geom type="capsule" size=".03" fromto="0 0 0 0 .25 0"/></body>
      <body pos="0 -.1 0"><joint name="right" axis="0 0 1" range="-90 90" limited="true"/>
        <geom type="capsule" size=".03" fromto="0 0 0 0 -.25 0"/></body>
    </body></worldbody>
    <tendon><fixed name="turned"><joint joint="dial" coef="1"/><joint joint="x" coef="-1"/></fixed></tendon>
    <equality><joint name="fingers" joint1="right" joint2="left" polycoef=")" +
         coupling + R"("/><tendon tendon1="turned"/></equality></mujoco>)";
}

TEST_P(EveryPlanner, HoldsCouplingsAllTheWay) {
  const Scene scene = Scene::FromString(CoupledHand());
  const std::vector<double> start = {-1, -1, 0.1, 0.2, -0.2}, goal = {1, 1, -0.1, -0.3, 0.3};
  const Path path = Plan(scene, start, goal, With(GetParam()));
  ExpectFree(scene, path, start, goal);  // the verifier's *free* is that equalities hold, too
  const auto closed = [](const std::vector<double>& q) { return std::abs(q[3]) > 0.8; };
  EXPECT_TRUE(std::any_of(path.q.begin(), path.q.end(), closed));
}

// A crank, a coupler and a rocker, on a carriage that must pass a gap: the rocker must lean for it.
constexpr char kFourBar[] = R"(<mujoco><compiler angle="radian"/>
  <default><geom type="capsule" size=".01"/><joint axis="0 1 0"/></default>
  <worldbody>
    <geom type="box" size=".1 .5 .5" pos="0 0 -.52"/><geom type="box" size=".1 .5 .5" pos="0 0 .72"/>
    <body name="carriage">
      <joint name="x" type="slide" axis="1 0 0" range="-1 1"/>
      <joint name="z" type="slide" axis="0 0 1" range="-.1 .1"/>
      <geom fromto="0 0 0 .3 0 0"/>
      <body name="crank"><joint name="crank" range="-2 2"/><geom fromto="0 .03 0 0 .03 .1"/>
        <body name="coupler" pos="0 0 .1"><joint name="coupler" range="-3 3"/><geom fromto="0 .06 0 .3 .06 0"/></body></body>
      <body name="rocker" pos=".25 0 -.1"><joint name="rocker" range="-3 3"/><geom fromto="0 .03 0 .05 .03 .2"/></body>
    </body></worldbody>
  <equality><connect name="pin" body1="coupler" body2="rocker" anchor=".3 0 0"/></equality></mujoco>)";

TEST_P(EveryPlanner, FollowsALoopAllTheWay) {
  const Scene scene = Scene::FromString(kFourBar);
  Solver solver(scene);
  const std::vector<double> start = solver.Solve({-.7, 0, 0.3, 0, -.6}).q,
                            goal = solver.Solve({.7, 0, 0.3, 0, -.6}).q;
  const Path path = Plan(scene, start, goal, With(GetParam()));
  ExpectFree(scene, path, start, goal);  // the verifier's *free* is that the loop is closed, too
  ASSERT_GE(path.corners.size(), 3u);    // round something
  EXPECT_EQ(path.corners.front(), 0);
  EXPECT_EQ(path.corners.back() + 1, static_cast<int>(path.q.size()));
  EXPECT_GT(path.q.size(), 2 * path.corners.size());  // and bent
}

TEST(PlanTest, FollowsACurvedCoupling) {
  const Scene scene = Scene::FromString(CoupledHand("0 -1 .1 0 0"));
  Solver solver(scene);
  const std::vector<double> start = solver.Solve({-1, -1, 0.1, 0.2, -0.2}).q,
                            goal = solver.Solve({1, 1, -0.1, -0.3, 0.3}).q;
  for (const char* planner : {"birrt-r", "birrt-pdg"}) {
    const Path path = Plan(scene, start, goal, With(planner));
    ExpectFree(scene, path, start, goal);
    EXPECT_GT(path.q.size(), path.corners.size());
  }
}

TEST_P(EveryPlanner, TheSameSeedGivesTheSamePath) {
  const Scene scene = Scene::FromString(DiscAndGap(0.1));
  const std::vector<double> start = {-1.0, 0.7}, goal = {1.0, -0.7};
  const Path path = Plan(scene, start, goal, With(GetParam(), 3));
  const Path again = Plan(scene, start, goal, With(GetParam(), 3));
  const Path other = Plan(scene, start, goal, With(GetParam(), 4));
  ASSERT_TRUE(path.found);
  EXPECT_EQ(path.q, again.q);
  EXPECT_EQ(path.nodes, again.nodes);
  EXPECT_EQ(path.collision_queries, again.collision_queries);
  EXPECT_NE(path.q, other.q);
}

// At any number of threads, but for the time.
TEST(PlanTest, ThreadsDoNotChangeThePath) {
  const Scene scene = Scene::FromFile(std::string(MJCF_PDG_MODEL_DIR) + "/bridge/bridge.xml");
  int late = 0;  // found by another run than the first
  for (const auto& [planner, seed] : {std::pair{"birrt-r", 10u}, {"birrt-pdg", 11u}}) {
    PlanOptions options = With(planner, seed);
    options.max_samples = 300;
    const Path path = Plan(scene, scene.KeyQpos(0), scene.KeyQpos(1), options);
    late += path.found && path.samples > 100;
    for (const int threads : {2, 3}) {
      options.threads = threads;
      const Path other = Plan(scene, scene.KeyQpos(0), scene.KeyQpos(1), options);
      EXPECT_EQ(path.q, other.q);
      EXPECT_EQ(path.nodes, other.nodes);
      EXPECT_EQ(path.samples, other.samples);
      EXPECT_EQ(path.collision_queries, other.collision_queries);
    }
  }
  EXPECT_GT(late, 0);
}

// OMPL draws samples to set itself up, which are no part of a run.
TEST_P(EveryPlanner, AnEasyProblemTakesFewSamples) {
  const Scene scene = Scene::FromString(DiscAndGap(2.0));
  const Path path = Plan(scene, {-0.5, 0.1}, {0.5, -0.1}, With(GetParam()));
  ASSERT_TRUE(path.found);
  EXPECT_LT(path.samples, 20);
}

TEST(PlanTest, RetractionNeedsFewerNodesInANarrowGap) {
  const Scene scene = Scene::FromString(DiscAndGap(0.01));
  const auto nodes = [&](const char* planner) {
    int sum = 0;
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
      const Path path = Plan(scene, {-1.0, 0.7}, {1.0, -0.7}, With(planner, seed));
      EXPECT_TRUE(path.found || std::string(planner) == "birrt") << planner << " " << seed;
      sum += path.nodes;  // without retraction, all samples may not be enough
    }
    return sum;
  };
  const int plain = nodes("birrt");
  EXPECT_LT(nodes("birrt-r"), plain / 2);
  EXPECT_LT(nodes("birrt-pdg"), plain / 2);
}

TEST(PlanTest, EndsInCollisionAreRepaired) {
  const Scene scene = Scene::FromString(DiscAndGap(0.1));
  const Path path = Plan(scene, {-0.25, 1.0}, {1.0, 0.0}, With("birrt-pdg"));
  EXPECT_EQ(path.start.status, Status::kSolved);
  // 5 cm back from the wall, and a little more so that a motion can begin there.
  EXPECT_NEAR(std::sqrt(path.start.sigma), 0.05, 1e-3);
  EXPECT_EQ(path.goal.status, Status::kAlreadyFree);
  ExpectFree(scene, path, path.start.q, {1.0, 0.0});
}

TEST(PlanTest, EndsThatTouchAreReached) {
  const Scene scene = Scene::FromString(DiscAndGap(0.1));
  const std::vector<double> start = {-0.3, 1.0}, goal = {0.3, 1.0};
  ExpectFree(scene, Plan(scene, start, goal, With("birrt-pdg")), start, goal);
}

TEST(PlanTest, AnEndThatCannotBeRepairedIsSaid) {
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody>
    <geom type="box" size="9 9 9"/>
    <body><joint type="slide" range="-1 1" limited="true"/><geom size=".1"/></body>
    </worldbody></mujoco>)");
  const Path path = Plan(scene, {0.0}, {1.0}, With("birrt"));
  EXPECT_FALSE(path.found);
  EXPECT_THAT(path.reason, testing::HasSubstr("start"));
}

// A free body, a limited ball and a hinge: a bar that must turn to go through a slit.
TEST(PlanTest, FreeAndBallJointsTurn) {
  const Scene scene = Scene::FromString(R"(<mujoco><statistic extent="2"/><worldbody>
    <geom type="box" size=".05 .8 1" pos="0 1 0"/><geom type="box" size=".05 .8 1" pos="0 -1 0"/>
    <geom type="box" size=".05 .3 .4" pos="0 0 .7"/><geom type="box" size=".05 .3 .4" pos="0 0 -.7"/>
    <body name="bar"><freejoint/><geom type="box" size=".05 .3 .05"/>
      <body pos="0 .35 0"><joint type="ball" range="0 30" limited="true"/><geom type="box" size=".03 .1 .03" pos="0 .1 0"/></body>
    </body></worldbody></mujoco>)");
  const std::vector<double> start = {-1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
  std::vector<double> goal = start;
  goal[0] = 1.0;
  for (const char* planner : {"birrt", "birrt-pdg"}) {
    ExpectFree(scene, Plan(scene, start, goal, With(planner)), start, goal);
  }
}

TEST(PlanTest, FrozenJointsStay) {
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody>
    <geom type="box" size=".1 .5 1"/>
    <body name="ball"><joint type="slide" axis="1 0 0" range="-2 2" limited="true"/><joint type="slide" axis="0 1 0" range="-2 2" limited="true"/><geom size=".1"/></body>
    <body name="door" pos="0 1.2 0"><joint axis="0 0 1"/><geom type="box" size=".1 .3 .5"/></body>
    </worldbody></mujoco>)",
                                        {.movable = {"ball"}});
  const std::vector<double> start = {-1, 0, 0.1}, goal = {1, 0, 0.1};
  const Path path = Plan(scene, start, goal, With("birrt-pdg"));
  ExpectFree(scene, path, start, goal);
  for (const std::vector<double>& q : path.q) EXPECT_EQ(q[2], 0.1);
  EXPECT_THROW(Plan(scene, start, {1, 0, 0.2}, With("birrt")), Error);
}

TEST(PlanTest, EveryNamedPlannerPlans) {
  const Scene scene = Scene::FromString(DiscAndGap(1.0));
  const Scene coupled = Scene::FromString(CoupledHand());
  const std::vector<double> start = {-0.6, 0.3}, goal = {0.6, -0.3};
  const std::vector<double> open = {-1, -1, 0, 0.2, -0.2}, moved = {-0.5, -0.5, 0.3, -0.3, 0.3};
  int planned = 0;
  for (const std::string& name : PlannerNames()) {
    SCOPED_TRACE(name);
    const Path path = Plan(scene, start, goal, With(name));
    ExpectFree(scene, path, start, goal);
    ExpectFree(coupled, Plan(coupled, open, moved, With(name)), open, moved);
    ++planned;
  }
  EXPECT_GE(planned, 15);
}

// The scenes of Table IV are what they are said to be: links, degrees of freedom, triangles, and
// ends that are free.
TEST(PlanTest, ScenesAreAsInThePaper) {
  struct Paper {
    const char* name;
    int links, dof, triangles;
  };
  for (const Paper& paper : {Paper{"placement", 15, 41, 52000}, {"bridge", 13, 40, 31000}}) {
    SCOPED_TRACE(paper.name);
    const std::string path =
        std::string(MJCF_PDG_MODEL_DIR) + "/" + paper.name + "/" + paper.name + ".xml";
    const Scene scene = Scene::FromFile(path);
    const mjModel& m = *scene.model();
    EXPECT_EQ(scene.dof(), paper.dof);
    EXPECT_EQ(std::count_if(m.body_dofnum, m.body_dofnum + m.nbody, [](int n) { return n > 0; }),
              paper.links);
    int triangles = 0;
    for (int g = 0; g < m.ngeom; ++g) {
      if (m.geom_type[g] == mjGEOM_MESH) triangles += m.mesh_facenum[m.geom_dataid[g]];
    }
    EXPECT_NEAR(triangles, paper.triangles, 1000);
    EXPECT_EQ(scene.KeyNames(), (std::vector<std::string>{"start", "goal"}));
    Solver solver(scene);
    EXPECT_TRUE(solver.IsFree(scene.KeyQpos(0)));
    EXPECT_TRUE(solver.IsFree(scene.KeyQpos(1)));
    // There is something in the way.
    EXPECT_EQ(CheckMotion(scene, scene.KeyQpos(0), scene.KeyQpos(1)).outcome,
              MotionOutcome::kContact);
  }
}

// Without beginning anew, three of eight searches found nothing in more samples.
TEST(PlanTest, TheBridgeIsPassedWhateverTheSeed) {
  const Scene scene = Scene::FromFile(std::string(MJCF_PDG_MODEL_DIR) + "/bridge/bridge.xml");
  for (int seed = 0; seed < test::Trials(8); ++seed) {
    PlanOptions options = With("birrt-pdg", static_cast<std::uint64_t>(seed));
    options.max_samples = 5000;
    EXPECT_TRUE(Plan(scene, scene.KeyQpos(0), scene.KeyQpos(1), options).found) << seed;
  }
}

TEST(PlanTest, NarrowPassagesOfKnownWidthArePassed) {
  for (const auto& [name, seed] : {std::pair{"gap", 1}, {"slot", 1}, {"piano", 2}}) {
    SCOPED_TRACE(name);
    const Scene scene =
        Scene::FromFile(std::string(MJCF_PDG_MODEL_DIR) + "/passages/" + name + ".xml",
                        {.exact_mesh = std::string(name) == "piano"});
    ExpectFree(scene,
               Plan(scene, scene.KeyQpos(0), scene.KeyQpos(1),
                    With("birrt-pdg", static_cast<std::uint64_t>(seed))),
               scene.KeyQpos(0), scene.KeyQpos(1));
  }
}

TEST(PlanTest, TheFigurePutsTheToolIntoTheShelf) {
  const Scene scene = Scene::FromFile(std::string(MJCF_PDG_MODEL_DIR) + "/placement/placement.xml");
  ExpectFree(scene, Plan(scene, scene.KeyQpos(0), scene.KeyQpos(1), With("birrt-pdg")),
             scene.KeyQpos(0), scene.KeyQpos(1));
}

TEST(PlanTest, BadInputIsRefused) {
  const Scene scene = Scene::FromString(DiscAndGap(0.1));
  const auto message = [&](const std::vector<double>& start, const PlanOptions& options) {
    try {
      Plan(scene, start, {1.0, 0.0}, options);
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_THAT(message({0.0}, With("birrt")), testing::HasSubstr("2"));
  EXPECT_NE(message({0.0, NAN}, With("birrt")), "");
  EXPECT_THAT(message({-1.0, 0.0}, With("birrt-x")), testing::HasSubstr("birrt-pdg"));
}

// Motions lead as far as the loop can be followed, and not from one way to close it to the other.
TEST(PlanTest, MotionsFollowALoop) {
  const Scene scene = Scene::FromString(kFourBar);
  Solver solver(scene);
  const auto at = [&](const std::vector<double>& q) {
    const Result result = solver.Solve(q);
    EXPECT_NE(result.status, Status::kUnsolved);
    return ToEigen(result.q);
  };
  const VectorXd open = at({-.7, 0, -.5, .5, -.4}), leaning = at({-.6, 0, 1.2, -1.2, .3});
  const ConfigurationSpace space(scene, {}, open, leaning);
  EXPECT_FALSE(space.straight());
  std::vector<ConfigurationSpace::Piece> pieces;
  const auto append = [&pieces](const ConfigurationSpace::Piece& piece) {
    pieces.push_back(piece);
    return true;
  };
  ASSERT_TRUE(space.Follow(open, leaning, append));
  EXPECT_EQ(pieces.back().q, leaning);
  EXPECT_EQ(pieces.back().t, 1.0);
  VectorXd before = open, q;
  double t = 0.0;
  for (const ConfigurationSpace::Piece& piece : pieces) {
    EXPECT_GT(piece.t, t);
    for (int k = 0; k <= 100; ++k) {
      q = before + 0.01 * k * (piece.q - before);  // slides and hinges
      EXPECT_TRUE(space.HoldsEqualities(q));
    }
    space.Interpolate(open, leaning, 0.5 * (t + piece.t), q);  // of the same curve
    EXPECT_LT((q - 0.5 * (before + piece.q)).norm(), 1e-4);
    before = piece.q;
    t = piece.t;
  }
  EXPECT_GT(pieces.size(), 50u);

  // The same crank with the rocker folded under the coupler: the other way to close the loop.
  VectorXd folded = ToEigen({-.7, 0, -.5, 1.69, -2.27});
  ASSERT_TRUE(space.Project(folded));
  ASSERT_LT(folded[4], -2.0);
  EXPECT_FALSE(space.Follow(open, folded, append));
}

// A bend that is odd about the middle of the motion holds there whether it is followed or not.
TEST(PlanTest, MotionsFollowACouplingThatIsOdd) {
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody>
    <body><joint name="a"/><geom size=".1"/></body><body pos="1 0 0"><joint name="b"/><geom size=".1"/></body>
    </worldbody><equality><joint joint1="b" joint2="a" polycoef="0 0 0 1 0"/></equality></mujoco>)");
  const VectorXd from = ToEigen({-.5, -.125}), to = ToEigen({.5, .125});
  const ConfigurationSpace space(scene, {}, from, to);
  int pieces = 0;
  EXPECT_TRUE(space.Follow(from, to, [&](const ConfigurationSpace::Piece& piece) {
    ++pieces;
    return space.HoldsEqualities(piece.q);
  }));
  EXPECT_GT(pieces, 100);
}

TEST(PlanTest, EndsOffTheCouplingsAreRepaired) {
  const Scene scene = Scene::FromString(CoupledHand());
  const Path path = Plan(scene, {-1, -1, 0, 0.4, 0}, {1, 0.9, 0, 0, 0}, With("birrt-pdg"));
  EXPECT_EQ(path.start.status, Status::kSolved);
  EXPECT_EQ(path.goal.status, Status::kSolved);
  ExpectFree(scene, path, path.start.q, path.goal.q);
}

TEST(PlanTest, EndsWhenAsked) {
  const Scene scene = Scene::FromString(DiscAndGap(-0.01));
  PlanOptions options = With("birrt-pdg");
  options.max_samples = 0;
  int asked = 0;
  options.go_on = [&asked] { return ++asked < 100; };
  const Path path = Plan(scene, {-1.0, 0.7}, {1.0, -0.7}, options);
  EXPECT_FALSE(path.found);
  EXPECT_THAT(path.reason, testing::HasSubstr("stopped"));
  EXPECT_GE(asked, 100);
  EXPECT_LT(asked, 110);
}

// Whenever the search is asked to end once a path is found, there is a path, and it is proven.
TEST(PlanTest, EndingWhileThePathIsShortenedLeavesAPath) {
  const Scene scene = Scene::FromString(DiscAndGap(0.1));
  const std::vector<double> start = {-1.0, 0.7}, goal = {1.0, -0.7};
  const auto plan = [&](int answers) {  // how often go_on says yes
    PlanOptions options = With("birrt-pdg");
    int asked = 0;
    options.go_on = [&] { return asked++ < answers; };
    return std::pair{Plan(scene, start, goal, options), asked};
  };
  const auto [whole, asked] = plan(std::numeric_limits<int>::max());
  ASSERT_TRUE(whole.found);
  int found = 0;
  double longest = 0.0;
  for (int answers = asked - 1; answers >= asked - 6; --answers) {
    const Path path = plan(answers).first;
    if (!path.found) break;  // that was before
    ExpectFree(scene, path, start, goal);
    longest = std::max(longest, path.length);
    ++found;
  }
  EXPECT_GE(found, 4);  // it is asked before each of the four ways to shorten
  EXPECT_GT(longest, 1.001 * whole.length);
}

}  // namespace
}  // namespace mjcf_pdg
