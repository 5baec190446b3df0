// What support_pieces.h promises of pieces: their support functions and derivatives by samples and
// differences, and which of them are found.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "collide/convex/support_points.h"
#include "gradient/support_pieces.h"
#include "tests/support/brute_distance.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

using Kind = SupportPiece::Kind;

class SupportPiecesContractTest : public MujocoTest {};

const std::vector<int> kSolids = {mjGEOM_SPHERE,   mjGEOM_CAPSULE, mjGEOM_ELLIPSOID,
                                  mjGEOM_CYLINDER, mjGEOM_BOX,     mjGEOM_MESH};

SupportPiece RandomPiece(Kind kind, double scale, Random& rng) {
  SupportPiece piece{kind, 0, scale * rng.InBox(1.0), scale * rng.Uniform(0.1, 1.0)};
  if (kind == Kind::kPoint && rng.Chance(0.3)) piece.radius = 0.0;
  if (kind == Kind::kRim) piece.p_G.head<2>().setZero();
  if (kind == Kind::kEllipsoid) {
    piece.p_G = piece.p_G.cwiseAbs() + Vector3d::Constant(0.1 * scale);
    piece.radius = 0.0;
  }
  return piece;
}

// A point of the piece, by its definition.
Vector3d PointOf(const SupportPiece& piece, Random& rng) {
  const Vector3d v = rng.UnitVector();
  if (piece.kind == Kind::kPoint) return piece.p_G + piece.radius * v;
  if (piece.kind == Kind::kEllipsoid) return piece.p_G.cwiseProduct(v);
  const Eigen::Vector2d out = v.head<2>().normalized();
  return {piece.radius * out.x(), piece.radius * out.y(), piece.p_G.z()};
}

TEST_F(SupportPiecesContractTest, APieceIsEvaluatedAtItsFarthestPoint) {
  Random rng(1);
  for (int trial = 0; trial < 120; ++trial) {
    const double scale = std::pow(10.0, rng.Uniform(-3.0, 3.0));
    const SupportPiece piece = RandomPiece(static_cast<Kind>(trial % 3), scale, rng);
    const Vector3d u = rng.UnitVector();
    const SupportValue at = Evaluate(piece, u);
    double most = -std::numeric_limits<double>::infinity(), off = -most;
    for (int k = 0; k < 20000; ++k) {
      const Vector3d x = PointOf(piece, rng);
      most = std::max(most, u.dot(x));
      off = std::min(off, (x - at.x_G).norm());
    }
    EXPECT_GE(at.h, most - 1e-12 * scale) << trial;
    EXPECT_LE(at.h, most + 2e-3 * scale) << trial;
    EXPECT_LE(off, 0.06 * scale) << trial;
    EXPECT_NEAR(u.dot(at.x_G), at.h, 1e-12 * scale) << trial;
  }
}

// h of a direction of any length; a support function grows with the length.
double HeightOf(const SupportPiece& piece, const Vector3d& v) {
  return v.norm() * Evaluate(piece, v.normalized()).h;
}

TEST_F(SupportPiecesContractTest, DerivativesAreThoseOfTheSupportFunction) {
  Random rng(2);
  for (int trial = 0; trial < 300; ++trial) {
    const double scale = std::pow(10.0, rng.Uniform(-3.0, 3.0));
    const SupportPiece piece = RandomPiece(static_cast<Kind>(trial % 3), scale, rng);
    const Vector3d u = rng.UnitVector();
    if (u.head<2>().norm() < 0.1) continue;
    const SupportValue at = Evaluate(piece, u);
    const double step = 1e-5;
    for (int k = 0; k < 3; ++k) {
      const Vector3d d = step * Vector3d::Unit(k);
      const double slope = (HeightOf(piece, u + d) - HeightOf(piece, u - d)) / (2.0 * step);
      EXPECT_NEAR(at.x_G[k], slope, 1e-6 * scale) << trial;
      const Vector3d change =
          (Evaluate(piece, (u + d).normalized()).x_G - Evaluate(piece, (u - d).normalized()).x_G) /
          (2.0 * step);
      EXPECT_LT((at.second_G.col(k) - change).norm(), 1e-5 * scale) << trial;
    }
  }
}

// Where a rim's support function has no derivative, it has a value and a farthest point.
TEST_F(SupportPiecesContractTest, ARimSeenAlongItsAxisHasAValue) {
  for (const double side : {1.0, -1.0}) {
    const SupportPiece rim{Kind::kRim, 0, Vector3d(0.0, 0.0, 0.3), 0.2};
    const SupportValue at = Evaluate(rim, side * Vector3d::UnitZ());
    EXPECT_DOUBLE_EQ(at.h, side * 0.3);
    EXPECT_NEAR(at.x_G.head<2>().norm(), 0.2, 1e-15);
    EXPECT_TRUE(at.second_G.allFinite());
  }
}

// ---- Found pieces ----

struct OneGeom {
  OneGeom(int type, double scale, Random& rng) : shape(RandomShape(type, rng)) {
    shape.size *= scale;
    for (Vector3d& v : shape.vertices) v *= scale;
    Load();
  }
  explicit OneGeom(Shape s) : shape(std::move(s)) { Load(); }
  void Load() {
    shape.attributes = "mass='1'";
    TwoGeoms two{.first = shape};
    two.joint1 = "<joint type='slide'/>";
    scene = std::make_unique<Scene>(Scene::FromString(TwoGeomXml(two)));
    posed = std::make_unique<PosedModel>(&scene->tables().query_model);
    posed->Pose(VectorXd::Zero(1));
  }
  std::vector<SupportPiece> Find(const Vector3d& u_G, double slab) const {
    std::vector<SupportPiece> pieces(3);  // which are to be replaced
    FindPieces(scene->tables(), 0, u_G, slab, pieces);
    return pieces;
  }
  // h of the geom by its definition, in the geom's frame.
  double Reach(const Vector3d& u_G) const {
    const Matrix3d R = AsMatrix(posed->data()->geom_xmat);
    const Vector3d u = R * u_G;
    return test::Support(scene->model(), posed->data(), 0, u) -
           u.dot(AsVector(posed->data()->geom_xpos));
  }

  Shape shape;
  std::unique_ptr<Scene> scene;
  std::unique_ptr<PosedModel> posed;
};

TEST_F(SupportPiecesContractTest, TheMaximumOfThePiecesIsTheSupportFunctionOfTheGeom) {
  Random rng(3);
  for (int trial = 0; trial < 120; ++trial) {
    const double scale = std::pow(10.0, rng.Uniform(-2.0, 3.0));
    const OneGeom geom(kSolids[trial % 6], scale, rng);
    for (int k = 0; k < 40; ++k) {
      const Vector3d u =
          k < 6 ? Vector3d((k % 2 ? 1.0 : -1.0) * Vector3d::Unit(k / 2)) : rng.UnitVector();
      const double slab = (k % 3) * 0.05 * scale;
      const std::vector<SupportPiece> pieces = geom.Find(u, slab);
      ASSERT_FALSE(pieces.empty());
      const double reach = geom.Reach(u);
      EXPECT_NEAR(Evaluate(pieces[0], u).h, reach, 1e-6 * scale) << kSolids[trial % 6];
      for (const SupportPiece& piece : pieces) {
        const double h = Evaluate(piece, u).h;
        EXPECT_LE(h, reach + 1e-6 * scale);
        EXPECT_GE(h, reach - slab - 1e-6 * scale);
      }
      EXPECT_LE(pieces.size(), 32u);
      // Wherever the plane is tilted to, as far as the slab allows it, the pieces still say.
      const Vector3d tilted = (u + rng.Uniform(0.0, 0.02) * rng.UnitVector()).normalized();
      double most = -std::numeric_limits<double>::infinity();
      for (const SupportPiece& piece : pieces) most = std::max(most, Evaluate(piece, tilted).h);
      EXPECT_LE(most, geom.Reach(tilted) + 1e-6 * scale);
      // A cap counts as a polygon.
      if (slab > 0.0) {
        EXPECT_GE(most, geom.Reach(tilted) - 2e-4 * scale) << kSolids[trial % 6];
      }
    }
  }
}

TEST_F(SupportPiecesContractTest, NoVertexWithinTheSlabIsLeftOutAndEachKeepsItsNumber) {
  Random rng(4);
  int inside = 0, outside = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const OneGeom geom(trial % 2 ? mjGEOM_BOX : mjGEOM_MESH, 1.0, rng);
    const std::vector<SupportPiece> all = geom.Find(Vector3d::UnitX(), 10.0);
    ASSERT_LE(all.size(), 32u);
    EXPECT_TRUE(trial % 2 == 0 || all.size() == 8u);
    std::map<int, Vector3d> numbered;
    for (const SupportPiece& piece : all) numbered[piece.id] = piece.p_G;
    EXPECT_EQ(numbered.size(), all.size());
    for (int k = 0; k < 20; ++k) {
      const Vector3d u = rng.UnitVector();
      const double slab = rng.Uniform(0.0, 0.3);
      const std::vector<SupportPiece> near = geom.Find(u, slab);
      std::size_t within = 0;
      for (const SupportPiece& piece : all) {
        within += u.dot(piece.p_G) > geom.Reach(u) - slab;
      }
      EXPECT_EQ(near.size(), within);
      inside += static_cast<int>(within);
      outside += static_cast<int>(all.size() - within);
      for (const SupportPiece& piece : near) EXPECT_EQ(numbered.at(piece.id), piece.p_G);
    }
  }
  EXPECT_GT(inside, 500);
  EXPECT_GT(outside, 500);
}

TEST_F(SupportPiecesContractTest, OfAFinelyCutMeshTheNearest32AreFound) {
  Random rng(5);
  Shape ball{.type = mjGEOM_MESH};
  for (int k = 0; k < 300; ++k) ball.vertices.push_back(rng.UnitVector());
  const OneGeom geom(ball);
  for (int k = 0; k < 20; ++k) {
    const Vector3d u = rng.UnitVector();
    const std::vector<SupportPiece> pieces = geom.Find(u, 10.0);
    ASSERT_EQ(pieces.size(), 32u);
    std::vector<double> reach, found;
    for (const Eigen::Vector3f& p : geom.scene->tables().support->HullPoints(0)) {
      reach.push_back(u.dot(p.cast<double>()));
    }
    std::sort(reach.rbegin(), reach.rend());
    for (const SupportPiece& piece : pieces) found.push_back(u.dot(piece.p_G));
    std::sort(found.rbegin(), found.rend());
    for (int i = 0; i < 32; ++i) EXPECT_DOUBLE_EQ(found[i], reach[i]);
  }
}

// The two rims of a cylinder, or the corners of a cap that a plane touches.
TEST_F(SupportPiecesContractTest, NumbersOfACylindersPiecesAreDistinct) {
  const OneGeom geom(Shape{.type = mjGEOM_CYLINDER, .size = {0.2, 0.3, 0.0}});
  for (const Vector3d& u :
       {Vector3d(0, 0, 1), Vector3d(0, 0, -1), Vector3d(1, 0, 0), Vector3d(0.6, 0, 0.8)}) {
    for (const double slab : {0.01, 1.0}) {
      const std::vector<SupportPiece> pieces = geom.Find(u, slab);
      std::map<int, int> seen;
      for (const SupportPiece& piece : pieces) EXPECT_EQ(seen[piece.id]++, 0);
      const std::size_t both = slab == 1.0 || u.z() == 0.0 ? 2 : 1;
      EXPECT_EQ(pieces.size(), both * (std::abs(u.z()) == 1.0 ? 12 : 1));
    }
  }
}

}  // namespace
}  // namespace mjcf_pdg::test
