// The convex hull of a mesh asset, as MuJoCo stores it in mjModel::mesh_graph.
#ifndef MJCF_PDG_SRC_MESH_MESH_HULL_H_
#define MJCF_PDG_SRC_MESH_MESH_HULL_H_

#include <mujoco/mujoco.h>

#include <optional>
#include <span>

namespace mjcf_pdg {

// Spans of the model's arrays.
struct MeshHull {
  std::span<const int> vertices;  // the hull's vertices, as numbers of the mesh's vertices
  std::span<const int> faces;     // three corners each, as numbers of the mesh's vertices
  // The neighbours of vertices[k] begin at edges[first_edge[k]], as indices into `vertices`, and
  // end with -1.
  std::span<const int> first_edge, edges;
};

// The hull of mesh asset `mesh`; nothing if MuJoCo has none. Valid as long as the model.
std::optional<MeshHull> HullOf(const mjModel& m, int mesh);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_MESH_MESH_HULL_H_
