// Counts how many free answers of a solver CGAL (tests/support/mesh_oracle.h) confirms.
#ifndef MJCF_PDG_BENCH_ORACLE_TALLY_H_
#define MJCF_PDG_BENCH_ORACLE_TALLY_H_

#include <algorithm>
#include <cstdio>

#include "mjcf_pdg/pdg.h"
#include "tests/support/mesh_oracle.h"

namespace mjcf_pdg::bench {

class OracleTally {
 public:
  // The scene must outlive this object. An overlap deeper than `tolerance` [m] is a failure.
  OracleTally(const Scene& scene, double tolerance) : oracle_(scene), tolerance_(tolerance) {}

  // Asks CGAL about an answer, unless it is unsolved.
  void Ask(const Result& result) {
    if (result.status == Status::kUnsolved) return;
    ++asked_;
    double depth = -1.0;
    for (const test::OracleOverlap& overlap : oracle_.Overlaps(result.q)) {
      depth = std::max(depth, overlap.depth);
    }
    failed_ += depth > tolerance_;
    touching_ += depth >= 0.0 && depth <= tolerance_;
    deepest_ = std::max(deepest_, depth);
  }

  int asked() const { return asked_; }
  int failed() const { return failed_; }

  void Print() const {
    std::printf("  CGAL: %d free answers asked, %d failed, %d touch; deepest overlap %.1e m\n",
                asked_, failed_, touching_, deepest_);
  }

 private:
  test::MeshOracle oracle_;
  double tolerance_;
  int asked_ = 0, failed_ = 0, touching_ = 0;
  double deepest_ = 0.0;  // [m]
};

}  // namespace mjcf_pdg::bench

#endif  // MJCF_PDG_BENCH_ORACLE_TALLY_H_
