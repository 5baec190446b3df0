// What the verifier's convex units promise, each by its definition: support points by looking at
// all vertices, minimum-norm points by their planes, penetration depths by many directions.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "tests/support/test_support.h"
#include "verify/convex/certificate.h"
#include "verify/convex/direction_search.h"
#include "verify/convex/minimum_norm.h"

namespace mjcf_pdg::verify {
namespace {

using test::Random;

ConvexShape Hull(int count, const Vector3d& widths, Random& rng) {
  std::vector<Vector3d> vertices;
  for (int k = 0; k < count; ++k) vertices.push_back(widths.cwiseProduct(rng.InBox(1.0)));
  ConvexShape shape;
  shape.type = mjGEOM_MESH;
  shape.extent = widths.norm();
  shape.vertices = std::make_shared<const VertexTree>(vertices);
  return shape;
}

Matrix3d RandomTurn(Random& rng) {
  return Eigen::AngleAxisd(rng.Uniform(0.0, M_PI), rng.UnitVector()).toRotationMatrix();
}

// Two hulls whose origins are `apart` from each other.
struct Hulls {
  ConvexShape first, second;
  ConvexPair pair;

  Hulls(double apart, Random& rng)
      : first(Hull(4 + rng.Index(30), {1.0, 0.5, 0.3}, rng)),
        second(Hull(4 + rng.Index(30), {0.6, 0.8, 0.4}, rng)),
        pair{first, second, RandomTurn(rng), apart * rng.UnitVector()} {}
  Hulls(const Hulls&) = delete;

  // n · p of the difference's point that has least of it.
  double Gap(const Vector3d& n) const {
    double farthest = -std::numeric_limits<double>::infinity(), nearest = -farthest;
    for (const Vector3d& v : first.vertices->vertices()) farthest = std::max(farthest, n.dot(v));
    for (const Vector3d& v : second.vertices->vertices()) {
      nearest = std::min(nearest, n.dot(pair.between + pair.turn * v));
    }
    return nearest - farthest;
  }
};

TEST(VertexTreeTest, TheSupportIsTheFarthestOfAllVertices) {
  Random rng(1);
  for (const int count : {1, 2, 7, 8, 9, 50, 400}) {
    const ConvexShape shape = Hull(count, {1.0, 0.1, 2.0}, rng);
    for (int trial = 0; trial < 50; ++trial) {
      const Vector3d n = rng.UnitVector();
      double farthest = -std::numeric_limits<double>::infinity();
      for (const Vector3d& v : shape.vertices->vertices()) farthest = std::max(farthest, n.dot(v));
      EXPECT_EQ(n.dot(shape.Support(n)), farthest);
    }
  }
}

TEST(MinimumNormTest, PointAndPlaneMeetWhereTheHullsAreApart) {
  Random rng(2);
  int apart = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const Hulls hulls(rng.Uniform(0.2, 2.0), rng);
    const Vector3d shift = trial % 2 ? Vector3d(0.3 * rng.UnitVector()) : Vector3d::Zero();
    const MinimumNorm found =
        FindMinimumNorm(hulls.pair, {.shift = shift, .start = rng.UnitVector()});
    double sum = 0.0;
    for (int k = 0; k < found.count; ++k) {
      EXPECT_GE(found.weight[k], 0.0);
      sum += found.weight[k];
      EXPECT_LT((found.corral[k].b - found.corral[k].a - found.corral[k].p).norm(), 1e-14);
    }
    EXPECT_NEAR(sum, 1.0, 1e-12);
    EXPECT_LT((found.b() - found.a() + shift - found.x).norm(), 1e-12);
    EXPECT_NEAR(found.n.norm(), 1.0, 1e-12);
    EXPECT_LE(found.lower, hulls.Gap(found.n) + found.n.dot(shift) + 1e-12);
    if (found.holds_origin) continue;
    if (found.upper() < 1e-9) continue;  // they touch
    ++apart;
    EXPECT_NEAR(found.lower, found.upper(), 1e-7);
  }
  EXPECT_GT(apart, 100);
}

TEST(MinimumNormTest, TheBallInACorralTouchesItsNearestFacet) {
  Random rng(3);
  int held = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Hulls hulls(rng.Uniform(0.0, 0.3), rng);
    const MinimumNorm found = FindMinimumNorm(hulls.pair, {.start = rng.UnitVector()});
    Vector3d n = Vector3d::Zero();
    const double radius = BallInCorral(found, n);
    if (!found.holds_origin) {
      EXPECT_EQ(radius, 0.0);
      continue;
    }
    ++held;
    // Along n the corral ends at the ball; along no direction before it.
    double nearest = std::numeric_limits<double>::infinity();
    for (const DifferencePoint& point : found.corral) nearest = std::min(nearest, n.dot(point.p));
    EXPECT_NEAR(nearest, -radius, 1e-12);
    for (int k = 0; k < 200; ++k) {
      const Vector3d d = rng.UnitVector();
      double end = std::numeric_limits<double>::infinity();
      for (const DifferencePoint& point : found.corral) end = std::min(end, d.dot(point.p));
      EXPECT_LE(end, -radius + 1e-12);
    }
  }
  EXPECT_GT(held, 50);
}

// The greatest gap of many directions, each of the best improved by ever smaller random changes.
double GreatestGap(const Hulls& hulls, Random& rng) {
  double greatest = -std::numeric_limits<double>::infinity();
  for (int start = 0; start < 40; ++start) {
    Vector3d n = rng.UnitVector();
    double gap = hulls.Gap(n);
    for (double spread = 0.5; spread > 1e-6; spread *= 0.85) {
      for (int k = 0; k < 4; ++k) {
        const Vector3d other = (n + spread * rng.UnitVector()).normalized();
        if (hulls.Gap(other) <= gap) continue;
        gap = hulls.Gap(other);
        n = other;
      }
    }
    greatest = std::max(greatest, gap);
  }
  return greatest;
}

TEST(DirectionSearchTest, NoDirectionPartsOverlapsByLess) {
  Random rng(4);
  int overlaps = 0, climbed = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const Hulls hulls(rng.Uniform(0.0, 0.6), rng);
    const double greatest = GreatestGap(hulls, rng);
    if (greatest >= -1e-3) continue;
    ++overlaps;
    const Vector3d begin = rng.UnitVector();
    const CoreGap local = Climb(hulls.pair, begin, kRoundingOfSize);
    EXPECT_GE(local.gap, hulls.Gap(begin) - 1e-12);
    EXPECT_NEAR(local.gap, hulls.Gap(local.n), 1e-12);
    climbed += local.gap > hulls.Gap(begin) + 1e-6;
    DirectionSearch search(hulls.pair, local, {});
    EXPECT_FALSE(search.AllBelow(1.01 * greatest)) << "the gap of some direction is greater";
    DirectionSearch bounding(hulls.pair, local, {});
    EXPECT_TRUE(bounding.AllBelow(0.9 * greatest)) << "no gap is so great";
    EXPECT_TRUE(search.Maximize(1e-4));
    const CoreGap& best = search.best();
    EXPECT_NEAR(best.gap, hulls.Gap(best.n), 1e-12);
    EXPECT_GE(best.gap, greatest - 2e-4 * -greatest);
    EXPECT_LE(best.gap, 0.0);
    // a and b are points of their shapes that touch last.
    EXPECT_NEAR(best.n.dot(best.b - best.a), best.gap, 1e-7);
    EXPECT_LT((best.b - best.gap * best.n - best.a).norm(), 1e-6);
  }
  EXPECT_GT(overlaps, 30);
  EXPECT_GT(climbed, 25);
}

}  // namespace
}  // namespace mjcf_pdg::verify
