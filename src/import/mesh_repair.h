// Flaws of triangle meshes as files have them, and their repair.
#ifndef MJCF_PDG_SRC_IMPORT_MESH_REPAIR_H_
#define MJCF_PDG_SRC_IMPORT_MESH_REPAIR_H_

#include "mesh/triangle_mesh.h"

namespace mjcf_pdg {

// What RepairMesh found. Counts are of triangles unless said otherwise.
struct MeshRepairs {
  int repeated_corners = 0;    // two corners are one vertex: removed
  int duplicates = 0;          // has the corners of an earlier triangle, in any order: removed
  int non_manifold_edges = 0;  // edges of more than two triangles: the surface is cut apart there
  int turned = 0;              // turned over to agree with their neighbours
  int inward_components = 0;   // closed components that were inside out: turned over
};

// The mesh of a welded one in which nothing that can be repaired unambiguously is left: see
// MeshRepairs. Of each component the majority of the triangles keeps its orientation, unless it is
// closed: then outer surfaces face outwards and cavities inwards (a component in an odd number of
// others that already faces inwards is a cavity). Vertices where the surface is cut apart are
// repeated, so the result must not be welded again.
//
// Solids that touch in a face become a component each. Two triangles with the same corners that
// face each other belong to one of two such solids each; of a sheet or solid whose every triangle
// is there for both sides, one side is kept.
TriangleMesh RepairMesh(const TriangleMesh& welded, MeshRepairs* repairs);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_IMPORT_MESH_REPAIR_H_
