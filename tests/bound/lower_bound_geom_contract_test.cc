// What lower_bound_geom.h promises of its farthest and extreme points, against the definitions of
// the geoms.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "bound/lower_bound_geom.h"
#include "tests/bound/posed_geoms.h"

namespace mjcf_pdg::test {
namespace {

class LowerBoundGeomContractTest : public MujocoTest {};

const std::vector<int> kSolids = {mjGEOM_SPHERE,   mjGEOM_CAPSULE, mjGEOM_ELLIPSOID,
                                  mjGEOM_CYLINDER, mjGEOM_BOX,     mjGEOM_MESH};

// max n · x over the hull of the geom's points, grown by its radius.
double ReachOfPoints(const ConvexGeom& geom, const Vector3d& n) {
  double most = -std::numeric_limits<double>::infinity();
  for (int k = 0; k < geom.num_points(); ++k) most = std::max(most, n.dot(geom.Point(k)));
  return most + geom.radius * n.norm();
}

TEST_F(LowerBoundGeomContractTest, TheFarthestPointIsOfTheGeomAndNoneIsFarther) {
  Random rng(1);
  for (int trial = 0; trial < 120; ++trial) {
    const double scale = std::pow(10.0, rng.Uniform(-3.0, 3.0));
    const PosedGeoms geoms(kSolids[trial % 6], mjGEOM_BOX, 1.0, scale, rng);
    const ConvexGeom geom = geoms.Filled(0);
    for (int k = 0; k < 30; ++k) {
      const double length = std::pow(10.0, rng.Uniform(-3.0, 3.0));
      const Vector3d n = length * rng.UnitVector();
      const Vector3d p = geom.Support(n);
      EXPECT_NEAR(n.dot(p), geoms.Reach(0, n), 1e-6 * scale * length) << kSolids[trial % 6];
      for (int i = 0; i < 20; ++i) {
        const Vector3d other = rng.UnitVector();
        EXPECT_LE(other.dot(p), geoms.Reach(0, other) + 1e-6 * scale) << kSolids[trial % 6];
      }
    }
  }
}

TEST_F(LowerBoundGeomContractTest, TheGeomIsTheHullOfItsPointsGrownByTheRadiusOrInsideIt) {
  Random rng(2);
  int round = 0;
  for (int trial = 0; trial < 120; ++trial) {
    const int type = kSolids[trial % 6];
    const double scale = std::pow(10.0, rng.Uniform(-3.0, 3.0));
    const PosedGeoms geoms(mjGEOM_BOX, type, 1.0, scale, rng);
    const int id = geoms.model->geom_type[1] == type ? 1 : 0;
    const ConvexGeom geom = geoms.Filled(id);
    ASSERT_GT(geom.num_points(), 0);
    EXPECT_EQ(geom.round, type == mjGEOM_ELLIPSOID || type == mjGEOM_CYLINDER);
    round += geom.round;
    double widest = 0.0;
    for (int k = 0; k < 300; ++k) {
      const Vector3d n =
          k < 6 ? Vector3d((k % 2 ? 1.0 : -1.0) * geom.R.col(k / 2)) : rng.UnitVector();
      const double by_points = ReachOfPoints(geom, n), reach = geoms.Reach(id, n);
      EXPECT_GE(by_points, reach - 1e-6 * scale) << type;
      if (!geom.round) {
        EXPECT_NEAR(by_points, reach, 1e-6 * scale) << type;
      }
      const double from_center = n.dot(geom.center);
      widest = std::max(widest, (by_points - from_center) / (reach - from_center));
    }
    // A prism with 12 sides about a cylinder exceeds it by 1/cos 15° at most.
    if (type == mjGEOM_CYLINDER) {
      EXPECT_LT(widest, 1.0 / std::cos(mjPI / 12) + 1e-9);
    }
  }
  EXPECT_EQ(round, 40);
}

TEST_F(LowerBoundGeomContractTest, PointsThatAreGivenAreTheGeomWhateverItWasBefore) {
  Random rng(3);
  ConvexGeom geom;
  for (int trial = 0; trial < 60; ++trial) {
    const double scale = std::pow(10.0, rng.Uniform(-3.0, 3.0));
    const PosedGeoms geoms(kSolids[trial % 6], mjGEOM_BOX, 1.0, scale, rng);
    geom.Fill(*geoms.posed, *geoms.points, 0);
    std::vector<Vector3d> corners(1 + rng.Index(8));
    for (Vector3d& corner : corners) corner = scale * (rng.InBox(1.0) + Vector3d(3, 2, 1));
    geom.Fill(corners);
    EXPECT_FALSE(geom.round);
    EXPECT_EQ(geom.core_radius, 0.0);
    ASSERT_EQ(geom.num_points(), static_cast<int>(corners.size()));
    for (int k = 0; k < 40; ++k) {
      const Vector3d n = rng.UnitVector(), p = geom.Support(n);
      double most = -std::numeric_limits<double>::infinity(), off = -most;
      for (const Vector3d& corner : corners) {
        most = std::max(most, n.dot(corner));
        off = std::min(off, (corner - p).norm());
      }
      EXPECT_EQ(off, 0.0);
      EXPECT_EQ(n.dot(p), most);
      EXPECT_NEAR(ReachOfPoints(geom, n), most, 1e-14 * scale);
    }
    geom.Fill(*geoms.posed, *geoms.points, 0);
    const Vector3d n = rng.UnitVector();
    EXPECT_NEAR(n.dot(geom.Support(n)), geoms.Reach(0, n), 1e-6 * scale);
  }
}

// The core is what a sphere or capsule exceeds by its radius; others are their own cores.
TEST_F(LowerBoundGeomContractTest, TheCoreRadiusIsThatOfSpheresAndCapsules) {
  Random rng(4);
  for (const int type : kSolids) {
    PosedGeoms geoms(type, mjGEOM_MESH, 1.0, 1.0, rng);
    const ConvexGeom geom = geoms.Filled(0);
    const bool has_core = type == mjGEOM_SPHERE || type == mjGEOM_CAPSULE;
    EXPECT_EQ(geom.core_radius, has_core ? geoms.model->geom_size[0] : 0.0) << type;
    if (type != mjGEOM_CAPSULE) continue;
    geoms.model->geom_size[1] = 0.0;
    const ConvexGeom sphere = geoms.Filled(0);
    const Vector3d n = rng.UnitVector();
    EXPECT_NEAR(n.dot(sphere.Support(n) - sphere.center), geoms.model->geom_size[0], 1e-12);
    EXPECT_NEAR(ReachOfPoints(sphere, n), n.dot(sphere.Support(n)), 1e-12);
  }
}

TEST_F(LowerBoundGeomContractTest, OfAPlaneTheCenterAndTheAxesAreThoseInTheWorld) {
  Random rng(5);
  for (int trial = 0; trial < 10; ++trial) {
    const PosedGeoms geoms(mjGEOM_PLANE, mjGEOM_BOX, 1.0, 1.0, rng);
    const ConvexGeom plane = geoms.Filled(0);
    EXPECT_EQ(plane.center, Vector3d::Zero());
    const mjtNum* xmat = geoms.posed->data()->geom_xmat;
    EXPECT_EQ(plane.R.col(2), Vector3d(xmat[2], xmat[5], xmat[8]));
    EXPECT_EQ(plane.num_points(), 0);
  }
}

}  // namespace
}  // namespace mjcf_pdg::test
