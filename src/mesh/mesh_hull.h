// A mesh's convex hull as MuJoCo stores it.
#ifndef MJCF_PDG_SRC_MESH_MESH_HULL_H_
#define MJCF_PDG_SRC_MESH_MESH_HULL_H_

#include <mujoco/mujoco.h>

#include <optional>
#include <span>

namespace mjcf_pdg {

struct MeshHull {
  // Both count from the mesh's first vertex.
  std::span<const int> vertices;
  std::span<const int> faces;  // three vertices each
  // Per hull vertex, where its neighbours begin in `edges`: places in `vertices`, then -1.
  std::span<const int> first_edge, edges;
};

// Refers to the model. None where MuJoCo has no hull of the mesh.
std::optional<MeshHull> HullOf(const mjModel& m, int mesh);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_MESH_MESH_HULL_H_
