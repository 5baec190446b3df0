// What the units of collide/terrain promise, by all prisms of a field and all corners of a prism.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>
#include <vector>

#include "collide/contacts.h"
#include "collide/terrain/highest_blocks.h"
#include "collide/terrain/on_terrain.h"
#include "collide/terrain/way_out.h"
#include "tests/support/brute_distance.h"
#include "tests/support/terrain.h"

namespace mjcf_pdg::test {
namespace {

class TerrainUnitsContractTest : public MujocoTest {};

std::array<Vector3d, 6> CornersOf(const Prism& prism) {
  std::array<Vector3d, 6> corners;
  for (int k = 0; k < 3; ++k) {
    corners[k] = corners[k + 3] = prism.top[k];
    corners[k + 3].z() = prism.base;
  }
  return corners;
}

TEST_F(TerrainUnitsContractTest, NoCornerOfAPrismIsFartherThanItsSupport) {
  Random rng(1);
  for (int trial = 0; trial < 500; ++trial) {
    Prism prism;
    for (Vector3d& corner : prism.top) corner = rng.InBox(1.0) + Vector3d(0, 0, 2.0);
    prism.base = rng.Uniform(-1.0, 0.9);
    if (prism.Cross().z() < 0.0) std::swap(prism.top[0], prism.top[1]);
    const Vector3d n = rng.Uniform(0.1, 3.0) * rng.UnitVector();
    double farthest = -std::numeric_limits<double>::infinity(), off = -farthest;
    for (const Vector3d& p : CornersOf(prism)) {
      farthest = std::max(farthest, n.dot(p));
      off = std::min(off, (p - prism.Support(n)).norm());
    }
    EXPECT_EQ(off, 0.0) << "a corner";
    EXPECT_NEAR(n.dot(prism.Support(n)), farthest, 1e-12);
    EXPECT_NEAR(prism.Farthest(n), farthest, 1e-12);
    EXPECT_NEAR(prism.Normal().norm(), 1.0, 1e-12);
    EXPECT_GT(prism.Normal().z(), 0.0);
    for (const Vector3d& p : prism.top)
      EXPECT_NEAR(prism.Cross().dot(p - prism.top[0]), 0.0, 1e-12);
  }
}

// A random geom at a random pose over a tilted field, and the field's prisms as convex meshes.
struct Placed {
  Placed(int type, Random& rng)
      : field(NoisyField(7, 6, 0.5, 0.4, 0.25, rng)),
        shape(RandomShape(type, rng)),
        turn(rng.UnitQuat()) {
    const double quat[] = {turn.w(), turn.x(), turn.y(), turn.z()};
    field.pose = "pos='.3 .2 .1' quat='" + Join(quat, 4) + "'";
    scene = std::make_unique<Scene>(Scene::FromString(FieldXml(field, shape)));
    posed = std::make_unique<PosedModel>(&scene->tables().query_model);
    const Vector3d p =
        turn * Vector3d(rng.Uniform(-0.6, 0.6), rng.Uniform(-0.5, 0.5), rng.Uniform(-0.1, 0.6));
    const Eigen::Quaterniond own = rng.UnitQuat();
    q.resize(7);
    q << p + Vector3d(.3, .2, .1), own.w(), own.x(), own.y(), own.z();
    posed->Pose(q);
    on = std::make_unique<OnTerrain>(scene->tables(), *posed, scene->tables().pairs.at(0));
  }
  std::vector<NearPrism> Near(double reach, const Vector3d& shift) const {
    std::vector<NearPrism> near;
    on->CollectPrisms(on->CellsNear(shift, reach), shift, reach, near);
    return near;
  }
  // Of all prisms, with their bounds.
  std::vector<NearPrism> All() const { return Near(100.0, Vector3d::Zero()); }

  Field field;
  Shape shape;
  Eigen::Quaterniond turn;
  std::unique_ptr<Scene> scene;
  std::unique_ptr<PosedModel> posed;
  std::unique_ptr<OnTerrain> on;
  VectorXd q;
};

const std::vector<int> kTypes = {mjGEOM_SPHERE,   mjGEOM_CAPSULE, mjGEOM_ELLIPSOID,
                                 mjGEOM_CYLINDER, mjGEOM_BOX,     mjGEOM_MESH};

// The prism's distance from the core moved by `shift`, to about a nanometre; 0 if they overlap.
double DistanceOf(const OnTerrain& on, const Prism& prism, const Vector3d& shift) {
  GjkNearest found;
  const GjkAccuracy accuracy{.gap = 1e-9, .last = 1e-3};
  return on.Ask(prism, shift, 100.0, accuracy, found) == GjkEnding::kApart ? found.distance : 0.0;
}

TEST_F(TerrainUnitsContractTest, NoPrismWithinReachIsLeftOutAndBoundsHold) {
  Random rng(2);
  int left_out = 0, kept = 0, tight = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const Placed placed(kTypes[trial % 6], rng);
    const std::vector<NearPrism> all = placed.All();
    ASSERT_EQ(all.size(), 2u * 6 * 5);
    const double reach = rng.Uniform(0.0, 0.3);
    const Vector3d shift = rng.InBox(0.2);
    const std::vector<NearPrism> near = placed.Near(reach, shift);
    for (const NearPrism& one : all) {
      const double distance = DistanceOf(*placed.on, one.prism, shift);
      const auto same = [&one](const NearPrism& other) {
        return other.row == one.row && other.col == one.col && other.prism.top == one.prism.top;
      };
      const auto found = std::find_if(near.begin(), near.end(), same);
      if (found == near.end()) {
        ++left_out;
        EXPECT_GT(distance, reach - 1e-6) << trial % 6;
        continue;
      }
      ++kept;
      EXPECT_LE(found->at_least, distance + 1e-6) << trial % 6;
      tight += distance > 0.02 && found->at_least > 0.7 * distance;
    }
  }
  EXPECT_GT(left_out, 200);
  EXPECT_GT(kept, 200);
  EXPECT_GT(tight, 200);
}

TEST_F(TerrainUnitsContractTest, AnswersAreThePlanesAndPointsThatTheyClaim) {
  Random rng(3);
  int apart = 0, beyond = 0, overlapping = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const Placed placed(kTypes[trial % 6], rng);
    const OnTerrain& on = *placed.on;
    const Vector3d shift = rng.InBox(0.2);
    for (const NearPrism& one : placed.All()) {
      GjkNearest found;
      const double cutoff = rng.Uniform(0.05, 0.5);
      const GjkEnding ending = on.Ask(one.prism, shift, cutoff, {.gap = 1e-9, .last = 1e-3}, found);
      const double distance = DistanceOf(on, one.prism, shift);
      EXPECT_EQ(on.CoreOverlaps(one.prism, shift), distance < 1e-6);
      if (std::abs(distance - on.radius()) > 1e-6) {
        EXPECT_EQ(on.Overlap(one.prism, shift), distance < std::max(on.radius(), 1e-6));
      }
      if (ending == GjkEnding::kEnclosed || ending == GjkEnding::kTouching) {
        ++overlapping;
        continue;
      }
      const double by_plane =
          found.n.dot(on.Support(-found.n) + shift) - one.prism.Farthest(found.n);
      EXPECT_NEAR(found.n.norm(), 1.0, 1e-12);
      if (ending == GjkEnding::kBeyond) {
        ++beyond;
        EXPECT_GE(by_plane, cutoff - 1e-9);
        continue;
      }
      ASSERT_EQ(ending, GjkEnding::kApart);
      ++apart;
      EXPECT_NEAR(by_plane, found.distance, 1e-8);
      EXPECT_NEAR(found.n.dot(found.corner.p2 - found.corner.p1), found.distance, 1e-8);
      EXPECT_NEAR((found.corner.p2 - found.corner.p1).norm(), found.distance, 1e-8);
      EXPECT_LE(found.n.dot(found.corner.p1), one.prism.Farthest(found.n) + 1e-9);
    }
  }
  EXPECT_GT(apart, 200);
  EXPECT_GT(beyond, 200);
  EXPECT_GT(overlapping, 100);
}

TEST_F(TerrainUnitsContractTest, AWayOutLeadsOutOfAllPrismsAndABoundOutOfOne) {
  Random rng(4);
  int overlapping = 0, bounded = 0;
  WayOut way_out;
  for (int trial = 0; trial < 500; ++trial) {
    const Placed placed(kTypes[trial % 6], rng);
    const OnTerrain& on = *placed.on;
    std::vector<NearPrism> near = placed.Near(on.radius(), Vector3d::Zero());
    const std::vector<NearPrism> all = placed.All();
    const auto free = [&](const Vector3d& shift) {
      return std::none_of(all.begin(), all.end(), [&](const NearPrism& one) {
        return DistanceOf(on, one.prism, shift) < on.radius() - 1e-7;
      });
    };
    if (free(Vector3d::Zero())) continue;
    ++overlapping;
    const Way way = way_out.Find(on, WayOut::Effort::kShortest, near);
    EXPECT_NEAR(way.u.norm(), 1.0, 1e-12);
    EXPECT_NEAR(way.n.norm(), 1.0, 1e-12);
    EXPECT_TRUE(free((way.length + 1e-5) * way.u)) << trial;
    EXPECT_FALSE(free((0.99 * way.length - 1e-5) * way.u)) << trial;
    near = placed.Near(on.radius(), Vector3d::Zero());
    const Way rough = way_out.Find(on, WayOut::Effort::kRough, near);
    EXPECT_GE(rough.length, 0.99 * way.length - 1e-5);
    EXPECT_TRUE(free((rough.length + 2e-4) * rough.u)) << trial;
    const NearPrism& one = all[rng.Index(static_cast<int>(all.size()))];
    const Vector3d u = rng.UnitVector();
    const double exit = on.ExitBound(one.prism, on.PlanesOf(u));
    if (!(exit > 0.0) || !std::isfinite(exit)) continue;
    ++bounded;
    EXPECT_GE(DistanceOf(on, one.prism, (exit + 1e-6) * u), on.radius() - 1e-6);
  }
  EXPECT_GT(overlapping, 80);
  EXPECT_GT(bounded, 20);
}

TEST_F(TerrainUnitsContractTest, ABoxOverlapsAPrismBetweenTheEndsOfAStretch) {
  Random rng(8);
  int inside = 0, never = 0;
  for (int trial = 0; trial < 100; ++trial) {
    const Placed placed(mjGEOM_BOX, rng);
    const OnTerrain& on = *placed.on;
    for (const NearPrism& one : placed.All()) {
      const Vector3d u = rng.UnitVector();
      OnTerrain::Stretch overlap;
      ASSERT_TRUE(on.OverlapOfBox(one.prism, u, overlap));
      EXPECT_NEAR(overlap.n.norm(), 1.0, 1e-12);
      const auto apart = [&](double t) { return DistanceOf(on, one.prism, t * u) > 0.0; };
      if (!(overlap.begin < overlap.end)) {
        ++never;
        EXPECT_TRUE(apart(rng.Uniform(-1.0, 1.0)));
        continue;
      }
      const double t = rng.Uniform(overlap.begin, overlap.end);
      const bool at_base = on.core_box().min().z() + t * u.z() < one.prism.base;
      if (!at_base && std::min(t - overlap.begin, overlap.end - t) > 1e-5) {
        ++inside;
        EXPECT_FALSE(apart(t)) << trial;
      }
      // Asked for one place only, it tells the same of a place inside, and of others that they are
      // not inside.
      OnTerrain::Stretch there;
      const double outside = overlap.end + rng.Uniform(0.0, 1.0);
      ASSERT_TRUE(on.OverlapOfBox(one.prism, u, there, outside));
      EXPECT_FALSE(there.begin < outside && outside < there.end);
      ASSERT_TRUE(on.OverlapOfBox(one.prism, u, there, t));
      EXPECT_EQ(there.begin, overlap.begin);
      EXPECT_EQ(there.end, overlap.end);
      // At each end a plane parts them, from there on by as much as the way goes along its normal.
      OnTerrain::Stretch back;
      ASSERT_TRUE(on.OverlapOfBox(one.prism, -u, back));
      EXPECT_NEAR(back.end, -overlap.begin, 1e-9);
      for (const auto& [end, n, way] :
           {std::tuple(overlap.end, overlap.n, u), std::tuple(back.end, back.n, Vector3d(-u))}) {
        ASSERT_GT(n.dot(way), 0.0);
        EXPECT_NEAR(n.dot(on.Support(-n) + end * way), one.prism.Farthest(n), 1e-9);
        EXPECT_GT(DistanceOf(on, one.prism, (end + 1e-5 / n.dot(way)) * way), 0.9e-5) << trial;
      }
    }
  }
  EXPECT_GT(inside, 200);
  EXPECT_GT(never, 200);
  const Placed ball(mjGEOM_SPHERE, rng);
  OnTerrain::Stretch overlap;
  EXPECT_FALSE(ball.on->OverlapOfBox(ball.All()[0].prism, Vector3d::UnitZ(), overlap));
}

TEST_F(TerrainUnitsContractTest, FramesAreThoseOfTheFieldAndTheGeom) {
  Random rng(5);
  for (int trial = 0; trial < 30; ++trial) {
    const Placed placed(kTypes[trial % 6], rng);
    const mjModel& m = *placed.scene->model();
    const mjData& d = *placed.posed->data();
    const int field = mj_name2id(&m, mjOBJ_GEOM, "field"),
              geom = mj_name2id(&m, mjOBJ_GEOM, "geom");
    const Matrix3d R = AsMatrix(d.geom_xmat + 9 * field);
    const Vector3d p = rng.InBox(1.0);
    EXPECT_LT((placed.on->ToWorld(p) - AsVector(d.geom_xpos + 3 * geom) - R * p).norm(), 1e-12);
    EXPECT_LT((placed.on->DirectionToWorld(p) - R * p).norm(), 1e-12);
    const NearPrism one = placed.All()[2 * (3 * 5 + 2)];
    EXPECT_EQ(one.row, 3);
    EXPECT_EQ(one.col, 2);
    const Prism in_field = placed.on->InField(one.prism);
    EXPECT_NEAR(in_field.base, -placed.field.base, 1e-6);
    for (const Vector3d& corner : in_field.top) {
      double off = std::numeric_limits<double>::infinity();
      for (int k = 0; k < 4; ++k) {
        off = std::min(off, (corner - placed.field.Corner(3 + k / 2, 2 + k % 2)).norm());
      }
      EXPECT_LT(off, 1e-6);
    }
    for (int k = 0; k < 50; ++k) {
      const Vector3d n = rng.UnitVector();
      const Vector3d farthest = placed.on->Support(n);
      const double from_origin =
          Support(&m, &d, geom, R * n) - (R * n).dot(AsVector(d.geom_xpos + 3 * geom));
      EXPECT_NEAR(n.dot(farthest) + placed.on->radius(), from_origin, 1e-9);
      EXPECT_TRUE((farthest.array() >= placed.on->core_box().min().array() - 1e-6).all());
      EXPECT_TRUE((farthest.array() <= placed.on->core_box().max().array() + 1e-6).all());
    }
  }
}

// Above everything a geom has no features, however near the margin comes to it, and below the
// margin it has them.
TEST_F(TerrainUnitsContractTest, FeaturesBeginAtTheDistance) {
  Random rng(7);
  int apart = 0;
  for (int trial = 0; trial < 240; ++trial) {
    const Placed placed(kTypes[trial % 6], rng);
    ContactFinder finder(placed.scene->tables());
    finder.Pose(placed.q);
    NearPair nearest, other;
    ASSERT_TRUE(finder.Distance(0, 10.0, nearest));
    if (nearest.distance < 0.02) continue;
    ++apart;
    std::vector<NearPair> features;
    finder.AppendFeatures(0, nearest.distance - 1e-4, Depths::kMeasured, features);
    EXPECT_TRUE(features.empty());
    EXPECT_FALSE(finder.Distance(0, nearest.distance - 1e-4, other));
    finder.AppendFeatures(0, nearest.distance + 1e-4, Depths::kMeasured, features);
    ASSERT_FALSE(features.empty());
    EXPECT_NEAR(features.front().distance, nearest.distance, 1e-5);
    EXPECT_TRUE(finder.Distance(0, nearest.distance + 1e-4, other));
  }
  EXPECT_GT(apart, 50);
}

TEST_F(TerrainUnitsContractTest, BlocksAreAsHighAsTheCellsBelowARectangleAndHardlyHigher) {
  Random rng(8);
  int none = 0, tight = 0;
  for (int trial = 0; trial < 400; ++trial) {
    Field field = NoisyField(2 + rng.Index(14), 2 + rng.Index(14), 0.5, 0.4, 0.25, rng);
    const ModelPtr model =
        LoadModel(FieldXml(field, {.size = Vector3d::Constant(0.1), .attributes = "mass='1'"}));
    const int geom = mj_name2id(model.get(), mjOBJ_GEOM, "field");
    const HeightField read(*model, geom);
    const HighestBlocks blocks(*model, geom);
    const Eigen::Vector2d middle(rng.Uniform(-0.8, 0.8), rng.Uniform(-0.7, 0.7));
    const Eigen::Vector2d half(rng.Uniform(0.0, 0.4), rng.Uniform(0.0, 0.4));
    const Eigen::AlignedBox2d xy(middle - half, middle + half);
    const double highest = blocks.Above(xy);
    const CellRange cells = read.CellsUnder(xy);
    if (cells.empty()) {  // the last blocks reach beyond the edge
      none += std::isinf(highest);
      continue;
    }
    EXPECT_GE(highest, read.Highest(cells));
    constexpr int kBeyond = 4;  // cells
    const CellRange around{
        std::max(cells.row_begin - kBeyond, 0), std::min(cells.row_end + kBeyond, field.rows - 1),
        std::max(cells.col_begin - kBeyond, 0), std::min(cells.col_end + kBeyond, field.cols - 1)};
    EXPECT_LE(highest, read.Highest(around));
    tight += highest < read.Highest({0, field.rows - 1, 0, field.cols - 1});
  }
  EXPECT_GT(none, 20);
  EXPECT_GT(tight, 20);
}

}  // namespace
}  // namespace mjcf_pdg::test
