// Dilated scenes: what may overlap there, and by how much.
#include "plan/dilation.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "mjcf_pdg/motion.h"
#include "mjcf_pdg/pdg.h"

namespace mjcf_pdg {
namespace {

// A bar, 0.2 m at its thinnest, over a block that is larger.
constexpr char kBar[] = R"(<mujoco><worldbody>
    <geom name="block" type="box" size="2 2 2" pos="0 0 -2"/>
    <body name="bar"><joint type="slide" axis="0 0 1"/><geom name="bar" type="box" size=".3 .1 .4"/>
    </body></worldbody></mujoco>)";

// The solver asks the verifier, the motion checker the contacts of the search.
void ExpectMayOverlapBy(double depth, const Scene& scene) {
  const double touching = 0.4, less = touching - depth + 1e-4, more = touching - depth - 1e-4;
  EXPECT_TRUE(Solver(scene).IsFree(std::vector<double>{less}));
  EXPECT_FALSE(Solver(scene).IsFree(std::vector<double>{more}));
  const auto moved_down_to = [&](double z) {
    return CheckMotion(scene, std::vector<double>{1.0}, std::vector<double>{z}).outcome;
  };
  EXPECT_EQ(moved_down_to(less), MotionOutcome::kFree);
  EXPECT_EQ(moved_down_to(more), MotionOutcome::kContact);
}

TEST(DilationTest, OverlapsMayBeAsDeepAsTheThinnerMovingGeomIsWideThenHalfOfThat) {
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

TEST(DilationTest, WhatTheModelAllowsIsAllowedOnTopOfThat) {
  const Scene scene =
      Scene::FromString(kBar, {.allow = {{.names = {"bar", "block"}, .depth = 0.05}}});
  ExpectMayOverlapBy(0.25, DilatedScenes(scene).front());
}

TEST(DilationTest, WhereNothingIsConvexThereIsNone) {
  const Scene piano = Scene::FromFile(std::string(MJCF_PDG_MODEL_DIR) + "/passages/piano.xml",
                                      {.exclude = {{"piano", "world"}}, .exact_mesh = true});
  EXPECT_TRUE(DilatedScenes(piano).empty());
}

}  // namespace
}  // namespace mjcf_pdg
