#include "mesh/mesh_hull.h"

#include <cstddef>

namespace mjcf_pdg {

// A mesh's part of mesh_graph is: numvert, numface, vert_edgeadr[numvert], vert_globalid[numvert],
// edge_localid[numvert + 3 numface], face_globalid[3 numface].
std::optional<MeshHull> HullOf(const mjModel& m, int mesh) {
  if (m.mesh_graphadr[mesh] < 0) return std::nullopt;
  const int* graph = m.mesh_graph + m.mesh_graphadr[mesh];
  const auto num_vertices = static_cast<std::size_t>(graph[0]);
  const auto num_corners = 3 * static_cast<std::size_t>(graph[1]);
  const std::size_t num_edges = num_vertices + num_corners;
  const int* first_edge = graph + 2;
  const int* vertices = first_edge + num_vertices;
  const int* edges = vertices + num_vertices;
  const int* faces = edges + num_edges;
  return MeshHull{{vertices, num_vertices},
                  {faces, num_corners},
                  {first_edge, num_vertices},
                  {edges, num_edges}};
}

}  // namespace mjcf_pdg
