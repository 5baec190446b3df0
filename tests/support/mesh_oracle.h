// A second opinion on exact meshes from a library that neither the solver nor its verifier uses:
// CGAL with exact predicates. For tests and benchmarks only, because CGAL is GPL.
//
// Round primitives are inscribed polyhedra here, so overlaps of less than kUnseen times their
// radius may be missed. A plane is a block of 100 m.
#ifndef MJCF_PDG_TESTS_SUPPORT_MESH_ORACLE_H_
#define MJCF_PDG_TESTS_SUPPORT_MESH_ORACLE_H_

#include <memory>
#include <string>
#include <vector>

#include "mjcf_pdg/scene.h"

namespace mjcf_pdg::test {

// Two geoms whose surfaces intersect or touch, or one of which contains a piece of the other.
struct OracleOverlap {
  int geom1 = -1, geom2 = -1;  // ids in the model
  bool contained = false;      // one is inside the other; their surfaces do not intersect
  // Depth of the deepest vertex or middle of a part of an edge that is inside the other [m]; 0 if
  // surfaces only touch.
  double depth = 0.0;
};

class MeshOracle {
 public:
  static constexpr double kUnseen = 2e-4;  // share of a round primitive's radius

  // Throws Error if an exact pair of the scene has a geom of an unknown kind (a mesh that collides
  // as its hull, an SDF, a height field). The scene must outlive this object.
  explicit MeshOracle(const Scene& scene);
  ~MeshOracle();

  // The kept exact pairs that overlap or touch at q.
  std::vector<OracleOverlap> Overlaps(const std::vector<double>& q);

  // True if none of them overlaps by more than `tolerance` [m].
  bool Free(const std::vector<double>& q, double tolerance);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace mjcf_pdg::test

#endif  // MJCF_PDG_TESTS_SUPPORT_MESH_ORACLE_H_
