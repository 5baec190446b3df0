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

}  // namespace
}  // namespace mjcf_pdg
