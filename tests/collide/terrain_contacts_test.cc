// Signed distances to height fields, against brute force over prisms, MuJoCo, and closed forms.
#include "collide/terrain/terrain_contacts.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstdio>

#include "collide/contacts.h"
#include "tests/support/terrain.h"

namespace mjcf_pdg::test {
namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;

constexpr double kBrute = 1e-5;  // the oracle's own ridges [m]

class TerrainContactsTest : public MujocoTest {
 protected:
  Random rng_{25};
};

// A free body's pose; the body's frame is that of its geom, unless that is a mesh.
VectorXd PoseOf(const Vector3d& p, const Quaterniond& turn = Quaterniond::Identity()) {
  VectorXd q(7);
  q << p, turn.w(), turn.x(), turn.y(), turn.z();
  return q;
}

double DistanceAt(ContactFinder& finder, const VectorXd& q, double cutoff = 1.0) {
  finder.Pose(q);
  NearPair near;
  return finder.Distance(0, cutoff, near) ? near.distance : cutoff;
}

const std::vector<int> kShapes = {mjGEOM_SPHERE,   mjGEOM_CAPSULE, mjGEOM_ELLIPSOID,
                                  mjGEOM_CYLINDER, mjGEOM_BOX,     mjGEOM_MESH};

// A rough field, tilted, and a random shape above, in and below it, over its edges too.
struct RandomPose {
  Field field;
  Shape shape;
  VectorXd q;
};
RandomPose Draw(int type, Random& rng) {
  RandomPose drawn{NoisyField(5, 4, 0.5, 0.4, 0.25, rng), RandomShape(type, rng), {}};
  const Quaterniond turn = rng.UnitQuat();
  const double quat[] = {turn.w(), turn.x(), turn.y(), turn.z()};
  const Vector3d at = rng.InBox(0.5);
  drawn.field.pose = "pos='" + Join(at.data(), 3) + "' quat='" + Join(quat, 4) + "'";
  const Vector3d in_field(rng.Uniform(-0.6, 0.6), rng.Uniform(-0.5, 0.5), rng.Uniform(-0.4, 0.5));
  drawn.q = PoseOf(at + turn * in_field, rng.UnitQuat());
  return drawn;
}

TEST_F(TerrainContactsTest, DistancesAreThoseToTheNearestPrism) {
  int apart = 0, overlaps = 0;
  for (const int type : kShapes) {
    for (int trial = 0; trial < 12; ++trial) {
      const RandomPose drawn = Draw(type, rng_);
      SCOPED_TRACE(TypeName(type) + " at " + Join(drawn.q));
      PrismOracle oracle(FieldWithPrismsXml(drawn.field, drawn.shape));
      oracle.Pose(drawn.q);
      const double brute = oracle.Distance();
      const Scene scene = Scene::FromString(FieldXml(drawn.field, drawn.shape));
      ASSERT_EQ(scene.num_kept_pairs(), 1);
      ContactFinder finder(scene.tables());
      finder.Pose(drawn.q);
      NearPair near;
      const bool found = finder.Distance(0, 0.4, near);
      if (brute < 0.4 - kBrute) {
        ASSERT_TRUE(found);
        EXPECT_NEAR(near.n_W.norm(), 1.0, 1e-12);
        EXPECT_NEAR(near.n_W.dot(near.p2_W - near.p1_W), near.distance, 1e-9);
      }
      if (brute > kBrute && brute < 0.4) {
        ++apart;
        EXPECT_NEAR(near.distance, brute, kBrute);
        EXPECT_NEAR((near.p2_W - near.p1_W).norm(), near.distance, 1e-6);
      } else if (brute < -kBrute) {
        ++overlaps;
        EXPECT_LT(near.distance, brute + kBrute) << "the union is no easier to leave than a prism";
        // The way out leads out, and no less of it does.
        EXPECT_GE(oracle.Distance((-near.distance + kBrute) * near.n_W), 0.0);
        EXPECT_LT(oracle.Distance(-0.99 * near.distance * near.n_W), kBrute);
      }
    }
  }
  EXPECT_GT(apart, 12);
  EXPECT_GT(overlaps, 20);
}

// Dense sampling: how much shorter than the way that is found can a translation out be?
TEST_F(TerrainContactsTest, FewWaysOutAreMuchShorterThanTheOneFound) {
  int overlaps = 0, longer = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const int type = kShapes[trial % kShapes.size()];
    const Field field = MakeField(7, 7, 0.6, 0.6, [](double x, double y) {
      return 0.1 * std::sin(5 * x) * std::cos(4 * y) + 0.1 * x;
    });
    const Shape shape = RandomShape(type, rng_);
    const Scene scene = Scene::FromString(FieldXml(field, shape));
    ContactFinder finder(scene.tables());
    const VectorXd q =
        PoseOf({rng_.Uniform(-0.3, 0.3), rng_.Uniform(-0.3, 0.3), rng_.Uniform(0.1, 0.3)},
               rng_.UnitQuat());
    const double found = DistanceAt(finder, q);
    if (found > -0.01) continue;
    ++overlaps;
    bool shorter = false;
    for (int k = 0; k < 300 && !shorter; ++k) {
      VectorXd moved = q;
      moved.head<3>() += -0.9 * found * rng_.UnitVector();
      shorter = DistanceAt(finder, moved) > 0.0;
    }
    longer += shorter;
  }
  std::printf("  of %d overlaps %d have a way out that is shorter by a tenth\n", overlaps, longer);
  EXPECT_GT(overlaps, 25);
  EXPECT_LE(longer, 0.2 * overlaps);
}

TEST_F(TerrainContactsTest, MujocoSeesTheSameOverlaps) {
  int overlaps = 0, free = 0, missed = 0, invented = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const RandomPose drawn = Draw(kShapes[trial % kShapes.size()], rng_);
    const ModelPtr model = LoadModel(FieldXml(drawn.field, drawn.shape));
    const DataPtr data(mj_makeData(model.get()));
    mju_copy(data->qpos, drawn.q.data(), 7);
    mj_kinematics(model.get(), data.get());
    mj_comPos(model.get(), data.get());
    mj_collision(model.get(), data.get());
    const Scene scene = Scene::FromModel(model.get());
    ContactFinder finder(scene.tables());
    const double distance = DistanceAt(finder, drawn.q);
    if (std::abs(distance) < 1e-4) continue;
    (distance < 0 ? overlaps : free) += 1;
    missed += distance < 0 && data->ncon == 0;
    invented += distance > 0 && data->ncon > 0;
  }
  EXPECT_GT(overlaps, 80);
  EXPECT_GT(free, 80);
  EXPECT_EQ(missed, 0);
  EXPECT_EQ(invented, 0);
}

// ---- Closed forms ----

TEST_F(TerrainContactsTest, ATiltedPlaneGivesTheDistanceOfAPlane) {
  const double slope = 0.3;
  const Field field = MakeField(9, 9, 2, 2, [&](double x, double) { return slope * x; });
  const Vector3d n = Vector3d(-slope, 0, 1).normalized();
  for (const int type : {mjGEOM_SPHERE, mjGEOM_CAPSULE, mjGEOM_BOX}) {
    const Shape shape{type, {0.1, 0.15, 0.05}};
    const Scene scene = Scene::FromString(FieldXml(field, shape));
    ContactFinder finder(scene.tables());
    for (int trial = 0; trial < 40; ++trial) {
      const Quaterniond turn = rng_.UnitQuat();
      const VectorXd q =
          PoseOf({rng_.Uniform(-1, 1), rng_.Uniform(-1, 1), rng_.Uniform(0.4, 1.1)}, turn);
      const Vector3d n_G = turn.conjugate() * n;
      double reach = 0.1;
      if (type == mjGEOM_CAPSULE) reach += 0.15 * std::abs(n_G.z());
      if (type == mjGEOM_BOX) reach = n_G.cwiseAbs().dot(shape.size);
      const double expected = n.dot(Vector3d(q.head<3>()) - Vector3d(0, 0, 2 * slope)) - reach;
      EXPECT_NEAR(DistanceAt(finder, q), expected, 1e-7) << Join(q);
    }
  }
}

// Steps of 0.2 m that rise by 0.1 m along x, over one cell's width of 0.01 m.
Field Stairs() {
  return MakeField(3, 101, 0.5, 0.5,
                   [](double x, double) { return 0.1 * std::floor((x + 0.5 + 1e-9) / 0.2); });
}

TEST_F(TerrainContactsTest, ABoxOnAStepGoesTheShortWayUpOrBack) {
  const Scene scene = Scene::FromString(FieldXml(Stairs(), {mjGEOM_BOX, {0.05, 0.1, 0.05}}));
  ContactFinder finder(scene.tables());
  // The riser from 0.1 to 0.2 m begins at x = -0.11 and ends at -0.1.
  const auto at = [&](double into_riser, double z) {
    return DistanceAt(finder, PoseOf({-0.11 - 0.05 + into_riser, 0, z + 0.05}));
  };
  const auto before_riser = [](double into_riser, double z) {
    return (0.1 * (z - 0.1) - into_riser) / std::hypot(1.0, 0.1);
  };
  EXPECT_NEAR(at(-0.02, 0.13), before_riser(-0.02, 0.13), 1e-7);
  EXPECT_NEAR(at(-0.03, 0.12), 0.02, 1e-7) << "above the step";
  EXPECT_NEAR(at(-0.03, 0.09), -0.01, 1e-7) << "in the step";
  EXPECT_NEAR(at(0.08, 0.19), -0.01, 1e-7) << "in the next step: up";
  EXPECT_NEAR(at(0.02, 0.12), before_riser(0.02, 0.12), 1e-7) << "in the riser: back";
}

TEST_F(TerrainContactsTest, ASphereInAValleyRestsOnBothSides) {
  const Field field = MakeField(5, 5, 1, 1, [](double x, double) { return std::abs(x); });
  const Scene scene = Scene::FromString(FieldXml(field, {mjGEOM_SPHERE, {0.1, 0, 0}}));
  ContactFinder finder(scene.tables());
  const double touching = 0.1 * std::sqrt(2.0);
  EXPECT_NEAR(DistanceAt(finder, PoseOf({0, 0.1, touching + 0.01})), 0.01 / std::sqrt(2.0), 1e-9);
  // Each side tells 0.01 / √2, but the way out is straight up.
  EXPECT_NEAR(DistanceAt(finder, PoseOf({0, 0.1, touching - 0.01})), -0.01, 1e-8);
  finder.Pose(PoseOf({0, 0.1, touching - 0.01}));
  const std::vector<NearPair>& rows = finder.Find(0.0);
  ASSERT_GE(rows.size(), 2u);
  double left = 0, right = 0;
  for (const NearPair& row : rows) {
    EXPECT_EQ(row.kind, PairKind::kTerrain);
    EXPECT_NEAR(row.distance, -0.01 / std::sqrt(2.0), 1e-8);
    (row.n_W.x() > 0 ? left : right) = row.n_W.x();
  }
  EXPECT_NEAR(left, std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(right, -std::sqrt(0.5), 1e-6);
}

// The diagonal of a cell is the floor of a valley: with a row of only the nearer wall, descents go
// from one wall to the other and back.
TEST_F(TerrainContactsTest, ASphereInAValleyInsideOneCellHasARowOfBothWalls) {
  const Field field = MakeField(2, 2, 1, 1, [](double x, double y) { return x * y < 0; });
  const Scene scene = Scene::FromString(FieldXml(field, {mjGEOM_SPHERE, {0.1, 0, 0}}));
  ContactFinder finder(scene.tables());
  const double slant = std::sqrt(1.5);  // of the walls' normals, (∓½, ±½, 1)
  for (const double gap : {0.005, -0.005}) {
    finder.Pose(PoseOf({0.001, 0, (0.1 + gap) * slant}));
    double left = 0, right = 0;
    for (const NearPair& near : finder.Find(0.02)) {
      EXPECT_NEAR(near.distance, gap, 1e-3);
      (near.n_W.x() < 0 ? right : left) = near.n_W.x();
    }
    EXPECT_NEAR(left, 0.5 / slant, 1e-6) << gap;
    EXPECT_NEAR(right, -0.5 / slant, 1e-6) << gap;
  }
}

// ---- Degenerate places ----

TEST_F(TerrainContactsTest, EdgesCornersAndTheBaseAreThoseOfASolid) {
  const Field field = MakeField(3, 3, 1, 0.5, [](double x, double) { return x == 0 ? 0.2 : 0.0; });
  const Scene scene = Scene::FromString(FieldXml(field, {mjGEOM_SPHERE, {0.05, 0, 0}}));
  ContactFinder finder(scene.tables());
  const auto at = [&](double x, double y, double z) {
    return DistanceAt(finder, PoseOf({x, y, z}));
  };
  EXPECT_NEAR(at(1.2, 0, -0.05), 0.15, 1e-9) << "beside it";
  EXPECT_NEAR(at(1.3, 0.9, -0.05), 0.45, 1e-9) << "off a corner";
  EXPECT_NEAR(at(1.03, 0, -0.05), -0.02, 1e-9) << "in its side";
  EXPECT_NEAR(at(0.99, 0, -0.05), -0.06, 1e-9) << "through its side";
  EXPECT_NEAR(at(0, 0, -0.25), 0.1, 1e-9) << "below its base";
  EXPECT_NEAR(at(0, 0, -0.13), -0.02, 1e-9) << "in its base: down";
  EXPECT_NEAR(at(0, 0, 0.3), 0.05, 1e-9) << "above the ridge";
  EXPECT_NEAR(at(0, 0, 0.25), 0.0, 1e-9) << "on the ridge";
  EXPECT_NEAR(at(0, 0.5, 0.25), 0.0, 1e-9) << "on the ridge's end";
}

TEST_F(TerrainContactsTest, AGeomLargerThanTheFieldIsMeasuredToo) {
  const Field field = MakeField(4, 4, 0.1, 0.1, [](double x, double y) { return x + y; });
  for (const int type : {mjGEOM_BOX, mjGEOM_ELLIPSOID}) {
    const Scene scene = Scene::FromString(FieldXml(field, {type, {3, 3, 1}}));
    ContactFinder finder(scene.tables());
    const double top = 0.4, over = DistanceAt(finder, PoseOf({0, 0, top + 1.2}), 2.0);
    EXPECT_NEAR(over, 0.2, 2e-3);
    EXPECT_NEAR(DistanceAt(finder, PoseOf({0, 0, top + 0.9})), -0.1, 2e-3);
    EXPECT_LT(DistanceAt(finder, PoseOf({0, 0, 0.2})), -0.9);
  }
}

TEST_F(TerrainContactsTest, AFieldOfOneCellAndAFlatOneWork) {
  const Field cell = MakeField(2, 2, 1, 1, [](double x, double y) { return x > 0 && y > 0; });
  const Scene one = Scene::FromString(FieldXml(cell, {mjGEOM_SPHERE, {0.1, 0, 0}}));
  ContactFinder finder(one.tables());
  EXPECT_NEAR(DistanceAt(finder, PoseOf({1, 1, 1.5})), 0.4, 1e-9);
  // Both triangles rise from 0 at the far corners to 1: the diagonal is a ridge.
  EXPECT_NEAR(DistanceAt(finder, PoseOf({0, 0, 0.5})), -0.1, 1e-9);
  EXPECT_NEAR(DistanceAt(finder, PoseOf({0.4, -0.4, 0.3})), -0.1, 1e-9);
  Field flat = cell;  // MuJoCo takes equal heights for 0
  flat.heights = {0, 0, 0, 1e-9};
  const Scene still = Scene::FromString(FieldXml(flat, {mjGEOM_BOX, {0.1, 0.1, 0.1}}));
  ContactFinder other(still.tables());
  EXPECT_NEAR(DistanceAt(other, PoseOf({0, 0, 0.15})), 0.05, 1e-8);
  EXPECT_NEAR(DistanceAt(other, PoseOf({0, 0, 0.05})), -0.05, 1e-8);
}

// ---- Rows ----

// A feature's row must tell how its distance changes: along n, and not across.
TEST_F(TerrainContactsTest, NormalsAreTheGradientsOfDistance) {
  int checked = 0;
  for (int trial = 0; trial < 80; ++trial) {
    const RandomPose drawn = Draw(kShapes[trial % kShapes.size()], rng_);
    const Scene scene = Scene::FromString(FieldXml(drawn.field, drawn.shape));
    ContactFinder finder(scene.tables());
    finder.Pose(drawn.q);
    NearPair near;
    if (!finder.Distance(0, 0.3, near) || near.distance < 1e-3) continue;
    Vector3d gradient;
    const double h = 1e-6;
    for (int axis = 0; axis < 3; ++axis) {
      VectorXd more = drawn.q, less = drawn.q;
      more[axis] += h;
      less[axis] -= h;
      gradient[axis] = (DistanceAt(finder, more) - DistanceAt(finder, less)) / (2 * h);
    }
    if (gradient.norm() < 0.99) continue;  // between two features
    ++checked;
    EXPECT_NEAR((gradient - near.n_W).norm(), 0.0, 2e-2) << Join(drawn.q);
  }
  EXPECT_GT(checked, 20);
}

TEST_F(TerrainContactsTest, ALongGeomOverTwoHillsHasAFeatureOnEach) {
  const Field field =
      MakeField(3, 41, 1, 0.2, [](double x, double) { return 0.1 * (1 - std::cos(2 * M_PI * x)); });
  const Scene scene = Scene::FromString(FieldXml(field, {mjGEOM_BOX, {0.7, 0.05, 0.05}}));
  ContactFinder finder(scene.tables());
  for (const double z : {0.26, 0.24}) {  // the hills' tops are at x = ±0.5
    finder.Pose(PoseOf({0, 0, z}));
    double left = 0, right = 0;
    for (const NearPair& near : finder.Find(0.05)) {
      EXPECT_NEAR(near.n_W.z(), 1.0, 1e-3);
      (near.p1_W.x() < 0 ? left : right) = near.p1_W.x();
    }
    EXPECT_NEAR(left, -0.5, 0.06) << z;
    EXPECT_NEAR(right, 0.5, 0.06) << z;
  }
}

}  // namespace
}  // namespace mjcf_pdg::test
