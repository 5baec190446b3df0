// What decides when a search ends that has found something free. (Until then VariedStarts goes on,
// up to EffortPlan::blind starts, or until the budget is spent.)
//
// A search ends when its best answer is proven to be the nearest (σ within 1 % of the lower bound),
// or when enough independent starts have ended at that answer: the more, the farther √σ is above
// its bound, for near the bound there is little room for another optimum. An answer on which so
// many agree as could be enough gets a tighter bound of its own. Starts that were given up, since
// they promised nothing nearer, count as well, but little. Without agreement it ends when it has
// used its collision queries or its estimated time, both from problem/effort.h.
// Trees that move share the queries: a start draws all of them anew, and is of use only if all of
// them fare well together, which soon becomes unlikely. In heaps of 10 to 40 bodies all later
// starts together lowered σ by less than 1 % in the median, for 3 to 11 times the queries.
// Time is estimated from counts instead of read from a clock, so that answers repeat. The numbers
// were chosen on random problems of nine robots (bench/README.md, Agreement).
#ifndef MJCF_PDG_SRC_SEARCH_STOPPING_RULE_H_
#define MJCF_PDG_SRC_SEARCH_STOPPING_RULE_H_

#include <algorithm>
#include <cstdint>
#include <functional>

#include "optimize/local_optimization.h"
#include "problem/effort.h"
#include "problem/strategy.h"
#include "problem/workspace.h"

namespace mjcf_pdg {

class StoppingRule {
 public:
  explicit StoppingRule(const Workspace& work) : work_(work) {}

  // Begins a search. `depth` is the deepest overlap at q_in [m]; `meshes_overlap` says whether
  // pairs that collide as triangles overlap there.
  void Begin(const EffortPlan& plan, const StrategyInput& input, double depth, bool meshes_overlap);
  // No free configuration has a smaller σ than this [m²].
  void Prove(double sigma) { sigma_lower_bound_ = std::max(sigma_lower_bound_, sigma); }
  // Counts queries from here on, as if the search began here.
  void RenewQueries() { first_query_ = work_.finder.queries(); }
  // The first free configuration has been found; `lcp_steps` is the count of LCP steps then.
  void FirstFree(std::int64_t lcp_steps);

  // Counts a start that ended with `result`. `best_sigma` is that of the candidates before the
  // result joins them, infinite if there are none [m²].
  void Count(const LocalResult& result, Component start, double best_sigma);

  // Whether a search whose best answer has `best_sigma`, finite, may end [m²].
  bool Done(double best_sigma, std::int64_t lcp_steps);
  // Whether √(best_sigma) is more than `depths` times the deepest overlap at q_in; true if there is
  // no answer.
  bool Exceeds(double depths, double best_sigma) const {
    return best_sigma > depths * depths * depth_ * depth_;
  }

 private:
  // Whether enough starts agree. May tighten the bound.
  bool Agreed(double best_sigma);
  double Evaluations(std::int64_t lcp_steps) const;

  const Workspace& work_;
  EffortPlan plan_;
  double sigma_lower_bound_ = 0.0;  // [m²]
  std::function<double(double)> tighten_;
  double tightened_ = 0.0;  // the σ for which the bound was tightened last; infinite: none [m²]
  int trees_ = 1;           // kinematic trees that may move
  int distances_at_input_ = 0;
  double depth_ = 0.0;  // [m]
  bool meshes_overlap_ = false;
  int agreeing_ = 0;  // independent starts that ended at the best answer, or close to it
  int given_up_ = 0;  // ... that were given up since the best answer was found
  // The finder's counts when the search began, and when the first free configuration was found.
  std::int64_t first_query_ = 0, first_box_test_ = 0;
  std::int64_t free_query_ = 0, free_distance_ = 0, free_lcp_step_ = 0;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_SEARCH_STOPPING_RULE_H_
