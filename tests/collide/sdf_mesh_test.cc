// Round primitives and planes against meshes, by asking every triangle.
#include "collide/exact/sdf_mesh.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>

#include "tests/support/brute_mesh.h"
#include "tests/support/test_support.h"
#include "verify/exact/primitive_distance.h"

namespace mjcf_pdg::test {
namespace {

constexpr double kFar = 10.0 * kTreeUnits;

// A primitive (sizes in m) and a mesh at a pose in its frame.
struct Posed {
  int type;
  Vector3d size;
  const MeshShape& shape;
  Matrix3d R;
  Vector3d t;

  PrimitiveSdf Field() const { return {type, kTreeUnits * size}; }
  RelativePose TreePose() const { return {R, kTreeUnits * t}; }
  // The least signed distance over the mesh's triangles [m].
  double Brute() const {
    double least = kFar;
    const MeshShape there = Moved(shape, R, t);
    for (const Eigen::Vector3i& f : there.faces) {
      const Vector3d corners[3] = {there.vertices[f[0]], there.vertices[f[1]],
                                   there.vertices[f[2]]};
      Vector3d x = (corners[0] + corners[1] + corners[2]) / 3.0;
      double reach = 0.0;
      for (const Vector3d& corner : corners) reach = std::max(reach, (corner - x).norm());
      if (verify::RoundDistanceAt(type, size, x) - reach > least) continue;
      least = std::min(least, verify::RoundDistanceOnTriangle(type, size, corners, x));
    }
    return least;
  }
  // How far points of the answer, tree units in the mesh's frame, are from the surfaces [m].
  double OffMesh(const Vector3d& p) const { return BruteDistance(shape, p / kTreeUnits); }
  double OffField(const Vector3d& p) const {
    return std::abs(verify::RoundDistanceAt(type, size, R * (p / kTreeUnits) + t));
  }
};

const int kTypes[] = {mjGEOM_PLANE, mjGEOM_SPHERE, mjGEOM_CAPSULE, mjGEOM_ELLIPSOID,
                      mjGEOM_CYLINDER};

// Asks `ask(field mesh, posed)` of random poses of a type against every shape.
template <typename Ask>
void ForRandomPoses(int type, std::uint64_t seed, int count, double spread, const Ask& ask) {
  Random rng(seed);
  for (const MeshShape& shape : SmallShapes()) {
    const TriangleBvh solid = MakeSolid(shape);
    for (int i = 0; i < count; ++i) {
      const Vector3d size(rng.Uniform(0.02, 0.06), rng.Uniform(0.02, 0.06),
                          rng.Uniform(0.02, 0.06));
      const Posed posed{type, size, shape, rng.UnitQuat().matrix(), rng.InBox(spread)};
      ask(SdfMesh(posed.Field(), solid, posed.TreePose()), posed);
    }
  }
}

class SdfMeshTest : public ::testing::TestWithParam<int> {};

INSTANTIATE_TEST_SUITE_P(Types, SdfMeshTest, ::testing::ValuesIn(kTypes),
                         [](const auto& test) { return TypeName(test.param); });

TEST_P(SdfMeshTest, TheLeastDistanceIsThatOfAllTriangles) {
  Random rng(81);
  const int count = GetParam() == mjGEOM_ELLIPSOID ? 8 : 25;  // by every triangle that one is slow
  int apart = 0, overlapping = 0;
  ForRandomPoses(GetParam(), 82, count, 0.25, [&](const SdfMesh& pair, const Posed& posed) {
    const double expected = posed.Brute();
    const SdfNearest nearest = pair.Nearest(kFar);
    ASSERT_GE(nearest.triangle, 0);
    ++(expected > 0.0 ? apart : overlapping);
    EXPECT_NEAR(nearest.f / kTreeUnits, expected, 1e-7);
    EXPECT_LT(posed.OffMesh(nearest.x), 1e-10);
    EXPECT_NEAR(posed.Field().At(posed.TreePose() * nearest.x).f, nearest.f, 1e-4);
    EXPECT_EQ(pair.Nearest(nearest.f - 1e-3).triangle, -1);
    EXPECT_NEAR(pair.Nearest(nearest.f + 1e-3).f, nearest.f, 1e-6);
    const int warm = rng.Index(static_cast<int>(posed.shape.faces.size()));
    EXPECT_NEAR(pair.Nearest(kFar, warm).f, nearest.f, 1e-6);
    const SignedGap gap = pair.Gap(nearest);
    EXPECT_NEAR(gap.n.norm(), 1.0, 1e-9);
    EXPECT_NEAR(gap.n.dot(gap.p2 - gap.p1), gap.distance, 1e-6) << "from the primitive to the mesh";
    EXPECT_LT(posed.OffMesh(gap.p2), 1e-10);
    if (expected > 0.0) {
      EXPECT_LT(posed.OffField(gap.p1), 1e-7);
    }
  });
  EXPECT_GE(apart, count / 2);
  EXPECT_GE(overlapping, count / 3);
}

TEST_P(SdfMeshTest, WhatIsInsideTheMeshIsContained) {
  Random rng(83);
  const MeshShape cup = Cup(0.2, 0.3, 0.08, 12);
  MeshShape open = cup;
  open.faces.pop_back();
  const TriangleBvh solid = MakeSolid(cup), leaky = MakeSolid(open);
  int inside = 0, outside = 0;
  for (int i = 0; i < 300; ++i) {
    const Vector3d center = rng.InBox(0.3);  // in the mesh's frame
    const Matrix3d R = rng.UnitQuat().matrix();
    const Posed posed{GetParam(), {0.01, 0.01, 0.01}, cup, R, R * -center};
    const SdfMesh pair(posed.Field(), solid, posed.TreePose());
    if (pair.Nearest(0.0).triangle >= 0) continue;
    const bool expected = GetParam() != mjGEOM_PLANE && InsideBySolidAngle(cup, center);
    EXPECT_EQ(pair.Contained(), expected) << center.transpose();
    EXPECT_FALSE(SdfMesh(posed.Field(), leaky, posed.TreePose()).Contained());
    ++(expected ? inside : outside);
  }
  EXPECT_GT(outside, 10);
  EXPECT_GE(inside, GetParam() == mjGEOM_PLANE ? 0 : 15);
}

TEST_P(SdfMeshTest, FeaturesAreRealPairsOfPointsNearestFirst) {
  const double margin = 0.04;
  int poses = 0, several = 0;
  ForRandomPoses(GetParam(), 84, 25, 0.2, [&](const SdfMesh& pair, const Posed& posed) {
    const SdfNearest first = pair.Nearest(kTreeUnits * margin);
    if (first.triangle < 0 || first.f <= 0.0) return;
    std::vector<SignedGap> features;
    pair.Features(kTreeUnits * margin, first, features);
    ASSERT_FALSE(features.empty());
    EXPECT_NEAR(features.front().distance, first.f, 1e-6);
    ++poses;
    several += features.size() > 1;
    double before = 0.0;
    for (const SignedGap& gap : features) {
      EXPECT_GT(gap.distance, 0.0) << "apart";
      EXPECT_GE(gap.distance, before - 1e-6) << "sorted";
      before = gap.distance;
      EXPECT_LT(gap.distance, kTreeUnits * margin);
      EXPECT_NEAR(gap.n.norm(), 1.0, 1e-9);
      EXPECT_NEAR(gap.n.dot(gap.p2 - gap.p1), gap.distance, 1e-6);
      EXPECT_LT(posed.OffField(gap.p1), 1e-7);
      EXPECT_LT(posed.OffMesh(gap.p2), 1e-10);
    }
  });
  EXPECT_GT(poses, 6);
  EXPECT_GT(several, poses / 4);
}

TEST_P(SdfMeshTest, OverlapsAreDeepestFirstWithAPointOnASurface) {
  int overlapping = 0;
  ForRandomPoses(GetParam(), 85, 20, 0.12, [&](const SdfMesh& pair, const Posed& posed) {
    if (pair.Nearest(0.0).triangle < 0 && !pair.Contained()) return;
    std::vector<SignedGap> gaps;
    pair.AppendOverlaps(gaps);
    ++overlapping;
    ExpectOverlaps(gaps);
    for (const SignedGap& gap : gaps) {
      EXPECT_TRUE(posed.OffMesh(gap.p2) < 1e-9 || posed.OffField(gap.p1) < 1e-6);
    }
  });
  EXPECT_GT(overlapping, 15);
}

// On a flat face the depth is that of the lowest point, whatever the primitive.
TEST_P(SdfMeshTest, OnAFlatFaceTheDepthIsExact) {
  if (GetParam() == mjGEOM_PLANE) GTEST_SKIP() << "a plane is the face itself";
  Random rng(86);
  const MeshShape block = BoxMesh({0.6, 0.6, 0.3});
  const TriangleBvh solid = MakeSolid(block);
  for (int i = 0; i < 40; ++i) {
    const Vector3d size(rng.Uniform(0.02, 0.05), rng.Uniform(0.02, 0.05), rng.Uniform(0.02, 0.05));
    const Matrix3d R = rng.UnitQuat().matrix();  // of the primitive in the block's frame
    const PrimitiveSdf field{GetParam(), size};
    const double low = (R * field.Support(R.transpose() * -Vector3d::UnitZ())).z();
    const double depth = rng.Chance(0.5) ? rng.Uniform(1e-5, 5e-3) : rng.Uniform(0.05, 0.2);
    const Vector3d center(rng.Uniform(-0.1, 0.1), rng.Uniform(-0.1, 0.1), 0.3 - depth - low);
    const Posed posed{GetParam(), size, block, R.transpose(), -(R.transpose() * center)};
    const SdfMesh pair(posed.Field(), solid, posed.TreePose());
    std::vector<SignedGap> gaps;
    pair.AppendOverlaps(gaps);
    ASSERT_FALSE(gaps.empty());
    EXPECT_NEAR(-gaps.front().distance / kTreeUnits, depth, 1e-3 * depth + 1e-9) << i;
    EXPECT_LT(gaps.front().n.z(), -0.99) << "from the primitive to the block";
  }
}

// ---- Degenerate ----

TEST(FieldMeshDegenerateTest, TheMiddleOfAPrimitiveOnAFaceAnEdgeOrACorner) {
  const MeshShape box = BoxMesh({0.125, 0.125, 0.125});
  const TriangleBvh solid = MakeSolid(box);
  for (const int type : kTypes) {
    for (const Vector3d& at : {Vector3d(0.03, 0.02, 0.125), Vector3d(0.125, 0.02, 0.125),
                               Vector3d(0.125, 0.125, 0.125)}) {
      const Posed posed{type, {0.03, 0.03, 0.03}, box, Matrix3d::Identity(), -at};
      const SdfMesh pair(posed.Field(), solid, posed.TreePose());
      const double expected = type == mjGEOM_PLANE ? -0.125 - at.z() : -0.03;
      EXPECT_NEAR(pair.Nearest(kFar).f / kTreeUnits, expected, 1e-7) << TypeName(type);
      std::vector<SignedGap> gaps;
      pair.AppendOverlaps(gaps);
      ExpectOverlaps(gaps);
    }
  }
}

TEST(FieldMeshDegenerateTest, ACapsuleThroughASingleTriangle) {
  MeshShape triangle;
  triangle.vertices = {{-1, -1, 0}, {2, -1, 0}, {-1, 2, 0}};
  triangle.faces = {{0, 1, 2}};
  const TriangleBvh solid = MakeSolid(triangle);
  const PrimitiveSdf capsule{mjGEOM_CAPSULE, kTreeUnits * Vector3d(0.05, 0.2, 0)};
  for (const double z : {0.0, 0.1, 0.2}) {
    const SdfMesh pair(capsule, solid, {Matrix3d::Identity(), kTreeUnits * Vector3d(0, 0, z)});
    const SdfNearest nearest = pair.Nearest(kFar);
    EXPECT_NEAR(nearest.f / kTreeUnits, -0.05, 1e-9) << z;
    EXPECT_NEAR(nearest.x.z(), 0.0, 1e-6);
    EXPECT_FALSE(pair.Contained());
    std::vector<SignedGap> gaps;
    pair.AppendOverlaps(gaps);
    ASSERT_FALSE(gaps.empty());
    EXPECT_LT(gaps.front().distance, 0.0);
  }
  const SdfMesh above(capsule, solid, {Matrix3d::Identity(), kTreeUnits * Vector3d(0, 0, -0.3)});
  EXPECT_NEAR(above.Nearest(kFar).f / kTreeUnits, 0.05, 1e-9);
}

}  // namespace
}  // namespace mjcf_pdg::test
