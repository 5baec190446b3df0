#include "search/stopping_rule.h"

#include <algorithm>

namespace mjcf_pdg {
namespace {

constexpr double kSameAnswer = 1.01;  // two answers are the same up to this ratio of their σ
constexpr double kNearProven = 5.0;   // σ over its lower bound where few starts need to agree
// Time of one query, of one pair distance and of one LCP step per degree of freedom, the latter two
// over the distances at q_in but no fewer than kFewDistances [evaluations]: a regression over the
// solves of nine robots on one machine. It only bounds a search that found no agreement.
constexpr double kPerQuery = 0.3, kPerDistance = 0.8, kPerStepAndDof = 0.03;
constexpr int kFewDistances = 4;
// Answers so many times as far as the meshes are deep: there may well be a nearer one.
constexpr double kVeryFar = 10.0;

}  // namespace

void StoppingRule::Begin(const EffortPlan& plan, const StrategyInput& input, double depth,
                         bool meshes_overlap) {
  plan_ = plan;
  sigma_lower_bound_ = input.sigma_lower_bound;
  distances_at_input_ = input.distances_at_input;
  depth_ = depth;
  meshes_overlap_ = meshes_overlap;
  agreeing_ = 0;
  RenewQueries();
  first_box_test_ = work_.finder.box_tests();
}

void StoppingRule::FirstFree(std::int64_t lcp_steps) {
  free_query_ = work_.finder.queries();
  free_distance_ = work_.finder.distances();
  free_lcp_step_ = lcp_steps;
}

// A hop starts from the best answer, so its return there says nothing; nor do translations in other
// directions, which symmetry makes as long.
void StoppingRule::Count(const LocalResult& result, Component start, double best_sigma) {
  const bool independent = start != Component::kHop;
  if (result.free && result.sigma * kSameAnswer < best_sigma) {
    agreeing_ = independent;
  } else if (result.reached_known || (result.free && result.sigma <= kSameAnswer * best_sigma)) {
    agreeing_ += independent && start != Component::kConstrainedTranslation;
  }
}

bool StoppingRule::Done(double best_sigma, std::int64_t lcp_steps) const {
  if (best_sigma <= kSameAnswer * sigma_lower_bound_) return true;  // the nearest: proven
  const bool near_proven = best_sigma <= kNearProven * sigma_lower_bound_;
  if (agreeing_ >= (near_proven ? plan_.agree_near_proven : plan_.agree)) return true;
  const std::int64_t queries = work_.finder.queries() - first_query_;
  if (!meshes_overlap_)
    return Evaluations(lcp_steps) >= plan_.evaluations || queries >= plan_.queries;
  // More queries: most of them only ask whether a configuration is free.
  if (Exceeds(kVeryFar, best_sigma)) return queries >= 3 * plan_.queries;
  const auto box_tests = static_cast<double>(work_.finder.box_tests() - first_box_test_);
  return 2 * queries >= 3 * plan_.queries ||
         box_tests >= plan_.box_tests * work_.problem().tables.n;
}

double StoppingRule::Evaluations(std::int64_t lcp_steps) const {
  const auto queries = static_cast<double>(work_.finder.queries() - free_query_);
  const auto distances = static_cast<double>(work_.finder.distances() - free_distance_);
  const auto steps = static_cast<double>(lcp_steps - free_lcp_step_);
  const double in_distances =
      kPerDistance * distances + kPerStepAndDof * work_.problem().tables.n * steps;
  return kPerQuery * queries + in_distances / std::max(kFewDistances, distances_at_input_);
}

}  // namespace mjcf_pdg
