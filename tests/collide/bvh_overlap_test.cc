// How deep meshes overlap, against brute force and known answers.
#include "collide/exact/bvh_overlap.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/support/brute_mesh.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

// ---- Two triangles ----

MeshShape AsShape(const Vector3d t[3]) {
  MeshShape shape;
  shape.vertices = {t[0], t[1], t[2]};
  shape.faces = {{0, 1, 2}};
  return shape;
}

TEST(BvhOverlapTest, TrianglesOverlapWhereTheyCrossAndTheirMovePartsThem) {
  Random rng(71);
  int crossing = 0, apart = 0;
  for (int i = 0; i < 3000; ++i) {
    Vector3d s[3], t[3];
    for (int k = 0; k < 3; ++k) {
      s[k] = rng.InBox(1.0);
      t[k] = rng.InBox(1.0);
    }
    Vector3d n = Vector3d::Zero();
    const double overlap = TriangleOverlap(s, t, n);
    const double distance = BruteDistance(AsShape(s), AsShape(t));
    if (std::abs(overlap) < 1e-9) continue;
    EXPECT_EQ(overlap > 0.0, distance == 0.0) << i;
    if (overlap < 0.0) {
      EXPECT_LE(-overlap, distance + 1e-12) << "the gap along an axis";
      ++apart;
      continue;
    }
    ++crossing;
    EXPECT_NEAR(n.norm(), 1.0, 1e-9);
    for (Vector3d& p : t) p += (overlap + 1e-9) * n;
    EXPECT_GT(BruteDistance(AsShape(s), AsShape(t)), 0.0) << i;
  }
  EXPECT_GT(crossing, 200);
  EXPECT_GT(apart, 1000);
}

TEST(BvhOverlapTest, DegenerateTrianglesHaveAnAnswer) {
  const Vector3d flat[3] = {{-1, -1, 0}, {2, -1, 0}, {-1, 2, 0}};
  const Vector3d segment[3] = {{0, 0, -0.25}, {0, 0, 0.5}, {0, 0, 0.125}};
  const Vector3d point[3] = {{0, 0, 0.5}, {0, 0, 0.5}, {0, 0, 0.5}};
  Vector3d n;
  EXPECT_NEAR(TriangleOverlap(flat, segment, n), 0.25, 1e-12);
  EXPECT_NEAR(n.z(), 1.0, 1e-12);
  EXPECT_NEAR(TriangleOverlap(segment, flat, n), 0.25, 1e-12);
  EXPECT_NEAR(n.z(), -1.0, 1e-12);
  EXPECT_LE(TriangleOverlap(flat, point, n), 0.0);
  EXPECT_NEAR(std::abs(TriangleOverlap(flat, flat, n)), 0.0, 1e-12) << "no thickness";
}

// ---- One inside the other ----

TEST(BvhOverlapTest, ContainedIsWhatTheSolidAngleSays) {
  Random rng(72);
  const MeshShape cup = Cup(0.2, 0.3, 0.08, 12);
  MeshShape open = cup;
  open.faces.pop_back();
  const MeshShape crumb = Globe(4, 5, [](const Vector3d&) { return 0.01; });
  const TriangleBvh outer = MakeSolid(cup), leaky = MakeSolid(open), inner = MakeSolid(crumb);
  int inside = 0, outside = 0;
  for (int i = 0; i < 400; ++i) {
    const Vector3d t = rng.InBox(0.3);
    const RelativePose pose{rng.UnitQuat().matrix(), kTreeUnits * t};
    const BvhPair pair(outer, inner, pose), turned(inner, outer, pose.Inverse());
    if (Intersects(pair)) continue;
    const bool expected = InsideBySolidAngle(cup, t);
    EXPECT_EQ(Contained(pair), expected) << t.transpose();
    EXPECT_EQ(Contained(turned), expected) << t.transpose();
    EXPECT_FALSE(Contained(BvhPair(leaky, inner, pose)));
    ++(expected ? inside : outside);
  }
  EXPECT_GT(inside, 20);
  EXPECT_GT(outside, 100);
}

// ---- Faces that rest on each other ----

// By definition: a move that parts the two.
TEST(BvhOverlapTest, GrazingMeshesPartByTheMove) {
  Random rng(73);
  const TriangleBvh cup = MakeSolid(Cup(0.2, 0.3, 0.08, 12)),
                    box = MakeSolid(BoxMesh({0.1, 0.1, 0.1}));
  int grazing = 0;
  for (int i = 0; i < 200; ++i) {
    const double depth = i % 2 == 0 ? rng.Uniform(0.0, 2.9e-8) : rng.Uniform(1e-7, 1e-4);
    const Vector3d t(rng.Uniform(-0.2, 0.2), rng.Uniform(-0.2, 0.2), -0.1 + depth);
    const Eigen::AngleAxisd turn(rng.Uniform(-3.0, 3.0), Vector3d::UnitZ());
    const BvhPair pair(cup, box, {turn.matrix(), kTreeUnits * t});
    const NearestTriangles crossing = pair.Nearest(BvhPair::kTouching);
    if (crossing.a < 0) continue;
    const std::optional<SignedGap> graze = Graze(pair, crossing);
    ASSERT_EQ(graze.has_value(), i % 2 == 0) << depth;
    if (!graze) continue;
    ++grazing;
    EXPECT_LT(graze->distance, -kTreeUnits * depth);
    EXPECT_NEAR(graze->n.dot(graze->p2 - graze->p1), graze->distance, 1e-9);
    const Vector3d moved = kTreeUnits * t - graze->distance * graze->n;
    EXPECT_FALSE(Intersects(BvhPair(cup, box, {turn.matrix(), moved})));
  }
  EXPECT_GT(grazing, 80);
}

// Their triangles cross little, and they are inside each other.
TEST(BvhOverlapTest, MeshesThatCoincideDoNotGraze) {
  const TriangleBvh cup = MakeSolid(Cup(0.2, 0.3, 0.08, 12));
  const BvhPair pair(cup, cup, {Matrix3d::Identity(), Vector3d::Constant(1e-9 * kTreeUnits)});
  const NearestTriangles crossing = pair.Nearest(BvhPair::kTouching);
  ASSERT_GE(crossing.a, 0);
  EXPECT_FALSE(Graze(pair, crossing).has_value());
}

// ---- Depths ----

// The deepest vertex of `from` inside `in` [m].
double DeepestVertex(const MeshShape& from, const MeshShape& in) {
  double deepest = 0.0;
  for (const Vector3d& p : from.vertices) {
    if (InsideBySolidAngle(in, p)) deepest = std::max(deepest, BruteDistance(in, p));
  }
  return deepest;
}

// The deepest of many points of the surface of `from` inside `in` [m].
double DeepestSample(const MeshShape& from, const MeshShape& in) {
  constexpr int kSteps = 4;
  double deepest = 0.0;
  for (const Eigen::Vector3i& f : from.faces) {
    for (int i = 0; i <= kSteps; ++i) {
      for (int j = 0; i + j <= kSteps; ++j) {
        const double u = static_cast<double>(i) / kSteps, v = static_cast<double>(j) / kSteps;
        const Vector3d p =
            (1.0 - u - v) * from.vertices[f[0]] + u * from.vertices[f[1]] + v * from.vertices[f[2]];
        if (InsideBySolidAngle(in, p)) deepest = std::max(deepest, BruteDistance(in, p));
      }
    }
  }
  return deepest;
}

TEST(BvhOverlapTest, OverlapsAreNeitherDeeperThanTheSurfacesNorNothing) {
  Random rng(73);
  int overlapping = 0, as_deep_as_a_vertex = 0;
  for (const MeshShape& a : SmallShapes()) {
    const TriangleBvh solid_a = MakeSolid(a);
    for (const MeshShape& b : SmallShapes()) {
      const TriangleBvh solid_b = MakeSolid(b);
      for (int i = 0; i < 5; ++i) {
        const Matrix3d R = rng.UnitQuat().matrix();
        const Vector3d t = rng.InBox(0.12);
        const BvhPair pair(solid_a, solid_b, {R, kTreeUnits * t});
        if (!Intersects(pair)) continue;
        std::vector<SignedGap> gaps;
        AppendOverlaps(pair, kFewParts, gaps);
        ExpectOverlaps(gaps);
        const MeshShape there = Moved(b, R, t);
        const double deepest = std::max(DeepestSample(a, there), DeepestSample(there, a));
        const double vertex = std::max(DeepestVertex(a, there), DeepestVertex(there, a));
        const double depth = -gaps.front().distance / kTreeUnits;
        EXPECT_LT(depth, 1.3 * deepest + 1e-3) << i;
        as_deep_as_a_vertex += depth > vertex / 1.1 - 1e-9;
        ++overlapping;
      }
    }
  }
  EXPECT_GT(overlapping, 25);
  // Ways out along which the surfaces face the same way are left out: not in all.
  EXPECT_GT(as_deep_as_a_vertex, overlapping / 2);
}

TEST(BvhOverlapTest, ABoxOnABoxIsAsDeepAsItsLowestCorner) {
  Random rng(74);
  const MeshShape base = BoxMesh({0.3, 0.3, 0.1}), box = BoxMesh({0.05, 0.06, 0.07});
  const TriangleBvh below = MakeSolid(base), above = MakeSolid(box);
  for (int i = 0; i < 50; ++i) {
    const Matrix3d R = rng.UnitQuat().matrix();
    double low = 0.0;
    for (const Vector3d& p : box.vertices) low = std::min(low, (R * p).z());
    const double depth = rng.Uniform(1e-5, 5e-3);
    const Vector3d t(rng.Uniform(-0.1, 0.1), rng.Uniform(-0.1, 0.1), 0.1 - depth - low);
    std::vector<SignedGap> gaps;
    AppendOverlaps(BvhPair(below, above, {R, kTreeUnits * t}), kFewParts, gaps);
    ExpectOverlaps(gaps);
    EXPECT_NEAR(-gaps.front().distance / kTreeUnits, depth, 1e-9) << i;
    EXPECT_GT(gaps.front().n.z(), 0.999) << "from the first to the second, the way out";
  }
}

// Boxes over parts of a surface leave the middle out.
TEST(BvhOverlapTest, ABodyWhollyInsideIsAsDeepAsItsDeepestVertex) {
  Random rng(75);
  MeshShape body;
  for (const Vector3d& p :
       {Vector3d(1, 1, 1), Vector3d(1, -1, -1), Vector3d(-1, 1, -1), Vector3d(-1, -1, 1)}) {
    body.vertices.push_back(0.3 * p);
  }
  body.faces = {{1, 3, 2}, {0, 2, 3}, {0, 3, 1}, {0, 1, 2}};
  const MeshShape pebble = Globe(10, 12, [](const auto&) { return 0.01; });
  const TriangleBvh around = MakeSolid(body), inside = MakeSolid(pebble);
  int contained = 0;
  for (int i = 0; i < 40; ++i) {
    const Vector3d t = rng.InBox(0.1);
    const BvhPair pair(around, inside, {Matrix3d::Identity(), kTreeUnits * t});
    if (pair.RoughlyNearest(BvhPair::kTouching, nullptr).a >= 0 || !Contained(pair)) continue;
    ++contained;
    std::vector<SignedGap> gaps;
    AppendOverlaps(pair, kFewParts, gaps);
    ExpectOverlaps(gaps);
    const double deepest = DeepestVertex(Moved(pebble, Matrix3d::Identity(), t), body);
    EXPECT_GT(-gaps.front().distance / kTreeUnits, deepest / 1.1) << t.transpose();
  }
  EXPECT_GT(contained, 10);
}

// Hundreds of pieces lie in the hollow of a cup, where their boxes may be as deep in its wall as
// the box of the one that is.
TEST(BvhOverlapTest, APieceWhollyInsideIsSeenAmongMany) {
  Random rng(76);
  const MeshShape crumb = Globe(2, 3, [](const Vector3d&) { return 1e-4; });
  MeshShape crumbs;
  for (int k = 0; k < 600; ++k) {
    const double angle = rng.Uniform(0.0, 2.0 * mjPI), z = rng.Uniform(0.05, 0.28);
    const Vector3d p(0.19 * std::cos(angle), 0.19 * std::sin(angle), z);
    crumbs.Append(MeshShape(crumb).Move(Matrix3d::Identity(), k == 0 ? Vector3d(p * 1.03) : p));
  }
  const TriangleBvh cup = MakeSolid(Cup(0.2, 0.3, 0.005, 48)), many = MakeSolid(crumbs);
  const BvhPair pair(cup, many, {}), turned(many, cup, {});
  ASSERT_TRUE(Contained(pair));
  for (const BvhPair* one : {&pair, &turned}) {
    std::vector<SignedGap> gaps;
    AppendOverlaps(*one, kFewParts, gaps);
    ExpectOverlaps(gaps);
    EXPECT_LT(gaps.front().distance, -kTreeUnits * 1e-4);
  }
}

TEST(BvhOverlapTest, SurfacesThatCoincideAndOpenMeshesHaveADepth) {
  const Matrix3d I = Matrix3d::Identity();
  for (const MeshShape& shape : SmallShapes()) {
    const TriangleBvh solid = MakeSolid(shape);
    std::vector<SignedGap> gaps;
    AppendOverlaps(BvhPair(solid, solid, {I, Vector3d::Zero()}), kFewParts, gaps);
    ExpectOverlaps(gaps);
  }
  MeshShape open = BoxMesh({0.1, 0.1, 0.1});
  open.faces.resize(10);
  const TriangleBvh surface = MakeSolid(open);
  const BvhPair pair(surface, surface, {I, kTreeUnits * Vector3d(0.15, 0.03, 0.02)});
  ASSERT_TRUE(Intersects(pair));
  std::vector<SignedGap> gaps;
  AppendOverlaps(pair, kFewParts, gaps);
  ExpectOverlaps(gaps);
}

TEST(BvhOverlapTest, TheDeepestComeFirstAndRepetitionsAreLeftOut) {
  auto way = [](double distance, const Vector3d& p, bool faces_apart) {
    return WayOut{{distance, p, p + distance * Vector3d::UnitX(), Vector3d::UnitX()}, faces_apart};
  };
  std::vector<WayOut> ways = {way(-1.0, {0, 0, 0}, true), way(-2.0, {0, 9, 0}, true),
                              way(-1.1, {0, 0.1, 0}, true), way(-5.0, {0, 0, 9}, false)};
  std::vector<SignedGap> gaps;
  AppendDeepest(ways, 1.0, gaps);
  ASSERT_EQ(gaps.size(), 2u) << "one place twice, and one that faces the same way";
  EXPECT_EQ(gaps[0].distance, -2.0);
  EXPECT_EQ(gaps[1].distance, -1.1);
  ways = {way(-5.0, {0, 0, 9}, false)};
  gaps.clear();
  AppendDeepest(ways, 1.0, gaps);
  ASSERT_EQ(gaps.size(), 1u) << "if there is no other";
}

}  // namespace
}  // namespace mjcf_pdg::test
