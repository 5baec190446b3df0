// What the verifier asks of single triangles, against every direction that there is.
#include "verify/exact/triangles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "tests/support/test_support.h"

namespace mjcf_pdg::verify {
namespace {

using test::Random;
using Triangle = std::array<Vector3d, 3>;

Triangle RandomTriangle(Random& rng) { return {rng.InBox(1.0), rng.InBox(1.0), rng.InBox(1.0)}; }

// How far the second triangle must go along n until all of it is beyond the first.
double MoveAlong(const Triangle& s, const Triangle& t, const Vector3d& n) {
  const auto dot = [&n](const Vector3d& p) { return n.dot(p); };
  double farthest = -std::numeric_limits<double>::infinity(), nearest = -farthest;
  for (const Vector3d& p : s) farthest = std::max(farthest, dot(p));
  for (const Vector3d& p : t) nearest = std::min(nearest, dot(p));
  return farthest - nearest;
}

// The least of many directions, each of the best improved by ever smaller random changes.
double LeastOfAllDirections(const Triangle& s, const Triangle& t, Random& rng) {
  double least = std::numeric_limits<double>::infinity();
  for (int start = 0; start < 60; ++start) {
    Vector3d n = rng.UnitVector();
    double move = MoveAlong(s, t, n);
    for (double spread = 0.5; spread > 1e-6; spread *= 0.9) {
      for (int k = 0; k < 4; ++k) {
        const Vector3d other = (n + spread * rng.UnitVector()).normalized();
        if (MoveAlong(s, t, other) >= move) continue;
        move = MoveAlong(s, t, other);
        n = other;
      }
    }
    least = std::min(least, move);
  }
  return least;
}

TEST(TrianglesTest, TheLeastMoveIsTheLeastOfAllDirections) {
  Random rng(41);
  int crossing = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const Triangle s = RandomTriangle(rng), t = RandomTriangle(rng);
    Vector3d n = Vector3d::Zero();
    const double move = LeastMove(s, t, n);
    if (move == 0.0) continue;  // apart
    ++crossing;
    EXPECT_NEAR(n.norm(), 1.0, 1e-12);
    EXPECT_NEAR(MoveAlong(s, t, n), move, 1e-12) << trial;
    EXPECT_NEAR(LeastOfAllDirections(s, t, rng), move, 1e-4) << trial;
  }
  EXPECT_GT(crossing, 60);
  EXPECT_LT(crossing, 240);
}

// Whichever edge or face decides, it does so in whatever order the corners come.
TEST(TrianglesTest, TheLeastMoveDoesNotDependOnTheOrderOfCorners) {
  Random rng(42);
  for (int trial = 0; trial < 200; ++trial) {
    const Triangle s = RandomTriangle(rng), t = RandomTriangle(rng);
    Vector3d n, back;
    const double move = LeastMove(s, t, n);
    for (int k = 0; k < 3; ++k) {
      const Triangle turned = {s[k], s[(k + 1) % 3], s[(k + 2) % 3]};
      const Triangle other = {t[(k + 2) % 3], t[(k + 1) % 3], t[k]};
      EXPECT_NEAR(LeastMove(turned, other, n), move, 1e-12) << trial;
      EXPECT_NEAR(LeastMove(other, turned, back), move, 1e-12) << trial;
    }
  }
}

TEST(TrianglesTest, TrianglesThatTouchHaveNoWayToGo) {
  const Triangle s = {Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(0, 1, 0)};
  const Triangle t = {Vector3d(0.2, 0.2, 0), Vector3d(0.2, 0.3, 1), Vector3d(0.3, 0.2, 1)};
  Vector3d n;
  EXPECT_EQ(LeastMove(s, t, n), 0.0);
}

}  // namespace
}  // namespace mjcf_pdg::verify
