// How far bodies are moved, in their own radii.
#include "plan/body_travel.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mjcf_pdg/scene.h"

namespace mjcf_pdg {
namespace {

// A sphere of 0.5 m on a slide, which carries on a hinge a sphere of 0.1 m that is 0.3 m from the
// axis. The plane's body has no radius.
Scene SlideAndHinge() {
  return Scene::FromString(R"(<mujoco><worldbody><geom type="plane" size="1 1 1" pos="0 0 -9"/>
    <body><joint type="slide" axis="1 0 0"/><geom type="sphere" size=".5"/>
      <body><joint type="hinge" axis="0 0 1"/><geom type="sphere" size=".1" pos=".3 0 0"/></body>
    </body></worldbody></mujoco>)");
}

TEST(BodyTravelTest, TheBodyThatMovesFarthestInItsOwnRadiiCounts) {
  const Scene scene = SlideAndHinge();
  BodyTravel travel(scene.tables());
  const VectorXd still = VectorXd::Zero(2);
  EXPECT_EQ(travel.InRadii(still, still), 0.0);
  EXPECT_NEAR(travel.InRadii(still, VectorXd{{0.2, 0.0}}), 2.0, 1e-12);
}

// By the chord of the centre and that of a point 1 m from it.
TEST(BodyTravelTest, ATurnCountsByChords) {
  const Scene scene = SlideAndHinge();
  BodyTravel travel(scene.tables());
  const double chord = 2.0 * std::sin(0.2);
  EXPECT_NEAR(travel.InRadii(VectorXd{{0.7, 0.1}}, VectorXd{{0.7, 0.5}}), chord * 0.3 / 0.1 + chord,
              1e-12);
}

// Two balls on slides of 1 m, one of 2 m across and one of 0.1 m: the small one tells.
TEST(BodyTravelTest, TypicalTravelIsThatOfTheSmallestBodyAndInProportionToTheLength) {
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody>
    <body><joint type="slide" axis="1 0 0" range="-.5 .5"/><geom type="sphere" size="1"/></body>
    <body pos="0 9 0"><joint type="slide" axis="1 0 0" range="-.5 .5"/>
      <geom type="sphere" size=".05" density="8e6"/></body>
    </worldbody></mujoco>)");
  const VectorXd still = VectorXd::Zero(2);
  const ConfigurationSpace space(scene, {}, still, still);
  const double travel = TypicalTravel(space, 0.01);
  // Two slides of equal masses: √σ is √½ of how far both go, and one goes at least as far as that.
  EXPECT_GT(travel, 0.0);
  EXPECT_LT(travel, 0.01 * std::sqrt(2.0) / 0.05);
  EXPECT_NEAR(TypicalTravel(space, 0.005), 0.5 * travel, 1e-9 * travel);
}

TEST(BodyTravelTest, TypicalTravelOfOneBodyIsTheLength) {
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody>
    <body><joint type="slide" axis="1 0 0" range="-.5 .5"/><geom type="sphere" size=".2"/></body>
    </worldbody></mujoco>)");
  const VectorXd still = VectorXd::Zero(1);
  const ConfigurationSpace space(scene, {}, still, still);
  EXPECT_NEAR(TypicalTravel(space, 0.01), 0.05, 1e-9);
}

}  // namespace
}  // namespace mjcf_pdg
