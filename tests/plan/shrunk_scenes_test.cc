// Scenes in which what moves is smaller: by how much, and about what.
#include "plan/shrunk_scenes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "mjcf_pdg/motion.h"
#include "mjcf_pdg/pdg.h"
#include "model/scene_tables.h"

namespace mjcf_pdg {
namespace {

// The beginning of a model, with a mesh of 0.8 m a side.
const std::string kCube = R"(<mujoco><asset><mesh name="cube" vertex="
    -.4 -.4 -.4  .4 -.4 -.4  -.4 .4 -.4  .4 .4 -.4
    -.4 -.4 .4  .4 -.4 .4  -.4 .4 .4  .4 .4 .4"/></asset>)";

constexpr double kTouching = 0.4;  // z of the geom on the block [m]
constexpr std::size_t kHalf = 7;   // the scene in which what moves has half of its size

// The solver asks the verifier, the motion checker the contacts of the search.
void ExpectTouchesAt(double z, const Scene& scene) {
  const double above = z + 1e-4, below = z - 1e-4;
  EXPECT_TRUE(Solver(scene).IsFree(std::vector<double>{above}));
  EXPECT_FALSE(Solver(scene).IsFree(std::vector<double>{below}));
  const auto moved_down_to = [&](double end) {
    return CheckMotion(scene, std::vector<double>{1.0}, std::vector<double>{end}).outcome;
  };
  EXPECT_EQ(moved_down_to(above), MotionOutcome::kFree);
  EXPECT_EQ(moved_down_to(below), MotionOutcome::kContact);
}

TEST(ShrunkScenesTest, WhatMovesGrowsBySixteenths) {
  for (const std::string geom : {"type='box' size='.3 .1 .4'", "type='sphere' size='.4'",
                                 "type='capsule' size='.1 .3'", "type='cylinder' size='.1 .4'",
                                 "type='ellipsoid' size='.1 .2 .4'", "type='mesh' mesh='cube'"}) {
    SCOPED_TRACE(geom);
    const Scene scene = Scene::FromString(kCube + R"(<worldbody>
        <geom type="box" size="2 2 2" pos="0 0 -2"/>
        <body><joint type="slide" axis="0 0 1"/><geom )" +
                                          geom + "/></body></worldbody></mujoco>");
    for (const Shrunk what : {Shrunk::kBodies, Shrunk::kGeoms}) {
      const std::vector<Scene> shrunk = ShrunkScenes(scene, what);
      ASSERT_EQ(shrunk.size(), 15U);
      for (std::size_t k = 0; k < shrunk.size(); ++k) {
        ExpectTouchesAt(static_cast<double>(k + 1) / 16.0 * kTouching, shrunk[k]);
        EXPECT_EQ(shrunk[k].tables().size, scene.tables().size);
      }
    }
    ExpectTouchesAt(kTouching, scene);  // which is what it was
  }
}

// Half as thick: half of the shortest edge is taken from each, but not from the one that is
// longest.
TEST(ShrunkScenesTest, AGeomThatIsThinnerIsAsLongAsBefore) {
  const std::string bar = R"(<mujoco><asset><mesh name="bar" vertex="
      -.4 -.1 -.2  .4 -.1 -.2  -.4 .1 -.2  .4 .1 -.2
      -.4 -.1 .2  .4 -.1 .2  -.4 .1 .2  .4 .1 .2"/></asset>)";
  struct Case {
    std::string geom;
    std::vector<double> half;  // along x, y, z, when it is half as thick [m]
  };
  const std::vector<Case> cases = {{"type='box' size='.3 .1 .4'", {0.25, 0.05, 0.4}},
                                   {"type='box' size='.4 .1 .4'", {0.35, 0.05, 0.35}},
                                   {"type='sphere' size='.4'", {0.2, 0.2, 0.2}},
                                   {"type='capsule' size='.1 .3'", {0.05, 0.05, 0.4}},
                                   {"type='cylinder' size='.1 .4'", {0.05, 0.05, 0.4}},
                                   {"type='cylinder' size='.4 .1'", {0.35, 0.35, 0.05}},
                                   {"type='ellipsoid' size='.1 .2 .4'", {0.05, 0.15, 0.4}},
                                   {"type='mesh' mesh='bar'", {0.4, 0.05, 0.15}}};
  const std::vector<std::string> up = {"euler='0 90 0'", "euler='90 0 0'", ""};
  for (const Case& each : cases) {
    for (std::size_t axis = 0; axis < up.size(); ++axis) {
      SCOPED_TRACE(each.geom + " " + up[axis]);
      const Scene scene =
          Scene::FromString(bar + R"(<worldbody>
          <geom type="box" size="2 2 2" pos="0 0 -2"/><body><joint type="slide" axis="0 0 1"/><geom )" +
                            each.geom + " " + up[axis] + "/></body></worldbody></mujoco>");
      ExpectTouchesAt(each.half[axis], ShrunkScenes(scene, Shrunk::kThickness).at(kHalf));
    }
  }
}

// About the centre of the sphere around its geoms, here 0.5 m above the body's frame. The frames of
// geoms that coincide with the body's or with that of its inertia move with the others.
TEST(ShrunkScenesTest, ABodyOfSeveralGeomsIsSmallerAsAWhole) {
  const std::string foot = R"(<geom type="box" size=".1 .1 .1"/>)";
  const std::string head = R"(<geom type="box" size=".1 .1 .1" pos="0 0 1" quat="1 1 0 0"/>)";
  const std::string inertia =
      R"(<inertial mass="1" pos="0 0 1" quat="1 1 0 0" diaginertia="3 2 1.5"/>)";
  for (const std::string& body : {foot + head, inertia + head + foot}) {
    const Scene scene = Scene::FromString(R"(<mujoco><worldbody>
        <geom type="box" size="2 2 2" pos="0 0 -2"/><geom type="box" size="2 2 2" pos="0 0 5"/>
        <body><joint type="slide" axis="0 0 1"/>)" +
                                          body + "</body></worldbody></mujoco>");
    const Scene shrunk = ShrunkScenes(scene, Shrunk::kBodies).at(kHalf);
    ExpectTouchesAt(-0.2, shrunk);
    Solver smaller(shrunk);
    EXPECT_TRUE(smaller.IsFree(std::vector<double>{2.2 - 1e-4}));
    EXPECT_FALSE(smaller.IsFree(std::vector<double>{2.2 + 1e-4}));
    // By geoms, which stay where they are, its feet are lower.
    ExpectTouchesAt(0.05, ShrunkScenes(scene, Shrunk::kGeoms).at(kHalf));
  }
}

// Balls beside each other's tops: no plane along an axis of their boxes parts them.
TEST(ShrunkScenesTest, TheVerifierKnowsTheSmallerShapes) {
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody>
      <geom type="sphere" size="2" pos="-1.2 -.9 -2"/>
      <body><joint type="slide" axis="0 0 1"/><geom type="sphere" size=".4"/></body>
      </worldbody></mujoco>)");
  const double radius = 2.0 + 0.4 / 16.0, touching = std::sqrt(radius * radius - 1.5 * 1.5) - 2.0;
  Solver smaller(ShrunkScenes(scene, Shrunk::kBodies).front());
  EXPECT_TRUE(smaller.IsFree(std::vector<double>{touching + 1e-4}));
  EXPECT_FALSE(smaller.IsFree(std::vector<double>{touching - 1e-4}));
}

TEST(ShrunkScenesTest, AMeshThatSomethingAtRestHasTooStaysAsItIs) {
  const Scene scene = Scene::FromString(kCube + R"(<worldbody>
      <geom type="mesh" mesh="cube" pos="0 0 -.4"/>
      <body><joint type="slide" axis="0 0 1"/><geom type="mesh" mesh="cube"/></body>
      </worldbody></mujoco>)");
  EXPECT_TRUE(ShrunkScenes(scene, Shrunk::kBodies).empty());
}

TEST(ShrunkScenesTest, AMeshOfTwoThatMoveIsSmallerForBoth) {
  const Scene scene = Scene::FromString(kCube + R"(<worldbody>
      <geom type="box" size="2 2 2" pos="0 0 -2"/>
      <body><joint type="slide" axis="0 0 1"/><geom type="mesh" mesh="cube"/></body>
      <body pos="1 0 0"><joint type="slide" axis="0 0 1"/><geom type="mesh" mesh="cube"/></body>
      </worldbody></mujoco>)");
  Solver smaller(ShrunkScenes(scene, Shrunk::kBodies).front());
  constexpr double kHalfEdge = 0.4 / 16.0;
  EXPECT_TRUE(smaller.IsFree(std::vector<double>{kHalfEdge + 1e-4, kHalfEdge + 1e-4}));
  EXPECT_FALSE(smaller.IsFree(std::vector<double>{kHalfEdge - 1e-4, kHalfEdge + 1e-4}));
  EXPECT_FALSE(smaller.IsFree(std::vector<double>{kHalfEdge + 1e-4, kHalfEdge - 1e-4}));
}

// Its size is part of the tendon's length.
TEST(ShrunkScenesTest, AGeomThatATendonWrapsAroundStaysAsItIs) {
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody>
      <site name="from" pos="-1 0 1"/><site name="to" pos="1 0 1"/>
      <geom type="box" size="2 2 2" pos="0 0 -2"/>
      <body><joint type="slide" axis="0 0 1"/><geom name="pulley" type="sphere" size=".4"/></body>
      </worldbody><tendon><spatial>
      <site site="from"/><geom geom="pulley"/><site site="to"/></spatial></tendon></mujoco>)");
  EXPECT_TRUE(ShrunkScenes(scene, Shrunk::kBodies).empty());
}

TEST(ShrunkScenesTest, AnExactMeshIsSmallerToo) {
  const Scene piano = Scene::FromFile(std::string(MJCF_PDG_MODEL_DIR) + "/passages/piano.xml",
                                      {.exact_mesh = true});
  ASSERT_TRUE(piano.HasExactMeshes());
  const Scene smaller = ShrunkScenes(piano, Shrunk::kBodies).at(2);
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

}  // namespace
}  // namespace mjcf_pdg
