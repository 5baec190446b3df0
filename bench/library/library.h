// The interface of a collision library that library_bench compares with our own code, on the geoms
// of a MuJoCo model.
#ifndef MJCF_PDG_BENCH_LIBRARY_LIBRARY_H_
#define MJCF_PDG_BENCH_LIBRARY_LIBRARY_H_

#include <mujoco/mujoco.h>

#include <Eigen/Dense>
#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "base/signed_gap.h"
#include "mesh/mesh_hull.h"

namespace mjcf_pdg::bench {

class Library {
 public:
  virtual ~Library() = default;
  virtual const char* name() const = 0;
  // Sets `gap` to the signed distance of two convex geoms (a mesh is its hull) at the poses in `d`,
  // with witness points and normal in world axes. Returns false if the library has no answer.
  virtual bool Distance(const mjData& d, int geom1, int geom2, SignedGap& gap) = 0;
  // Whether two convex geoms overlap; nothing if the library has no answer.
  virtual std::optional<bool> Overlap(const mjData& d, int geom1, int geom2) = 0;
  // The distance [m] of two meshes as their triangles, which do not cross; `cutoff` if it is not
  // less.
  virtual double TriangleDistance(const mjData& d, int geom1, int geom2, double cutoff) = 0;
  // True if some triangles of two meshes cross.
  virtual bool TrianglesCross(const mjData& d, int geom1, int geom2) = 0;
};

// Make a library with the geoms of `m`; with `triangles`, mesh geoms also get trees over their
// triangles. They return null if this program was built without the library.
std::unique_ptr<Library> MakeFcl(const mjModel& m, bool triangles);
std::unique_ptr<Library> MakeCoal(const mjModel& m, bool triangles);

// The vertices and triangles of one mesh, or of its convex hull.
struct MeshArrays {
  std::vector<Eigen::Vector3d> vertices;    // [m]
  std::vector<std::array<int, 3>> corners;  // by triangle, indices of its vertices

  MeshArrays(const mjModel& m, int mesh, bool hull) {
    const std::optional<MeshHull> of = hull ? HullOf(m, mesh) : std::nullopt;
    const int* face = of ? of->faces.data() : m.mesh_face + 3 * m.mesh_faceadr[mesh];
    const int count = of ? static_cast<int>(of->faces.size()) / 3 : m.mesh_facenum[mesh];
    // New index of each vertex; -1: none yet. A hull leaves some vertices out.
    std::vector<int> place(m.mesh_vertnum[mesh], -1);
    for (int t = 0; t < count; ++t) {
      std::array<int, 3>& triangle = corners.emplace_back();
      for (int k = 0; k < 3; ++k) {
        const int vertex = face[3 * t + k];
        if (place[vertex] < 0) {
          place[vertex] = static_cast<int>(vertices.size());
          const float* p = m.mesh_vert + 3 * (m.mesh_vertadr[mesh] + vertex);
          vertices.emplace_back(p[0], p[1], p[2]);
        }
        triangle[k] = place[vertex];
      }
    }
  }
};

}  // namespace mjcf_pdg::bench

#endif  // MJCF_PDG_BENCH_LIBRARY_LIBRARY_H_
