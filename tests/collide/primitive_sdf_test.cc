// Signed distances of primitives, their gradients, their minima over triangles.
#include "collide/exact/primitive_sdf.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "tests/support/test_support.h"
#include "verify/exact/primitive_distance.h"

namespace mjcf_pdg {
namespace {

using Eigen::Vector3d;
using test::Random;

const int kTypes[] = {mjGEOM_PLANE, mjGEOM_SPHERE, mjGEOM_CAPSULE, mjGEOM_ELLIPSOID,
                      mjGEOM_CYLINDER};

PrimitiveSdf RandomField(int type, Random& rng) {
  return {type, Vector3d(rng.Uniform(0.2, 1.0), rng.Uniform(0.2, 1.0), rng.Uniform(0.2, 1.0))};
}

TEST(PrimitiveSdfTest, SupportPointsBoundTheDistanceFromOutside) {
  Random rng(1);
  for (const int type : kTypes) {
    if (type == mjGEOM_PLANE) continue;
    for (int i = 0; i < 300; ++i) {
      const PrimitiveSdf field = RandomField(type, rng);
      const Vector3d x = rng.InBox(1.5);
      const SdfValue value = field.At(x);
      EXPECT_NEAR(value.gradient.norm(), 1.0, 1e-12);
      // Whatever the direction, a supporting plane is no farther; along the gradient it is as far.
      const Vector3d n = rng.UnitVector();
      EXPECT_GE(value.f, n.dot(x - field.Support(n)) - 1e-9);
      EXPECT_NEAR(value.f, value.gradient.dot(x - field.Support(value.gradient)), 1e-7)
          << test::TypeName(type);
      EXPECT_NEAR(value.f, verify::RoundDistanceAt(type, field.size, x), 1e-9)
          << test::TypeName(type);
      EXPECT_LE(field.Support(n).norm(), field.OuterRadius() + 1e-12);
    }
  }
}

TEST(PrimitiveSdfTest, EllipsoidsAreRightOnTheirPlanesOfSymmetry) {
  const Vector3d sizes[] = {{1, 2, 3}, {3, 1, 1}, {1, 1, 3}, {2, 2, 2}, {1, 3, 1}};
  for (const Vector3d& size : sizes) {
    const PrimitiveSdf field{mjGEOM_ELLIPSOID, size};
    EXPECT_NEAR(field.At(Vector3d::Zero()).f, -size.minCoeff(), 1e-12);
    for (int axis = 0; axis < 3; ++axis) {
      for (const double share : {0.01, 0.3, 0.7, 0.99, 1.0, 1.5}) {
        const Vector3d x = share * size[axis] * Vector3d::Unit(axis);
        EXPECT_NEAR(field.At(x).f, verify::RoundDistanceAt(mjGEOM_ELLIPSOID, size, x), 1e-9)
            << size.transpose() << " at " << x.transpose();
        const Vector3d beside = x + 1e-7 * Vector3d(1, 1, 1);
        EXPECT_NEAR(field.At(x).f, field.At(beside).f, 2e-7);
      }
    }
  }
}

TEST(PrimitiveSdfTest, GradientsBoundTheFunctionFromBelow) {
  Random rng(2);
  for (const int type : kTypes) {
    for (int i = 0; i < 500; ++i) {
      const PrimitiveSdf field = RandomField(type, rng);
      const Vector3d x = rng.InBox(1.5), y = rng.InBox(1.5);
      const SdfValue at_x = field.At(x);
      EXPECT_GE(field.At(y).f, at_x.f + at_x.gradient.dot(y - x) - 1e-9) << test::TypeName(type);
    }
  }
}

TEST(PrimitiveSdfTest, MinimaOnTrianglesAreThoseOfAnotherMethod) {
  Random rng(5);
  for (const int type : kTypes) {
    int below = 0;
    for (int i = 0; i < 200; ++i) {
      const PrimitiveSdf field = RandomField(type, rng);
      const double size = rng.Chance(0.5) ? 0.05 : 1.5;
      const Vector3d center = rng.InBox(1.2);
      const Vector3d corners[3] = {center + rng.InBox(size), center + rng.InBox(size),
                                   center + rng.InBox(rng.Chance(0.2) ? 1e-6 : size)};
      Vector3d x;
      const double expected = verify::RoundDistanceOnTriangle(type, field.size, corners, x);
      const SdfMinimum least = MinimumOnTriangle(field, corners, 1e9, 1e-9);
      EXPECT_LE(least.f, expected + 1e-8) << test::TypeName(type) << " " << i;
      EXPECT_GE(least.f, expected - 1e-7) << test::TypeName(type) << " " << i;
      EXPECT_NEAR(field.At(least.x).f, least.f, 1e-12);
      // A cutoff below the minimum is certain, one above changes nothing.
      EXPECT_EQ(MinimumOnTriangle(field, corners, expected - 1e-6, 1e-9).f, expected - 1e-6);
      EXPECT_NEAR(MinimumOnTriangle(field, corners, expected + 1e-3, 1e-9).f, least.f, 1e-8);
      below += expected < 0.0;
    }
    EXPECT_GT(below, 20) << test::TypeName(type);
  }
}

}  // namespace
}  // namespace mjcf_pdg
