// A smooth primitive against a triangle mesh: nearest point, features within a margin, overlap.
//
// With f the primitive's signed distance (primitive_sdf.h), the least f over the mesh's triangles
// is the pair's distance when it is positive. Branch and bound over the mesh's tree: over a box, f
// is at least its linearization at the centre.
//
// Overlap of a closed mesh and a primitive: its depth is the largest of -f over the mesh's surface
// and of the depth of a point of the primitive inside the mesh, sought from support points along
// the normals of the mesh's nearest faces. As in bvh_overlap.h, ways out along which the surfaces
// face the same way count only if there is no other. A sphere whose nearest face is flat gets its
// exact penetration depth.
// Tree units (triangle_bvh.h), in the mesh's frame; gap.p1 is on the primitive, gap.p2 on the mesh
// and n points from the primitive to the mesh.
#ifndef MJCF_PDG_SRC_COLLIDE_EXACT_SDF_MESH_H_
#define MJCF_PDG_SRC_COLLIDE_EXACT_SDF_MESH_H_

#include <vector>

#include "collide/exact/bvh_overlap.h"
#include "collide/exact/primitive_sdf.h"

namespace mjcf_pdg {

struct SdfNearest {
  double f = std::numeric_limits<double>::infinity();
  Vector3d x = Vector3d::Zero();  // on the mesh
  int triangle = -1;              // -1: nothing below the cutoff
};

class SdfMesh {
 public:
  // `mesh_in_field`: the mesh's frame in the primitive's. `field` is in tree units.
  SdfMesh(const PrimitiveSdf& field, const TriangleBvh& mesh, const RelativePose& mesh_in_field)
      : field_(field), mesh_(mesh), pose_(mesh_in_field) {}

  // The least f over the mesh, if it is below `cutoff`. `warm`: a triangle, or -1.
  SdfNearest Nearest(double cutoff, int warm = -1) const;
  // The primitive is inside the closed mesh. To be asked when the least f is not negative.
  bool Contained() const;
  SignedGap Gap(const SdfNearest& nearest) const;

  // As BvhPair::Features and AppendOverlaps. `first`: the result of Nearest(margin).
  void Features(double margin, const SdfNearest& first, std::vector<SignedGap>& out) const;
  void AppendOverlaps(std::vector<SignedGap>& out) const;

 private:
  SdfNearest Below(int box, double cutoff, int warm) const;
  void Descend(int box, SdfNearest& best) const;
  void AskTriangle(int triangle, SdfNearest& best) const;
  double LowerBound(int box) const;
  BoundedBoxes ChildrenBelow(int box, double cutoff) const;
  // Of each patch its least f, if below the margin.
  void Patches(double margin, double patch, const SdfNearest& first,
               std::vector<SdfNearest>& out) const;
  double PatchSize(double margin) const;
  void AppendWayFromWithin(const Vector3d& p, Vector3d outward, std::vector<WayOut>& ways) const;

  const PrimitiveSdf field_;
  const TriangleBvh& mesh_;
  const RelativePose pose_;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_COLLIDE_EXACT_SDF_MESH_H_
