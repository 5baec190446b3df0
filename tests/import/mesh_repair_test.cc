// Flaws of meshes whose answers are known.
#include "import/mesh_repair.h"

#include <gtest/gtest.h>

#include "mesh/mesh_components.h"
#include "tests/support/hand_made_meshes.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

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

TEST(MeshRepairTest, ASoundMeshIsLeftAsItIs) {
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

TEST(MeshRepairTest, AnInwardMeshIsTurnedOutwards) {
  EXPECT_NEAR(FindSolidProperties(InsideOut(CubeMesh())).volume, -1.0, 1e-15);
  const Repaired result = Repair(InsideOut(CubeMesh()));
  EXPECT_EQ(result.repairs.inward_components, 1);
  EXPECT_EQ(result.repairs.turned, 0);
  EXPECT_NEAR(result.solid.volume, 1.0, 1e-15);
}

TEST(MeshRepairTest, AnyMixOfOrientationsComesOutConsistent) {
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

TEST(MeshRepairTest, AnOpenMeshIsCalledOpen) {
  const Repaired result = Repair(Without(CubeMesh(), 5));
  EXPECT_EQ(result.topology.open_edges, 3);
  EXPECT_EQ(result.topology.components, 1);
  EXPECT_EQ(NumRepairs(result.repairs), 0);
}

TEST(MeshRepairTest, AMoebiusStripCannotBeRepairedAndStaysOpen) {
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

TEST(MeshRepairTest, DegenerateAndDuplicateTrianglesAreRemoved) {
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

TEST(MeshRepairTest, ATriangleWithoutAreaThatClosesTheSurfaceIsKept) {
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

TEST(MeshRepairTest, SeparateSolidsAreComponents) {
  const Repaired result = Repair(Together(CubeMesh(), CubeMesh({3, 0, 0})));
  EXPECT_EQ(result.topology.components, 2);
  EXPECT_EQ(NumRepairs(result.repairs), 0);
  EXPECT_NEAR(result.solid.volume, 2.0, 1e-14);
}

TEST(MeshRepairTest, SolidsThatShareAnEdgeOrVertexAreCutApart) {
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

TEST(MeshRepairTest, ACavityStaysACavityWhicheverWayTheFileFaces) {
  const TriangleMesh outer = CuboidMesh({3, 3, 3}), inner = CubeMesh({1, 1, 1});
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

TEST(MeshRepairTest, ASolidInsideASolidIsReported) {
  const Repaired result = Repair(Together(CuboidMesh({3, 3, 3}), CubeMesh({1, 1, 1})));
  EXPECT_EQ(result.topology.nested_components, 1);
  EXPECT_NEAR(result.solid.volume, 28.0, 1e-12);
}

// x -> -x.
TriangleMesh Mirrored(TriangleMesh mesh) {
  mesh.vertices.row(0) *= -1.0;
  return InsideOut(mesh);
}

// Every triangle for both sides.
TriangleMesh DoubleSided(const TriangleMesh& mesh) {
  return WeldVertices(Together(mesh, InsideOut(mesh)));
}

void ExpectBvhs(const Repaired& result, int count, double volume) {
  EXPECT_EQ(result.topology.components, count);
  EXPECT_EQ(result.topology.open_edges, 0);
  EXPECT_EQ(result.topology.nested_components, 0);
  EXPECT_EQ(result.repairs.duplicates, 0);
  EXPECT_NEAR(result.solid.volume, volume, 1e-5);
}

TEST(MeshRepairTest, SolidsThatTouchInAFaceStayWhole) {
  const TriangleMesh cube = CubeMesh(), beside = CubeMesh({1, 0, 0});
  // With the diagonals of the face between them along each other, and across.
  const TriangleMesh mirrored = Mirrored(CubeMesh({-2, 0, 0}));
  const struct {
    TriangleMesh mesh;
    int count;
  } cases[] = {{Together(cube, beside), 2},
               {Together(cube, mirrored), 2},
               {Together(Together(cube, beside), CubeMesh({0, 0, 1})), 3},
               {Together(Together(cube, mirrored), CubeMesh({1, 1, 0})), 3}};
  Random random(7);
  for (const auto& [mesh, count] : cases) {
    ExpectBvhs(Repair(mesh), count, count);
    const Repaired inward = Repair(InsideOut(mesh));
    ExpectBvhs(inward, count, count);
    EXPECT_EQ(inward.repairs.inward_components, count);
    // Off the axes the face between them is flat to within rounding only.
    TriangleMesh tilted = WeldVertices(mesh);
    tilted.vertices = random.UnitQuat().toRotationMatrix() * tilted.vertices;
    tilted.vertices = tilted.vertices.cast<float>().cast<double>().eval();
    ExpectBvhs(Repair(tilted), count, count);
  }
}

TEST(MeshRepairTest, RandomHeapsOfCubesComeApartIntoCubes) {
  Random random(8);
  for (int trial = 0; trial < 30; ++trial) {
    TriangleMesh heap = CubeMesh();
    int count = 1;
    for (int cell = 1; cell < 27; ++cell) {
      if (!random.Chance(0.3)) continue;
      const Vector3d low(cell % 3, cell / 3 % 3, cell / 9);
      const TriangleMesh mirrored = Mirrored(CubeMesh({-low.x() - 1.0, low.y(), low.z()}));
      heap = Together(heap, random.Chance(0.5) ? CubeMesh(low) : mirrored);
      ++count;
    }
    ExpectBvhs(Repair(heap), count, count);
  }
}

TEST(MeshRepairTest, TouchingSolidsThatFaceAgainstEachOtherAreNotMadeIntoOne) {
  Random random(9);
  int open = 0;
  for (int trial = 0; trial < 200; ++trial) {
    TriangleMesh heap = {Eigen::Matrix3Xd(3, 0), Eigen::Matrix3Xi(3, 0)};
    for (const Vector3d& low : {Vector3d(0, 0, 0), Vector3d(0, 1, 0), Vector3d(1, 0, 0)}) {
      TriangleMesh cube = CubeMesh(low);
      if (random.Chance(0.5)) cube = Mirrored(CubeMesh({-low.x() - 1.0, low.y(), low.z()}));
      heap = Together(heap, random.Chance(0.5) ? cube : InsideOut(cube));
    }
    const Repaired result = Repair(heap);
    if (result.topology.open_edges == 0) {
      EXPECT_NEAR(result.solid.volume, 3.0, 1e-12);
    }
    open += result.topology.open_edges > 0;
  }
  EXPECT_LT(open, 180);  // in a quarter of the trials all face the same way
}

TEST(MeshRepairTest, ADoubleSidedSolidIsTheSolid) {
  for (const TriangleMesh& mesh : {CubeMesh(), TetrahedronMesh(), TorusMesh(2.0, 0.5, 12)}) {
    for (const TriangleMesh& both : {DoubleSided(mesh), DoubleSided(InsideOut(mesh))}) {
      const Repaired result = Repair(both);
      EXPECT_EQ(result.repairs.duplicates, mesh.triangles.cols());
      EXPECT_EQ(result.topology.components, 1);
      EXPECT_EQ(result.topology.open_edges, 0);
      EXPECT_NEAR(result.solid.volume, FindSolidProperties(mesh).volume, 1e-12);
    }
  }
}

TEST(MeshRepairTest, ADoubleSidedSheetKeepsOneSide) {
  const TriangleMesh cup = Without(Without(CubeMesh(), 0), 1), sheet = Without(cup, 4);
  for (const TriangleMesh& mesh : {cup, sheet, Without(TetrahedronMesh(), 0)}) {
    const Repaired result = Repair(DoubleSided(mesh));
    EXPECT_EQ(result.repairs.duplicates, mesh.triangles.cols());
    EXPECT_EQ(result.mesh.triangles.cols(), mesh.triangles.cols());
    EXPECT_EQ(result.topology.components, 1);
    EXPECT_EQ(result.topology.open_edges, Repair(mesh).topology.open_edges);
  }
}

TEST(MeshRepairTest, ADoubleSidedFinOnASolidIsASheetOfItsOwn) {
  TriangleMesh fin = {Eigen::Matrix3Xd::Zero(3, 3), Eigen::Matrix3Xi(3, 1)};
  fin.vertices(0, 1) = 1.0;
  fin.triangles << 0, 1, 2;
  for (const double across : {-1.0, 0.5}) {  // outside, and within
    fin.vertices.col(2) << 0.0, across, across;
    const Repaired result = Repair(Together(CubeMesh(), DoubleSided(fin)));
    EXPECT_EQ(result.mesh.triangles.cols(), 13);
    EXPECT_EQ(result.topology.components, 2);
    EXPECT_EQ(result.topology.open_edges, 3);
  }
}

// A strip of squares between two lines along x, `n` long; corners at x = 0 .. n.
TriangleMesh Strip(const Vector3d& from, const Vector3d& to, int n) {
  TriangleMesh mesh = {Eigen::Matrix3Xd(3, 2 * n + 2), Eigen::Matrix3Xi(3, 2 * n)};
  for (int i = 0; i <= n; ++i) {
    mesh.vertices.col(2 * i) = from + i * Vector3d::UnitX();
    mesh.vertices.col(2 * i + 1) = to + i * Vector3d::UnitX();
  }
  for (int i = 0; i < n; ++i) {
    mesh.triangles.col(2 * i) << 2 * i, 2 * i + 2, 2 * i + 3;
    mesh.triangles.col(2 * i + 1) << 2 * i, 2 * i + 3, 2 * i + 1;
  }
  return mesh;
}

TEST(MeshRepairTest, AFoldOfASolidIntoItselfGoes) {
  TriangleMesh bar = {Eigen::Matrix3Xd(3, 0), Eigen::Matrix3Xi(3, 0)};
  const Vector3d corners[] = {{0, 0, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1}};
  for (int i = 0; i < 4; ++i)
    bar = Together(bar, InsideOut(Strip(corners[i], corners[(i + 1) % 4], 3)));
  const TriangleMesh cube = CubeMesh();
  for (const int end : {0, 3}) {
    TriangleMesh cap = {cube.vertices, cube.triangles.middleCols(end == 0 ? 8 : 10, 2)};
    cap.vertices.row(0).array() += end == 0 ? 0 : 2;
    bar = Together(bar, cap);
  }
  bar = WeldVertices(bar);
  const Repaired without = Repair(bar);
  ExpectBvhs(without, 1, 3.0);
  const Repaired folded =
      Repair(WeldVertices(Together(bar, DoubleSided(Strip({0, 0, 0}, {0, 0.5, 0.5}, 3)))));
  EXPECT_EQ(folded.repairs.duplicates, 12);
  EXPECT_EQ(folded.topology.components, 1);
  EXPECT_EQ(folded.topology.open_edges, 0);
  EXPECT_NEAR(folded.solid.volume, 3.0, 1e-12);
}

}  // namespace
}  // namespace mjcf_pdg::test
