// A second opinion on exact meshes, from a library that neither the solver nor its verifier uses:
// CGAL, with exact predicates. For tests and benchmarks only (CGAL is GPL).
//
// Round primitives are inscribed polyhedra here: overlaps of less than kUnseen of their radius may
// go unnoticed. A plane is a block of 100 m.
#ifndef MJCF_PDG_TESTS_SUPPORT_MESH_ORACLE_H_
#define MJCF_PDG_TESTS_SUPPORT_MESH_ORACLE_H_

#include <memory>
#include <string>
#include <vector>

#include "mjcf_pdg/scene.h"

namespace mjcf_pdg::test {

// Two geoms whose surfaces intersect or touch, or of which one contains a piece of the other.
struct OracleOverlap {
  int geom1 = -1, geom2 = -1;
  bool contained = false;  // no surfaces intersect
  // The deepest vertex or edge found inside the other [m]; 0 where surfaces only touch.
  double depth = 0.0;
};

class MeshOracle {
 public:
  static constexpr double kUnseen = 2e-4;

  // Throws Error for an exact pair with a geom of a kind that it does not know (a mesh that
  // collides as its hull, SDF, height field). The scene must outlive this object.
  explicit MeshOracle(const Scene& scene);
  ~MeshOracle();

  // The exact pairs that overlap at q, of those that are kept.
  std::vector<OracleOverlap> Overlaps(const std::vector<double>& q);

  // None overlaps by more than `tolerance` [m].
  bool Free(const std::vector<double>& q, double tolerance);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace mjcf_pdg::test

#endif  // MJCF_PDG_TESTS_SUPPORT_MESH_ORACLE_H_
