// A triangle mesh prepared for collision queries: a bounding volume hierarchy over its triangles,
// by which nearest points, winding numbers and crossings are found. The narrow phase of exact pairs
// (collide/exact) builds on it.
//
// Lengths in this header, and in those that build on it, are in *tree units*, because FCL's
// triangle distance has an absolute threshold (areas below 2e-8 count as none). A scene's size is
// some 400 tree units. There is a power of two of them to the metre, so that scaling rounds
// nothing. Points are in the mesh's own frame.
#ifndef MJCF_PDG_SRC_MESH_TRIANGLE_BVH_H_
#define MJCF_PDG_SRC_MESH_TRIANGLE_BVH_H_

#include <Eigen/Dense>
#include <limits>
#include <string>
#include <vector>

#include "mesh/box_tree.h"

namespace mjcf_pdg {

inline constexpr double kTreeUnits = 4096.0;  // tree units per metre for a scene of size 0.1 m
double TreeUnits(double size);                // tree units per metre for a scene of `size` [m]

// The surface point nearest to a given point.
struct SurfacePoint {
  double distance = std::numeric_limits<double>::infinity();  // between the two
  Vector3d p = Vector3d::Zero();
  int triangle = -1;  // that p is on; -1: none was found
};

// Immutable, so that solvers and threads may share it. Triangles without area are dropped; indices
// of triangles count the others.
class TriangleBvh {
 public:
  // vertices (3 × nv) [m], triangles (3 × nt) of vertex indices. Vertices with equal coordinates
  // count as one; a closed mesh whose triangles face inwards is turned round. `units`: tree units
  // per metre. Throws Error if no triangle has an area.
  TriangleBvh(const Matrix3Xd& vertices, const Matrix3Xi& triangles, double units = kTreeUnits);

  // True if every edge is used by as many triangles in one direction as in the other, so that there
  // is an inside. If false, open_edges() edges are not, and the mesh is a mere surface.
  bool closed() const { return open_edges_ == 0; }
  int open_edges() const { return open_edges_; }

  int num_triangles() const { return static_cast<int>(triangles_.cols()); }
  Vector3d Corner(int triangle, int k) const { return vertices_.col(triangles_(k, triangle)); }
  // The unit normal by the right-hand rule; outward on a closed mesh.
  const auto Normal(int triangle) const { return normals_.col(triangle); }
  // One vertex of each connected piece of the mesh.
  const std::vector<Vector3d>& pieces() const { return pieces_; }
  // The centre of the axis-aligned bounding box, and the radius of the bounding sphere about it.
  const Vector3d& center() const { return center_; }
  double radius() const { return radius_; }

  const BoxTree& tree() const { return tree_; }

  // The surface point nearest to x, if it is nearer than `cutoff`; otherwise triangle = -1 and
  // distance = cutoff.
  SurfacePoint Nearest(const Vector3d& x,
                       double cutoff = std::numeric_limits<double>::infinity()) const;
  // The surface point nearest to x, at any distance. The search is faster if `guess`, any point of
  // the surface, is near x; guess.triangle = -1 stands for no guess.
  SurfacePoint NearestFrom(const SurfacePoint& guess, const Vector3d& x) const;

  // The winding number of the oriented surface round x: not 0 if x is inside, 0 outside and for a
  // mesh that is not closed. It is the sum of the signed crossings of a ray; a ray that meets an
  // edge is replaced by one of another direction, up to eight times.
  int Winding(const Vector3d& x) const;
  // The winding number of x, by the crossings between x and the point `known`, whose winding number
  // is `winding`. Faster than Winding if the two are near each other. For closed meshes.
  int WindingFrom(const Vector3d& known, int winding, const Vector3d& x) const;
  // True if x is inside a closed mesh.
  bool Contains(const Vector3d& x) const { return Winding(x) != 0; }

  // Sets `out` to the parameters in [0, 1], ascending, at which the segment from p to q crosses
  // triangles. A crossing at an edge may appear once per triangle there.
  void Crossings(const Vector3d& p, const Vector3d& q, std::vector<double>& out) const;

 private:
  struct Ray;
  // Steps of the constructor.
  void CountOpenEdges();
  void Orient();
  void DropFlatTriangles();
  void FindPieces();
  // Replaces `best` by a point below the box that is nearer to x, if there is one.
  void NearestBelow(int box, const Vector3d& x, SurfacePoint& best) const;
  // Adds the ray's crossings with the triangles below a box, or with one triangle, to the ray.
  void CastBelow(int box, Ray& ray) const;
  void CastOnTriangle(int triangle, Ray& ray) const;

  Matrix3Xd vertices_;
  Matrix3Xi triangles_;
  Matrix3Xd normals_;
  std::vector<Vector3d> pieces_;
  Vector3d center_ = Vector3d::Zero();
  double radius_ = 0.0;
  int open_edges_ = 0;
  BoxTree tree_;
};

// The point of the triangle a, b, c nearest to x. Source: Ericson, Real-Time Collision Detection,
// 5.1.5.
Vector3d NearestOnTriangle(const Vector3d& x, const Vector3d& a, const Vector3d& b,
                           const Vector3d& c);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_MESH_TRIANGLE_BVH_H_
