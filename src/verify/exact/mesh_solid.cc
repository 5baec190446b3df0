#include "verify/exact/mesh_solid.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace mjcf_pdg::verify {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Unit directions of rays: to the faces and corners of a cube, turned a little so that rays seldom
// run along edges of a mesh.
std::vector<Vector3d> RayDirections() {
  const Matrix3d turn = Eigen::AngleAxisd(0.3, Vector3d(0.2, 0.5, 0.84).normalized()).matrix();
  std::vector<Vector3d> list;
  for (int i = 0; i < 3; ++i) {
    for (const double sign : {-1.0, 1.0}) list.push_back(turn * (sign * Vector3d::Unit(i)));
  }
  for (int k = 0; k < 8; ++k) {
    const Vector3d corner(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1);
    list.push_back(turn * corner.normalized());
  }
  return list;
}

}  // namespace

MeshSolid::MeshSolid(Triangles mesh, bool is_convex, double tree_scale)
    : triangles(std::move(mesh)),
      scale(tree_scale),
      convex(is_convex),
      closed(is_convex || CountOpenEdges(triangles) == 0) {
  tree.beginModel();
  for (const auto& t : triangles) {
    tree.addTriangle(scale * t[0], scale * t[1], scale * t[2]);
    for (const Vector3d& p : t) extent = std::max(extent, p.norm());
  }
  tree.endModel();
  for (const std::vector<int>& piece : Pieces(triangles)) AddProbes(piece);
}

double MeshSolid::ConvexDepth(const Vector3d& p, Vector3d& out) const {
  Vector3d middle = Vector3d::Zero();
  for (const auto& t : triangles) middle += t[0] / static_cast<double>(triangles.size());
  double depth = kInfinity;
  for (const auto& t : triangles) {
    Vector3d n = (t[1] - t[0]).cross(t[2] - t[0]);
    if (!(n.norm() > 0.0)) continue;
    n.normalize();
    if (n.dot(t[0] - middle) < 0.0) n = -n;
    const double below = n.dot(t[0] - p);
    if (below < depth) {
      depth = below;
      out = n;
    }
  }
  return std::max(depth, 0.0);
}

void MeshSolid::CastOn(int triangle, const Vector3d& p, const Vector3d& direction,
                       RayHits& hits) const {
  // A hit is too near an edge, or to the ray's start, below this share of the triangle's size, or
  // of the body's extent.
  constexpr double kEdge = 1e-9;
  const auto& [a, b, c] = triangles[triangle];
  const Vector3d e1 = b - a, e2 = c - a, h = direction.cross(e2), s = p - a;
  const double det = e1.dot(h);
  const Vector3d k = s.cross(e1);
  // The hit is at a + (u e1 + v e2) / det, and at the distance t / det along the ray.
  const double u = s.dot(h), v = direction.dot(k), t = e2.dot(k);
  const double size = std::abs(det), sign = det < 0.0 ? -1.0 : 1.0, edge = kEdge * size;
  const double least = std::min({sign * u, sign * v, size - sign * (u + v)});
  const double at_start = edge * extent;
  if (least < -edge || sign * t < -at_start) return;
  const bool edge_on = !(size > 1e-12 * e1.norm() * e2.norm());
  if (edge_on || least < edge || sign * t < at_start) {
    hits.clean = false;
    hits.from_surface |= !edge_on && sign * t < at_start;
    return;
  }
  ++hits.count;
  hits.winding += det < 0.0 ? -1 : 1;
  hits.first = std::min(hits.first, t / det);
}

// Casts the ray against the triangles below a node, if it meets the node's oriented box (slab
// test).
void MeshSolid::CastBelow(int node, const Vector3d& p, const Vector3d& direction,
                          RayHits& hits) const {
  constexpr double kRounding = 1e-9;  // share of the lengths by which a box is enlarged
  const auto& bv = tree.getBV(node);
  const Vector3d from = bv.bv.obb.axis.transpose() * (scale * p - bv.bv.obb.To);
  const Vector3d along = bv.bv.obb.axis.transpose() * direction;
  double enter = 0.0, leave = kInfinity;
  for (int i = 0; i < 3; ++i) {
    const double half = bv.bv.obb.extent[i] + kRounding * (std::abs(from[i]) + from.norm());
    if (std::abs(along[i]) < 1e-15) {
      if (std::abs(from[i]) > half) return;
      continue;
    }
    const double t1 = (-half - from[i]) / along[i], t2 = (half - from[i]) / along[i];
    enter = std::max(enter, std::min(t1, t2));
    leave = std::min(leave, std::max(t1, t2));
  }
  if (enter > leave) return;
  if (bv.isLeaf()) return CastOn(bv.primitiveId(), p, direction, hits);
  CastBelow(bv.leftChild(), p, direction, hits);
  CastBelow(bv.rightChild(), p, direction, hits);
}

MeshSolid::RayHits MeshSolid::Cast(const Vector3d& p, const Vector3d& direction) const {
  RayHits hits;
  CastBelow(0, p, direction, hits);
  return hits;
}

// Several rays vote: a ray says "inside" if its winding is not zero, which holds even where parts
// of the surface overlap or touch.
double MeshSolid::DepthOf(const Vector3d& p, Vector3d& out) const {
  if (!closed) return 0.0;
  if (convex) return ConvexDepth(p, out);
  int votes = 0, count = 0;
  double depth = kInfinity;
  static const std::vector<Vector3d> directions = RayDirections();
  for (const Vector3d& direction : directions) {
    const RayHits hits = Cast(p, direction);
    if (hits.from_surface) return 0.0;
    if (!hits.clean) continue;
    if (hits.count == 0) return 0.0;  // a ray that meets nothing proves that p is outside
    votes += hits.winding != 0;
    ++count;
    if (hits.first < depth) {
      depth = hits.first;
      out = direction;
    }
    if (count == 5 && votes < 3) return 0.0;
  }
  return 2 * votes > count ? depth : 0.0;
}

void MeshSolid::AddProbes(const std::vector<int>& piece) {
  constexpr std::size_t kTriangles = 8;
  constexpr double kBelow = 1e-6;  // start of a ray off its triangle, as a share of the triangle
  probes.push_back({triangles[piece.front()][0]});
  Probe best;
  for (std::size_t k = 0; k < piece.size(); k += 1 + piece.size() / kTriangles) {
    const auto& [a, b, c] = triangles[piece[k]];
    const Vector3d middle = (a + b + c) / 3.0;
    const Vector3d normal = (b - a).cross(c - a).normalized();
    for (const Vector3d& way : {Vector3d(-normal), normal}) {
      const Vector3d from = middle + kBelow * (a - middle).norm() * way;
      const RayHits hits = Cast(from, way);
      if (hits.count == 0) continue;
      const Vector3d x = from + 0.5 * hits.first * way;
      Vector3d out;
      const double inside = DepthOf(x, out);
      if (inside > best.inside) best = {x, inside};
    }
  }
  if (best.inside > 0.0) probes.push_back(best);
}

}  // namespace mjcf_pdg::verify
