// Polygons with and without corners in the middle of a side.
#include "import/polygon.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <utility>

#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

// No crack: each side of the polygon is used once forwards, everything else in both directions.
void ExpectNoCracks(int n, const std::vector<std::array<int, 3>>& triangles) {
  EXPECT_EQ(static_cast<int>(triangles.size()), n - 2);
  std::map<std::pair<int, int>, int> uses;
  for (int i = 0; i < n; ++i) --uses[{i, (i + 1) % n}];
  for (const auto& t : triangles) {
    for (int k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      if (uses.count({b, a}) && uses[{b, a}] > 0) {
        --uses[{b, a}];
      } else {
        ++uses[{a, b}];
      }
    }
  }
  for (const auto& [edge, count] : uses) EXPECT_EQ(count, 0) << edge.first << " " << edge.second;
}

Vector3d AreaOf(const Matrix3Xd& corners, const std::array<int, 3>& t) {
  const Vector3d a = corners.col(t[0]);
  return 0.5 * (Vector3d(corners.col(t[1])) - a).cross(Vector3d(corners.col(t[2])) - a);
}

// And no overlap: areas add up without any that faces the other way.
void ExpectCutsCleanly(const Matrix3Xd& corners) {
  const auto triangles = CutPolygon(corners);
  ExpectNoCracks(static_cast<int>(corners.cols()), triangles);
  Vector3d sum = Vector3d::Zero();
  double absolute = 0.0;
  for (const auto& t : triangles) {
    sum += AreaOf(corners, t);
    absolute += AreaOf(corners, t).norm();
  }
  EXPECT_NEAR(absolute, sum.norm(), 1e-5 * absolute);
}

// In a plane of its own, rounded as in a file.
Matrix3Xd Tilted(const Matrix3Xd& corners, Random& random) {
  const Matrix3Xd turned = random.UnitQuat().toRotationMatrix() * corners;
  return turned.cast<float>().cast<double>();
}

// A star with `between` corners in the middle of each side.
Matrix3Xd Star(int points, int between, Random& random) {
  std::vector<Vector3d> tips;
  for (int i = 0; i < points; ++i) {
    const double angle = 2 * EIGEN_PI * i / points, radius = random.Uniform(0.2, 1.0);
    tips.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0.0);
  }
  Matrix3Xd corners(3, points * (between + 1));
  for (int i = 0; i < corners.cols(); ++i) {
    const Vector3d from = tips[i / (between + 1)], to = tips[(i / (between + 1) + 1) % points];
    corners.col(i) = from + (i % (between + 1)) / (between + 1.0) * (to - from);
  }
  return corners;
}

TEST(PolygonTest, AConvexQuadIsCutFromItsFirstCorner) {
  Matrix3Xd quad(3, 4);
  quad << 0, 1, 1, 0, 0, 0, 1, 1, 0, 0, 0, 0;
  const std::vector<std::array<int, 3>> expected = {{0, 1, 2}, {2, 3, 0}};
  EXPECT_EQ(CutPolygon(quad), expected);
}

TEST(PolygonTest, StarsWithCornersInTheMiddleOfSidesAreCutCleanlyInAnyPlane) {
  Random random(1);
  for (int trial = 0; trial < 200; ++trial) {
    const Matrix3Xd star = Star(3 + trial % 20, trial % 4, random);
    ExpectCutsCleanly(star);
    ExpectCutsCleanly(Tilted(star, random));
  }
}

TEST(PolygonTest, CombsWithSidesInOneLineAreCutCleanly) {
  Random random(2);
  constexpr int kTeeth = 12;
  Matrix3Xd comb(3, 4 * kTeeth + 2);
  int n = 0;
  comb.col(n++) << 2 * kTeeth, -1, 0;
  for (int i = kTeeth; i-- > 0;) {
    comb.col(n++) << 2 * i + 2, 0, 0;  // in one line, all of them
    comb.col(n++) << 2 * i + 2, 1, 0;
    comb.col(n++) << 2 * i + 1, 1, 0;
    comb.col(n++) << 2 * i + 1, 0, 0;
  }
  comb.col(n++) << 0, -1, 0;
  ExpectCutsCleanly(comb);
  for (int trial = 0; trial < 50; ++trial) ExpectCutsCleanly(Tilted(comb, random));
}

TEST(PolygonTest, AHoleOnABridgeStaysAHole) {
  Matrix3Xd ring(3, 10);
  ring << 0, 3, 3, 0, 0, 1, 1, 2, 2, 1,  //
      0, 0, 3, 3, 0, 1, 2, 2, 1, 1,      //
      0, 0, 0, 0, 0, 0, 0, 0, 0, 0;
  ExpectCutsCleanly(ring);
}

TEST(PolygonTest, WhatIsNoPolygonIsCutWithoutCracksAllTheSame) {
  Matrix3Xd line(3, 5), bow(3, 4);
  line << 0, 1, 2, 3, 1.5, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0;
  bow << 0, 1, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0;
  for (const Matrix3Xd& corners : {line, bow, Matrix3Xd(Matrix3Xd::Zero(3, 6))}) {
    ExpectNoCracks(static_cast<int>(corners.cols()), CutPolygon(corners));
  }
}

}  // namespace
}  // namespace mjcf_pdg::test
