// Which surfaces are inside which, and that many of them take no long time.
#include "mesh/mesh_components.h"

#include <gtest/gtest.h>

#include <cmath>
#include <ctime>
#include <vector>

#include "tests/support/hand_made_meshes.h"

namespace mjcf_pdg::test {
namespace {

using Eigen::Vector3d;

// Small tetrahedra at these places.
TriangleMesh Tetrahedra(const std::vector<Vector3d>& places, double size) {
  const TriangleMesh one = TetrahedronMesh();
  const Eigen::Index n = static_cast<Eigen::Index>(places.size());
  TriangleMesh mesh = {Eigen::Matrix3Xd(3, 4 * n), Eigen::Matrix3Xi(3, 4 * n)};
  for (Eigen::Index i = 0; i < n; ++i) {
    mesh.vertices.middleCols(4 * i, 4) = (size * one.vertices).colwise() + places[i];
    mesh.triangles.middleCols(4 * i, 4) = one.triangles.array() + static_cast<int>(4 * i);
  }
  return mesh;
}

std::vector<Vector3d> Grid(int n, double spacing) {
  std::vector<Vector3d> places;
  for (int i = 0; i < n * n * n; ++i) {
    places.push_back(spacing * Vector3d(i % n, i / n % n, i / n / n));
  }
  return places;
}

TEST(MeshComponentsTest, WhatIsInTheTubeOfATorusIsInsideAndWhatIsInItsHoleIsNot) {
  for (const int n : {3, 12}) {  // few and many, which are found out in different ways
    std::vector<Vector3d> places;
    int inside = 0;
    for (const Vector3d& p : Grid(n, 4.6 / (n - 1))) {
      const Vector3d x = p - Vector3d(2.3, 2.3, 2.3);
      const double off_ring = std::hypot(std::hypot(x.x(), x.y()) - 2.0, x.z());
      if (std::abs(off_ring - 0.5) < 0.1) continue;
      places.push_back(x);
      inside += off_ring < 0.5;
    }
    ASSERT_GT(inside, 0);
    const MeshTopology topology =
        FindTopology(Together(TorusMesh(2.0, 0.5, 48), Tetrahedra(places, 0.01)));
    EXPECT_EQ(topology.components, 1 + static_cast<int>(places.size()));
    EXPECT_EQ(topology.nested_components, inside);
  }
}

// An L of three cubes in one piece; the dent is the cube at (1, 1, 0).
TriangleMesh AngleMesh() {
  TriangleMesh mesh = {Eigen::Matrix3Xd(3, 12), Eigen::Matrix3Xi(3, 20)};
  mesh.vertices.leftCols(6) << 1, 1, 0, 0, 2, 2,  //
      1, 2, 2, 0, 0, 1,                           //
      0, 0, 0, 0, 0, 0;
  mesh.vertices.rightCols(6) = mesh.vertices.leftCols(6).colwise() + Vector3d::UnitZ();
  int n = 0;
  for (int i = 1; i < 5; ++i) {
    mesh.triangles.col(n++) << 0, i + 1, i;
    mesh.triangles.col(n++) << 6, 6 + i, 7 + i;
  }
  for (int i = 0; i < 6; ++i) {
    const int next = (i + 1) % 6;
    mesh.triangles.col(n++) << i, next, 6 + next;
    mesh.triangles.col(n++) << i, 6 + next, 6 + i;
  }
  return mesh;
}

TEST(MeshComponentsTest, ASolidInTheDentOfAnotherIsNotInsideIt) {
  const TriangleMesh angle = AngleMesh(), cube = CubeMesh({1, 1, 0});
  EXPECT_NEAR(FindSolidProperties(angle).volume, 3.0, 1e-12);
  for (const TriangleMesh& mesh : {Together(angle, cube), Together(angle, InsideOut(cube))}) {
    const std::vector<MeshComponent> components = FindComponents(mesh);
    ASSERT_EQ(components.size(), 2u);
    EXPECT_TRUE(components[1].containers.empty());
  }
}

TEST(MeshComponentsTest, APartThatReachesOutOfAnotherIsNotInsideIt) {
  // Through the dent of the L, within the box around it.
  const TriangleMesh bar = CuboidMesh({1.5, 0.2, 0.2}, {0.2, 0.9, 0.4});
  for (int first = 0; first < 12; ++first) {
    TriangleMesh turned = bar;
    for (int t = 0; t < 12; ++t) turned.triangles.col(t) = bar.triangles.col((first + t) % 12);
    const std::vector<MeshComponent> components = FindComponents(Together(AngleMesh(), turned));
    ASSERT_EQ(components.size(), 2u);
    EXPECT_TRUE(components[1].containers.empty()) << first;
  }
}

TEST(MeshComponentsTest, AHundredThousandPartsTakeSeconds) {
  std::vector<Vector3d> places = Grid(46, 1.0);
  const TriangleMesh mesh =
      Together(Tetrahedra(places, 0.3), CuboidMesh({50, 50, 50}, {-1, -1, -1}));
  const std::clock_t begin = std::clock();
  const MeshTopology topology = FindTopology(mesh);
  EXPECT_EQ(topology.components, 46 * 46 * 46 + 1);
  EXPECT_EQ(topology.nested_components, 46 * 46 * 46);
  EXPECT_LT(std::clock() - begin, 15 * CLOCKS_PER_SEC);
}

}  // namespace
}  // namespace mjcf_pdg::test
