// Repairs flaws that triangle meshes have in files: repeated and duplicate triangles, inconsistent
// orientation, edges with more than two triangles.
#ifndef MJCF_PDG_SRC_IMPORT_MESH_REPAIR_H_
#define MJCF_PDG_SRC_IMPORT_MESH_REPAIR_H_

#include "mesh/triangle_mesh.h"

namespace mjcf_pdg {

// What RepairMesh did.
struct MeshRepairs {
  int repeated_corners = 0;    // triangles removed because two of their corners are one vertex
  int duplicates = 0;          // triangles removed because another one has the same corners
  int non_manifold_edges = 0;  // edges of more than two triangles, where the surface was cut apart
  int turned = 0;              // triangles turned over to agree with their neighbours
  int inward_components = 0;   // closed components turned over because they were inside out
};

// Returns the mesh, whose vertices must have been welded, with all flaws repaired that can be
// repaired unambiguously; `repairs` says which. In each component the majority of the triangles
// keeps its orientation. A closed component that no other contains and that faces inwards is then
// turned over, together with the closed components inside it, which may be its cavities. Vertices
// are repeated where the surface is cut apart, so the result must not be welded again.
//
// Solids that touch in a face become one component each: two triangles with the same corners and
// opposite orientations there belong to one solid each. A sheet or solid that has each of its
// triangles in both orientations keeps one of the two.
TriangleMesh RepairMesh(const TriangleMesh& welded, MeshRepairs* repairs);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_IMPORT_MESH_REPAIR_H_
