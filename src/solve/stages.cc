#include "solve/stages.h"

#include <algorithm>
#include <limits>

#include "base/tuning.h"
#include "paper/paper_method.h"
#include "problem/effort.h"
#include "search/auto_method.h"

namespace mjcf_pdg {
namespace {

std::unique_ptr<Strategy> MakeStrategy(Workspace& work) {
  if (work.problem().options.method == Method::kPaper) return std::make_unique<PaperMethod>(work);
  return std::make_unique<AutoMethod>(work);
}

}  // namespace

Stages::Stages(Workspace& w, Verifier& verifier)
    : work(w), strategy(MakeStrategy(work)), acceptance(work, *strategy, verifier) {}

Outcome& Stages::Search(const std::vector<NearPair>& overlaps, int distances, const VectorXd* hint,
                        const VectorXd* of_fewer) {
  const Options& options = work.problem().options;
  sigma_lower_bound_ = 0.0;
  if (options.report_lower_bound || strategy->UsesLowerBound()) {
    sigma_lower_bound_ = bound.Sigma(work, overlaps, PlanFor(options.effort).bound_cells);
  }
  tightened_ = std::numeric_limits<double>::infinity();
  Outcome& outcome = strategy->Run({.overlaps = overlaps,
                                    .distances_at_input = distances,
                                    .sigma_lower_bound = sigma_lower_bound_,
                                    .tighten = [this](double sigma) { return Tighten(sigma); },
                                    .hint = hint,
                                    .of_fewer = of_fewer});
  sigma_lower_bound_ = std::max(sigma_lower_bound_, outcome.sigma_lower_bound);
  if (options.report_lower_bound && !outcome.free.empty()) Tighten(outcome.free.front().sigma);
  return outcome;
}

double Stages::Tighten(double sigma) {
  constexpr double kSame = tuning::stopping::kSameAnswer;
  const int per_pair = PlanFor(work.problem().options.effort).bound_nodes;
  if (per_pair > 0 && sigma > kSame * sigma_lower_bound_ && tightened_ > kSame * sigma) {
    tightened_ = sigma;
    sigma_lower_bound_ = std::max(sigma_lower_bound_, bound.Tighten(sigma, per_pair, &work.budget));
  }
  return sigma_lower_bound_;
}

}  // namespace mjcf_pdg
