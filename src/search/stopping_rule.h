// What decides when a search ends.
//
// A search ends early when the best answer is as near as is proven, or when enough independent
// starts have ended at it: fewer of them where the lower bound is not far below, for contacts that
// hardly interact leave few other optima. It ends late by a budget of collision queries and of
// estimated time. Time is estimated from counts, not read from a clock, so that answers repeat.
// Measured on 7700 random problems of nine robots (bench/README.md, Agreement).
#ifndef MJCF_PDG_SRC_SEARCH_STOPPING_RULE_H_
#define MJCF_PDG_SRC_SEARCH_STOPPING_RULE_H_

#include <cstdint>

#include "optimize/local_optimization.h"
#include "problem/effort.h"
#include "problem/strategy.h"
#include "problem/workspace.h"

namespace mjcf_pdg {

class StoppingRule {
 public:
  explicit StoppingRule(const Workspace& work) : work_(work) {}

  // A search begins. `depth`: how far q_in must be parted [m]; `meshes_overlap`: some as triangles.
  void Begin(const EffortPlan& plan, const StrategyInput& input, double depth, bool meshes_overlap);
  // The bound on queries counts from here again.
  void RenewQueries() { first_query_ = work_.finder.queries(); }
  // The first free configuration was found after so many steps of the LCP.
  void FirstFree(std::int64_t lcp_steps);

  // Another start ended, before its result joins the candidates; `best_sigma` is theirs, infinite
  // if there is none [m²].
  void Count(const LocalResult& result, Component start, double best_sigma);

  // Of a search whose best answer has `best_sigma`, finite.
  bool Done(double best_sigma, std::int64_t lcp_steps) const;
  // The best answer is farther than so many depths, or there is none.
  bool Exceeds(double depths, double best_sigma) const {
    return best_sigma > depths * depths * depth_ * depth_;
  }

 private:
  double Evaluations(std::int64_t lcp_steps) const;

  const Workspace& work_;
  EffortPlan plan_;
  double sigma_lower_bound_ = 0.0;  // [m²]
  int distances_at_input_ = 0;
  double depth_ = 0.0;  // [m]
  bool meshes_overlap_ = false;
  int agreeing_ =
      0;  // independent starts that converged to the best answer or were stopped near it
  std::int64_t first_query_ = 0, first_box_test_ = 0;  // the finder's counts as the search begins
  // ... and as the first answer is free.
  std::int64_t free_query_ = 0, free_distance_ = 0, free_lcp_step_ = 0;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_SEARCH_STOPPING_RULE_H_
