#include "search/trials.h"

#include <algorithm>
#include <utility>

#include "base/tuning.h"

namespace mjcf_pdg {

namespace tune = tuning::starts;

LocalOptions Coarse() {
  LocalOptions options;
  options.max_iterations = tuning::descent::kCoarseSteps;
  options.convergence = tuning::descent::kCoarseConvergence;
  return options;
}

void Trials::Begin(const EffortPlan& plan, const StrategyInput& input, double depth,
                   bool meshes_overlap) {
  outcome_.Clear();
  needs_start_ = true;
  rule_.Begin(plan, input, depth, meshes_overlap);
}

bool Trials::Try(const VectorXd& q, Component start, const LocalOptions& options) {
  if (Spent() && (outcome_.starts > 0 || !needs_start_)) return false;
  ++outcome_.starts;
  LocalOptions bounded = options;
  bounded.start = start;
  if (HasFree() && problem_.Uses(Component::kEarlyExit)) {
    bounded.give_up_sigma = tune::kGiveUp * BestSigma();
    bounded.known = &Best();
    bounded.known_sigma = BestSigma();
  }
  const LocalResult& result = local_.Run(q, bounded);
  outcome_.iterations += result.iterations;
  rule_.Count(result, start, BestSigma());
  if (result.free && !HasFree()) rule_.FirstFree(local_.lcp_steps());
  Keep(result, start);
  return !result.hopeless;
}

void Trials::Keep(const LocalResult& result, Component start) {
  if (result.free) {
    outcome_.free.Insert(result.q, result.sigma, start);
    return;
  }
  const auto keep = [&](Candidate& candidate) {
    candidate.q = result.q;
    candidate.sigma = result.sigma;
    candidate.start = start;
  };
  if (!outcome_.has_overlap || result.violation < outcome_.least_violation) {
    outcome_.has_overlap = true;
    outcome_.least_violation = result.violation;
    keep(outcome_.least_overlap);
  }
  if (!result.hopeless && result.sigma < outcome_.nearest_overlap.sigma) {
    keep(outcome_.nearest_overlap);
  }
}

bool Trials::Polish(Candidate& candidate) {
  const LocalResult& polished = local_.Run(candidate.q, LocalOptions::Polishing());
  outcome_.iterations += polished.iterations;
  const bool nearer = polished.free && polished.sigma < candidate.sigma;
  if (nearer) {
    candidate.q = polished.q;
    candidate.sigma = polished.sigma;
  }
  return nearer;
}

}  // namespace mjcf_pdg
