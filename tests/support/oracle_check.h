// Asks both the library's own verifier and CGAL whether a configuration is free, as a solve
// promises.
#ifndef MJCF_PDG_TESTS_SUPPORT_ORACLE_CHECK_H_
#define MJCF_PDG_TESTS_SUPPORT_ORACLE_CHECK_H_

#include <gtest/gtest.h>

#include <vector>

#include "mjcf_pdg/pdg.h"
#include "tests/support/mesh_oracle.h"

namespace mjcf_pdg::test {

// Success if both find q free, CGAL with overlaps of up to `tolerance` [m].
inline ::testing::AssertionResult FreeByBoth(const Scene& scene, const std::vector<double>& q,
                                             double tolerance = 1e-6) {
  const Verdict verdict = Verify(scene, q);
  if (!verdict.free) return ::testing::AssertionFailure() << "Verify: " << verdict.reason;
  for (const OracleOverlap& overlap : MeshOracle(scene).Overlaps(q)) {
    if (overlap.depth <= tolerance) continue;
    return ::testing::AssertionFailure() << "CGAL: geoms " << overlap.geom1 << " and "
                                         << overlap.geom2 << " overlap by " << overlap.depth;
  }
  return ::testing::AssertionSuccess();
}

}  // namespace mjcf_pdg::test

#endif  // MJCF_PDG_TESTS_SUPPORT_ORACLE_CHECK_H_
