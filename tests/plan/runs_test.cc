// The runs of a search: how many samples they take, in which order they come, and what some kinds
// find that others do not.
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "tests/plan/plan_test_support.h"

namespace mjcf_pdg {
namespace {

// At any number of threads, but for the time.
TEST(PlanTest, ThreadsDoNotChangeThePath) {
  const Scene scene = Scene::FromFile(std::string(MJCF_PDG_MODEL_DIR) + "/bridge/bridge.xml");
  int late = 0;  // found by another run than the first
  for (const auto& [planner, seed] :
       {std::pair{"birrt", 9u}, {"birrt-r", 10u}, {"birrt-pdg", 23u}}) {
    PlanOptions options = With(planner, seed);
    options.max_samples = 700;
    const Path path = Plan(scene, scene.KeyQpos(0), scene.KeyQpos(1), options);
    late += path.found && path.samples > 250;
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

// Where paths are retracted, and none is found.
TEST(PlanTest, ThreadsDoNotChangeWhatRunsOfSmallerBodiesDo) {
  const Scene scene = Scene::FromString(DiscAndGap(-0.01));
  PlanOptions options = With("birrt-pdg");
  options.max_samples = 6000;
  const Path path = Plan(scene, {-0.5, 0.5}, {0.5, -0.5}, options);
  EXPECT_FALSE(path.found);
  EXPECT_GT(path.samples, 3000);
  for (const int threads : {2, 3, 5}) {
    options.threads = threads;
    const Path other = Plan(scene, {-0.5, 0.5}, {0.5, -0.5}, options);
    EXPECT_EQ(path.nodes, other.nodes);
    EXPECT_EQ(path.samples, other.samples);
    EXPECT_EQ(path.collision_queries, other.collision_queries);
  }
}

// OMPL draws samples to set itself up, which are no part of a run.
TEST_P(EveryPlanner, AnEasyProblemTakesFewSamples) {
  const Scene scene = Scene::FromString(DiscAndGap(2.0));
  const Path path = Plan(scene, {-0.5, 0.1}, {0.5, -0.1}, With(GetParam()));
  ASSERT_TRUE(path.found);
  EXPECT_LT(path.samples, 20);
}

// Walled in by a wall each, a tree keeps its root alone: nodes count the runs. Each kind has the
// terms of Luby's sequence, 1 1 2 ..., times 250 samples; those of birrt-pdg whose disc is smaller,
// so that its trees grow, in vain, have three times as many.
TEST_P(EveryPlanner, BeginsAnew) {
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody>
    <geom type="box" size="2 .05 .5" pos="0 -.25001 0"/><geom type="box" size="2 .05 .5" pos="0 .25001 0"/>
    <geom type="box" size=".05 .2 .5" pos="-1.25001 0 0"/><geom type="box" size=".05 .2 .5" pos="-.74999 0 0"/>
    <geom type="box" size=".05 .2 .5" pos=".74999 0 0"/><geom type="box" size=".05 .2 .5" pos="1.25001 0 0"/>
    <body name="disc">
      <joint type="slide" axis="1 0 0" range="-2 2" limited="true"/>
      <joint type="slide" axis="0 1 0" range="-2 2" limited="true"/>
      <geom type="cylinder" size=".2 .1"/>
    </body></worldbody></mujoco>)");
  using Counts = std::vector<std::pair<int, int>>;  // of samples and runs
  const std::map<std::string, Counts> expected = {
      {"birrt", {{250, 1}, {251, 2}, {1000, 4}, {1001, 5}, {1500, 5}, {1501, 6}}},
      {"birrt-r", {{250, 1}, {251, 2}, {2000, 8}, {2001, 9}, {2500, 9}, {2501, 10}}},
      {"birrt-pdg", {{250, 1}, {251, 2}, {500, 2}}}};
  const auto nodes = [&](int samples) {
    PlanOptions options = With(GetParam());
    options.max_samples = samples;
    const Path path = Plan(scene, {-1.0, 0.0}, {1.0, 0.0}, options);
    EXPECT_FALSE(path.found);
    EXPECT_EQ(path.samples, samples);
    return path.nodes;
  };
  for (const auto& [samples, runs] : expected.at(GetParam())) {
    EXPECT_EQ(nodes(samples), 2 * runs) << samples;
  }
  if (GetParam() != std::string("birrt-pdg")) return;
  EXPECT_GT(nodes(600), 2 * 3);             // with smaller bodies there is a way
  EXPECT_EQ(nodes(3251), nodes(3250) + 2);  // a run of the first kind
}

// A frame around a post, and another post around which it is to be: if it were smaller, the posts
// would be in it. So the third run is one of 250 samples as well, and only the sixth has a frame
// that is thinner.
TEST(PlanTest, WhereEndsAreNotFreeWithSmallerBodiesThereAreNone) {
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody>
    <geom type="box" size=".2 .2 .5" pos="-1 0 0"/><geom type="box" size=".2 .2 .5" pos="1 0 0"/>
    <body name="frame">
      <joint type="slide" axis="1 0 0" range="-2 2" limited="true"/>
      <joint type="slide" axis="0 1 0" range="-2 2" limited="true"/>
      <geom type="box" size=".3 .05 .1" pos="0 -.25001 0"/><geom type="box" size=".3 .05 .1" pos="0 .25001 0"/>
      <geom type="box" size=".05 .3 .1" pos="-.25001 0 0"/><geom type="box" size=".05 .3 .1" pos=".25001 0 0"/>
    </body></worldbody></mujoco>)");
  PlanOptions options = With("birrt-pdg");
  options.max_samples = 1250;
  const Path five = Plan(scene, {-1.0, 0.0}, {1.0, 0.0}, options);
  EXPECT_FALSE(five.found);
  EXPECT_EQ(five.nodes, 2 * 5);
  options.max_samples = 1251;
  EXPECT_GT(Plan(scene, {-1.0, 0.0}, {1.0, 0.0}, options).nodes, 2 * 5);
}

// Half of a room, and a hole in the wall between the halves that is 11 % wider than the body. The
// box that the model's extent makes is larger than the room: drawn from that alone, these seeds
// took 56,000, more than 100,000 and 81,000 samples when that was new; they take 3,753, 7,512 and
// 3,753 as it is.
TEST(PlanTest, AFreeBodyLeavesHalfOfAClosedRoom) {
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody>
    <geom type="box" size="2 4 4" pos="-4 0 0"/><geom type="box" size="2 4 4" pos="4 0 0"/>
    <geom type="box" size="4 2 4" pos="0 -3 0"/><geom type="box" size="4 2 4" pos="0 3 0"/>
    <geom type="box" size="4 4 2" pos="0 0 -3"/><geom type="box" size="4 4 2" pos="0 0 3"/>
    <geom type="box" size=".1 .45 1" pos="0 -.55 0"/><geom type="box" size=".1 .45 1" pos="0 .55 0"/>
    <geom type="box" size=".1 .1 .45" pos="0 0 -.55"/><geom type="box" size=".1 .1 .45" pos="0 0 .55"/>
    <body><freejoint/><geom type="box" size=".4 .09 .09"/></body></worldbody></mujoco>)");
  const std::vector<double> start = {-1.0, 0.5, 0.5, 0.0, 0.0, 0.0, 1.0};
  const std::vector<double> goal = {1.0, -0.5, 0.5, 0.0, 0.0, 0.0, 1.0};
  int found = 0;
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Path path = Plan(scene, start, goal, With("birrt-pdg", seed));
    if (!path.found) continue;
    ++found;
    ExpectFree(scene, path, start, goal);
  }
  EXPECT_GE(found, 2);
}

// An arm of six hinges has a plate behind a wall, 15 × 15 × 2 cm, at the end of a thin stick
// through a hole 3 % wider. Smaller, its links are apart, and a small plate finds no hole: all
// other runs find a way with neither seed.
TEST(PlanTest, AHandBehindAWallIsDrawnOutOfItsHole) {
  std::string links, ends;
  const double before[] = {0.0, 0.1, 0.4, 0.2, 0.2, 0.1}, after[] = {0.1, 0.4, 0.2, 0.2, 0.1};
  const std::string axes[] = {"0 0 1", "0 1 0", "0 1 0", "1 0 0", "0 1 0", "1 0 0"};
  for (int k = 0; k < 6; ++k) {
    links += "<body pos='" + std::to_string(before[k]) + " 0 0'><joint axis='" + axes[k] +
             "' range='-2.6 2.6'/>";
    if (k < 5) {
      links += "<geom type='capsule' size='.025' fromto='.03 0 0 " +
               std::to_string(after[k] - 0.03) + " 0 0'/>";
    }
    ends += "</body>";
  }
  const Scene scene = Scene::FromString(R"(<mujoco><compiler angle="radian"/><worldbody>
    <body pos="0.827374377 0.21758088 0.068783608" quat="0.958701921 0.279470919 -0.052077801 -0.008633309">
      <geom type="box" size=".015 2.46 5" pos="0 -2.53725 0"/>
      <geom type="box" size=".015 .0773 2.5" pos="0 0 -2.5103"/>
      <geom type="box" size=".015 .0773 2.5" pos="0 0 2.5103"/>
      <geom type="box" size=".015 2.46 5" pos="0 2.53725 0"/>
    </body>)" + links + R"(
    <geom type="capsule" size=".006" fromto="0 0 0 .15 0 0"/>
    <geom type="box" size=".075 .075 .01" pos=".225 0 0"/>)" +
                                        ends + "</worldbody></mujoco>");
  const std::vector<double> start = {1.34015, -1.40615, 2.3454, -0.495008, -0.620246, 0.35196},
                            goal = {0.349066, -0.872665, 1.5708, 0.523599, -0.872665, 0.174533};
  int found = 0;
  for (const std::uint64_t seed : {3, 4}) {
    PlanOptions options = With("birrt-pdg", seed);
    options.max_samples = 5000;
    const Path path = Plan(scene, start, goal, options);
    if (!path.found) continue;
    ++found;
    ExpectFree(scene, path, start, goal);
  }
  EXPECT_GE(found, 1);
}

// After two runs of 250 samples comes one of 750, those near the path included that is found with
// a smaller disc and cannot be retracted.
TEST(PlanTest, SamplesNearAPathThatIsRetractedCount) {
  PlanOptions options = With("birrt-pdg");
  options.max_samples = 1250;
  const Path path = Plan(Scene::FromString(DiscAndGap(-0.01)), {-0.5, 0.5}, {0.5, -0.5}, options);
  EXPECT_FALSE(path.found);
  EXPECT_LE(path.samples, 1250);
  EXPECT_GT(path.samples, 600);
}

// A coin, 20 times as wide as thick, and a slot 1 % higher: less than twice what contact samples
// keep in the first round. If they kept it in all, none of these seeds would find a path in 20,000
// samples; they take 2,900 and 3,100.
TEST(PlanTest, AThinBodyPassesASlotThatIsHardlyWider) {
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody>
    <geom type="box" size=".05 3 1.5" pos="0 0 1.507575"/><geom type="box" size=".05 3 1.5" pos="0 0 -1.507575"/>
    <geom type="box" size=".05 1.5 .007575" pos="0 1.695 0"/><geom type="box" size=".05 1.5 .007575" pos="0 -1.695 0"/>
    <body>
      <joint type="slide" axis="1 0 0" range="-1 1"/><joint type="slide" axis="0 1 0" range="-1 1"/>
      <joint type="slide" axis="0 0 1" range="-1 1"/><joint type="ball"/>
      <geom type="cylinder" size=".15 .0075"/>
    </body></worldbody></mujoco>)");
  const std::vector<double> start = {-0.7, 0.3, 0.2, 1.0, 0.0, 0.0, 0.0};
  const std::vector<double> goal = {0.7, -0.2, 0.1, 1.0, 0.0, 0.0, 0.0};
  for (const std::uint64_t seed : {1, 2}) {
    ExpectFree(scene, Plan(scene, start, goal, With("birrt-pdg", seed)), start, goal);
  }
}

}  // namespace
}  // namespace mjcf_pdg
