// The trials of one search: each start goes through local optimization, and what is free joins the
// candidates. No start is trusted; the best free answer wins.
#ifndef MJCF_PDG_SRC_SEARCH_TRIALS_H_
#define MJCF_PDG_SRC_SEARCH_TRIALS_H_

#include <cstdint>
#include <limits>

#include "optimize/local_optimization.h"
#include "problem/strategy.h"
#include "problem/workspace.h"
#include "search/stopping_rule.h"

namespace mjcf_pdg {

class Trials {
 public:
  explicit Trials(Workspace& work)
      : problem_(work.problem()), work_(work), rule_(work), local_(work) {
    outcome_.Reserve(static_cast<int>(problem_.tables.model->nq));
  }

  void Begin(const EffortPlan& plan, const StrategyInput& input, double depth, bool meshes_overlap);

  // Allows a search whose budget is spent to make no start at all, because there is a hint to fall
  // back on. Otherwise it makes one.
  void NeedNoStart() { needs_start_ = false; }

  // Descends from q and keeps what it finds; without budget it does nothing. Returns false if
  // nothing was done or the descent was given up because it led to nothing better.
  bool Try(const VectorXd& q, Component start, const LocalOptions& options);
  // Descends from the candidate to full precision. Returns true, and changes it, if that is nearer.
  bool Polish(Candidate& candidate);
  bool Retreat(const Candidate& candidate, VectorXd& q) {
    return mjcf_pdg::Retreat(local_, candidate, outcome_, q);
  }

  bool HasFree() const { return !outcome_.free.empty(); }
  const VectorXd& Best() const { return outcome_.free.front().q; }  // HasFree
  double BestSigma() const {
    return HasFree() ? outcome_.free.front().sigma : std::numeric_limits<double>::infinity();
  }
  bool Done() { return HasFree() && rule_.Done(BestSigma(), local_.lcp_steps()); }
  bool Exceeds(double depths) const { return rule_.Exceeds(depths, BestSigma()); }
  // Whether the budget of the whole solve is spent.
  bool Spent() const { return work_.Spent(); }
  void RenewQueries() { rule_.RenewQueries(); }
  // No free configuration has a smaller σ than this [m²].
  void Prove(double sigma) {
    rule_.Prove(sigma);
    outcome_.sigma_lower_bound = sigma;
  }

  Outcome& outcome() { return outcome_; }
  std::int64_t lcp_steps() const { return local_.lcp_steps(); }

 private:
  void Keep(const LocalResult& result, Component start);

  const Problem& problem_;
  Workspace& work_;
  StoppingRule rule_;
  LocalOptimization local_;
  Outcome outcome_;
  bool needs_start_ = true;
};

// How to descend from a start: less precisely, for whether it leads to something better shows
// early, and the best answer is polished in the end.
LocalOptions Coarse();

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_SEARCH_TRIALS_H_
