// Contacts of meshes that collide as their triangles.
#include <algorithm>
#include <cmath>

#include "collide/contacts.h"
#include "model/exact_mesh.h"
#include "tests/support/brute_mesh.h"
#include "tests/support/mesh_shapes.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg {
namespace {

using test::MeshShape;
using test::Random;

class ExactMeshContactsTest : public test::MujocoTest {};

constexpr double kFar = 10.0;

using test::Exact;

// Mesh "mesh" as geom "g2" of a fixed body; what moves freely has the geom "g1".
std::string TwoMeshes(const MeshShape& fixed, const MeshShape& moving) {
  return test::MeshSceneXml(fixed, "type='mesh' mesh='moving'", test::MeshXml("moving", moving));
}

// MuJoCo turns and moves a mesh's vertices, and the geom the other way round, so that a body at
// `position` holds the mesh where the shape's own coordinates put it.
VectorXd At(const Vector3d& position, const Eigen::Quaterniond& turn = {1, 0, 0, 0}) {
  VectorXd q(7);
  q << position, turn.w(), turn.x(), turn.y(), turn.z();
  return q;
}

// Of meshes that are their own hulls, too, the triangles: here they are what is asked.
SceneTables WithTriangles(const Scene& scene) {
  SceneTables tables = scene.tables();
  for (KeptPair& pair : tables.pairs) {
    if (tables.exact[pair.geom1] || tables.exact[pair.geom2]) pair.kind = PairKind::kExact;
  }
  BuildBvhs(tables);
  return tables;
}

class Finder {
 public:
  explicit Finder(const std::string& xml, const SceneOptions& options = Exact())
      : scene_(Scene::FromString(xml, options)), tables_(WithTriangles(scene_)), finder_(tables_) {}

  const Scene& scene() const { return scene_; }
  NearPair Nearest(const VectorXd& q, double cutoff = kFar) {
    finder_.Pose(q);
    NearPair near;
    near.distance = kFar;
    found_ = finder_.Distance(0, cutoff, near);
    return near;
  }
  double Distance(const VectorXd& q) { return Nearest(q).distance; }
  bool found() const { return found_; }
  std::vector<NearPair> Find(const VectorXd& q, double margin) {
    finder_.Forget();
    finder_.Pose(q);
    return finder_.Find(margin);
  }

 private:
  Scene scene_;
  SceneTables tables_;
  ContactFinder finder_;
  bool found_ = false;
};

MeshShape Moved(const MeshShape& shape, const VectorXd& q) {
  return test::Moved(shape, QuatAt(q, 3).matrix(), q.head<3>());
}

// ---- Convex meshes: their triangles enclose their hulls ----

TEST_F(ExactMeshContactsTest, ConvexMeshesAgreeWithTheirHullsAgainstEveryType) {
  Random rng(11);
  for (const int type : test::ConvexTypes()) {
    int overlapping = 0, apart = 0;
    for (int k = 0; k < 12; ++k) {
      test::TwoGeoms two;
      two.first = test::RandomShape(mjGEOM_MESH, rng);
      two.second = test::RandomShape(type, rng);
      const std::string xml = test::TwoGeomXml(two);
      Finder hull(xml, {}), exact(xml);
      for (int i = 0; i < 30; ++i) {
        const VectorXd q = At(rng.InBox(0.4), rng.UnitQuat());
        const double expected = hull.Distance(q);
        const NearPair near = exact.Nearest(q);
        ASSERT_TRUE(exact.found());
        EXPECT_NEAR(near.n_W.norm(), 1.0, 1e-9);
        EXPECT_NEAR(near.n_W.dot(near.p2_W - near.p1_W), near.distance, 1e-9);
        if (std::abs(expected) < 1e-6) continue;
        EXPECT_EQ(near.distance < 0.0, expected < 0.0)
            << test::TypeName(type) << ": " << near.distance << ", the hull " << expected;
        ++(expected > 0.0 ? apart : overlapping);
        if (expected < 0.0) continue;
        EXPECT_NEAR(near.distance, expected, 1e-6) << test::TypeName(type);
      }
    }
    EXPECT_GT(apart, 50) << test::TypeName(type);
    EXPECT_GT(overlapping, 30) << test::TypeName(type);
  }
}

// ---- Any meshes ----

TEST_F(ExactMeshContactsTest, DistancesOfMeshesAreThoseOfAllPairsOfTriangles) {
  Random rng(13);
  const std::vector<MeshShape>& shapes = test::SmallShapes();
  int apart = 0, overlapping = 0;
  for (const MeshShape& fixed : shapes) {
    for (const MeshShape& moving : shapes) {
      Finder finder(TwoMeshes(fixed, moving));
      for (int i = 0; i < 8; ++i) {
        const VectorXd q = At(rng.InBox(0.3), rng.UnitQuat());
        const double expected = test::BruteDistance(fixed, Moved(moving, q));
        const double distance = finder.Distance(q);
        ++(expected > 0.0 ? apart : overlapping);
        if (expected == 0.0) {
          EXPECT_LT(distance, 0.0) << i;
        } else if (distance > 0.0) {
          EXPECT_NEAR(distance, expected, 1e-7);
        } else {  // contained
          const MeshShape there = Moved(moving, q);
          EXPECT_TRUE(test::InsideBySolidAngle(fixed, there.vertices[0]) ||
                      test::InsideBySolidAngle(there, fixed.vertices[0]));
        }
      }
    }
  }
  EXPECT_GT(apart, 20);
  EXPECT_GT(overlapping, 15);
}

TEST_F(ExactMeshContactsTest, LinkedRingsAreFreeAndCrossedOnesAreNot) {
  const MeshShape ring = test::Torus(0.1, 0.02, 48, 16);
  Finder exact(TwoMeshes(ring, ring)), hull(TwoMeshes(ring, ring), {});
  const Eigen::Quaterniond upright(Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitX()));
  const VectorXd linked = At({0.1, 0.0, 0.0}, upright);
  EXPECT_NEAR(exact.Distance(linked), 0.06, 1e-3);
  EXPECT_LT(hull.Distance(linked), 0.0);
  EXPECT_NEAR(exact.Distance(At({0.17, 0.0, 0.0}, upright)), -0.01, 3e-3);
}

TEST_F(ExactMeshContactsTest, ACupIsHollowAndItsWallIsNot) {
  const MeshShape cup = test::Cup(0.1, 0.2, 0.04, 32);
  Finder finder(test::MeshSceneXml(cup, "type='sphere' size='0.01'"));
  EXPECT_NEAR(finder.Distance(At({0.0, 0.0, 0.1})), 0.06 - 0.01 - 0.06 * (1 - std::cos(M_PI / 32)),
              1e-3);
  EXPECT_NEAR(finder.Distance(At({0.0, 0.0, 0.045})), -0.005, 1e-6);
  // Wholly inside the bottom: from 0.015 above the outer face.
  EXPECT_NEAR(finder.Distance(At({0.0, 0.0, 0.015})), -0.025, 1e-6);
  EXPECT_NEAR(finder.Nearest(At({0.0, 0.0, 0.015})).n_W.z(), 1.0, 1e-6);
}

TEST_F(ExactMeshContactsTest, WhateverIsWhollyInsideASolidCollides) {
  const MeshShape block = test::BoxMesh({0.3, 0.3, 0.3});
  const MeshShape knot = test::TorusKnot(0.03, 0.005, 60, 8);
  const std::string inner[] = {"type='sphere' size='0.02'",
                               "type='capsule' size='0.02 0.05'",
                               "type='ellipsoid' size='0.02 0.03 0.04'",
                               "type='cylinder' size='0.02 0.03'",
                               "type='box' size='0.02 0.03 0.04'",
                               "type='mesh' mesh='knot'"};
  for (const std::string& geom : inner) {
    Finder finder(test::MeshSceneXml(block, geom, test::MeshXml("knot", knot)));
    EXPECT_LT(finder.Distance(At({0.1, 0.0, 0.0})), -0.2) << geom;
    EXPECT_GT(finder.Distance(At({0.5, 0.0, 0.0})), 0.0) << geom;
    Finder around(test::MeshSceneXml(knot, "type='box' size='0.3 0.3 0.3'"));
    EXPECT_LT(around.Distance(At({0.1, 0.0, 0.0})), -0.2);
  }
}

TEST_F(ExactMeshContactsTest, SolidsThatCoincideOverlap) {
  const MeshShape cup = test::Cup(0.1, 0.2, 0.04, 16), box = test::BoxMesh({0.1, 0.2, 0.3});
  EXPECT_LT(Finder(TwoMeshes(cup, cup)).Distance(At({0, 0, 0})), -0.005);
  EXPECT_LT(Finder(TwoMeshes(box, box)).Distance(At({0, 0, 0})), -0.01);
  EXPECT_LT(
      Finder(test::MeshSceneXml(box, "type='box' size='0.1 0.2 0.3'")).Distance(At({0, 0, 0})),
      -0.01);
}

TEST_F(ExactMeshContactsTest, FacesThatTouchDoNotOverlap) {
  const MeshShape box = test::BoxMesh({0.125, 0.125, 0.125});
  Finder finder(TwoMeshes(box, box));
  for (const Vector3d& beside : {Vector3d(0.25, 0.0, 0.0), Vector3d(0.1, 0.05, 0.25)}) {
    EXPECT_NEAR(finder.Distance(At(beside)), 0.0, 1e-7);
  }
}

// No vertex of either is inside the other.
TEST_F(ExactMeshContactsTest, CrossedEdgesAndPiercedFacesOverlap) {
  const MeshShape bar = test::BoxMesh({0.3, 0.02, 0.02});
  const Eigen::Quaterniond across(Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitZ()));
  const Eigen::Quaterniond on_edge(Eigen::AngleAxisd(M_PI / 4, Vector3d::UnitX()));
  MeshShape edge_up = bar;
  edge_up.Move(on_edge.matrix(), Vector3d::Zero());
  Finder finder(TwoMeshes(edge_up, edge_up));
  const double touch = 2.0 * 0.02 * std::sqrt(2.0);
  for (const double overlap : {1e-2, 1e-3, 1e-5, 2e-6}) {
    const double distance = finder.Distance(At({0, 0, touch - overlap}, across));
    EXPECT_LT(distance, -0.2 * overlap) << overlap;
    EXPECT_GE(distance, -1.01 * overlap);
    EXPECT_NEAR(finder.Distance(At({0, 0, touch + overlap}, across)), overlap, 1e-7);
  }
  Finder plate(TwoMeshes(test::BoxMesh({0.3, 0.3, 0.005}), bar));
  const Eigen::Quaterniond upright(Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitY()));
  EXPECT_LT(plate.Distance(At({0, 0, 0}, upright)), -0.002);
}

TEST_F(ExactMeshContactsTest, AnOpenMeshIsASurface) {
  MeshShape open = test::BoxMesh({0.1, 0.1, 0.1});
  open.faces.resize(10);  // the lid is off (x = 0.1)
  Finder finder(test::MeshSceneXml(open, "type='sphere' size='0.02'"));
  ASSERT_EQ(finder.scene().Warnings().size(), 1u);
  EXPECT_NE(finder.scene().Warnings()[0].find("'g2' is not closed (4 open edges)"),
            std::string::npos)
      << finder.scene().Warnings()[0];
  EXPECT_NEAR(finder.Distance(At({0, 0, 0})), 0.08, 1e-7);
  EXPECT_NEAR(finder.Distance(At({-0.09, 0, 0})), -0.01, 1e-7);
  Finder boxes(test::MeshSceneXml(open, "type='box' size='0.05 0.02 0.02'"));
  EXPECT_GT(boxes.Distance(At({0, 0, 0})), 0.0);
  EXPECT_LT(boxes.Distance(At({-0.1, 0, 0})), -0.001);
}

TEST_F(ExactMeshContactsTest, ScaledAndTurnedAssetsAreWhereMujocoPutsThem) {
  MeshShape cup = test::Cup(0.1, 0.2, 0.02, 24);
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()));
  cup.Move(turn.matrix(), {0.3, -0.2, 0.1});
  const std::string xml =
      "<mujoco><asset>" + test::MeshXml("cup", cup, "scale='2 2 2'") +
      "</asset><worldbody><geom name='g2' type='mesh' mesh='cup' pos='0.1 0.2 0.3'/>"
      "<body><freejoint/><geom name='g1' size='0.05'/></body></worldbody></mujoco>";
  Finder finder(xml);
  const Vector3d inside = turn * Vector3d(0.0, 0.0, 0.1) + Vector3d(0.3, -0.2, 0.1);
  const double expected = 2.0 * 0.08 * std::cos(M_PI / 24) - 0.05;
  EXPECT_NEAR(finder.Distance(At(2.0 * inside + Vector3d(0.1, 0.2, 0.3))), expected, 1e-5);
}

// ---- Features ----

TEST_F(ExactMeshContactsTest, AFaceOnAFaceHasRowsAtItsCorners) {
  Finder finder(TwoMeshes(test::BoxMesh({0.5, 0.5, 0.1}), test::BoxMesh({0.1, 0.1, 0.1})));
  const std::vector<NearPair> near = finder.Find(At({0.1, 0.05, 0.201}), 0.01);
  ASSERT_GE(near.size(), 4u);
  for (const double x : {0.0, 0.2}) {
    for (const double y : {-0.05, 0.15}) {
      EXPECT_TRUE(std::any_of(near.begin(), near.end(),
                              [&](const NearPair& n) {
                                return (n.p1_W - Vector3d(x, y, 0.1)).norm() < 0.05 &&
                                       std::abs(n.n_W.z()) > 0.999;
                              }))
          << x << " " << y;
    }
  }
}

TEST_F(ExactMeshContactsTest, APegInAHoleHasRowsAllAround) {
  const MeshShape block = test::Revolution({{0.1, 0}, {0.2, 0}, {0.2, 0.2}, {0.1, 0.2}}, 48);
  for (const std::string& geom :
       {std::string("type='cylinder' size='0.098 0.05'"), std::string("type='mesh' mesh='peg'")}) {
    const MeshShape peg =
        test::Revolution({{0.05, -0.05}, {0.098, -0.05}, {0.098, 0.05}, {0.05, 0.05}}, 48);
    Finder finder(test::MeshSceneXml(block, geom, test::MeshXml("peg", peg)));
    const std::vector<NearPair> near = finder.Find(At({0, 0, 0.1}), 0.005);
    for (int k = 0; k < 4; ++k) {
      const Vector3d way(std::cos(k * M_PI / 2), std::sin(k * M_PI / 2), 0.0);
      EXPECT_TRUE(std::any_of(near.begin(), near.end(),
                              [&](const NearPair& n) {
                                return std::abs(n.n_W.dot(way)) > 0.8 && n.p1_W.dot(way) > 0.05;
                              }))
          << geom << k;
    }
    for (const NearPair& n : near) EXPECT_GT(n.distance, 0.0);
  }
}

TEST_F(ExactMeshContactsTest, FeaturesKeepTheirPromises) {
  Random rng(17);
  const MeshShape knot = test::TorusKnot(0.1, 0.03, 60, 8);
  int rows = 0;
  for (const std::string& geom :
       {std::string("type='mesh' mesh='m'"), std::string("type='capsule' size='0.03 0.1'"),
        std::string("type='cylinder' size='0.05 0.1'")}) {
    Finder finder(test::MeshSceneXml(knot, geom, test::MeshXml("m", knot)));
    for (int i = 0; i < 40; ++i) {
      const VectorXd q = At(rng.InBox(0.25), rng.UnitQuat());
      const double nearest = finder.Distance(q);
      const std::vector<NearPair> near = finder.Find(q, 0.03);
      EXPECT_EQ(near.empty(), nearest >= 0.03);
      EXPECT_LE(near.size(), 32u);
      if (near.empty()) continue;
      double least = kFar;
      for (const NearPair& n : near) {
        least = std::min(least, n.distance);
        EXPECT_NEAR(n.n_W.norm(), 1.0, 1e-9);
        EXPECT_NEAR(n.n_W.dot(n.p2_W - n.p1_W), n.distance, 1e-9);
        ++rows;
      }
      EXPECT_NEAR(least, nearest, nearest > 0 ? 0.25 * nearest + 1e-9 : 0.2 * std::abs(nearest));
      // The same pose after others gives the same answer.
      finder.Find(At(rng.InBox(0.25)), 0.03);
      const std::vector<NearPair> again = finder.Find(q, 0.03);
      ASSERT_EQ(again.size(), near.size());
      for (std::size_t k = 0; k < near.size(); ++k) {
        EXPECT_EQ(again[k].distance, near[k].distance);
        EXPECT_EQ(again[k].n_W, near[k].n_W);
      }
    }
  }
  EXPECT_GT(rows, 100);
}

}  // namespace
}  // namespace mjcf_pdg
