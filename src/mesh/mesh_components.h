// The connected surfaces of a triangle mesh, and which of them are inside which.
#ifndef MJCF_PDG_SRC_MESH_MESH_COMPONENTS_H_
#define MJCF_PDG_SRC_MESH_MESH_COMPONENTS_H_

#include <Eigen/Dense>
#include <vector>

#include "mesh/triangle_mesh.h"

namespace mjcf_pdg {

struct MeshTopology {
  int components = 0;
  int open_edges = 0;         // not used once in each direction; 0: the surface is closed
  int zero_area = 0;          // triangles with collinear corners, which may be needed to close it
  int nested_components = 0;  // inside another one without being its cavity: counted twice
};

// Of a repaired mesh; components are connected by edges of two triangles.
MeshTopology FindTopology(const TriangleMesh& mesh);

struct MeshComponent {
  std::vector<Eigen::Index> members;  // triangles of the whole mesh
  Eigen::Matrix3Xi triangles;         // those
  bool closed = false;
  double volume = 0.0;  // if closed
  Eigen::AlignedBox3d box;
  std::vector<int> containers = {};  // closed components around it
};

// With their containers.
std::vector<MeshComponent> FindComponents(const TriangleMesh& mesh);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_MESH_MESH_COMPONENTS_H_
