// The lower bound where geoms are in height fields.
#include "bound/lower_bound_terrain.h"

#include <gtest/gtest.h>

#include "tests/bound/bound_check.h"
#include "tests/support/terrain.h"

namespace mjcf_pdg::test {
namespace {

class LowerBoundTerrainTest : public MujocoTest {};

VectorXd At(const Vector3d& p) {
  VectorXd q(7);
  q << p, 1, 0, 0, 0;
  return q;
}

// Flat but for one corner.
Field Flat() {
  return MakeField(20, 20, 1, 1, [](double x, double y) { return x + y < 1.95 ? 0.2 : 0.0; });
}

Field Waves() {
  return MakeField(40, 40, 1, 1, [](double x, double y) {
    return 0.05 * std::sin(9 * x) * std::cos(7 * y) + 0.03 * x;
  });
}

TEST_F(LowerBoundTerrainTest, OnAFlatFieldItIsThatOfAFloor) {
  const Scene scene = Scene::FromString(FieldXml(Flat(), {mjGEOM_SPHERE, {0.1, 0, 0}}));
  const AtStart at(scene, At({0.1, -0.2, 0.2 + 0.1 - 0.01}));
  EXPECT_LE(std::sqrt(at.Bound()), 0.01 - kTolerance);
  EXPECT_GE(std::sqrt(at.Bound()), 0.8 * 0.01);
}

TEST_F(LowerBoundTerrainTest, OnASlopeItIsTheDepthAlongItsNormal) {
  const double slope = 0.4, deep = 0.02;
  const Field field = MakeField(30, 30, 2, 2, [&](double x, double) { return slope * x; });
  const Scene scene = Scene::FromString(FieldXml(field, {mjGEOM_SPHERE, {0.1, 0, 0}}));
  const Vector3d n = Vector3d(-slope, 0, 1).normalized();
  const AtStart at(scene, At(Vector3d(0.21, 0.13, slope * 2.21) + (0.1 - deep) * n));
  EXPECT_LE(std::sqrt(at.Bound()), deep - kTolerance);
  EXPECT_GE(std::sqrt(at.Bound()), 0.8 * deep);
}

// At the end of a field the way past its side is short.
TEST_F(LowerBoundTerrainTest, TheSideOfAFieldIsAWayOut) {
  const Scene scene = Scene::FromString(FieldXml(Flat(), {mjGEOM_SPHERE, {0.1, 0, 0}}));
  const AtStart at(scene, At({-1.08, 0, 0.05}));
  EXPECT_LE(std::sqrt(at.Bound()), 0.02 - kTolerance);
  EXPECT_GE(std::sqrt(at.Bound()), 0.8 * 0.02);
}

TEST_F(LowerBoundTerrainTest, WhatIsFreeIsBoundByZero) {
  const Scene scene = Scene::FromString(FieldXml(Flat(), {mjGEOM_SPHERE, {0.1, 0, 0}}));
  const AtStart at(scene, At({0, 0, 0.2 + 0.1 + 1e-4}));
  EXPECT_FALSE(at.near.empty());
  EXPECT_EQ(at.Bound(), 0.0);
}

// The height of the surface at x, y in the frame of the field, triangle by triangle.
double HeightAt(const Field& field, double x, double y) {
  const double col = (x / field.half_x + 1.0) / 2.0 * (field.cols - 1);
  const double row = (y / field.half_y + 1.0) / 2.0 * (field.rows - 1);
  const int c = std::min(static_cast<int>(col), field.cols - 2);
  const int r = std::min(static_cast<int>(row), field.rows - 2);
  const double u = col - c, v = row - r;
  const auto z = [&](int dr, int dc) { return field.Corner(r + dr, c + dc).z(); };
  return u > v ? z(0, 0) + u * (z(0, 1) - z(0, 0)) + v * (z(1, 1) - z(0, 1))
               : z(0, 0) + v * (z(1, 0) - z(0, 0)) + u * (z(1, 1) - z(1, 0));
}

TEST_F(LowerBoundTerrainTest, SolidsAreInsideTheField) {
  Random rng(4);
  int looked_at = 0;
  for (int k = 0; k < 20; ++k) {
    Field field = NoisyField(12, 15, 1.5, 1.0, 0.4, rng);
    field.pose = "pos='.3 -.2 .1' euler='10 -20 30'";
    const Scene scene = Scene::FromString(FieldXml(field, {mjGEOM_BOX, {0.1, 0.2, 0.05}}));
    PosedModel posed(&scene.tables().query_model);
    posed.Pose(At({0, 0, 5}));
    const int geom = mj_name2id(scene.model(), mjOBJ_GEOM, "field");
    const Vector3d x = AsVector(posed.data()->geom_xpos + 3 * geom);
    const Matrix3d R = AsMatrix(posed.data()->geom_xmat + 9 * geom);
    NearPair near;
    near.p2_W = x + R * Vector3d(rng.Uniform(-1.5, 1.5), rng.Uniform(-1, 1), 0.1);
    near.n_W = R * Vector3d(rng.Uniform(-1, 1), rng.Uniform(-1, 1), 1).normalized();
    std::vector<InscribedSolid> solids;
    FindInscribed(posed, geom, near, rng.Uniform(0.01, 0.3), solids);
    for (const InscribedSolid& solid : solids) {
      double highest = -1.0;  // of the top below the surface
      for (int sample = 0; sample < 300; ++sample) {
        Vector3d p = Vector3d::Zero();
        double sum = 0.0;
        for (int corner = 0; corner < 8; ++corner) {
          // The first samples are on the top.
          const double share = sample < 200 && corner % 2 ? 0.0 : -std::log(rng.Uniform(1e-9, 1));
          p += share * solid.corners_W[corner];
          sum += share;
        }
        p = R.transpose() * (p / sum - x);
        const double below = p.z() - HeightAt(field, p.x(), p.y());
        ASSERT_LE(below, 1e-9);
        ASSERT_GE(p.z(), -field.base - 1e-9);
        highest = std::max(highest, below);
      }
      EXPECT_GT(highest, -0.4);
      ++looked_at;
    }
  }
  EXPECT_GT(looked_at, 100);
}

TEST_F(LowerBoundTerrainTest, HoldsForRandomGeomsOnWavesAndNoise) {
  Random rng(21);
  Ratios ratios;
  for (int k = 0; k < 16; ++k) {
    const Field field = k % 2 ? Waves() : NoisyField(15, 15, 1, 1, 0.1, rng);
    const Shape shape = RandomShape(ConvexTypes()[1 + rng.Index(6)], rng);
    ratios.Try(Scene::FromString(FieldXml(field, shape)), rng, Metric::kSequential, 0.15);
  }
  EXPECT_GT(ratios.values.size(), 8u);
  EXPECT_GT(ratios.Median(), 0.2);
}

// An arm of three hinges, its tip in the ground; a field that slides below a fixed post.
TEST_F(LowerBoundTerrainTest, HoldsForArmsAndMovingFields) {
  const std::string asset = FieldXml(Waves(), {mjGEOM_SPHERE, {0.1, 0, 0}});
  const std::string assets =
      asset.substr(asset.find("<asset>"), asset.find("</asset>") + 8 - asset.find("<asset>"));
  const std::string field = "<geom type='hfield' hfield='field'/>";
  Random rng(22);
  Ratios ratios;
  for (int k = 0; k < 8; ++k) {
    ratios.Try(Scene::FromString("<mujoco>" + assets + "<worldbody>" + field + R"(
        <body pos="0 0 .45"><joint axis="0 1 0"/><geom type="capsule" fromto="0 0 0 .3 0 0" size=".04"/>
        <body pos=".3 0 0"><joint axis="0 1 0"/><joint axis="0 0 1"/><geom type="capsule" fromto="0 0 0 .3 0 0" size=".04"/>
        <body pos=".3 0 0"><joint axis="0 1 0"/><geom type="box" size=".08 .05 .03" pos=".08 0 0"/>
        </body></body></body></worldbody></mujoco>)"),
               rng, Metric::kSequential, 0.7);
    ratios.Try(Scene::FromString("<mujoco>" + assets + "<worldbody><body><freejoint/>" + field +
                                 R"(<inertial pos="0 0 0" mass="3" diaginertia="1 1 2"/></body>
        <geom type="capsule" size=".1 .2" pos=".2 .1 .3"/></worldbody></mujoco>)"),
               rng, Metric::kSequential, 0.1);
  }
  EXPECT_GT(ratios.values.size(), 6u);
  EXPECT_GT(ratios.Median(), 0.1);
}

}  // namespace
}  // namespace mjcf_pdg::test
