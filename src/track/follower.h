// Follows one optimum of σ from tick to tick: one or two steps of local optimization from where it
// was, towards where the new command has moved it.
#ifndef MJCF_PDG_SRC_TRACK_FOLLOWER_H_
#define MJCF_PDG_SRC_TRACK_FOLLOWER_H_

#include "optimize/local_optimization.h"
#include "problem/workspace.h"

namespace mjcf_pdg {

class Follower {
 public:
  explicit Follower(Workspace& work)
      : work_(work), local_(work), apart_(work.problem().tables, work.problem().options.metric) {}

  // Descends from `q` (nq), which is free if `free`, at the workspace's problem. A free one moves
  // by at most `reach` [√σ, m]; one that is not moves as far as it must. The result is valid until
  // the next call; it is free, by the solver's distances, if LocalResult::free.
  const LocalResult& Follow(const VectorXd& q, bool free, double reach);
  // A configuration near `q` that keeps every required distance in full, where the verifier refuses
  // q; not free if there is none.
  const LocalResult& Retreat(const VectorXd& q);

  // √σ(from, to) [m].
  double Apart(const VectorXd& from, const VectorXd& to);

  std::int64_t lcp_steps() const { return local_.lcp_steps(); }

 private:
  Workspace& work_;
  LocalOptimization local_;
  NormEvaluator apart_;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_TRACK_FOLLOWER_H_
