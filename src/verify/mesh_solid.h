// A mesh as the independent check sees it: FCL's tree over its triangles, and what is inside.
#ifndef MJCF_PDG_SRC_VERIFY_MESH_SOLID_H_
#define MJCF_PDG_SRC_VERIFY_MESH_SOLID_H_

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/OBBRSS.h>

#include <limits>
#include <vector>

#include "verify/triangles.h"

namespace mjcf_pdg::verify {

struct MeshSolid {
  using Bvh = fcl::BVHModel<fcl::OBBRSS<double>>;

  // FCL's tree holds the triangles `tree_scale` times as large: its thresholds are absolute.
  MeshSolid(Triangles mesh, bool is_convex, double tree_scale);

  // A point that tells whether one of the connected pieces is inside another body.
  struct Probe {
    Vector3d p;
    double inside = 0.0;  // how deep it is in its own body, if it is [m]
  };

  Triangles triangles;  // geom frame [m]; empty for planes and round primitives
  std::vector<Probe> probes;
  double scale = 1.0;   // of the tree
  double extent = 0.0;  // no corner is farther from the geom's origin [m]
  bool convex = false;  // box or hull: inside is below every face
  bool closed = false;  // else nothing is inside
  Bvh tree;

  // How deep p is inside, and the way out; 0 outside and on the surface. Geom frame.
  double DepthOf(const Vector3d& p, Vector3d& out) const;

 private:
  // What a ray meets. Not clean: an edge, or a triangle edge on, so that the count is doubtful.
  struct RayHits {
    double first = std::numeric_limits<double>::infinity();  // [m]
    int count = 0, winding = 0;
    bool clean = true;
    bool from_surface = false;  // it begins on a triangle
  };
  RayHits Cast(const Vector3d& p, const Vector3d& direction) const;
  void CastBelow(int node, const Vector3d& p, const Vector3d& direction, RayHits& hits) const;
  void CastOn(int triangle, const Vector3d& p, const Vector3d& direction, RayHits& hits) const;
  // A vertex of the piece, and a point as far inside as a few of its triangles tell.
  void AddProbes(const std::vector<int>& piece);
  double ConvexDepth(const Vector3d& p, Vector3d& out) const;
};

}  // namespace mjcf_pdg::verify

#endif  // MJCF_PDG_SRC_VERIFY_MESH_SOLID_H_
