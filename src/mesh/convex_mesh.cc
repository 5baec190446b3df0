#include "mesh/convex_mesh.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "mesh/mesh_components.h"
#include "mesh/triangle_bvh.h"

namespace mjcf_pdg {
namespace {

// The rounding error of a coordinate stored as float, as a share of the largest coordinate.
constexpr double kFloatRounding = 1.2e-7;
// A vertex lies on a face of the hull if it is no farther from it than this many rounding errors.
constexpr double kOnHull = 4.0;
// The most hull faces that AllVerticesOnHull may look at; a mesh that needs more counts as not
// convex.
constexpr double kMostWork = 2e7;

bool OnSurface(const Vector3d& x, const TriangleMesh& mesh, const Matrix3Xi& hull, double reach) {
  return std::any_of(hull.colwise().begin(), hull.colwise().end(), [&](const auto& corners) {
    const Vector3d p =
        NearestOnTriangle(x, mesh.vertices.col(corners[0]), mesh.vertices.col(corners[1]),
                          mesh.vertices.col(corners[2]));
    return (p - x).norm() <= reach;
  });
}

bool SameVolume(const TriangleMesh& mesh, const Matrix3Xi& hull, double rounding) {
  const TriangleMesh enclosing{mesh.vertices, hull};
  const double difference =
      std::abs(FindSolidProperties(mesh).volume) - std::abs(FindSolidProperties(enclosing).volume);
  return std::abs(difference) <= kOnHull * rounding * SurfaceArea(enclosing);
}

// Most vertices of a convex mesh are vertices of the hull; the others must lie within its faces.
bool AllVerticesOnHull(const TriangleMesh& mesh, const Matrix3Xi& hull, double rounding) {
  std::vector<char> known(static_cast<std::size_t>(mesh.vertices.cols()), 0);
  for (const int vertex : hull.reshaped()) known[vertex] = 1;
  double work = 0.0;
  for (const int vertex : mesh.triangles.reshaped()) {
    if (known[vertex]) continue;
    work += static_cast<double>(hull.cols());
    if (work > kMostWork) return false;
    if (!OnSurface(mesh.vertices.col(vertex), mesh, hull, kOnHull * rounding)) return false;
    known[vertex] = 1;
  }
  return true;
}

}  // namespace

bool IsItsOwnHull(const TriangleMesh& mesh, const Matrix3Xi& hull) {
  const double rounding = kFloatRounding * mesh.vertices.cwiseAbs().maxCoeff();
  if (!AllVerticesOnHull(mesh, hull, rounding)) return false;
  const TriangleMesh welded = WeldVertices(mesh);
  const MeshTopology topology = FindTopology(welded);
  return topology.components == 1 && topology.open_edges == 0 && topology.zero_area == 0 &&
         LocallyConvex(welded, rounding) && SameVolume(mesh, hull, rounding);
}

}  // namespace mjcf_pdg
