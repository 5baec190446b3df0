// Which meshes are their own convex hulls.
#include "convex_mesh.h"

#include "mesh_shapes.h"
#include "mjcf_pdg/scene.h"
#include "scene_tables.h"
#include "test_support.h"

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
  EXPECT_EQ(scene.tables().pairs.at(0).exact, !scene.tables().convex[0]);
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

// MuJoCo stops adding vertices to its hull: then the hull is less than the mesh.
TEST_F(ConvexMeshTest, AHullWithFewerVerticesIsAnotherBody) {
  EXPECT_TRUE(Convex(Ball(12, 16)));
  EXPECT_FALSE(Convex(Ball(12, 16), "maxhullvert='20'"));
}

}  // namespace
}  // namespace mjcf_pdg
