// Flaws and mass properties of meshes whose answers are known.
#include "triangle_mesh.h"

#include <gtest/gtest.h>

#include "hand_made_meshes.h"
#include "test_support.h"

namespace mjcf_pdg::test {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

struct Repaired {
  TriangleMesh mesh;
  MeshRepairs repairs;
  MeshTopology topology;
  SolidProperties solid;
};

Repaired Repair(const TriangleMesh& mesh) {
  Repaired result;
  result.mesh = RepairMesh(WeldVertices(mesh), &result.repairs);
  result.topology = FindTopology(result.mesh);
  result.solid = FindSolidProperties(result.mesh);
  return result;
}

int NumRepairs(const MeshRepairs& r) {
  return r.repeated_corners + r.duplicates + r.non_manifold_edges + r.turned + r.inward_components;
}

TEST(TriangleMeshTest, ASoundMeshIsLeftAsItIs) {
  for (const TriangleMesh& mesh : {CubeMesh(), TetrahedronMesh(), TorusMesh(2.0, 0.5, 12)}) {
    const Repaired result = Repair(mesh);
    EXPECT_EQ(NumRepairs(result.repairs), 0);
    EXPECT_EQ(result.topology.components, 1);
    EXPECT_EQ(result.topology.open_edges, 0);
    EXPECT_EQ(result.topology.zero_area, 0);
    EXPECT_GT(result.solid.volume, 0.0);
    EXPECT_EQ(result.mesh.vertices.cols(), mesh.vertices.cols());
    EXPECT_EQ(result.mesh.vertices(Eigen::all, result.mesh.triangles.reshaped()),
              mesh.vertices(Eigen::all, mesh.triangles.reshaped()));
  }
}

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
  const SolidProperties box = FindSolidProperties(BoxMesh(size, low));
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
    TriangleMesh mesh = BoxMesh(random.InBox(1.0).cwiseAbs() + Vector3d::Constant(0.1));
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

TEST(TriangleMeshTest, AnInwardMeshIsTurnedOutwards) {
  EXPECT_NEAR(FindSolidProperties(InsideOut(CubeMesh())).volume, -1.0, 1e-15);
  const Repaired result = Repair(InsideOut(CubeMesh()));
  EXPECT_EQ(result.repairs.inward_components, 1);
  EXPECT_EQ(result.repairs.turned, 0);
  EXPECT_NEAR(result.solid.volume, 1.0, 1e-15);
}

TEST(TriangleMeshTest, AnyMixOfOrientationsComesOutConsistent) {
  Random random(4);
  int mixed = 0;
  for (int trial = 0; trial < 50; ++trial) {
    TriangleMesh mesh = Together(TorusMesh(2.0, 0.5, 8), CubeMesh({5, 5, 5}));
    for (int t = 0; t < mesh.triangles.cols(); ++t) {
      if (random.Chance(0.5)) std::swap(mesh.triangles(1, t), mesh.triangles(2, t));
    }
    const Repaired result = Repair(mesh);
    mixed += result.repairs.turned > 0;
    EXPECT_LE(result.repairs.turned, mesh.triangles.cols() / 2);
    EXPECT_EQ(result.topology.open_edges, 0);
    EXPECT_NEAR(result.solid.volume,
                FindSolidProperties(Together(TorusMesh(2.0, 0.5, 8), CubeMesh())).volume, 1e-12);
  }
  EXPECT_GT(mixed, 45);
}

TEST(TriangleMeshTest, AnOpenMeshIsCalledOpen) {
  const Repaired result = Repair(Without(CubeMesh(), 5));
  EXPECT_EQ(result.topology.open_edges, 3);
  EXPECT_EQ(result.topology.components, 1);
  EXPECT_EQ(NumRepairs(result.repairs), 0);
}

TEST(TriangleMeshTest, AMoebiusStripCannotBeRepairedAndStaysOpen) {
  constexpr int kQuads = 6;
  TriangleMesh strip = {Eigen::Matrix3Xd(3, 2 * kQuads), Eigen::Matrix3Xi(3, 2 * kQuads)};
  for (int i = 0; i < kQuads; ++i) {
    const double u = 2 * EIGEN_PI * i / kQuads;
    const Vector3d radial(std::cos(u), std::sin(u), 0.0);
    const Vector3d across = std::cos(u / 2) * radial + std::sin(u / 2) * Vector3d::UnitZ();
    strip.vertices.col(2 * i) = radial + 0.3 * across;
    strip.vertices.col(2 * i + 1) = radial - 0.3 * across;
    const bool last = i + 1 == kQuads;
    const int a = 2 * i, b = 2 * i + 1, c = last ? 1 : a + 2, d = last ? 0 : b + 2;
    strip.triangles.col(2 * i) << a, b, c;
    strip.triangles.col(2 * i + 1) << c, b, d;
  }
  const Repaired result = Repair(strip);
  EXPECT_GT(result.topology.open_edges, 2 * kQuads);  // the rim, and where the turn is
  EXPECT_EQ(result.topology.components, 1);
}

TEST(TriangleMeshTest, DegenerateAndDuplicateTrianglesAreRemoved) {
  TriangleMesh mesh = CubeMesh();
  mesh.triangles.conservativeResize(3, 15);
  mesh.triangles.col(12) << 3, 3, 5;                         // a corner twice
  mesh.triangles.col(13) = mesh.triangles.col(4);            // again
  mesh.triangles.col(14) = mesh.triangles.col(7).reverse();  // again, the other way round
  const Repaired result = Repair(mesh);
  EXPECT_EQ(result.repairs.repeated_corners, 1);
  EXPECT_EQ(result.repairs.duplicates, 2);
  EXPECT_EQ(result.repairs.turned, 0);
  EXPECT_EQ(result.topology.open_edges, 0);
  EXPECT_NEAR(result.solid.volume, 1.0, 1e-15);
}

TEST(TriangleMeshTest, ATriangleWithoutAreaThatClosesTheSurfaceIsKept) {
  // The face z = 0 with a vertex on the middle of one of its edges, met from one side only.
  TriangleMesh mesh = CubeMesh();
  mesh.vertices.conservativeResize(3, 9);
  mesh.vertices.col(8) << 0.5, 0.0, 0.0;
  mesh.triangles.conservativeResize(3, 14);
  mesh.triangles.col(4) << 0, 8, 5;  // was 0 1 5
  mesh.triangles.col(12) << 8, 1, 5;
  mesh.triangles.col(13) << 0, 1, 8;
  const Repaired result = Repair(mesh);
  EXPECT_EQ(result.topology.zero_area, 1);
  EXPECT_EQ(result.topology.open_edges, 0);
  EXPECT_NEAR(result.solid.volume, 1.0, 1e-15);
}

TEST(TriangleMeshTest, SeparateSolidsAreComponents) {
  const Repaired result = Repair(Together(CubeMesh(), CubeMesh({3, 0, 0})));
  EXPECT_EQ(result.topology.components, 2);
  EXPECT_EQ(NumRepairs(result.repairs), 0);
  EXPECT_NEAR(result.solid.volume, 2.0, 1e-14);
}

TEST(TriangleMeshTest, SolidsThatShareAnEdgeOrVertexAreCutApart) {
  for (const Vector3d& low : {Vector3d(1, 1, 0), Vector3d(1, 1, 1)}) {
    for (const bool inside_out : {false, true}) {
      TriangleMesh other = CubeMesh(low);
      if (inside_out) other = InsideOut(other);
      const Repaired result = Repair(Together(CubeMesh(), other));
      EXPECT_EQ(result.repairs.non_manifold_edges, low.z() == 0.0 ? 1 : 0);
      EXPECT_EQ(result.repairs.inward_components, inside_out);
      EXPECT_EQ(result.topology.components, 2);
      EXPECT_EQ(result.topology.open_edges, 0);
      EXPECT_NEAR(result.solid.volume, 2.0, 1e-14);
    }
  }
}

TEST(TriangleMeshTest, ACavityStaysACavityWhicheverWayTheFileFaces) {
  const TriangleMesh outer = BoxMesh({3, 3, 3}), inner = CubeMesh({1, 1, 1});
  const TriangleMesh hollow = Together(outer, InsideOut(inner));
  for (const TriangleMesh& mesh : {hollow, InsideOut(hollow)}) {
    const Repaired result = Repair(mesh);
    EXPECT_NEAR(result.solid.volume, 26.0, 1e-12);
    EXPECT_EQ(result.topology.components, 2);
    EXPECT_EQ(result.topology.nested_components, 0);
  }
  EXPECT_EQ(Repair(hollow).repairs.inward_components, 0);
  EXPECT_EQ(Repair(InsideOut(hollow)).repairs.inward_components, 2);
}

TEST(TriangleMeshTest, ASolidInsideASolidIsReported) {
  const Repaired result = Repair(Together(BoxMesh({3, 3, 3}), CubeMesh({1, 1, 1})));
  EXPECT_EQ(result.topology.nested_components, 1);
  EXPECT_NEAR(result.solid.volume, 28.0, 1e-12);
}

}  // namespace
}  // namespace mjcf_pdg::test
