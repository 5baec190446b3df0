// A primitive (plane, sphere, capsule, ellipsoid, cylinder) against a triangle mesh: nearest point,
// features within a margin, overlap. ExactContacts makes one SdfMesh per query of such a pair.
//
// With f the primitive's signed distance (primitive_sdf.h), the minimum of f over the mesh's
// triangles is the pair's distance if it is positive. It is found by branch and bound over the
// mesh's hierarchy of boxes: on a box, f is at least its linearization at the centre.
//
// The depth of an overlap is the largest of -f over the mesh's surface and of the depths of points
// of the primitive inside the mesh, if that is closed. Such points are sought among the support
// points against the normals of the mesh's nearest faces. As in bvh_overlap.h, ways out along which
// the surfaces face the same way are reported only if there are no others. For a sphere whose
// nearest face is flat this is the exact penetration depth.
//
// Lengths are in tree units (triangle_bvh.h). Points and directions are in the mesh's frame: gap.p1
// is on the primitive, gap.p2 on the mesh, and n points from the primitive to the mesh.
#ifndef MJCF_PDG_SRC_COLLIDE_EXACT_SDF_MESH_H_
#define MJCF_PDG_SRC_COLLIDE_EXACT_SDF_MESH_H_

#include <vector>

#include "collide/exact/bvh_overlap.h"
#include "collide/exact/primitive_sdf.h"

namespace mjcf_pdg {

// The point of the mesh, or of a part of it, where f is smallest.
struct SdfNearest {
  double f = std::numeric_limits<double>::infinity();
  Vector3d x = Vector3d::Zero();
  int triangle = -1;  // that x is on; -1: f is not below the cutoff anywhere
};

// Refers to `mesh`, which must outlive it.
class SdfMesh {
 public:
  // `field` is the primitive, its size in tree units; `mesh_in_field` the pose of the mesh's frame
  // in the primitive's.
  SdfMesh(const PrimitiveSdf& field, const TriangleBvh& mesh, const RelativePose& mesh_in_field)
      : field_(field), mesh_(mesh), pose_(mesh_in_field) {}

  // The minimum of f over the mesh, if it is below `cutoff`; otherwise triangle = -1 and f =
  // cutoff. `warm`: the triangle where f was smallest at an earlier pose, or -1.
  SdfNearest Nearest(double cutoff, int warm = -1) const;
  // True if the primitive's centre is inside the mesh. Where f is nowhere negative on the mesh, the
  // whole primitive is then inside. False for planes and meshes that are not closed.
  bool Contained() const;
  // The witness points, normal and distance that belong to a point of the mesh.
  SignedGap Gap(const SdfNearest& nearest) const;

  // Appends the features from which a contact matrix gets its rows: the minima of f on patches of
  // the mesh, where they are below `margin`. Of similar ones the nearest is kept; the nearest comes
  // first, and there are at most BvhPair::kMaxFeatures. `first` is the result of Nearest(margin).
  void Features(double margin, const SdfNearest& first, std::vector<SignedGap>& out) const;
  // Appends the overlap's gaps, with distance <= 0, in the order and number of AppendDeepest.
  void AppendOverlaps(std::vector<SignedGap>& out) const;

 private:
  // The minimum of f over the triangles below a box, as Nearest.
  SdfNearest Below(int box, double cutoff, int warm) const;
  // Replaces `best` by a point below the box, or on the triangle, if f is smaller there.
  void Descend(int box, SdfNearest& best) const;
  void AskTriangle(int triangle, SdfNearest& best) const;
  // A lower bound of f on a box, and the children of a box whose bounds are below `cutoff`.
  double LowerBound(int box) const;
  BoundedBoxes ChildrenBelow(int box, double cutoff) const;
  // Appends the minimum of f on each patch (a box of at most `patch` in diameter) where it is below
  // `margin`, the smallest first.
  void Patches(double margin, double patch, const SdfNearest& first,
               std::vector<SdfNearest>& out) const;
  double PatchSize(double margin) const;
  // Appends ways out of the mesh for points of the primitive, the first of which is the support
  // point against `outward`, the mesh's outward unit normal at its surface point p.
  void AppendWayFromWithin(const Vector3d& p, Vector3d outward, std::vector<WayOut>& ways) const;

  const PrimitiveSdf field_;
  const TriangleBvh& mesh_;
  const RelativePose pose_;  // from the mesh's frame to the primitive's
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_COLLIDE_EXACT_SDF_MESH_H_
