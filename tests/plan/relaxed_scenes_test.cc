// Relaxed scenes: what is smaller there or may overlap, and by how much.
#include "plan/relaxed_scenes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "mjcf_pdg/motion.h"
#include "mjcf_pdg/pdg.h"
#include "model/scene_tables.h"
#include "model/shrunk_model.h"

namespace mjcf_pdg {
namespace {

// A bar, 0.2 m at its thinnest, over a block that is larger.
constexpr char kBar[] = R"(<mujoco><worldbody>
    <geom name="block" type="box" size="2 2 2" pos="0 0 -2"/>
    <body name="bar"><joint type="slide" axis="0 0 1"/><geom name="bar" type="box" size=".3 .1 .4"/>
    </body></worldbody></mujoco>)";

// The beginning of a model, with a mesh of 0.8 m a side.
const std::string kCube = R"(<mujoco><asset><mesh name="cube" vertex="
    -.4 -.4 -.4  .4 -.4 -.4  -.4 .4 -.4  .4 .4 -.4
    -.4 -.4 .4  .4 -.4 .4  -.4 .4 .4  .4 .4 .4"/></asset>)";

constexpr double kTouching = 0.4;  // z of the bar on the block [m]

// The solver asks the verifier, the motion checker the contacts of the search.
void ExpectMayOverlapBy(double depth, const Scene& scene) {
  const double less = kTouching - depth + 1e-4, more = kTouching - depth - 1e-4;
  EXPECT_TRUE(Solver(scene).IsFree(std::vector<double>{less}));
  EXPECT_FALSE(Solver(scene).IsFree(std::vector<double>{more}));
  const auto moved_down_to = [&](double z) {
    return CheckMotion(scene, std::vector<double>{1.0}, std::vector<double>{z}).outcome;
  };
  EXPECT_EQ(moved_down_to(less), MotionOutcome::kFree);
  EXPECT_EQ(moved_down_to(more), MotionOutcome::kContact);
}

TEST(ShrunkScenesTest, WhatMovesIsSmallerByThreeQuartersThenByHalfOfThat) {
  for (const std::string geom : {"type='box' size='.3 .1 .4'", "type='sphere' size='.4'",
                                 "type='capsule' size='.1 .3'", "type='cylinder' size='.1 .4'",
                                 "type='ellipsoid' size='.1 .2 .4'", "type='mesh' mesh='cube'"}) {
    SCOPED_TRACE(geom);
    const Scene scene = Scene::FromString(kCube + R"(<worldbody>
        <geom type="box" size="2 2 2" pos="0 0 -2"/>
        <body><joint type="slide" axis="0 0 1"/><geom )" +
                                          geom + "/></body></worldbody></mujoco>");
    const std::vector<Scene> shrunk = ShrunkScenes(scene);
    ASSERT_EQ(shrunk.size(), 6u);
    double share = 0.75;
    for (const Scene& each : shrunk) {
      ExpectMayOverlapBy(share * kTouching, each);
      EXPECT_EQ(each.tables().size, scene.tables().size);
      share /= 2.0;
    }
    ExpectMayOverlapBy(0.0, scene);  // which is what it was
  }
}

// Balls beside each other's tops: no plane along an axis of their boxes parts them.
TEST(ShrunkScenesTest, TheVerifierKnowsTheSmallerShapes) {
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody>
      <geom type="sphere" size="2" pos="-1.2 -.9 -2"/>
      <body><joint type="slide" axis="0 0 1"/><geom type="sphere" size=".4"/></body>
      </worldbody></mujoco>)");
  const double radius = 2.0 + 0.25 * 0.4, touching = std::sqrt(radius * radius - 1.5 * 1.5) - 2.0;
  Solver smaller(ShrunkScenes(scene).front());
  EXPECT_TRUE(smaller.IsFree(std::vector<double>{touching + 1e-4}));
  EXPECT_FALSE(smaller.IsFree(std::vector<double>{touching - 1e-4}));
}

TEST(ShrunkScenesTest, AMeshThatSomethingAtRestHasTooStaysAsItIs) {
  const Scene scene = Scene::FromString(kCube + R"(<worldbody>
      <geom type="mesh" mesh="cube" pos="0 0 -.4"/>
      <body><joint type="slide" axis="0 0 1"/><geom type="mesh" mesh="cube"/></body>
      </worldbody></mujoco>)");
  EXPECT_TRUE(ShrunkScenes(scene).empty());
}

TEST(ShrunkScenesTest, AMeshOfTwoThatMoveIsSmallerForBoth) {
  const Scene scene = Scene::FromString(kCube + R"(<worldbody>
      <geom type="box" size="2 2 2" pos="0 0 -2"/>
      <body><joint type="slide" axis="0 0 1"/><geom type="mesh" mesh="cube"/></body>
      <body pos="1 0 0"><joint type="slide" axis="0 0 1"/><geom type="mesh" mesh="cube"/></body>
      </worldbody></mujoco>)");
  Solver smaller(ShrunkScenes(scene).front());
  EXPECT_TRUE(smaller.IsFree(std::vector<double>{0.1 + 1e-4, 0.1 + 1e-4}));
  EXPECT_FALSE(smaller.IsFree(std::vector<double>{0.1 - 1e-4, 0.1 + 1e-4}));
  EXPECT_FALSE(smaller.IsFree(std::vector<double>{0.1 + 1e-4, 0.1 - 1e-4}));
}

// Its size is part of the tendon's length.
TEST(ShrunkScenesTest, AGeomThatATendonWrapsAroundStaysAsItIs) {
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody>
      <site name="from" pos="-1 0 1"/><site name="to" pos="1 0 1"/>
      <geom type="box" size="2 2 2" pos="0 0 -2"/>
      <body><joint type="slide" axis="0 0 1"/><geom name="pulley" type="sphere" size=".4"/></body>
      </worldbody><tendon><spatial>
      <site site="from"/><geom geom="pulley"/><site site="to"/></spatial></tendon></mujoco>)");
  EXPECT_TRUE(ShrunkScenes(scene).empty());
}

TEST(ShrunkModelTest, AnExactMeshIsSmallerToo) {
  const Scene piano = Scene::FromFile(std::string(MJCF_PDG_MODEL_DIR) + "/passages/piano.xml",
                                      {.exact_mesh = true});
  ASSERT_TRUE(piano.HasExactMeshes());
  EXPECT_TRUE(ShrunkScenes(piano).empty());
  const Scene smaller = piano.Resized(ShrunkModel(piano.tables(), 0.75));
  const std::vector<double> start = piano.KeyQpos(0), goal = piano.KeyQpos(1);
  Solver of_piano(piano), of_smaller(smaller);
  int free = 0, smaller_free = 0;
  for (int k = 0; k <= 200; ++k) {
    std::vector<double> q(start.size());
    for (std::size_t i = 0; i < q.size(); ++i) q[i] = std::lerp(start[i], goal[i], 0.005 * k);
    free += of_piano.IsFree(q);
    smaller_free += of_smaller.IsFree(q);
    EXPECT_EQ(of_smaller.IsFree(q), CheckMotion(smaller, q, q).outcome == MotionOutcome::kFree);
  }
  EXPECT_GT(free, 0);
  EXPECT_GT(smaller_free, free);
  EXPECT_LT(smaller_free, 201);
}

TEST(DilatedScenesTest, OverlapsMayBeAsDeepAsTheThinnerMovingGeomIsWideThenHalfOfThat) {
  const Scene scene = Scene::FromString(kBar);
  const std::vector<Scene> dilated = DilatedScenes(scene);
  ASSERT_EQ(dilated.size(), 7u);
  double depth = 0.2;
  for (const Scene& each : dilated) {
    ExpectMayOverlapBy(depth, each);
    depth /= 2.0;
  }
  ExpectMayOverlapBy(0.0, scene);  // which is what it was
}

TEST(DilatedScenesTest, WhatTheModelAllowsIsAllowedOnTopOfThat) {
  const Scene scene =
      Scene::FromString(kBar, {.allow = {{.names = {"bar", "block"}, .depth = 0.05}}});
  ExpectMayOverlapBy(0.25, DilatedScenes(scene).front());
}

TEST(DilatedScenesTest, WhereNothingIsConvexThereIsNone) {
  const Scene piano = Scene::FromFile(std::string(MJCF_PDG_MODEL_DIR) + "/passages/piano.xml",
                                      {.exclude = {{"piano", "world"}}, .exact_mesh = true});
  EXPECT_TRUE(DilatedScenes(piano).empty());
}

}  // namespace
}  // namespace mjcf_pdg
