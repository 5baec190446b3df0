// Tests whether a mesh is its own convex hull. Distances of convex geoms are then exact for it, and
// its triangles need not be looked at (MarkExactGeoms).
#ifndef MJCF_PDG_SRC_MESH_CONVEX_MESH_H_
#define MJCF_PDG_SRC_MESH_CONVEX_MESH_H_

#include "mesh/triangle_mesh.h"

namespace mjcf_pdg {

// True if the surface is that of the convex hull `hull` (triangles of mesh.vertices): every vertex
// lies on the hull, the surface is closed and in one piece, no edge is reflex, and the volume is
// the hull's (without that, star polyhedra would pass). Lengths are compared to within a few float
// roundings of the largest coordinate. Also false if the test would take too long.
bool IsItsOwnHull(const TriangleMesh& mesh, const Eigen::Matrix3Xi& hull);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_MESH_CONVEX_MESH_H_
