// Which meshes are their own convex hulls.
#include "mesh/convex_mesh.h"

#include <cmath>

#include "mjcf_pdg/scene.h"
#include "model/scene_tables.h"
#include "tests/support/mesh_shapes.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg {
namespace {

using Eigen::Vector3d;
using test::MeshShape;
using test::Random;

class ConvexMeshTest : public test::MujocoTest {};

// As the scene sees it: MuJoCo's hull, coordinates rounded to float.
bool Convex(const MeshShape& shape, const std::string& attributes = {}) {
  const Scene scene =
      Scene::FromString("<mujoco><asset>" + test::MeshXml("m", shape, attributes) +
                            "</asset><worldbody><geom type='mesh' mesh='m'/><body><freejoint/>"
                            "<geom size='.1'/></body></worldbody></mujoco>",
                        test::Exact());
  EXPECT_TRUE(scene.HasExactMeshes());
  EXPECT_EQ(scene.tables().pairs.at(0).kind,
            scene.tables().convex[0] ? PairKind::kConvex : PairKind::kExact);
  return scene.tables().convex[0];
}

MeshShape Ball(int rings, int sectors, double dent = 0.0) {
  return test::Globe(rings, sectors, [&](const Vector3d& u) {
    return 0.1 * (1.0 - dent * std::exp(-20.0 * (u - Vector3d::UnitX()).squaredNorm()));
  });
}

// A box 2 × 2 × 2 with a groove along y from side to side: all its vertices lie on the hull.
MeshShape GroovedBox(double depth) {
  MeshShape box;
  for (const double y : {-1.0, 1.0}) {
    for (const Vector3d& v :
         {Vector3d(-1, y, -1), Vector3d(1, y, -1), Vector3d(1, y, 1), Vector3d(0.2, y, 1),
          Vector3d(0, y, 1 - depth), Vector3d(-0.2, y, 1), Vector3d(-1, y, 1)}) {
      box.vertices.push_back(0.1 * v);
    }
  }
  for (int k = 0; k < 7; ++k) {
    const int next = (k + 1) % 7;
    box.faces.emplace_back(k, next, next + 7);
    box.faces.emplace_back(k, next + 7, k + 7);
  }
  for (const auto& [a, b, c] : {std::array{0, 4, 1}, std::array{1, 4, 3}, std::array{1, 3, 2},
                                std::array{0, 5, 4}, std::array{0, 6, 5}}) {
    box.faces.emplace_back(a, b, c);
    box.faces.emplace_back(a + 7, c + 7, b + 7);
  }
  return box;
}

TEST_F(ConvexMeshTest, BoxesAndBallsAreConvexHoweverTheyLieAndFace) {
  Random rng(3);
  for (int k = 0; k < 20; ++k) {
    const Eigen::Matrix3d R = rng.UnitQuat().toRotationMatrix();
    const Vector3d t = rng.InBox(0.2), size = rng.InBox(0.1) + Vector3d::Constant(0.15);
    EXPECT_TRUE(Convex(test::BoxMesh(size).Move(R, t)));
    EXPECT_TRUE(Convex(Ball(6, 9).Move(R, t)));
    EXPECT_TRUE(Convex(Ball(20, 30).Move(R, t)));
    EXPECT_TRUE(Convex(Ball(6, 9).TurnInsideOut().Move(R, t), "inertia='shell'"));
  }
}

TEST_F(ConvexMeshTest, AFaceCutIntoTrianglesIsStillFlat) {
  MeshShape box = GroovedBox(0.0);
  EXPECT_TRUE(Convex(box));
  EXPECT_TRUE(Convex(box.Move(Random(5).UnitQuat().toRotationMatrix(), {0.1, 0.2, 0.3})));
}

TEST_F(ConvexMeshTest, ReflexEdgesAreSeenThoughAllVerticesLieOnTheHull) {
  for (const double depth : {1.0, 0.1, 1e-3, 1e-5}) EXPECT_FALSE(Convex(GroovedBox(depth)));
}

TEST_F(ConvexMeshTest, DentsHolesAndPiecesAreSeen) {
  EXPECT_FALSE(Convex(Ball(20, 30, 0.3)));
  EXPECT_FALSE(Convex(Ball(40, 60, 0.01)));
  EXPECT_FALSE(Convex(test::Torus(0.1, 0.03, 16, 8)));
  EXPECT_FALSE(Convex(test::Cup(0.1, 0.2, 0.01, 16)));
  MeshShape open = test::BoxMesh({0.1, 0.1, 0.1});
  open.faces.pop_back();
  EXPECT_FALSE(Convex(open, "inertia='shell'"));
  MeshShape void_inside = test::BoxMesh({0.1, 0.1, 0.1});
  void_inside.Append(test::BoxMesh({0.01, 0.01, 0.01}).TurnInsideOut());
  EXPECT_FALSE(Convex(void_inside));
}

// A thin rod whose upper end is turned: its waist is narrower, and each side is cut along the
// reflex diagonal, for one sense of turning.
MeshShape TwistedRod(int n, double height, double radius, double turn) {
  MeshShape rod;
  for (const double z : {-0.5 * height, 0.5 * height}) {
    for (int k = 0; k < n; ++k) {
      const double angle = 2.0 * M_PI * k / n + (z > 0.0 ? turn : 0.0);
      rod.vertices.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
    }
  }
  for (int i = 0; i < n; ++i) {
    const int j = (i + 1) % n;
    rod.faces.emplace_back(i, j, n + i);
    rod.faces.emplace_back(j, n + j, n + i);
    if (i == 0 || j == 0) continue;
    rod.faces.emplace_back(0, j, i);
    rod.faces.emplace_back(n, n + i, n + j);
  }
  return rod;
}

TEST_F(ConvexMeshTest, TwistedRodsHaveAWaist) {
  EXPECT_TRUE(Convex(TwistedRod(16, 1.0, 0.1, 0.0)));
  for (const double sense : {-1.0, 1.0}) {
    EXPECT_FALSE(Convex(TwistedRod(16, 1.0, 0.001, 0.5 * sense)));
    EXPECT_FALSE(Convex(TwistedRod(64, 1.0, 0.005, 0.3 * sense)));
    EXPECT_FALSE(Convex(TwistedRod(200, 1.0, 0.02, 0.3 * sense)));
    EXPECT_FALSE(Convex(TwistedRod(400, 1.0, 0.02, 1.0 * sense)));
  }
}

// Twelve corners of an icosahedron, faces of five neighbours of a neighbour each: locally convex
// everywhere, but it passes through itself.
TEST_F(ConvexMeshTest, AStarPolyhedronIsNotItsHull) {
  const double g = 0.5 * (1.0 + std::sqrt(5.0));
  MeshShape star;
  for (const double a : {-1.0, 1.0}) {
    for (const double b : {-g, g}) {
      star.vertices.push_back(0.1 * Vector3d(0, a, b));
      star.vertices.push_back(0.1 * Vector3d(a, b, 0));
      star.vertices.push_back(0.1 * Vector3d(b, 0, a));
    }
  }
  auto far = [&](int i, int j) {  // the edges of the great icosahedron
    return std::abs((star.vertices[i] - star.vertices[j]).norm() - 0.2 * g) < 1e-6;
  };
  for (int i = 0; i < 12; ++i) {
    for (int j = i + 1; j < 12; ++j) {
      for (int k = j + 1; k < 12; ++k) {
        if (!far(i, j) || !far(j, k) || !far(k, i)) continue;
        const Vector3d a = star.vertices[i], b = star.vertices[j], c = star.vertices[k];
        const bool outward = (b - a).cross(c - a).dot(a + b + c) > 0.0;
        star.faces.emplace_back(i, outward ? j : k, outward ? k : j);
      }
    }
  }
  ASSERT_EQ(star.faces.size(), 20u);
  EXPECT_FALSE(Convex(star, "inertia='convex'"));
}

// MuJoCo stops adding vertices to its hull: then the hull is less than the mesh.
TEST_F(ConvexMeshTest, AHullWithFewerVerticesIsAnotherBody) {
  EXPECT_TRUE(Convex(Ball(12, 16)));
  EXPECT_FALSE(Convex(Ball(12, 16), "maxhullvert='20'"));
}

}  // namespace
}  // namespace mjcf_pdg
