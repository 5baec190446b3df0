// Welding and mass properties of meshes whose answers are known.
#include "mesh/triangle_mesh.h"

#include <gtest/gtest.h>

#include "tests/support/hand_made_meshes.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

TEST(TriangleMeshTest, WeldingJoinsEqualVerticesAndDropsUnusedOnes) {
  const TriangleMesh cube = CubeMesh();
  EXPECT_EQ(Soup(cube).vertices.cols(), 36);
  EXPECT_EQ(WeldVertices(Soup(cube)).vertices.cols(), 8);
  const TriangleMesh lonely = Without(TetrahedronMesh(), 3);
  EXPECT_EQ(WeldVertices(Without(Without(lonely, 2), 1)).vertices.cols(), 3);
  TriangleMesh signed_zeros = Soup(cube);
  for (double& x : signed_zeros.vertices.reshaped()) x = x == 0.0 ? -0.0 : x;
  EXPECT_EQ(WeldVertices(Together(Soup(cube), signed_zeros)).vertices.cols(), 8);
  TriangleMesh apart = Soup(cube);
  apart.vertices(0, 0) += 1e-12;  // exact: a hair's breadth is a gap
  EXPECT_EQ(WeldVertices(apart).vertices.cols(), 9);
}

TEST(TriangleMeshTest, BoxAndTetrahedronHaveTheirTextbookInertia) {
  const Vector3d size(1.0, 2.0, 3.0), low(10.0, -20.0, 30.0);
  const SolidProperties box = FindSolidProperties(CuboidMesh(size, low));
  EXPECT_NEAR(box.volume, 6.0, 1e-12);
  EXPECT_TRUE(box.center.isApprox(low + size / 2, 1e-14));
  const Matrix3d expected = (6.0 / 12.0 * Vector3d(4 + 9, 1 + 9, 1 + 4)).asDiagonal();
  EXPECT_TRUE(box.inertia.isApprox(expected, 1e-12)) << box.inertia;

  const SolidProperties tetrahedron = FindSolidProperties(TetrahedronMesh());
  EXPECT_NEAR(tetrahedron.volume, 1.0 / 6.0, 1e-15);
  EXPECT_TRUE(tetrahedron.center.isApprox(Vector3d::Constant(0.25), 1e-14));
  // ∫x² = 1/60, ∫xy = 1/120 about the corner; V c cᵀ = 1/96.
  const double moment = 2.0 * (1.0 / 60.0 - 1.0 / 96.0), product = 1.0 / 120.0 - 1.0 / 96.0;
  EXPECT_NEAR(tetrahedron.inertia(0, 0), moment, 1e-15);
  EXPECT_NEAR(tetrahedron.inertia(0, 1), -product, 1e-15);
  EXPECT_NEAR(tetrahedron.inertia(1, 2), -product, 1e-15);
}

TEST(TriangleMeshTest, TorusConvergesToItsFormulas) {
  const double ring = 2.0, tube = 0.5;
  const SolidProperties solid = FindSolidProperties(TorusMesh(ring, tube, 200));
  const double volume = 2.0 * EIGEN_PI * EIGEN_PI * ring * tube * tube;
  EXPECT_NEAR(solid.volume, volume, 1e-3 * volume);
  EXPECT_NEAR(SurfaceArea(TorusMesh(ring, tube, 200)), 4.0 * EIGEN_PI * EIGEN_PI * ring * tube,
              1e-2);
  const double about_z = volume * (ring * ring + 0.75 * tube * tube);
  EXPECT_NEAR(solid.inertia(2, 2), about_z, 1e-3 * about_z);
  const double across = volume * (0.5 * ring * ring + 0.625 * tube * tube);
  EXPECT_NEAR(solid.inertia(0, 0), across, 1e-3 * across);
}

TEST(TriangleMeshTest, MassPropertiesMoveAndTurnWithTheMesh) {
  Random random(3);
  for (int i = 0; i < 20; ++i) {
    TriangleMesh mesh = CuboidMesh(random.InBox(1.0).cwiseAbs() + Vector3d::Constant(0.1));
    const SolidProperties before = FindSolidProperties(mesh);
    const Matrix3d turn = random.UnitQuat().toRotationMatrix();
    const Vector3d shift = random.InBox(1000.0);
    mesh.vertices = ((turn * mesh.vertices).colwise() + shift).eval();
    const SolidProperties after = FindSolidProperties(mesh);
    EXPECT_NEAR(after.volume, before.volume, 1e-9 * before.volume);
    EXPECT_TRUE(after.center.isApprox(turn * before.center + shift, 1e-12));
    EXPECT_TRUE(after.inertia.isApprox(turn * before.inertia * turn.transpose(), 1e-9));
  }
}

}  // namespace
}  // namespace mjcf_pdg::test
