// Planning: narrow passages of known width, paths held against the independent verifier, ends in
// collision, and that a seed repeats.
#include "plan/plan.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "plan/planners.h"
#include "tests/plan/plan_test_support.h"

namespace mjcf_pdg {
namespace {

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

// At both ends the bar points nearly backwards, on either side of what the limits leave out: it is
// nearly where it has to be, and has the whole way still to go.
TEST_P(EveryPlanner, TurnsAllTheWayRound) {
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody><body>
    <joint axis="0 0 1" range="-175 175" limited="true"/>
    <geom type="capsule" size=".05" fromto="0 0 0 1 0 0"/></body></worldbody></mujoco>)");
  const std::vector<double> start = {-3.0}, goal = {3.0};
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u, 5u}) {
    PlanOptions options = With(GetParam(), seed);
    int asked = 0;
    options.go_on = [&asked] { return ++asked < 10000; };
    ExpectFree(scene, Plan(scene, start, goal, options), start, goal);
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

// OMPL's PRM looks at the clock; Roadmap does not.
TEST(PlanTest, TheSameSeedGivesTheSamePathOfARoadmap) {
  const Scene scene = Scene::FromString(DiscAndGap(0.1));
  const std::vector<double> start = {-1.0, 0.7}, goal = {1.0, -0.7};
  for (const char* planner : {"prm", "prmstar"}) {
    const Path path = Plan(scene, start, goal, With(planner, 3));
    const Path again = Plan(scene, start, goal, With(planner, 3));
    ExpectFree(scene, path, start, goal);
    EXPECT_EQ(path.q, again.q) << planner;
    EXPECT_EQ(path.nodes, again.nodes) << planner;
    EXPECT_GT(path.nodes, 20) << planner;  // it was looked for a path more than once
    EXPECT_NE(path.q, Plan(scene, start, goal, With(planner, 4)).q) << planner;
  }
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
  const std::vector<double> start = {-0.6, 0.3}, goal = {0.6, -0.3};
  int planned = 0;
  for (const std::string& name : PlannerNames()) {
    SCOPED_TRACE(name);
    const Path path = Plan(scene, start, goal, With(name));
    ExpectFree(scene, path, start, goal);
    ++planned;
  }
  EXPECT_GE(planned, 25);
}

// Setting up some of OMPL's planners draws samples; no bound of samples is still none then.
TEST(PlanTest, EveryNamedPlannerPlansWithoutABoundOfSamples) {
  const Scene scene = Scene::FromString(DiscAndGap(1.0));
  const std::vector<double> start = {-0.6, 0.3}, goal = {0.6, -0.3};
  for (const std::string& name : PlannerNames()) {
    SCOPED_TRACE(name);
    PlanOptions options = With(name);
    options.max_samples = 0;
    ExpectFree(scene, Plan(scene, start, goal, options), start, goal);
  }
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

TEST(PlanTest, EndsWhileATreeGrowsTowardsTheOther) {
  const Scene scene = Scene::FromString(DiscAndGap(4.0));
  PlanOptions options = With("birrt");
  options.range = 1e-3;
  int asked = 0;
  options.go_on = [&asked] { return ++asked < 500; };
  const Path path = Plan(scene, {-1.0, 0.0}, {1.0, 0.0}, options);
  EXPECT_FALSE(path.found);
  EXPECT_EQ(path.samples, 1);
  EXPECT_LT(asked, 510);
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
  for (int answers = asked - 1; answers > 0; --answers) {
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
