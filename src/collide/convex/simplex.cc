#include "collide/convex/simplex.h"

#include <cmath>
#include <limits>

namespace mjcf_pdg {
namespace {

using Eigen::Vector3d;

// A tetrahedron counts as flat if its fourth corner's height over a face is smaller than this share
// of an edge.
constexpr double kFlat = 1e-12;

// A face of the simplex (vertex, edge or triangle) with its point nearest to the origin.
struct Face {
  int corners[4];
  double weights[4];  // barycentric coordinates of that point
  int size = 0;
  double squared = std::numeric_limits<double>::infinity();  // its squared distance from the origin
};

Face VertexFace(int a, const Vector3d& x) { return {{a}, {1.0}, 1, x.squaredNorm()}; }

// The face with corners a and b whose nearest point is xa + t (xb - xa).
Face EdgeFace(int a, int b, const Vector3d& xa, const Vector3d& xb, double t) {
  return {{a, b}, {1.0 - t, t}, 2, (xa + t * (xb - xa)).squaredNorm()};
}

Face NearestOfEdge(int a, int b, const Vector3d x[4]) {
  const Vector3d along = x[b] - x[a];
  const double at = -x[a].dot(along), length = along.squaredNorm();
  if (!(at > 0.0)) return VertexFace(a, x[a]);
  if (at >= length) return VertexFace(b, x[b]);
  return EdgeFace(a, b, x[a], x[b], at / length);
}

// By the Voronoi regions of the triangle's vertices, edges and interior (Ericson, Real-Time
// Collision Detection, 5.1.5). Signed areas (of_a, of_b, of_c) come from cross products along the
// normal: differences of products of lengths would cancel for thin triangles.
Face NearestOfTriangle(int a, int b, int c, const Vector3d x[4]) {
  const Vector3d ab = x[b] - x[a], ac = x[c] - x[a];
  const double ab_a = -ab.dot(x[a]), ac_a = -ac.dot(x[a]);
  if (ab_a <= 0.0 && ac_a <= 0.0) return VertexFace(a, x[a]);
  const double ab_b = -ab.dot(x[b]), ac_b = -ac.dot(x[b]);
  if (ab_b >= 0.0 && ac_b <= ab_b) return VertexFace(b, x[b]);
  const double ab_c = -ab.dot(x[c]), ac_c = -ac.dot(x[c]);
  if (ac_c >= 0.0 && ab_c <= ac_c) return VertexFace(c, x[c]);
  const Vector3d normal = ab.cross(ac);
  const double of_c = normal.dot(x[a].cross(x[b]));
  if (of_c <= 0.0 && ab_a >= 0.0 && ab_b <= 0.0) {
    return EdgeFace(a, b, x[a], x[b], ab_a / (ab_a - ab_b));
  }
  const double of_b = normal.dot(x[c].cross(x[a]));
  if (of_b <= 0.0 && ac_a >= 0.0 && ac_c <= 0.0) {
    return EdgeFace(a, c, x[a], x[c], ac_a / (ac_a - ac_c));
  }
  const double of_a = normal.dot(x[b].cross(x[c]));
  const double from_b = ac_b - ab_b, from_c = ab_c - ac_c;
  if (of_a <= 0.0 && from_b >= 0.0 && from_c >= 0.0) {
    return EdgeFace(b, c, x[b], x[c], from_b / (from_b + from_c));
  }
  const double sum = of_a + of_b + of_c;
  Face face{{a, b, c}, {of_a / sum, of_b / sum, of_c / sum}, 3};
  face.squared =
      (face.weights[0] * x[a] + face.weights[1] * x[b] + face.weights[2] * x[c]).squaredNorm();
  return face;
}

// True if the plane through a, b and c separates the origin from d, or if the tetrahedron is too
// flat to tell.
bool Beyond(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d) {
  const Vector3d normal = (b - a).cross(c - a);
  const double origin = -normal.dot(a), fourth = normal.dot(d - a);
  return origin * fourth <= 0.0 || std::abs(fourth) < kFlat * normal.norm() * (d - a).norm();
}

// If the origin is inside, the face returned is empty (size 0).
Face NearestOfTetrahedron(const Vector3d x[4]) {
  constexpr int kFaces[4][4] = {{0, 1, 2, 3}, {0, 1, 3, 2}, {0, 2, 3, 1}, {1, 2, 3, 0}};
  Face best;
  for (const auto& f : kFaces) {
    if (!Beyond(x[f[0]], x[f[1]], x[f[2]], x[f[3]])) continue;
    const Face face = NearestOfTriangle(f[0], f[1], f[2], x);
    if (face.squared < best.squared) best = face;
  }
  return best;
}

}  // namespace

Simplex::Corner Simplex::Nearest() const {
  Corner mean{Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero()};
  for (int k = 0; k < size_; ++k) {
    mean.x += corners_[k].weight * corners_[k].x;
    mean.p1 += corners_[k].weight * corners_[k].p1;
    mean.p2 += corners_[k].weight * corners_[k].p2;
  }
  return mean;
}

void Simplex::KeepClosestSubSimplex() {
  Vector3d x[4];
  for (int k = 0; k < size_; ++k) x[k] = corners_[k].x;
  Face face;
  switch (size_) {
    case 1:
      face = VertexFace(0, x[0]);
      break;
    case 2:
      face = NearestOfEdge(0, 1, x);
      break;
    case 3:
      face = NearestOfTriangle(0, 1, 2, x);
      break;
    default:
      face = NearestOfTetrahedron(x);
      if (face.size == 0) return;  // the origin is inside
  }
  for (int k = 0; k < face.size; ++k) {  // face.corners ascend, so none is overwritten too early
    corners_[k] = corners_[face.corners[k]];
    corners_[k].weight = face.weights[k];
  }
  size_ = face.size;
}

}  // namespace mjcf_pdg
