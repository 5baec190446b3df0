#include "mesh/triangle_bvh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "mesh/mesh_edges.h"
#include "mesh/triangle_mesh.h"
#include "mjcf_pdg/types.h"

namespace mjcf_pdg {
namespace {

// The directions that Winding tries in turn. They are oblique to the axes, so that rays along edges
// or faces of real models are unlikely.
const std::array<Vector3d, 8>& RayDirections() {
  static const std::array<Vector3d, 8> directions = [] {
    std::array<Vector3d, 8> list = {
        Vector3d(0.3712, 0.8211, 0.4336),   Vector3d(-0.7123, 0.2911, 0.6387),
        Vector3d(0.1937, -0.4521, 0.8707),  Vector3d(-0.5419, -0.7717, -0.3331),
        Vector3d(0.8839, -0.2173, -0.4141), Vector3d(-0.1213, 0.6661, -0.7359),
        Vector3d(0.6047, 0.5101, -0.6113),  Vector3d(-0.9293, -0.1117, 0.3519)};
    for (Vector3d& d : list) d.normalize();
    return list;
  }();
  return directions;
}

}  // namespace

Vector3d NearestOnTriangle(const Vector3d& x, const Vector3d& a, const Vector3d& b,
                           const Vector3d& c) {
  const Vector3d ab = b - a, ac = c - a, ax = x - a;
  const double d1 = ab.dot(ax), d2 = ac.dot(ax);
  if (d1 <= 0.0 && d2 <= 0.0) return a;
  const Vector3d bx = x - b;
  const double d3 = ab.dot(bx), d4 = ac.dot(bx);
  if (d3 >= 0.0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return a + d1 / (d1 - d3) * ab;
  const Vector3d cx = x - c;
  const double d5 = ab.dot(cx), d6 = ac.dot(cx);
  if (d6 >= 0.0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return a + d2 / (d2 - d6) * ac;
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 >= d3 && d5 >= d6) {
    return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  }
  const double sum = va + vb + vc;
  return a + vb / sum * ab + vc / sum * ac;
}

double TreeUnits(double size) { return kTreeUnits * std::exp2(std::round(std::log2(0.1 / size))); }

TriangleBvh::TriangleBvh(const Matrix3Xd& vertices, const Matrix3Xi& triangles, double units) {
  const TriangleMesh mesh = WeldVertices({units * vertices, triangles});
  vertices_ = mesh.vertices;
  triangles_ = mesh.triangles;
  CountOpenEdges();
  Orient();
  DropFlatTriangles();
  if (triangles_.cols() == 0) throw Error("the mesh has no triangle with an area");
  FindPieces();
  tree_ = BoxTree(vertices_, triangles_);
  center_ = 0.5 * (vertices_.rowwise().minCoeff() + vertices_.rowwise().maxCoeff());
  radius_ = (vertices_.colwise() - center_).colwise().norm().maxCoeff();
}

void TriangleBvh::CountOpenEdges() {
  open_edges_ = 0;
  ForEachEdge(SortedEdgeUses(triangles_), [&](const EdgeUse* edge, int count) {
    if (edge->low == edge->high) return;  // a degenerate side
    int surplus = 0;                      // uses from low to high, less uses from high to low
    for (int k = 0; k < count; ++k) surplus += edge[k].forward ? 1 : -1;
    open_edges_ += surplus != 0;
  });
}

// If a closed mesh's triangles face inwards (negative volume), turns all of them round.
void TriangleBvh::Orient() {
  if (!closed()) return;
  double volume = 0.0;
  for (Eigen::Index t = 0; t < triangles_.cols(); ++t) {
    volume += Corner(t, 0).dot(Corner(t, 1).cross(Corner(t, 2)));
  }
  if (volume < 0.0) triangles_.row(1).swap(triangles_.row(2));
}

// Drops triangles without area and computes the others' normals. Nothing is lost: their points are
// on edges of neighbours.
void TriangleBvh::DropFlatTriangles() {
  normals_.resize(3, triangles_.cols());
  Eigen::Index count = 0;
  for (Eigen::Index t = 0; t < triangles_.cols(); ++t) {
    const Vector3d n = (Corner(t, 1) - Corner(t, 0)).cross(Corner(t, 2) - Corner(t, 0));
    if (!(n.norm() > 0.0)) continue;
    normals_.col(count) = n.normalized();
    triangles_.col(count++) = triangles_.col(t).eval();
  }
  triangles_.conservativeResize(3, count);
  normals_.conservativeResize(3, count);
}

void TriangleBvh::FindPieces() {
  OrientedSets connected(static_cast<int>(vertices_.cols()));
  for (Eigen::Index t = 0; t < triangles_.cols(); ++t) {
    connected.Join(triangles_(0, t), triangles_(1, t));
    connected.Join(triangles_(0, t), triangles_(2, t));
  }
  std::vector<char> seen(vertices_.cols(), 0);
  for (Eigen::Index t = 0; t < triangles_.cols(); ++t) {
    const int root = connected.Root(triangles_(0, t));
    if (!seen[root]) pieces_.push_back(Corner(t, 0));
    seen[root] = 1;
  }
}

SurfacePoint TriangleBvh::Nearest(const Vector3d& x, double cutoff) const {
  SurfacePoint best;
  best.distance = cutoff;
  NearestBelow(BoxTree::kRoot, x, best);
  return best;
}

SurfacePoint TriangleBvh::NearestFrom(const SurfacePoint& guess, const Vector3d& x) const {
  SurfacePoint best = guess;
  if (guess.triangle >= 0) best.distance = (guess.p - x).norm();
  NearestBelow(BoxTree::kRoot, x, best);
  return best;
}

void TriangleBvh::NearestBelow(int box, const Vector3d& x, SurfacePoint& best) const {
  if (tree_.IsLeaf(box)) {
    const int t = tree_.TriangleOf(box);
    const Vector3d p = NearestOnTriangle(x, Corner(t, 0), Corner(t, 1), Corner(t, 2));
    const double distance = (p - x).norm();
    if (distance < best.distance) best = {distance, p, t};
    return;
  }
  for (const BoundedBox& child : tree_.ChildrenNear(box, x, best.distance)) {
    if (child.bound < best.distance) NearestBelow(child.box, x, best);
  }
}

// A segment from `from` to from + along, and what it crosses.
struct TriangleBvh::Ray {
  Vector3d from, along;
  int winding = 0;        // crossings from inside to outside, less those from outside to inside
  bool doubtful = false;  // it meets an edge or runs along a triangle: `winding` may be wrong
  std::vector<double>* crossings = nullptr;  // if set, receives the parameters of the crossings
};

void TriangleBvh::CastBelow(int box, Ray& ray) const {
  if (tree_.IsLeaf(box)) return CastOnTriangle(tree_.TriangleOf(box), ray);
  for (const BoundedBox& child : tree_.ChildrenOn(box, ray.from, ray.along)) {
    CastBelow(child.box, ray);
  }
}

// The ray-triangle intersection of Möller and Trumbore.
void TriangleBvh::CastOnTriangle(int t, Ray& ray) const {
  // The ray meets an edge if a barycentric coordinate of the crossing is smaller. The same share of
  // lengths tells rays that are parallel to the triangle, or in its plane.
  constexpr double kEdge = 1e-9;
  const Vector3d a = Corner(t, 0), ab = Corner(t, 1) - a, ac = Corner(t, 2) - a;
  const Vector3d h = ray.along.cross(ac);
  const double det = ab.dot(h);
  if (std::abs(det) <= kEdge * ab.cross(ac).norm() * ray.along.norm()) {
    const double height = Normal(t).dot(ray.from - a);
    if (std::abs(height) <= kEdge * (1.0 + ray.along.norm())) ray.doubtful = true;
    return;
  }
  const Vector3d s = ray.from - a;
  const double u = s.dot(h) / det;
  const Vector3d q = s.cross(ab);
  const double v = ray.along.dot(q) / det;
  const double inside = std::min({u, v, 1.0 - u - v});
  if (inside < -kEdge) return;
  const double parameter = ac.dot(q) / det;
  if (parameter < 0.0 || parameter > 1.0) return;
  if (inside < kEdge) ray.doubtful = true;
  ray.winding += det > 0.0 ? -1 : 1;
  if (ray.crossings) ray.crossings->push_back(parameter);
}

int TriangleBvh::Winding(const Vector3d& x) const {
  if (!closed() || tree_.RootDistance(x) > 0.0f) return 0;
  Ray ray;
  for (const Vector3d& direction : RayDirections()) {
    ray = Ray();
    ray.from = x;
    ray.along = (2.0 * radius_ + (x - center_).norm()) * direction;
    CastBelow(BoxTree::kRoot, ray);
    if (!ray.doubtful) break;
  }
  return ray.winding;
}

int TriangleBvh::WindingFrom(const Vector3d& known, int winding, const Vector3d& x) const {
  Ray ray;
  ray.from = x;
  ray.along = known - x;
  CastBelow(BoxTree::kRoot, ray);
  return ray.doubtful ? Winding(x) : winding + ray.winding;
}

void TriangleBvh::Crossings(const Vector3d& p, const Vector3d& q, std::vector<double>& out) const {
  out.clear();
  Ray ray;
  ray.from = p;
  ray.along = q - p;
  ray.crossings = &out;
  CastBelow(BoxTree::kRoot, ray);
  std::sort(out.begin(), out.end());
}

}  // namespace mjcf_pdg
