// The closed forms for the top of a prism, against the general search.
#include "collide/terrain/top_nearest.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "collide/convex/gjk.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The corner that is farthest along n.
template <typename Corners>
Vector3d Farthest(const Corners& corners, const Vector3d& n) {
  return *std::max_element(
      std::begin(corners), std::end(corners),
      [&n](const Vector3d& a, const Vector3d& b) { return a.dot(n) < b.dot(n); });
}

// The distance of two hulls; negative if they meet.
template <typename A, typename B>
double Distance(const A& a, const B& b) {
  const auto support = [&](const Vector3d& n) {
    const Vector3d p1 = Farthest(a, n), p2 = Farthest(b, -n);
    return Simplex::Corner{p1 - p2, p1, p2};
  };
  Simplex simplex;
  simplex.Add(support(Vector3d::UnitZ()));
  GjkNearest found;
  const GjkAccuracy accuracy{.gap = 1e-12, .last = 1.0};
  return Gjk(support, 1e-9, kInfinity, accuracy, simplex, found) == GjkEnding::kApart
             ? found.distance
             : -1.0;
}

Triangle DrawTop(Random& rng) {
  return {Vector3d(0, 0, rng.Uniform(-0.3, 0.3)), Vector3d(1, 0, rng.Uniform(-0.3, 0.3)),
          Vector3d(1, 1, rng.Uniform(-0.3, 0.3))};
}

Vector3d DrawPoint(Random& rng) {
  return {rng.Uniform(-0.7, 1.7), rng.Uniform(-0.7, 1.7), rng.Uniform(-0.4, 1.0)};
}

TEST(TopNearestTest, ASegmentOrAPointIsAsFarAsTheSearchSays) {
  Random rng(3);
  int compared = 0, below = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const Triangle top = DrawTop(rng);
    const Vector3d a = DrawPoint(rng), b = trial % 3 == 0 ? a : DrawPoint(rng);
    NearestPoints nearest;
    if (!NearestOfSegment(top, a, b, nearest)) {
      ++below;
      continue;
    }
    const double distance = Distance(top, std::array{a, b});
    if (distance < 0.0) continue;  // the segment goes through the top
    ++compared;
    ASSERT_NEAR((nearest.p2 - nearest.p1).norm(), distance, 1e-9);
    const double of_points =
        Distance(top, std::array{nearest.p1}) + Distance(std::array{a, b}, std::array{nearest.p2});
    ASSERT_LT(of_points, 1e-9) << "the points are on the two";
  }
  EXPECT_GT(compared, 12000);
  EXPECT_GT(below, 1000);
}

// Of a box: right where the nearest of it is a corner above the top, or the nearest of the top is a
// corner; never too near.
TEST(TopNearestTest, ABoxIsNoNearerThanTheSearchSays) {
  Random rng(4);
  int faces = 0, corners = 0, edges = 0;
  for (int trial = 0; trial < 5000; ++trial) {
    const Triangle top = DrawTop(rng);
    const Vector3d center = DrawPoint(rng) + 0.3 * Vector3d::UnitZ();
    const Matrix3d axes = rng.UnitQuat().toRotationMatrix();
    const Vector3d half(rng.Uniform(0.05, 0.4), rng.Uniform(0.05, 0.4), rng.Uniform(0.05, 0.4));
    std::array<Vector3d, 8> box;
    for (int k = 0; k < 8; ++k) {
      const Vector3d sign(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1);
      box[k] = center + axes * half.cwiseProduct(sign);
    }
    const double distance = Distance(top, box);
    if (distance < 1e-6) continue;
    const Vector3d down = -(top[1] - top[0]).cross(top[2] - top[0]);
    NearestPoints nearest;
    if (NearestOfFace(top, Farthest(box, down), nearest)) {
      ASSERT_NEAR((nearest.p2 - nearest.p1).norm(), distance, 1e-9);
      ++faces;
    }
    ASSERT_TRUE(NearestOfCorner(top, center, axes, half, nearest));
    const double by_corner = (nearest.p2 - nearest.p1).norm();
    ASSERT_GT(by_corner, distance - 1e-9);
    (by_corner < distance + 1e-9 ? corners : edges) += 1;
  }
  EXPECT_GT(faces, 300);
  EXPECT_GT(corners, 700);
  EXPECT_GT(edges, 300);
}

TEST(TopNearestTest, ACornerInsideABoxHasNoNearestPoint) {
  const Triangle top = {Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(1, 1, 0)};
  NearestPoints nearest;
  EXPECT_FALSE(NearestOfCorner(top, Vector3d(1, 0, 0), Matrix3d::Identity(),
                               Vector3d::Constant(0.1), nearest));
}

}  // namespace
}  // namespace mjcf_pdg::test
