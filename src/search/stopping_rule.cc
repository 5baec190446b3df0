#include "search/stopping_rule.h"

#include <algorithm>
#include <limits>

#include "base/tuning.h"

namespace mjcf_pdg {

namespace tune = tuning::stopping;

namespace {

// How many kinematic trees may move, each for itself: equality constraints may join them.
int CountTrees(const Workspace& work) {
  if (work.equality.any()) return 1;
  const SceneTables& tables = work.problem().tables;
  int trees = 0, last = -1;
  for (const JointEntry& joint : tables.joints) {
    const int tree = tables.model->body_treeid[joint.body];
    trees += tree != last;
    last = tree;
  }
  return std::max(1, trees);
}

}  // namespace

void StoppingRule::Begin(const EffortPlan& plan, const StrategyInput& input, double depth,
                         bool meshes_overlap) {
  plan_ = plan;
  trees_ = CountTrees(work_);
  sigma_lower_bound_ = input.sigma_lower_bound;
  tighten_ = input.tighten;
  tightened_ = std::numeric_limits<double>::infinity();
  distances_at_input_ = input.distances_at_input;
  depth_ = depth;
  meshes_overlap_ = meshes_overlap;
  agreeing_ = given_up_ = 0;
  RenewQueries();
  first_box_test_ = work_.finder.box_tests();
}

void StoppingRule::FirstFree(std::int64_t lcp_steps) {
  free_query_ = work_.finder.queries();
  free_distance_ = work_.finder.distances();
  free_lcp_step_ = lcp_steps;
}

// Hops and translations do not count as independent: a hop starts from the best answer, so that its
// return there says nothing, and symmetric scenes have equally long translations in several
// directions. A start that was given up has found nothing nearer either, but where it leads is not
// known.
void StoppingRule::Count(const LocalResult& result, Component start, double best_sigma) {
  const bool independent = start != Component::kHop;
  const bool counts = independent && start != Component::kConstrainedTranslation;
  if (result.free && result.sigma * tune::kSameAnswer < best_sigma) {
    agreeing_ = independent;
    given_up_ = 0;
  } else if (result.reached_known ||
             (result.free && result.sigma <= tune::kSameAnswer * best_sigma)) {
    agreeing_ += counts;
  } else if (result.hopeless) {
    given_up_ += counts;
  }
}

bool StoppingRule::Agreed(double best_sigma) {
  const int agreeing = agreeing_ + given_up_ / tune::kGivenUpPerAgreement;
  if (agreeing >= plan_.agree) return true;
  if (agreeing < plan_.agree_over_bound) return false;  // too few, were the bound σ itself
  if (tighten_ && tightened_ > tune::kSameAnswer * best_sigma) {
    tightened_ = best_sigma;
    Prove(tighten_(best_sigma));
  }
  const double over_bound = agreeing / plan_.agree_over_bound;
  return over_bound * over_bound * sigma_lower_bound_ >= best_sigma;
}

bool StoppingRule::Done(double best_sigma, std::int64_t lcp_steps) {
  if (best_sigma <= tune::kSameAnswer * sigma_lower_bound_) return true;  // the nearest: proven
  if (Agreed(best_sigma)) return true;
  const std::int64_t queries = work_.finder.queries() - first_query_;
  if (!meshes_overlap_)
    return Evaluations(lcp_steps) >= plan_.evaluations || queries >= plan_.queries / trees_;
  const auto asked = static_cast<double>(queries);
  if (Exceeds(tuning::exact_meshes::kVeryFar, best_sigma))
    return asked >= tuning::exact_meshes::kQueriesVeryFar * plan_.queries;
  const auto box_tests = static_cast<double>(work_.finder.box_tests() - first_box_test_);
  return asked >= tuning::exact_meshes::kQueries * plan_.queries ||
         box_tests >= plan_.box_tests * work_.problem().tables.n;
}

double StoppingRule::Evaluations(std::int64_t lcp_steps) const {
  const auto queries = static_cast<double>(work_.finder.queries() - free_query_);
  const auto distances = static_cast<double>(work_.finder.distances() - free_distance_);
  const auto steps = static_cast<double>(lcp_steps - free_lcp_step_);
  const double in_distances =
      tune::kPerDistance * distances + tune::kPerStepAndDof * work_.problem().tables.n * steps;
  return tune::kPerQuery * queries +
         in_distances / std::max(tune::kFewDistances, distances_at_input_);
}

}  // namespace mjcf_pdg
