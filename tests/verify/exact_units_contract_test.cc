// What the headers of verify/exact promise: distances of points by samples of surfaces, insides by
// solid angles, triangles by their edges.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <vector>

#include "tests/support/brute_mesh.h"
#include "tests/support/mesh_shapes.h"
#include "tests/support/test_support.h"
#include "verify/exact/mesh_solid.h"
#include "verify/exact/primitive_distance.h"

namespace mjcf_pdg::test {
namespace {

using verify::MeshSolid;
using verify::RoundDistanceAt;
using verify::Triangles;
using verify::Vector3d;

const std::vector<int> kRound = {mjGEOM_SPHERE, mjGEOM_CAPSULE, mjGEOM_ELLIPSOID, mjGEOM_CYLINDER};

Triangles TrianglesOf(const MeshShape& shape) {
  Triangles triangles;
  for (const Eigen::Vector3i& f : shape.faces) {
    triangles.push_back({shape.vertices[f[0]], shape.vertices[f[1]], shape.vertices[f[2]]});
  }
  return triangles;
}

MeshShape At(MeshShape shape, const Vector3d& p) {
  return shape.Move(Eigen::Matrix3d::Identity(), p);
}

// The farthest a round shape reaches along the unit vector n.
double Reach(int type, const Vector3d& size, const Vector3d& n) {
  switch (type) {
    case mjGEOM_SPHERE:
      return size[0];
    case mjGEOM_CAPSULE:
      return size[0] + size[1] * std::abs(n.z());
    case mjGEOM_ELLIPSOID:
      return size.cwiseProduct(n).norm();
    default:
      return size[0] * n.head<2>().norm() + size[1] * std::abs(n.z());
  }
}

// The distance of a point from a convex shape is the greatest of n · x less the reach.
TEST(PrimitiveDistanceContractTest, NoPlanePartsAPointFartherAndTheGradientsPlaneDoes) {
  Random rng(1);
  int inside = 0, outside = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const int type = kRound[trial % 4];
    const Vector3d size = 0.05 * Vector3d::Ones() + 0.2 * rng.InBox(1.0).cwiseAbs();
    const Vector3d x = (trial % 8 < 4 ? 1.0 : 0.4) * rng.InBox(0.4);
    const double distance = RoundDistanceAt(type, size, x);
    ++(distance < 0.0 ? inside : outside);
    const Vector3d n = verify::RoundNormalAt(type, size, x);
    EXPECT_NEAR(n.norm(), 1.0, 1e-12);
    if (std::abs(distance) > 1e-3) {
      EXPECT_NEAR(n.dot(x) - Reach(type, size, n), distance, 1e-6) << type;
    }
    for (int k = 0; k < 50; ++k) {
      const Vector3d other = (n + rng.Uniform(0.0, 1.0) * rng.UnitVector()).normalized();
      EXPECT_LE(other.dot(x) - Reach(type, size, other), distance + 1e-12) << type;
    }
  }
  EXPECT_GT(inside, 300);
  EXPECT_GT(outside, 300);
  const Vector3d x(0.3, -2.0, -0.7);
  EXPECT_EQ(RoundDistanceAt(mjGEOM_PLANE, Vector3d::Zero(), x), -0.7);
  EXPECT_LT((verify::RoundNormalAt(mjGEOM_PLANE, {0, 0, 1}, x) - Vector3d::UnitZ()).norm(), 1e-9);
  EXPECT_EQ(verify::RoundNormalAt(mjGEOM_SPHERE, {1, 0, 0}, Vector3d::Zero()), Vector3d::UnitZ());
}

TEST(PrimitiveDistanceContractTest, OfATriangleNoPointIsNearer) {
  Random rng(2);
  for (int trial = 0; trial < 60; ++trial) {
    const int type = trial % 5 == 4 ? static_cast<int>(mjGEOM_PLANE) : kRound[trial % 5];
    const Vector3d size = 0.05 * Vector3d::Ones() + 0.2 * rng.InBox(1.0).cwiseAbs();
    const Vector3d middle = rng.InBox(0.3);
    const double width = trial % 2 ? 0.5 : 0.05;
    const Vector3d corners[3] = {middle + rng.InBox(width), middle + rng.InBox(width),
                                 middle + rng.InBox(width)};
    Vector3d x;
    const double least = verify::RoundDistanceOnTriangle(type, size, corners, x);
    EXPECT_NEAR(RoundDistanceAt(type, size, x), least, 1e-9);
    Eigen::Matrix3d C;
    C << corners[0], corners[1], corners[2];
    // x is a point of the triangle.
    Eigen::Matrix<double, 4, 3> A;
    A << C, Eigen::RowVector3d::Ones();
    const Eigen::Vector4d b(x.x(), x.y(), x.z(), 1.0);
    const Vector3d shares = A.colPivHouseholderQr().solve(b);
    EXPECT_GT(shares.minCoeff(), -1e-9);
    EXPECT_LT((A * shares - b).norm(), 1e-9);
    constexpr int kParts = 20;
    for (int i = 0; i <= kParts; ++i) {
      for (int k = 0; k <= kParts - i; ++k) {
        const Vector3d at = C * Vector3d(i, k, kParts - i - k) / kParts;
        EXPECT_GE(RoundDistanceAt(type, size, at), least - 1e-9) << type;
      }
    }
  }
}

TEST(TrianglesContractTest, TheTrianglesOfABoxAreItsSurface) {
  const Vector3d half(0.1, 0.3, 0.7);
  const Triangles box = verify::BoxTriangles(half);
  ASSERT_EQ(box.size(), 12u);
  double volume = 0.0;
  for (const auto& [a, b, c] : box) {
    for (const Vector3d& p : {a, b, c}) EXPECT_EQ(p.cwiseAbs(), half);
    const Vector3d n = (b - a).cross(c - a);
    EXPECT_EQ((n.array() != 0.0).count(), 1);
    volume += a.dot(n) / 6.0;  // positive: they face outwards
  }
  EXPECT_NEAR(volume, 8.0 * half.prod(), 1e-12);
  EXPECT_EQ(verify::CountOpenEdges(box), 0);
}

TEST(TrianglesContractTest, TrianglesOfAMeshAreTheModelsOrItsHulls) {
  Random rng(3);
  const MeshShape cup = Cup(0.3, 0.4, 0.05, 12);
  const ModelPtr m =
      LoadModel("<mujoco><asset>" + MeshXml("first", BoxMesh({.1, .2, .3})) + MeshXml("cup", cup) +
                "</asset><worldbody><geom type='mesh' mesh='first'/>"
                "<geom type='mesh' mesh='cup'/></worldbody></mujoco>");
  const Triangles exact = verify::MeshTriangles(*m, 1, true);
  const Triangles hull = verify::MeshTriangles(*m, 1, false);
  EXPECT_EQ(exact.size(), cup.faces.size());
  EXPECT_EQ(verify::CountOpenEdges(exact), 0);
  EXPECT_EQ(verify::CountOpenEdges(hull), 0);
  std::vector<Vector3d> vertices;
  for (const auto& t : exact) vertices.insert(vertices.end(), t.begin(), t.end());
  const verify::VertexTree tree(vertices);
  EXPECT_TRUE(verify::IsBoundaryOfHull(hull, tree));
  EXPECT_FALSE(verify::IsBoundaryOfHull(exact, tree)) << "it is hollow";
  // All that the hull is, and no less: half of what there is along any direction.
  for (int k = 0; k < 200; ++k) {
    const Vector3d n = rng.UnitVector();
    double farthest = -1.0, of_hull = -1.0;
    for (const Vector3d& p : vertices) farthest = std::max(farthest, n.dot(p));
    for (const auto& t : hull) {
      for (const Vector3d& p : t) of_hull = std::max(of_hull, n.dot(p));
    }
    EXPECT_NEAR(of_hull, farthest, 1e-6);
  }
  Triangles open = hull;
  open.pop_back();
  EXPECT_EQ(verify::CountOpenEdges(open), 3);
  EXPECT_FALSE(verify::IsBoundaryOfHull(open, tree));
  Triangles turned = hull;
  std::swap(turned[2][0], turned[2][1]);
  EXPECT_EQ(verify::CountOpenEdges(turned), 3);
  Triangles twice = hull;
  twice.insert(twice.end(), hull.begin(), hull.end());
  EXPECT_EQ(verify::CountOpenEdges(twice), 0);
}

TEST(TrianglesContractTest, PiecesAreWhatHangsTogether) {
  Random rng(4);
  std::vector<int> of;  // by triangle, its piece
  Triangles triangles;
  for (int piece = 0; piece < 5; ++piece) {
    const MeshShape shape = At(piece % 2 ? BoxMesh({.1, .2, .3}) : Torus(.3, .1, 6, 5),
                               Vector3d(2.0 * piece, 0.1, 0.0));
    for (const auto& t : TrianglesOf(shape)) {
      const int place = rng.Index(static_cast<int>(triangles.size()) + 1);
      triangles.insert(triangles.begin() + place, t);
      of.insert(of.begin() + place, piece);
    }
  }
  const std::vector<std::vector<int>> pieces = verify::Pieces(triangles);
  EXPECT_EQ(pieces.size(), 5u);
  std::set<int> seen;
  for (const std::vector<int>& piece : pieces) {
    EXPECT_TRUE(std::is_sorted(piece.begin(), piece.end()));
    for (const int t : piece) {
      EXPECT_EQ(of[t], of[piece.front()]);
      EXPECT_TRUE(seen.insert(t).second);
    }
  }
  EXPECT_EQ(seen.size(), triangles.size());
}

// How far one goes from x along `direction` until x is on the surface; infinite if never.
double WayOut(const MeshShape& shape, const Vector3d& x, const Vector3d& direction) {
  double first = std::numeric_limits<double>::infinity();
  for (const auto& [a, b, c] : TrianglesOf(shape)) {
    Eigen::Matrix3d M;
    M << b - a, c - a, -direction;
    const Vector3d hit = M.inverse() * (x - a);
    if (hit[0] >= 0.0 && hit[1] >= 0.0 && hit[0] + hit[1] <= 1.0 && hit[2] > 0.0) {
      first = std::min(first, hit[2]);
    }
  }
  return first;
}

TEST(MeshSolidContractTest, DepthIsAWayOutOfPointsInsideAndZeroOutside) {
  Random rng(5);
  std::vector<MeshShape> shapes = SmallShapes();
  shapes.push_back(BoxMesh({.1, .2, .3}));
  for (const MeshShape& plain : shapes) {
    const MeshShape shape = At(plain, {0.2, -0.1, 0.05});
    const bool convex = &plain == &shapes.back();
    const MeshSolid solid(TrianglesOf(shape), convex, 512.0);
    EXPECT_TRUE(solid.closed);
    double extent = 0.0;
    Eigen::AlignedBox3d box;
    for (const Vector3d& p : shape.vertices) {
      extent = std::max(extent, p.norm());
      box.extend(p);
    }
    EXPECT_EQ(solid.extent, extent);
    int inside = 0, outside = 0;
    for (int k = 0; k < 400; ++k) {
      const Vector3d x = box.center() + 0.5 * box.sizes().cwiseProduct(rng.InBox(1.1));
      Vector3d out = Vector3d::Zero();
      const double depth = solid.DepthOf(x, out);
      ASSERT_EQ(depth > 0.0, InsideBySolidAngle(shape, x));
      ++(depth > 0.0 ? inside : outside);
      if (depth == 0.0) continue;
      EXPECT_NEAR(out.norm(), 1.0, 1e-12);
      EXPECT_NEAR(WayOut(shape, x, out), depth, 1e-9);
      EXPECT_GE(depth, BruteDistance(shape, x) - 1e-9);
      if (convex) {
        EXPECT_NEAR(depth, BruteDistance(shape, x), 1e-9);
      }
    }
    EXPECT_GT(inside, 10);
    EXPECT_GT(outside, 40);
    Triangles open = solid.triangles;
    open.pop_back();
    const MeshSolid surface(open, false, 1.0);
    Vector3d out;
    EXPECT_FALSE(surface.closed);
    EXPECT_EQ(surface.DepthOf(box.center(), out), 0.0);
  }
}

// Of a body that is not convex the depth is the least of 14 ways, which are the same everywhere.
TEST(MeshSolidContractTest, OfFourteenWaysOutItIsTheShortest) {
  Random rng(6);
  const MeshShape& knot = SmallShapes().front();
  const MeshSolid solid(TrianglesOf(knot), false, 512.0);
  Eigen::AlignedBox3d box;
  for (const Vector3d& p : knot.vertices) box.extend(p);
  std::vector<Vector3d> inside, directions;
  std::vector<double> depths;
  for (int k = 0; k < 4000; ++k) {
    const Vector3d x = box.center() + 0.5 * box.sizes().cwiseProduct(rng.InBox(1.0));
    Vector3d out;
    const double depth = solid.DepthOf(x, out);
    if (depth == 0.0) continue;
    inside.push_back(x);
    depths.push_back(depth);
    const auto same = [&out](const Vector3d& known) { return known.dot(out) > 0.999; };
    if (std::none_of(directions.begin(), directions.end(), same)) directions.push_back(out);
  }
  EXPECT_EQ(directions.size(), 14u);
  ASSERT_GT(inside.size(), 100u);
  for (std::size_t k = 0; k < std::min<std::size_t>(inside.size(), 300); ++k) {
    double least = std::numeric_limits<double>::infinity();
    for (const Vector3d& way : directions) least = std::min(least, WayOut(knot, inside[k], way));
    EXPECT_NEAR(depths[k], least, 1e-9);
  }
}

TEST(MeshSolidContractTest, EveryPieceHasAProbeOnItAndMostOneInside) {
  MeshShape shape = At(BoxMesh({.1, .2, .3}), {2, 0, 0});
  shape.Append(At(Torus(.3, .1, 8, 6), {0, 1, 0})).Append(At(BoxMesh({.2, .2, .2}), {0, 0, 3}));
  const MeshSolid solid(TrianglesOf(shape), false, 64.0);
  ASSERT_EQ(solid.probes.size(), 6u);
  int inside = 0;
  std::set<int> places;  // the pieces are far from each other
  for (const MeshSolid::Probe& probe : solid.probes) {
    const double off = BruteDistance(shape, probe.p);
    if (probe.inside == 0.0) {
      EXPECT_LT(off, 1e-12);
      EXPECT_TRUE(places.insert(probe.p.x() > 1.0 ? 0 : probe.p.z() > 1.0 ? 1 : 2).second);
      continue;
    }
    ++inside;
    Vector3d out;
    EXPECT_TRUE(InsideBySolidAngle(shape, probe.p));
    EXPECT_EQ(probe.inside, solid.DepthOf(probe.p, out));
    EXPECT_GT(probe.inside, 0.05);
  }
  EXPECT_EQ(inside, 3);
}

}  // namespace
}  // namespace mjcf_pdg::test
