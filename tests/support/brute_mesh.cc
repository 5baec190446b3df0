#include "tests/support/brute_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace mjcf_pdg::test {
namespace {

struct Triangle {
  Triangle(const MeshShape& shape, const Eigen::Vector3i& f)
      : p{shape.vertices[f[0]], shape.vertices[f[1]], shape.vertices[f[2]]},
        middle((p[0] + p[1] + p[2]) / 3.0) {
    for (const Vector3d& corner : p) reach = std::max(reach, (corner - middle).norm());
  }
  Vector3d p[3];
  Vector3d middle;
  double reach = 0.0;
};

double Distance(const Vector3d& x, const Triangle& t) {
  return (NearestOnTriangle(x, t.p[0], t.p[1], t.p[2]) - x).norm();
}

// The distance of the segments p + [0, 1] u and q + [0, 1] v if their nearest points are inside
// both; infinite if not.
double EdgeDistance(const Vector3d& p, const Vector3d& u, const Vector3d& q, const Vector3d& v) {
  const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v);
  const double area = uu * vv - uv * uv;
  if (!(area > 1e-14 * uu * vv)) return std::numeric_limits<double>::infinity();
  const Vector3d w = q - p;
  const double s = (w.dot(u) * vv - w.dot(v) * uv) / area;
  const double t = (w.dot(u) * uv - w.dot(v) * uu) / area;
  if (s < 0.0 || s > 1.0 || t < 0.0 || t > 1.0) return std::numeric_limits<double>::infinity();
  return (p + s * u - q - t * v).norm();
}

// True if the segment from p to q crosses the triangle.
bool Pierces(const Vector3d& p, const Vector3d& q, const Vector3d t[3]) {
  auto volume = [](const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d) {
    return (b - a).dot((c - a).cross(d - a));
  };
  if ((volume(p, t[0], t[1], t[2]) > 0) == (volume(q, t[0], t[1], t[2]) > 0)) return false;
  const bool a = volume(p, q, t[0], t[1]) > 0, b = volume(p, q, t[1], t[2]) > 0;
  return a == b && b == (volume(p, q, t[2], t[0]) > 0);
}

double Distance(const Triangle& s, const Triangle& t) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    const Vector3d &s_end = s.p[(i + 1) % 3], &t_end = t.p[(i + 1) % 3];
    if (Pierces(s.p[i], s_end, t.p) || Pierces(t.p[i], t_end, s.p)) return 0.0;
    least = std::min({least, Distance(s.p[i], t), Distance(t.p[i], s)});
    for (int j = 0; j < 3; ++j) {
      const Vector3d v = t.p[(j + 1) % 3] - t.p[j];
      least = std::min(least, EdgeDistance(s.p[i], s_end - s.p[i], t.p[j], v));
    }
  }
  return least;
}

}  // namespace

double BruteDistance(const MeshShape& shape, const Vector3d& x) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& f : shape.faces) least = std::min(least, Distance(x, Triangle(shape, f)));
  return least;
}

double BruteDistance(const MeshShape& a, const MeshShape& b) {
  double least = std::numeric_limits<double>::infinity();
  std::vector<Triangle> others;
  for (const auto& g : b.faces) others.emplace_back(b, g);
  for (const auto& f : a.faces) {
    const Triangle s(a, f);
    for (const Triangle& t : others) {
      if ((s.middle - t.middle).norm() - s.reach - t.reach > least) continue;
      least = std::min(least, Distance(s, t));
      if (least == 0.0) return 0.0;
    }
  }
  return least;
}

MeshShape Moved(const MeshShape& shape, const Eigen::Matrix3d& R, const Vector3d& t) {
  MeshShape copy = shape;
  return copy.Move(R, t);
}

TriangleBvh MakeSolid(const MeshShape& shape) {
  return TriangleBvh(shape.Vertices(), shape.Faces());
}

bool Intersects(const BvhPair& pair) {
  return pair.RoughlyNearest(BvhPair::kTouching, nullptr).a >= 0;
}

const std::vector<MeshShape>& SmallShapes() {
  static const std::vector<MeshShape> shapes = {
      TorusKnot(0.1, 0.03, 20, 4), Cup(0.1, 0.15, 0.02, 7), Globe(5, 7, [](const Vector3d& d) {
        return 0.1 * (1.0 + 0.4 * std::sin(9.0 * d.x() + 7.0 * d.y()));
      })};
  return shapes;
}

void ExpectOverlaps(const std::vector<SignedGap>& gaps) {
  ASSERT_FALSE(gaps.empty());
  double before = -std::numeric_limits<double>::infinity();
  for (const SignedGap& gap : gaps) {
    EXPECT_LT(gap.distance, 0.0);
    EXPECT_GE(gap.distance, before) << "the deepest first";
    before = gap.distance;
    EXPECT_NEAR(gap.n.norm(), 1.0, 1e-9);
    EXPECT_NEAR(gap.n.dot(gap.p2 - gap.p1), gap.distance, 1e-5);
  }
}

}  // namespace mjcf_pdg::test
