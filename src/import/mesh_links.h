// Which triangles go on into each other where more than two meet at an edge.
#ifndef MJCF_PDG_SRC_IMPORT_MESH_LINKS_H_
#define MJCF_PDG_SRC_IMPORT_MESH_LINKS_H_

#include <vector>

#include "mesh/mesh_edges.h"
#include "mesh/triangle_mesh.h"

namespace mjcf_pdg {

// Two triangles that belong together at an edge; each is in at most one link there.
struct Link {
  EdgeUse a, b;
};

// At edges of two triangles, and where the ways around the ends of an edge decide. Orientation is
// not looked at.
std::vector<Link> FindCertainLinks(const Eigen::Matrix3Xi& triangles);

// The same, and where solids follow each other around an edge: the two triangles of each belong
// together, so that solids that touch come apart. For consistent orientation.
std::vector<Link> FindLinks(const TriangleMesh& mesh);

// Repeats vertices so that triangles hang together by links only. Returns the number of edges of
// more than two triangles; if there are none, nothing changes.
int CutApart(const std::vector<Link>& links, TriangleMesh* mesh);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_IMPORT_MESH_LINKS_H_
