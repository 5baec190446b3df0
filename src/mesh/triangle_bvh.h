// A triangle mesh as collision detection sees it: a tree of bounding volumes over its triangles,
// and whether it encloses a volume.
//
// FCL's triangle distance has an absolute threshold (areas below 2e-8 count as none), so everything
// of this header and of those that build on it is in *tree units*, of which a scene's size is some
// 400: a power of two to the metre, so that scaling rounds nothing.
#ifndef MJCF_PDG_SRC_MESH_TRIANGLE_BVH_H_
#define MJCF_PDG_SRC_MESH_TRIANGLE_BVH_H_

#include <Eigen/Dense>
#include <limits>
#include <string>
#include <vector>

#include "mesh/box_tree.h"

namespace mjcf_pdg {

inline constexpr double kTreeUnits = 4096.0;  // per metre, for sizes of 0.1 m
double TreeUnits(double size);                // per metre, for a scene of that size [m]

// The surface point nearest to a point, in tree units.
struct SurfacePoint {
  double distance = std::numeric_limits<double>::infinity();
  Vector3d p = Vector3d::Zero();
  int triangle = -1;
};

// Immutable, shared between solvers. Indices of triangles count those of non-zero area.
class TriangleBvh {
 public:
  // vertices (3 × nv) [m], triangles (3 × nt) of vertex indices. Vertices at the same place count
  // as one. `units`: tree units to the metre. Throws Error if no triangle has an area.
  TriangleBvh(const Matrix3Xd& vertices, const Matrix3Xi& triangles, double units = kTreeUnits);

  // Every edge is shared by as many triangles one way as the other: there is an inside. If not,
  // the mesh is a surface.
  bool closed() const { return open_edges_ == 0; }
  int open_edges() const { return open_edges_; }

  int num_triangles() const { return static_cast<int>(triangles_.cols()); }
  Vector3d Corner(int triangle, int k) const { return vertices_.col(triangles_(k, triangle)); }
  // Unit, by the right-hand rule; outward on a closed mesh.
  const auto Normal(int triangle) const { return normals_.col(triangle); }
  // One point of each connected piece.
  const std::vector<Vector3d>& pieces() const { return pieces_; }
  const Vector3d& center() const { return center_; }
  double radius() const { return radius_; }  // of the sphere about center() around all vertices

  const BoxTree& tree() const { return tree_; }

  // The nearest surface point, if it is nearer than `cutoff`; else triangle is -1 and the distance
  // is the cutoff.
  SurfacePoint Nearest(const Vector3d& x,
                       double cutoff = std::numeric_limits<double>::infinity()) const;
  // The nearest of all; quicker if some point of the surface, `guess`, is near.
  SurfacePoint NearestFrom(const SurfacePoint& guess, const Vector3d& x) const;

  // How often the oriented surface winds round x, by signed crossings of a ray; rays through edges
  // are given up for another direction. Not zero: inside. 0 for a mesh that is not closed.
  int Winding(const Vector3d& x) const;
  // The same, told from how often it winds round `known`: quicker where that is near.
  int WindingFrom(const Vector3d& known, int winding, const Vector3d& x) const;
  bool Contains(const Vector3d& x) const { return Winding(x) != 0; }

  // Parameters in [0, 1], ascending, at which the segment from p to q crosses triangles.
  void Crossings(const Vector3d& p, const Vector3d& q, std::vector<double>& out) const;

 private:
  struct Ray;
  void CountOpenEdges();
  void Orient();
  void DropFlatTriangles();
  void FindPieces();
  void NearestBelow(int box, const Vector3d& x, SurfacePoint& best) const;
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
