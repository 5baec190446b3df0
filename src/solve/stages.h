// The stages that a search goes through, for a scene or for an island of it.
#ifndef MJCF_PDG_SRC_SOLVE_STAGES_H_
#define MJCF_PDG_SRC_SOLVE_STAGES_H_

#include <cstdint>
#include <memory>

#include "bound/lower_bound.h"
#include "problem/strategy.h"
#include "problem/workspace.h"
#include "solve/acceptance.h"
#include "verify/verifier.h"

namespace mjcf_pdg {

struct Stages {
  // Both arguments must outlive this object.
  Stages(Workspace& w, Verifier& verifier);
  Stages(const Stages&) = delete;
  Stages& operator=(const Stages&) = delete;

  // The lower bound and the search, from the overlaps at q_in, where the finder stands; `distances`
  // is what the query for them took. The outcome is valid until the next call. The bound is left
  // out, and 0, where neither the search nor the report wants it.
  Outcome& Search(const std::vector<NearPair>& overlaps, int distances, const VectorXd* hint,
                  const VectorXd* of_fewer = nullptr);
  double sigma_lower_bound() const { return sigma_lower_bound_; }  // of the last search [m²]

  // The calls of finders since construction, the workspace's included.
  std::int64_t Queries() const { return work.finder.queries() + strategy->other_queries(); }

  Workspace& work;
  LowerBound bound;
  std::unique_ptr<Strategy> strategy;
  Acceptance acceptance;

 private:
  // A bound that may be tighter, where a free configuration with this σ is known [m²]. As it takes
  // longer than some queries, the search asks for it when starts agree, and the report in the end.
  double Tighten(double sigma);

  double sigma_lower_bound_ = 0.0;
  double tightened_ = 0.0;  // the σ for which the bound was tightened last; infinite: none [m²]
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_SOLVE_STAGES_H_
