// Slides along contacts: where they end, and what careful ones know that others do not.
#include "plan/contact_slide.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/plan/plan_test_support.h"

namespace mjcf_pdg {
namespace {

// A bar of 0.6 × 0.2 m in the plane, 3 mm from the walls of a channel on each side.
constexpr const char* kBarInChannel = R"(<mujoco><worldbody>
    <geom type="box" size="2 .1 .5" pos="0 .203 0"/><geom type="box" size="2 .1 .5" pos="0 -.203 0"/>
    <body><joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/><joint type="hinge" axis="0 0 1"/>
      <geom type="box" size=".3 .1 .2"/></body></worldbody></mujoco>)";

// A ball on top of a rod that turns about its lower end, which can be lifted; the ball stands on a
// plane, through which the rod passes.
constexpr const char* kBallOnARod =
    R"(<mujoco><worldbody><geom name="ground" type="plane" size="5 5 1" pos="0 0 .9"/>
    <body><joint type="slide" axis="0 0 1"/><joint type="hinge" axis="0 1 0"/>
      <geom name="ball" size=".1" pos="0 0 1"/></body></worldbody></mujoco>)";

class ContactSlideTest : public testing::Test {
 protected:
  // The least distance [m] at the end of the last of so many slides from q to `to`.
  double DistanceAfter(int slides, const VectorXd& q, const VectorXd& to) {
    const ConfigurationSpace space(scene_, {}, q, to);
    ContactSlide slide(scene_.tables(), space, {}, {.careful = careful_});
    for (int k = 0; k < slides; ++k) end_ = slide.Go(q, to);
    ContactFinder finder(scene_.tables());
    finder.Pose(end_);
    double least = 1.0;
    for (const NearPair& near : finder.Find(least)) least = std::min(least, near.distance);
    return least;
  }

  Scene scene_ = Scene::FromString(kBarInChannel);
  bool careful_ = false;
  VectorXd end_;
};

TEST_F(ContactSlideTest, WhereNothingIsNearItLeadsToTheTarget) {
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody>
    <body><joint type="slide"/><joint type="hinge"/><geom size=".1"/></body></worldbody></mujoco>)");
  const VectorXd q{{0.0, 0.0}}, to{{0.5, 0.3}};
  const ConfigurationSpace space(scene, {}, q, to);
  for (const bool careful : {false, true}) {
    ContactSlide slide(scene.tables(), space, {}, {.careful = careful});
    EXPECT_LT((slide.Go(q, to) - to).norm(), 1e-12);
  }
}

// Each wall has one pair of nearest points, at one end of the bar.
TEST_F(ContactSlideTest, ACarefulOneKnowsBothEndsOfABar) {
  const VectorXd q{{0.0, 0.0, 0.0}}, to{{0.3, 0.0, 0.3}};
  EXPECT_LT(DistanceAfter(4, q, to), -0.03);
  careful_ = true;
  EXPECT_GT(DistanceAfter(4, q, to), -1e-4);
  EXPECT_GT(end_[0], 0.29);
  EXPECT_GT(end_[2], 0.0);
}

TEST_F(ContactSlideTest, WhatItForgetsItDoesNotKnow) {
  const VectorXd q{{0.0, 0.0, 0.0}}, to{{0.3, 0.0, 0.3}};
  const ConfigurationSpace space(scene_, {}, q, to);
  ContactSlide slide(scene_.tables(), space, {}, {.careful = true});
  const VectorXd first = slide.Go(q, to);
  EXPECT_GT((slide.Go(q, to) - first).norm(), 1e-3);
  slide.Forget();
  EXPECT_EQ((slide.Go(q, to) - first).norm(), 0.0);
}

// To first order the ball does not fall when the rod turns.
TEST_F(ContactSlideTest, TheEndOfACarefulOneIsCorrected) {
  scene_ = Scene::FromString(kBallOnARod);
  const VectorXd q{{0.0, 0.0}}, to{{0.0, 0.4}};
  EXPECT_LT(DistanceAfter(1, q, to), -0.07);
  careful_ = true;
  EXPECT_GT(DistanceAfter(1, q, to), -0.005);
  EXPECT_GT(end_[1], 0.2);
}

// As in a run that begins with smaller bodies: the space is of the scene itself.
TEST_F(ContactSlideTest, ContactsAreOfTheTablesAndNotOfTheSpace) {
  scene_ = Scene::FromString(kBallOnARod);
  const Scene other = Scene::FromString(kBallOnARod, {.allow = {{{"ground", "ball"}, 0.2}}});
  const VectorXd q{{0.0, 0.0}}, to{{0.0, 0.4}};
  const ConfigurationSpace space(scene_, {}, q, to);
  ContactSlide slide(other.tables(), space, {}, {.careful = true});
  EXPECT_LT((slide.Go(q, to) - to).norm(), 1e-12);
}

}  // namespace
}  // namespace mjcf_pdg
