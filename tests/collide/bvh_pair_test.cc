// Two meshes against all pairs of their triangles.
#include "collide/exact/bvh_pair.h"

#include <algorithm>
#include <cmath>

#include "tests/support/brute_mesh.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

constexpr double kFar = 10.0 * kTreeUnits;

// Two shapes, the second at a pose in the first one's frame [m].
struct Posed {
  const MeshShape& a;
  const MeshShape& b;
  Matrix3d R;
  Vector3d t;

  RelativePose TreePose() const { return {R, kTreeUnits * t}; }
  double Brute() const { return BruteDistance(a, Moved(b, R, t)); }
  // How far points of the answer, tree units in a's frame, are from the surfaces [m].
  double OffA(const Vector3d& p) const { return BruteDistance(a, p / kTreeUnits); }
  double OffB(const Vector3d& p) const { return BruteDistance(Moved(b, R, t), p / kTreeUnits); }
};

// Asks `ask(pair, posed, brute distance)` of random poses of every pair of shapes.
template <typename Ask>
void ForRandomPoses(std::uint64_t seed, int count, double spread, const Ask& ask) {
  Random rng(seed);
  const std::vector<MeshShape>& shapes = SmallShapes();
  for (const MeshShape& a : shapes) {
    const TriangleBvh solid_a = MakeSolid(a);
    for (const MeshShape& b : shapes) {
      const TriangleBvh solid_b = MakeSolid(b);
      for (int i = 0; i < count; ++i) {
        const Posed posed{a, b, rng.UnitQuat().matrix(), rng.InBox(spread)};
        ask(BvhPair(solid_a, solid_b, posed.TreePose()), posed, posed.Brute());
      }
    }
  }
}

TEST(BvhPairTest, NearestTrianglesAreThoseOfAllPairs) {
  int apart = 0, crossing = 0;
  ForRandomPoses(61, 12, 0.3, [&](const BvhPair& pair, const Posed& posed, double expected) {
    const NearestTriangles near = pair.Nearest(kFar);
    ASSERT_GE(near.a, 0);
    ASSERT_LT(near.a, pair.a().num_triangles());
    ASSERT_LT(near.b, pair.b().num_triangles());
    EXPECT_EQ(Intersects(pair), expected == 0.0);
    EXPECT_NEAR(near.distance / kTreeUnits, expected, 1e-12);
    ++(expected > 0.0 ? apart : crossing);
    if (expected == 0.0) return;
    EXPECT_NEAR((near.pa - near.pb).norm(), near.distance, 1e-8);
    EXPECT_LT(posed.OffA(near.pa), 1e-12);
    EXPECT_LT(posed.OffB(near.pb), 1e-12);
    EXPECT_NEAR(pair.OfTriangles(near.a, near.b).distance, near.distance, 1e-8);
    const Vector3d n = pair.Normal(near);
    EXPECT_NEAR(n.norm(), 1.0, 1e-12);
    EXPECT_NEAR(n.dot(near.pb - near.pa), near.distance, 1e-8) << "from a to b";
  });
  EXPECT_GT(apart, 40);
  EXPECT_GT(crossing, 20);
}

TEST(BvhPairTest, ACutoffOrAWarmStartChangesNothingElse) {
  Random rng(62);
  int asked = 0;
  ForRandomPoses(63, 6, 0.3, [&](const BvhPair& pair, const Posed&, double expected) {
    if (expected < 1e-4) return;
    ++asked;
    const double distance = kTreeUnits * expected;
    const NearestTriangles below = pair.Nearest(distance * (1.0 - 1e-9));
    EXPECT_EQ(below.a, -1);
    EXPECT_EQ(below.b, -1);
    EXPECT_NEAR(pair.Nearest(distance * (1.0 + 1e-6)).distance, distance, 1e-8);
    for (int k = 0; k < 5; ++k) {
      const NearestTriangles warm = pair.OfTriangles(rng.Index(pair.a().num_triangles()),
                                                     rng.Index(pair.b().num_triangles()));
      EXPECT_NEAR(pair.Nearest(kFar, &warm).distance, distance, 1e-8);
      EXPECT_EQ(pair.Nearest(0.999 * distance, &warm).a, -1);
    }
  });
  EXPECT_GT(asked, 25);
}

TEST(BvhPairTest, RoughlyNearestIsNearestWithinAFifthAndSeesWhatIntersects) {
  int apart = 0, crossing = 0;
  ForRandomPoses(66, 12, 0.3, [&](const BvhPair& pair, const Posed&, double expected) {
    const double distance = kTreeUnits * expected;
    const NearestTriangles rough = pair.RoughlyNearest(kFar, nullptr);
    EXPECT_EQ(rough.distance == 0.0, expected == 0.0);
    EXPECT_GE(rough.distance, distance - 1e-8);
    EXPECT_LE(0.8 * rough.distance, distance + 1e-8);
    EXPECT_EQ(pair.RoughlyNearest(0.999 * distance, nullptr).a, -1);
    ++(expected > 0.0 ? apart : crossing);
  });
  EXPECT_GT(apart, 40);
  EXPECT_GT(crossing, 20);
}

// ---- Degenerate ----

MeshShape OneTriangle(const Vector3d& p, const Vector3d& q, const Vector3d& r) {
  MeshShape shape;
  shape.vertices = {p, q, r};
  shape.faces = {{0, 1, 2}};
  return shape;
}

double TriangleDistance(const MeshShape& a, const MeshShape& b) {
  const TriangleBvh first = MakeSolid(a), second = MakeSolid(b);
  return BvhPair(first, second, {}).Nearest(kFar).distance / kTreeUnits;
}

TEST(BvhPairTest, SingleTrianglesInEveryPosition) {
  const MeshShape flat = OneTriangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  auto at = [&](const Vector3d& t) { return Moved(flat, Matrix3d::Identity(), t); };
  EXPECT_NEAR(TriangleDistance(flat, at({0.1, 0.1, 0.25})), 0.25, 1e-12) << "parallel";
  EXPECT_NEAR(TriangleDistance(flat, at({1.5, 0, 0})), 0.5, 1e-12) << "in one plane";
  EXPECT_NEAR(TriangleDistance(flat, at({1, 0, 0})), 0.0, 1e-12) << "a corner shared";
  EXPECT_NEAR(TriangleDistance(flat, flat), 0.0, 1e-12) << "the same place";
  const MeshShape through = OneTriangle({0.2, 0.2, -1}, {0.2, 0.2, 1}, {0.3, 0.2, 1});
  EXPECT_EQ(TriangleDistance(flat, through), 0.0);
  EXPECT_NEAR(TriangleDistance(flat, Moved(through, Matrix3d::Identity(), {0, 0, 1.125})), 0.125,
              1e-12)
      << "a corner over a face";
}

TEST(BvhPairTest, SliversAndMeshesOfVeryDifferentSize) {
  Random rng(64);
  int asked = 0;
  for (int i = 0; i < 300; ++i) {
    const Vector3d p = rng.InBox(0.2), q = rng.InBox(0.2);
    const MeshShape sliver = OneTriangle(p, q, 0.5 * (p + q) + rng.InBox(1e-5));
    MeshShape other = SmallShapes()[2];
    for (Vector3d& x : other.vertices) x *= i % 2 ? 1e-3 : 1.0;
    const double expected = BruteDistance(other, sliver);
    if (expected < 1e-6) continue;
    EXPECT_NEAR(TriangleDistance(other, sliver), expected, 1e-9) << i;
    ++asked;
  }
  EXPECT_GT(asked, 150);
}

TEST(BvhPairTest, FacesThatTouchAreAtDistanceZero) {
  const MeshShape box = BoxMesh({0.125, 0.125, 0.125});
  const TriangleBvh solid = MakeSolid(box);
  for (const Vector3d& t : {Vector3d(0.25, 0, 0), Vector3d(0.1, 0.05, 0.25),
                            Vector3d(0.25, 0.25, 0.1), Vector3d(0.25, 0.25, 0.25)}) {
    const BvhPair pair(solid, solid, {Matrix3d::Identity(), kTreeUnits * t});
    EXPECT_NEAR(pair.Nearest(kFar).distance, 0.0, 1e-9) << t.transpose();
    const Vector3d n = pair.Normal(pair.Nearest(kFar));
    EXPECT_NEAR(n.norm(), 1.0, 1e-12);
    std::vector<SignedGap> features;
    pair.Features(0.01 * kTreeUnits, pair.Nearest(0.01 * kTreeUnits), features);
    for (const SignedGap& gap : features) EXPECT_GT(gap.distance, 0.0);
  }
}

// ---- Features ----

TEST(BvhPairTest, FeaturesAreRealPairsOfPointsNearestFirst) {
  const double margin = 0.05;
  int poses = 0, rows = 0, several = 0;
  ForRandomPoses(65, 12, 0.25, [&](const BvhPair& pair, const Posed& posed, double nearest) {
    const NearestTriangles first = pair.Nearest(kTreeUnits * margin);
    EXPECT_EQ(first.a >= 0, nearest < margin);
    if (first.a < 0) return;
    std::vector<SignedGap> features;
    pair.Features(kTreeUnits * margin, first, features);
    ++poses;
    rows += static_cast<int>(features.size());
    several += features.size() > 1;
    EXPECT_LE(features.size(), static_cast<std::size_t>(BvhPair::kMaxFeatures));
    EXPECT_FALSE(features.empty() && nearest > 0.0);
    double before = 0.0;
    for (const SignedGap& gap : features) {
      EXPECT_GT(gap.distance, 0.0) << "apart";
      EXPECT_GE(gap.distance, before) << "sorted";
      before = gap.distance;
      EXPECT_LT(gap.distance, kTreeUnits * margin);
      EXPECT_GE(gap.distance, kTreeUnits * nearest - 1e-8);
      EXPECT_NEAR(gap.n.norm(), 1.0, 1e-9);
      EXPECT_NEAR(gap.n.dot(gap.p2 - gap.p1), gap.distance, 1e-8) << "from a to b";
      EXPECT_NEAR((gap.p2 - gap.p1).norm(), gap.distance, 1e-8);
      EXPECT_LT(posed.OffA(gap.p1), 1e-12);
      EXPECT_LT(posed.OffB(gap.p2), 1e-12);
    }
    if (nearest > 0.0) {
      EXPECT_NEAR(features.front().distance, kTreeUnits * nearest, 1e-8);
    }
  });
  EXPECT_GT(poses, 50);
  EXPECT_GT(several, 30);
  EXPECT_GT(rows, 3 * poses);
}

// What is already in the list is left alone.
TEST(BvhPairTest, FeaturesAreAppended) {
  const TriangleBvh box = MakeSolid(BoxMesh({0.1, 0.1, 0.1}));
  const BvhPair pair(box, box, {Matrix3d::Identity(), kTreeUnits * Vector3d(0, 0, 0.201)});
  std::vector<SignedGap> features(2);
  features[0].distance = features[1].distance = -7.0;
  pair.Features(0.01 * kTreeUnits, pair.Nearest(0.01 * kTreeUnits), features);
  ASSERT_GE(features.size(), 2u + 3u) << "no plane is held by fewer";
  EXPECT_EQ(features[1].distance, -7.0);
  for (std::size_t k = 2; k < features.size(); ++k) {
    EXPECT_NEAR(features[k].distance, 0.001 * kTreeUnits, 1e-8);
    EXPECT_NEAR(features[k].n.z(), 1.0, 1e-9);
  }
}

}  // namespace
}  // namespace mjcf_pdg::test
