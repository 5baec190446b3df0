// The connected components of a triangle mesh's surface, and which of them are inside others: for
// mesh import (import/mesh_repair) and the convexity test (convex_mesh.h).
#ifndef MJCF_PDG_SRC_MESH_MESH_COMPONENTS_H_
#define MJCF_PDG_SRC_MESH_MESH_COMPONENTS_H_

#include <Eigen/Dense>
#include <vector>

#include "mesh/triangle_mesh.h"

namespace mjcf_pdg {

struct MeshTopology {
  int components = 0;
  int open_edges = 0;  // edges not used once in each direction; 0: the surface is closed
  int zero_area = 0;   // triangles with collinear corners, which may be needed to close the surface
  // Components inside others whose orientation does not fit: those inside an odd number of others
  // are cavities and must face inwards, those inside an even number outwards. Otherwise the volume
  // inside them counts twice.
  int nested_components = 0;
};

// Counts for a mesh whose vertices are welded. Two triangles are connected if they are the only two
// at a common edge.
MeshTopology FindTopology(const TriangleMesh& mesh);

struct MeshComponent {
  std::vector<Eigen::Index> members;  // its triangles: columns of the whole mesh's `triangles`
  Eigen::Matrix3Xi triangles;         // these columns
  bool closed = false;
  double volume = 0.0;               // [m³], negative if triangles face inwards; 0 if not closed
  Eigen::AlignedBox3d box;           // its axis-aligned bounding box
  std::vector<int> containers = {};  // the closed components that it is inside, if it is closed
};

// The components of a mesh whose vertices are welded, in the order of their first triangles.
std::vector<MeshComponent> FindComponents(const TriangleMesh& mesh);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_MESH_MESH_COMPONENTS_H_
