// A smooth primitive against a triangle mesh: nearest point, features within a margin, overlap.
//
// With f the primitive's signed distance (convex_field.h), the least f over the mesh's triangles is
// the pair's distance when it is positive. Branch and bound over the mesh's tree: over a box, f is
// at least its linearization at the centre.
//
// Overlap of a closed mesh and a primitive: its depth is the largest of -f over the mesh's surface
// and of the depth of a point of the primitive inside the mesh, sought from support points along
// the normals of the mesh's nearest faces. As in solid_overlap.h, ways out along which the surfaces
// face the same way count only if there is no other. A sphere whose nearest face is flat gets its
// exact penetration depth.
// Tree units (solid.h), in the mesh's frame; gap.p1 is on the primitive, gap.p2 on the mesh and n
// points from the primitive to the mesh.
#ifndef MJCF_PDG_SRC_COLLIDE_EXACT_FIELD_MESH_H_
#define MJCF_PDG_SRC_COLLIDE_EXACT_FIELD_MESH_H_

#include <vector>

#include "collide/exact/convex_field.h"
#include "collide/exact/solid_overlap.h"

namespace mjcf_pdg {

struct FieldNearest {
  double f = std::numeric_limits<double>::infinity();
  Vector3d x = Vector3d::Zero();  // on the mesh
  int triangle = -1;              // -1: nothing below the cutoff
};

class FieldMesh {
 public:
  // `mesh_in_field`: the mesh's frame in the primitive's. `field` is in tree units.
  FieldMesh(const ConvexField& field, const Solid& mesh, const RelativePose& mesh_in_field)
      : field_(field), mesh_(mesh), pose_(mesh_in_field) {}

  // The least f over the mesh, if it is below `cutoff`. `warm`: a triangle, or -1.
  FieldNearest Nearest(double cutoff, int warm = -1) const;
  // The primitive is inside the closed mesh. To be asked when the least f is not negative.
  bool Contained() const;
  SignedGap Gap(const FieldNearest& nearest) const;

  // As SolidPair::Features and AppendOverlaps. `first`: the result of Nearest(margin).
  void Features(double margin, const FieldNearest& first, std::vector<SignedGap>& out) const;
  void AppendOverlaps(std::vector<SignedGap>& out) const;

 private:
  FieldNearest Below(int box, double cutoff, int warm) const;
  void Descend(int box, FieldNearest& best) const;
  void AskTriangle(int triangle, FieldNearest& best) const;
  double LowerBound(int box) const;
  BoundedBoxes ChildrenBelow(int box, double cutoff) const;
  // Of each patch its least f, if below the margin.
  void Patches(double margin, double patch, const FieldNearest& first,
               std::vector<FieldNearest>& out) const;
  double PatchSize(double margin) const;
  void AppendWayFromWithin(const Vector3d& p, Vector3d outward, std::vector<WayOut>& ways) const;

  const ConvexField field_;
  const Solid& mesh_;
  const RelativePose pose_;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_COLLIDE_EXACT_FIELD_MESH_H_
