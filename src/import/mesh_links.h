// Which triangles continue each other where more than two meet at an edge, and cutting a surface
// apart there. Used by mesh_repair.
#ifndef MJCF_PDG_SRC_IMPORT_MESH_LINKS_H_
#define MJCF_PDG_SRC_IMPORT_MESH_LINKS_H_

#include <vector>

#include "mesh/mesh_edges.h"
#include "mesh/triangle_mesh.h"

namespace mjcf_pdg {

// Two triangles that continue each other across an edge. At an edge, a triangle is in at most one
// link.
struct Link {
  EdgeUse a, b;
};

// Returns the links that do not depend on the triangles' orientation: at edges of two triangles,
// and, at other edges, of two triangles whose corners are connected through such links around both
// ends of the edge.
std::vector<Link> FindCertainLinks(const Eigen::Matrix3Xi& triangles);

// Returns the certain links and those at edges where solids follow each other around the edge.
// There the two triangles of each solid are linked, so that solids that touch come apart. The
// triangles must be oriented consistently.
std::vector<Link> FindLinks(const TriangleMesh& mesh);

// Repeats vertices until triangles share them through links only. Returns the number of edges with
// more than two triangles; if there are none, the mesh is not changed.
int CutApart(const std::vector<Link>& links, TriangleMesh* mesh);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_IMPORT_MESH_LINKS_H_
