#include "solid.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "mjcf_pdg/types.h"
#include "triangle_mesh.h"

namespace mjcf_pdg {
namespace {

// Rays for containment, in turn; none is along what people build.
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

double DistanceToBox(const fcl::OBB<double>& box, const Vector3d& x) {
  const Vector3d local = box.axis.transpose() * (x - box.To);
  return (local.cwiseAbs() - box.extent).cwiseMax(0.0).norm();
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

Solid::Solid(const Matrix3Xd& vertices, const Matrix3Xi& triangles) {
  const TriangleMesh mesh = WeldVertices({kTreeUnits * vertices, triangles});
  vertices_ = mesh.vertices;
  triangles_ = mesh.triangles;
  CountOpenEdges();
  Orient();
  DropFlatTriangles();
  if (triangles_.cols() == 0) throw Error("the mesh has no triangle with an area");
  FindPieces();
  BuildTree();
  center_ = 0.5 * (vertices_.rowwise().minCoeff() + vertices_.rowwise().maxCoeff());
  radius_ = (vertices_.colwise() - center_).colwise().norm().maxCoeff();
}

void Solid::CountOpenEdges() {
  std::vector<std::array<int, 3>> edges;  // low, high, direction
  for (Eigen::Index t = 0; t < triangles_.cols(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int a = triangles_(k, t), b = triangles_((k + 1) % 3, t);
      if (a == b) continue;  // two corners at one place
      edges.push_back({std::min(a, b), std::max(a, b), a < b ? 1 : -1});
    }
  }
  std::sort(edges.begin(), edges.end());
  open_edges_ = 0;
  for (std::size_t i = 0; i < edges.size();) {
    int sum = 0;
    std::size_t j = i;
    for (; j < edges.size() && edges[j][0] == edges[i][0] && edges[j][1] == edges[i][1]; ++j) {
      sum += edges[j][2];
    }
    open_edges_ += sum != 0;
    i = j;
  }
}

// A closed mesh turned inside out is turned back.
void Solid::Orient() {
  if (!closed()) return;
  double volume = 0.0;
  for (Eigen::Index t = 0; t < triangles_.cols(); ++t) {
    volume += Corner(t, 0).dot(Corner(t, 1).cross(Corner(t, 2)));
  }
  if (volume < 0.0) triangles_.row(1).swap(triangles_.row(2));
}

// Of no area: their points are on the edges of their neighbours.
void Solid::DropFlatTriangles() {
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

void Solid::FindPieces() {
  std::vector<int> parent(vertices_.cols());
  std::iota(parent.begin(), parent.end(), 0);
  auto root = [&parent](int v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (Eigen::Index t = 0; t < triangles_.cols(); ++t) {
    for (int k = 1; k < 3; ++k) {
      const int a = root(triangles_(0, t)), b = root(triangles_(k, t));
      parent[std::max(a, b)] = std::min(a, b);
    }
  }
  std::vector<char> seen(vertices_.cols(), 0);
  for (Eigen::Index t = 0; t < triangles_.cols(); ++t) {
    const int r = root(triangles_(0, t));
    if (!seen[r]) pieces_.push_back(Corner(t, 0));
    seen[r] = 1;
  }
}

void Solid::BuildTree() {
  tree_.beginModel(num_triangles(), static_cast<int>(vertices_.cols()));
  std::vector<Vector3d> points;
  for (Eigen::Index v = 0; v < vertices_.cols(); ++v) points.push_back(vertices_.col(v));
  std::vector<fcl::Triangle> faces;
  for (Eigen::Index t = 0; t < triangles_.cols(); ++t) {
    faces.emplace_back(triangles_(0, t), triangles_(1, t), triangles_(2, t));
  }
  tree_.addSubModel(points, faces);
  tree_.endModel();
  places_.resize(num_triangles());
  for (int node = 0; node < tree_.getNumBVs(); ++node) {
    if (IsLeaf(node)) places_[TriangleOf(node)] = tree_.getBV(node).first_primitive;
  }
}

SurfacePoint Solid::Nearest(const Vector3d& x, double cutoff) const {
  SurfacePoint best;
  best.distance = cutoff;
  NearestBelow(0, x, best);
  return best;
}

void Solid::NearestBelow(int node, const Vector3d& x, SurfacePoint& best) const {
  if (IsLeaf(node)) {
    const int t = TriangleOf(node);
    const Vector3d p = NearestOnTriangle(x, Corner(t, 0), Corner(t, 1), Corner(t, 2));
    const double distance = (p - x).norm();
    if (distance < best.distance) best = {distance, p, t};
    return;
  }
  int near = LeftChild(node), far = RightChild(node);
  double d_near = DistanceToBox(BoxOf(near).obb, x), d_far = DistanceToBox(BoxOf(far).obb, x);
  if (d_far < d_near) {
    std::swap(near, far);
    std::swap(d_near, d_far);
  }
  if (d_near < best.distance) NearestBelow(near, x, best);
  if (d_far < best.distance) NearestBelow(far, x, best);
}

struct Solid::Ray {
  Vector3d from, along;  // the segment's end is from + along
  int winding = 0;
  bool doubtful = false;  // passes through an edge, or along a triangle
  std::vector<double>* crossings = nullptr;
};

void Solid::CastBelow(int node, Ray& ray) const {
  constexpr double kEdge = 1e-9;  // barycentric
  const fcl::OBB<double>& box = BoxOf(node).obb;
  const Vector3d from = box.axis.transpose() * (ray.from - box.To);
  const Vector3d along = box.axis.transpose() * ray.along;
  const double slack = 1e-9 * (1.0 + from.cwiseAbs().maxCoeff() + along.cwiseAbs().maxCoeff());
  double enter = 0.0, leave = 1.0;
  for (int i = 0; i < 3; ++i) {
    const double reach = box.extent[i] + slack;
    if (along[i] == 0.0) {
      if (std::abs(from[i]) > reach) return;
      continue;
    }
    const double t1 = (-reach - from[i]) / along[i], t2 = (reach - from[i]) / along[i];
    enter = std::max(enter, std::min(t1, t2));
    leave = std::min(leave, std::max(t1, t2));
  }
  if (enter > leave) return;
  if (!IsLeaf(node)) {
    CastBelow(LeftChild(node), ray);
    CastBelow(RightChild(node), ray);
    return;
  }
  // Möller-Trumbore.
  const int t = TriangleOf(node);
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

int Solid::Winding(const Vector3d& x) const {
  if (!closed() || DistanceToBox(BoxOf(0).obb, x) > 0.0) return 0;
  Ray ray;
  for (const Vector3d& direction : RayDirections()) {
    ray = Ray();
    ray.from = x;
    ray.along = (2.0 * radius_ + (x - center_).norm()) * direction;
    CastBelow(0, ray);
    if (!ray.doubtful) break;
  }
  return ray.winding;
}

void Solid::Crossings(const Vector3d& p, const Vector3d& q, std::vector<double>& out) const {
  out.clear();
  Ray ray;
  ray.from = p;
  ray.along = q - p;
  ray.crossings = &out;
  CastBelow(0, ray);
  std::sort(out.begin(), out.end());
}

}  // namespace mjcf_pdg
