// Whether a mesh is its own convex hull: then MuJoCo's collisions, which are of hulls, are exact.
#ifndef MJCF_PDG_SRC_MESH_CONVEX_MESH_H_
#define MJCF_PDG_SRC_MESH_CONVEX_MESH_H_

#include "mesh/triangle_mesh.h"

namespace mjcf_pdg {

// Does the surface enclose the convex hull, given as triangles of the same vertices, and nothing
// less? Up to a few roundings of the largest coordinate to float. Every vertex must lie on the
// hull, the surface must be closed and in one piece, no edge may be reflex, and the volume must be
// the hull's (star polyhedra pass the rest). False, too, where the answer would take too long.
bool IsItsOwnHull(const TriangleMesh& mesh, const Eigen::Matrix3Xi& hull);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_MESH_CONVEX_MESH_H_
