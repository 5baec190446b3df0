// A collision library beside our own code, on the geoms of a MuJoCo model. For library_bench alone.
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
  // Signed distance of two convex geoms (a mesh is its hull), posed as in `d`, with points and
  // normal in world axes. False: no answer.
  virtual bool Distance(const mjData& d, int geom1, int geom2, SignedGap& gap) = 0;
  // Of two meshes as their triangles: below `cutoff` and apart, else the cutoff [m] ...
  virtual double TriangleDistance(const mjData& d, int geom1, int geom2, double cutoff) = 0;
  // ... and whether some of them cross.
  virtual bool TrianglesCross(const mjData& d, int geom1, int geom2) = 0;
};

// `triangles`: mesh geoms get trees over their triangles, too. Null where this program was built
// without the library.
std::unique_ptr<Library> MakeFcl(const mjModel& m, bool triangles);
std::unique_ptr<Library> MakeCoal(const mjModel& m, bool triangles);

// One mesh's vertices and the corners of its triangles, or of its hull's.
struct MeshArrays {
  std::vector<Eigen::Vector3d> vertices;    // [m]
  std::vector<std::array<int, 3>> corners;  // of each triangle

  MeshArrays(const mjModel& m, int mesh, bool hull) {
    const std::optional<MeshHull> of = hull ? HullOf(m, mesh) : std::nullopt;
    const int* face = of ? of->faces.data() : m.mesh_face + 3 * m.mesh_faceadr[mesh];
    const int count = of ? static_cast<int>(of->faces.size()) / 3 : m.mesh_facenum[mesh];
    std::vector<int> place(m.mesh_vertnum[mesh], -1);  // a hull leaves some vertices out
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
