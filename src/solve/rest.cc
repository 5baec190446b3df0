#include "solve/rest.h"

#include <cstddef>
#include <limits>
#include <vector>

namespace mjcf_pdg {

void DistancesAtRest(const Verifier& verifier, const SceneTables& tables, VectorXd& at_rest) {
  const std::vector<KeptPair>& pairs = tables.pairs;
  at_rest.resize(static_cast<Eigen::Index>(pairs.size()));
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const double depth = verifier.DepthAtRest(pairs[k].geom1, pairs[k].geom2);
    at_rest[static_cast<Eigen::Index>(k)] =
        depth < 0.0 ? depth : std::numeric_limits<double>::infinity();
  }
}

}  // namespace mjcf_pdg
