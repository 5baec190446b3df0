// Triangle meshes as solids: closedness, orientation, nearest points, inside and outside.
#include "mesh/triangle_bvh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "tests/support/brute_mesh.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg {
namespace {

using test::MakeSolid;
using test::MeshShape;
using test::Random;

TEST(TriangleBvhTest, ClosedMeshesAreKnownByTheirEdges) {
  EXPECT_TRUE(MakeSolid(test::Torus(0.1, 0.03, 12, 8)).closed());
  EXPECT_TRUE(MakeSolid(test::Cup(0.1, 0.2, 0.01, 12)).closed());
  EXPECT_TRUE(MakeSolid(test::Globe(6, 9, [](const auto&) { return 0.1; })).closed());
  EXPECT_TRUE(MakeSolid(test::BoxMesh({0.1, 0.2, 0.3})).closed());
  MeshShape open = test::Torus(0.1, 0.03, 12, 8);
  open.faces.pop_back();
  EXPECT_EQ(MakeSolid(open).open_edges(), 3);
  MeshShape flipped = test::Torus(0.1, 0.03, 12, 8);
  std::swap(flipped.faces[5][0], flipped.faces[5][1]);
  EXPECT_EQ(MakeSolid(flipped).open_edges(), 3) << "a face turned over is no closed surface";
}

TEST(TriangleBvhTest, VerticesAtTheSamePlaceAreOne) {
  const MeshShape torus = test::Torus(0.1, 0.03, 12, 8);
  MeshShape soup;
  for (const auto& f : torus.faces) {
    const int first = static_cast<int>(soup.vertices.size());
    for (int k = 0; k < 3; ++k) soup.vertices.push_back(torus.vertices[f[k]]);
    soup.faces.emplace_back(first, first + 1, first + 2);
  }
  EXPECT_TRUE(MakeSolid(soup).closed());
}

TEST(TriangleBvhTest, AMeshTurnedInsideOutIsTurnedBack) {
  MeshShape box = test::BoxMesh({0.1, 0.1, 0.1});
  const TriangleBvh out = MakeSolid(box), in = MakeSolid(box.TurnInsideOut());
  for (const TriangleBvh* solid : {&out, &in}) {
    for (int t = 0; t < solid->num_triangles(); ++t) {
      EXPECT_GT(solid->Normal(t).dot(solid->Corner(t, 0)), 0.0);
    }
  }
}

TEST(TriangleBvhTest, TrianglesWithoutAreaAreLeftOutAndNothingElseIsAnError) {
  MeshShape box = test::BoxMesh({0.1, 0.1, 0.1});
  box.vertices.push_back(0.5 * (box.vertices[0] + box.vertices[1]));
  box.faces.emplace_back(0, 1, 8);
  EXPECT_EQ(MakeSolid(box).num_triangles(), 12);
  MeshShape flat;
  flat.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  flat.faces = {{0, 1, 2}};
  EXPECT_NE(test::ErrorOf([&] { MakeSolid(flat); }).find("no triangle with an area"),
            std::string::npos);
}

TEST(TriangleBvhTest, NearestPointsAreThoseOfAllTriangles) {
  Random rng(3);
  const MeshShape shape = test::TorusKnot(0.1, 0.02, 40, 8);
  const TriangleBvh solid = MakeSolid(shape);
  for (int i = 0; i < 300; ++i) {
    const Vector3d x = rng.InBox(0.25);
    const double expected = test::BruteDistance(shape, x);
    EXPECT_NEAR(solid.Nearest(kTreeUnits * x).distance / kTreeUnits, expected, 1e-12);
    EXPECT_EQ(solid.Nearest(kTreeUnits * x, kTreeUnits * expected * 0.999).triangle, -1);
  }
}

TEST(TriangleBvhTest, InsideIsWhatTheSolidAngleSays) {
  Random rng(4);
  MeshShape two = test::TorusKnot(0.1, 0.03, 40, 8);
  two.Append(test::BoxMesh({0.05, 0.05, 0.05}));  // pieces may overlap
  const MeshShape shapes[] = {two, test::Cup(0.15, 0.2, 0.03, 12)};
  for (const MeshShape& shape : shapes) {
    const TriangleBvh solid = MakeSolid(shape);
    int inside = 0;
    for (int i = 0; i < 1000; ++i) {
      const Vector3d x = rng.InBox(0.2);
      const bool expected = test::InsideBySolidAngle(shape, x);
      EXPECT_EQ(solid.Contains(kTreeUnits * x), expected) << x.transpose();
      inside += expected;
    }
    EXPECT_GT(inside, 30);
  }
}

TEST(TriangleBvhTest, WindingIsToldFromAnotherPoints) {
  Random rng(6);
  MeshShape two = test::TorusKnot(0.1, 0.03, 40, 8);
  two.Append(test::BoxMesh({0.05, 0.05, 0.05}));
  const TriangleBvh solid = MakeSolid(two);
  std::array<int, 3> seen = {};
  for (int i = 0; i < 1000; ++i) {
    const Vector3d known = kTreeUnits * rng.InBox(0.15), x = kTreeUnits * rng.InBox(0.15);
    const int winding = solid.Winding(x);
    EXPECT_EQ(solid.WindingFrom(known, solid.Winding(known), x), winding) << x.transpose();
    ++seen[winding];
  }
  EXPECT_GT(*std::min_element(seen.begin(), seen.end()), 10);
}

// Rays from the middle of symmetric meshes meet edges and vertices in many directions.
TEST(TriangleBvhTest, RaysThroughEdgesAndVerticesDoNotCount) {
  const TriangleBvh box = MakeSolid(test::BoxMesh({0.1, 0.1, 0.1}));
  const Vector3d d = Vector3d(0.3712, 0.8211, 0.4336).normalized();  // the first ray's direction
  for (int t = 0; t < box.num_triangles(); ++t) {
    for (const double share : {0.0, 0.25, 0.5}) {
      const Vector3d on_edge = (1.0 - share) * box.Corner(t, 0) + share * box.Corner(t, 1);
      for (const double back : {0.01, 0.05}) {
        const Vector3d x = on_edge - kTreeUnits * back * d;
        const bool expected = (x.array().abs() < kTreeUnits * 0.1).all();
        EXPECT_EQ(box.Contains(x), expected) << (x / kTreeUnits).transpose();
      }
    }
  }
}

TEST(TriangleBvhTest, AShellIsHollowAndAnOpenMeshHasNoInside) {
  MeshShape shell = test::Globe(12, 16, [](const auto&) { return 0.2; });
  MeshShape inner = test::Globe(12, 16, [](const auto&) { return 0.15; });
  shell.Append(inner.TurnInsideOut());
  const TriangleBvh solid = MakeSolid(shell);
  EXPECT_FALSE(solid.Contains(Vector3d::Zero()));
  EXPECT_TRUE(solid.Contains({kTreeUnits * 0.17, 0.0, 0.0}));
  EXPECT_EQ(solid.pieces().size(), 2u);
  shell.faces.pop_back();
  EXPECT_FALSE(MakeSolid(shell).Contains({kTreeUnits * 0.17, 0.0, 0.0}));
}

TEST(TriangleBvhTest, CrossingsOfASegmentComeInOrder) {
  const TriangleBvh torus = MakeSolid(test::Torus(0.1, 0.03, 24, 12));
  std::vector<double> crossings;
  torus.Crossings({-kTreeUnits * 0.2, 1.0, 2.0}, {kTreeUnits * 0.2, 1.0, 2.0}, crossings);
  ASSERT_EQ(crossings.size(), 4u);
  EXPECT_TRUE(std::is_sorted(crossings.begin(), crossings.end()));
  EXPECT_NEAR(crossings[0], 0.5 - 0.13 / 0.4, 0.01);
  EXPECT_NEAR(crossings[1], 0.5 - 0.07 / 0.4, 0.01);
}

}  // namespace
}  // namespace mjcf_pdg
