// A body of triangles as the verifier sees it: FCL's tree over its triangles, and which points are
// inside it.
#ifndef MJCF_PDG_SRC_VERIFY_EXACT_MESH_SOLID_H_
#define MJCF_PDG_SRC_VERIFY_EXACT_MESH_SOLID_H_

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/OBBRSS.h>

#include <limits>
#include <vector>

#include "verify/exact/triangles.h"

namespace mjcf_pdg::verify {

struct MeshSolid {
  using Bvh = fcl::BVHModel<fcl::OBBRSS<double>>;

  // `mesh` has at least one triangle; `is_convex` says that it is the surface of a convex body.
  // FCL's tree holds the triangles `tree_scale` times as large, because FCL's thresholds are
  // absolute.
  MeshSolid(Triangles mesh, bool is_convex, double tree_scale);

  // A point of a connected piece of the surface. If the piece crosses no triangle of another body,
  // its points tell whether it is inside that body.
  struct Probe {
    Vector3d p;           // geom frame [m]
    double inside = 0.0;  // how deep p is inside this body itself; 0: p is on its surface [m]
  };

  Triangles triangles;        // geom frame [m]
  std::vector<Probe> probes;  // one or two for each connected piece
  double scale = 1.0;         // of the tree: its units per metre
  double extent = 0.0;        // largest distance of a corner from the geom's origin [m]
  bool convex = false;        // a box or a hull: a point is inside if it is below every face
  bool closed = false;        // a surface that is not closed has no inside
  Bvh tree;

  // Returns how deep p (geom frame [m]) is inside, and sets `out` to the unit direction of the way
  // out; returns 0 if p is outside or on the surface. For a body that is not convex the depth is
  // the shortest way out along 14 directions, which may be more than the distance from the surface.
  double DepthOf(const Vector3d& p, Vector3d& out) const;

 private:
  // The triangles that a ray meets.
  struct RayHits {
    double first = std::numeric_limits<double>::infinity();  // distance to the first one [m]
    // How many triangles it meets, and how many of them from outside less those from inside.
    int count = 0, winding = 0;
    bool clean = true;          // false: an edge, or a triangle edge-on, makes the count doubtful
    bool from_surface = false;  // it begins on a triangle
  };
  RayHits Cast(const Vector3d& p, const Vector3d& direction) const;
  void CastBelow(int node, const Vector3d& p, const Vector3d& direction, RayHits& hits) const;
  void CastOn(int triangle, const Vector3d& p, const Vector3d& direction, RayHits& hits) const;
  // Adds a vertex of the piece (indices of triangles) and, if there is one, the deepest of some
  // points inside the body under the piece's triangles.
  void AddProbes(const std::vector<int>& piece);
  double ConvexDepth(const Vector3d& p, Vector3d& out) const;
};

}  // namespace mjcf_pdg::verify

#endif  // MJCF_PDG_SRC_VERIFY_EXACT_MESH_SOLID_H_
