// What is drawn, and in which colours.
#include "apps/view/ghost_scene.h"

#include <gmock/gmock.h>

#include <cmath>
#include <map>

#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

using app::Configuration;
using app::GhostScene;
using Color = std::array<float, 3>;

// Two balls; one has a collision geom that is not shown by default.
constexpr char kScene[] = R"(<mujoco><worldbody>
  <geom name="floor" type="plane" size="5 5 .1" rgba="0 1 0 1"/>
  <body name="left"><joint type="slide" axis="0 0 1"/>
    <geom name="seen" size=".1" pos="-1 0 0" rgba="0 1 0 1"/>
    <geom name="hidden" size=".05" pos="-1 0 0" group="3"/></body>
  <body name="right"><joint type="slide" axis="0 0 1"/>
    <geom name="other" size=".1" pos="1 0 0" rgba="0 1 0 1"/></body></worldbody></mujoco>)";

class ViewGhostSceneTest : public MujocoTest {
 protected:
  ViewGhostSceneTest() : model_(LoadModel(kScene)), view_(*model_) {
    Configuration row;
    row.q = {0.0, 0.5};
    view_.SetCommand(row);
  }
  int Geom(const char* name) const { return mj_name2id(model_.get(), mjOBJ_GEOM, name); }

  // The geoms of the model that are drawn: how many times, by id.
  std::map<int, std::vector<const mjvGeom*>> Drawn() const {
    std::map<int, std::vector<const mjvGeom*>> drawn;
    for (int i = 0; i < view_.scene.ngeom; ++i) {
      const mjvGeom& geom = view_.scene.geoms[i];
      if (geom.objtype == mjOBJ_GEOM) drawn[geom.objid].push_back(&geom);
    }
    return drawn;
  }
  static Color ColorOf(const mjvGeom& geom) { return {geom.rgba[0], geom.rgba[1], geom.rgba[2]}; }

  ModelPtr model_;
  GhostScene view_;
};

TEST_F(ViewGhostSceneTest, OfTheGhostOnlyWhatIsElsewhereIsDrawn) {
  view_.SetGhost(std::vector{0.2, 0.5}, true);
  view_.Update({}, {});
  const auto drawn = Drawn();
  ASSERT_EQ(drawn.at(Geom("seen")).size(), 2u);
  EXPECT_EQ(drawn.at(Geom("other")).size(), 1u);
  EXPECT_EQ(drawn.at(Geom("floor")).size(), 1u);
  const mjvGeom& ghost = *drawn.at(Geom("seen"))[1];
  EXPECT_EQ(ColorOf(ghost), app::kGhostColor);
  EXPECT_LT(ghost.rgba[3], 1.0f);
  EXPECT_NEAR(ghost.pos[2], 0.2, 1e-6);
  // The command is grey, although the model is green.
  const Color grey = ColorOf(*drawn.at(Geom("seen"))[0]);
  EXPECT_LT(std::abs(grey[1] - grey[0]), 0.15f);
}

TEST_F(ViewGhostSceneTest, WhatOverlapsIsOrangeEvenIfItsGroupIsNotShown) {
  view_.Update({Geom("hidden"), Geom("floor")}, {});
  const auto drawn = Drawn();
  ASSERT_EQ(drawn.at(Geom("hidden")).size(), 1u);
  EXPECT_EQ(ColorOf(*drawn.at(Geom("hidden"))[0]), app::kGuiltyColor);
  const Color floor = ColorOf(*drawn.at(Geom("floor"))[0]);
  EXPECT_GT(floor[0], floor[2] + 0.1f) << "the floor is tinted";
  view_.Update({}, {});
  EXPECT_EQ(Drawn().count(Geom("hidden")), 0u);
}

TEST_F(ViewGhostSceneTest, CommandAndGhostCanBeLeftOut) {
  view_.SetGhost(std::vector{0.2, 0.5}, false);
  view_.Update({}, {.command = false});
  auto drawn = Drawn();
  ASSERT_EQ(drawn.at(Geom("seen")).size(), 1u);
  EXPECT_EQ(ColorOf(*drawn.at(Geom("seen"))[0]), app::kUnfreeGhostColor);
  EXPECT_EQ(drawn.count(Geom("other")), 0u);
  view_.Update({}, {.ghost = false, .own_colors = true});
  drawn = Drawn();
  ASSERT_EQ(drawn.at(Geom("seen")).size(), 1u);
  EXPECT_EQ(ColorOf(*drawn.at(Geom("seen"))[0]), (Color{0, 1, 0}));
}

TEST_F(ViewGhostSceneTest, TheLettersShowContactsAndForces) {
  Configuration row;
  row.q = {0.0, 0.05};  // the right ball is 5 cm in the floor
  const auto decorations = [&] {
    view_.SetCommand(row);
    view_.Update({}, {});
    int count = 0;
    for (int i = 0; i < view_.scene.ngeom; ++i) {
      count += view_.scene.geoms[i].objtype != mjOBJ_GEOM ||
               view_.scene.geoms[i].category == mjCAT_DECOR;
    }
    return count;
  };
  const int none = decorations();
  view_.option.flags[mjVIS_CONTACTPOINT] = 1;
  const int points = decorations();
  EXPECT_GT(points, none);
  view_.option.flags[mjVIS_CONTACTFORCE] = 1;
  EXPECT_GT(decorations(), points);
}

TEST_F(ViewGhostSceneTest, APickFindsTheBodyInTheMiddle) {
  view_.camera.lookat[0] = 1;
  view_.camera.lookat[2] = 0.5;
  view_.camera.distance = 3;
  view_.camera.elevation = -10;
  view_.Update({}, {});
  const auto hit = view_.Pick(1.5, 0.5, 0.5);
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->body, mj_name2id(model_.get(), mjOBJ_BODY, "right"));
  const Eigen::Vector3d from_centre(hit->point_W[0] - 1, hit->point_W[1], hit->point_W[2] - 0.5);
  EXPECT_NEAR(from_centre.norm(), 0.1, 1e-6);
}

// Machado, Oliveira and Fernandes, "A physiologically-based model for simulation of color vision
// deficiency", 2009: what a deuteranope sees, in linear RGB.
Color Deuteranope(const Color& srgb) {
  constexpr double kMatrix[3][3] = {{0.367322, 0.860646, -0.227968},
                                    {0.280085, 0.672501, 0.047413},
                                    {-0.011820, 0.042940, 0.968881}};
  double linear[3];
  for (int k = 0; k < 3; ++k) {
    linear[k] = srgb[k] <= 0.04045 ? srgb[k] / 12.92 : std::pow((srgb[k] + 0.055) / 1.055, 2.4);
  }
  Color seen;
  for (int k = 0; k < 3; ++k) {
    double value = 0;
    for (int j = 0; j < 3; ++j) value += kMatrix[k][j] * linear[j];
    value = std::clamp(value, 0.0, 1.0);
    value = value <= 0.0031308 ? 12.92 * value : 1.055 * std::pow(value, 1 / 2.4) - 0.055;
    seen[k] = static_cast<float>(value);
  }
  return seen;
}

TEST_F(ViewGhostSceneTest, ADeuteranopeTellsTheColoursApart) {
  const std::array colors = {Deuteranope(app::kGuiltyColor), Deuteranope(app::kGhostColor),
                             Deuteranope(app::kUnfreeGhostColor), Color{0.3f, 0.3f, 0.3f}};
  for (std::size_t a = 0; a < colors.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      double distance = 0;
      for (int k = 0; k < 3; ++k) distance += std::pow(colors[a][k] - colors[b][k], 2);
      EXPECT_GT(std::sqrt(distance), 0.4) << a << " and " << b;
    }
  }
  // Red and green of the same lightness would not pass.
  const Color red = Deuteranope({0.8f, 0.3f, 0.2f}), green = Deuteranope({0.45f, 0.5f, 0.15f});
  double distance = 0;
  for (int k = 0; k < 3; ++k) distance += std::pow(red[k] - green[k], 2);
  EXPECT_LT(std::sqrt(distance), 0.4);
}

}  // namespace
}  // namespace mjcf_pdg::test
