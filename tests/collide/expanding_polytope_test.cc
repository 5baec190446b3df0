// The polytope around the origin, by its definition.
#include "collide/convex/expanding_polytope.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

using Eigen::Vector3d;

// A corner of bodies 1 and 2 that differ by x.
Simplex::Corner CornerAt(const Vector3d& x) { return {x, 2.0 * x, x}; }

Simplex TetrahedronOf(const std::vector<Vector3d>& x) {
  Simplex simplex;
  for (int k = 0; k < 4; ++k) simplex.Add(CornerAt(x[k]));
  return simplex;
}

bool HoldsTheOrigin(const std::vector<Vector3d>& x) {
  Simplex simplex = TetrahedronOf(x);
  simplex.KeepClosestSubSimplex();
  return simplex.size() == 4;
}

// The least distance from the origin of a plane through three of the points that has all of them
// on one side: of the hull's nearest face.
double NearestPlane(const std::vector<Vector3d>& x) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t a = 0; a < x.size(); ++a) {
    for (std::size_t b = a + 1; b < x.size(); ++b) {
      for (std::size_t c = b + 1; c < x.size(); ++c) {
        Vector3d n = (x[b] - x[a]).cross(x[c] - x[a]).normalized();
        if (n.dot(x[a]) < 0.0) n = -n;
        const bool face = std::all_of(x.begin(), x.end(),
                                      [&](const Vector3d& p) { return n.dot(p - x[a]) < 1e-9; });
        if (face) least = std::min(least, n.dot(x[a]));
      }
    }
  }
  return least;
}

// Points of which the first four hold the origin.
std::vector<Vector3d> PointsAround(Random& rng, int count) {
  std::vector<Vector3d> x(count);
  do {
    for (Vector3d& p : x) p = rng.InBox(1.0);
  } while (!HoldsTheOrigin(x));
  return x;
}

TEST(ExpandingPolytopeTest, ItsNearestFaceIsThatOfTheHull) {
  Random rng(5);
  for (int trial = 0; trial < 200; ++trial) {
    const std::vector<Vector3d> x = PointsAround(rng, 4 + trial % 12);
    ExpandingPolytope polytope;
    ASSERT_TRUE(polytope.Start(TetrahedronOf(x)));
    for (std::size_t k = 4; k < x.size(); ++k) ASSERT_TRUE(polytope.Add(CornerAt(x[k])));
    const ExpandingPolytope::Face face = polytope.Nearest();
    EXPECT_NEAR(face.distance, NearestPlane(x), 1e-9);
    const Simplex::Corner foot = polytope.Foot(face);
    EXPECT_NEAR((foot.x - face.distance * face.n).norm(), 0.0, 1e-9);
    EXPECT_NEAR((foot.p1 - foot.p2 - foot.x).norm(), 0.0, 1e-9);
  }
}

TEST(ExpandingPolytopeTest, PointsInsideOrOnAFaceChangeNothing) {
  Random rng(6);
  for (int trial = 0; trial < 50; ++trial) {
    const std::vector<Vector3d> x = PointsAround(rng, 8);
    ExpandingPolytope polytope;
    ASSERT_TRUE(polytope.Start(TetrahedronOf(x)));
    const double before = polytope.Nearest().distance;
    EXPECT_TRUE(polytope.Add(CornerAt(0.5 * x[0])));
    EXPECT_TRUE(polytope.Add(CornerAt((x[0] + x[1] + x[2]) / 3.0)));
    EXPECT_TRUE(polytope.Add(CornerAt(x[3])));
    EXPECT_EQ(polytope.Nearest().distance, before);
  }
}

TEST(ExpandingPolytopeTest, RefusesWhatHasNoVolume) {
  ExpandingPolytope polytope;
  EXPECT_FALSE(polytope.Start(TetrahedronOf({{1, 0, 0}, {-1, 0, 0}, {2, 0, 0}, {0, 1, 0}})));
  EXPECT_FALSE(polytope.Start(TetrahedronOf({{1, 1, 1}, {2, 1, 1}, {1, 2, 1}, {1, 1, 2}})))
      << "the origin is outside";
}

}  // namespace
}  // namespace mjcf_pdg::test
