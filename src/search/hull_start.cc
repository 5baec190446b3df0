#include "search/hull_start.h"

#include "bound/lower_bound.h"
#include "search/search.h"

namespace mjcf_pdg {
namespace {

SceneTables WithoutExactPairs(SceneTables tables) {
  for (KeptPair& pair : tables.pairs) pair.exact = false;
  return tables;
}

}  // namespace

struct HullStart::Hulls {
  explicit Hulls(const Problem& exact)
      : tables(WithoutExactPairs(exact.tables)), problem(tables, exact.options), search(problem) {}

  const SceneTables tables;
  Problem problem;
  LowerBound bound;
  Search search;
};

HullStart::HullStart(const Problem& problem) : problem_(problem) {}
HullStart::~HullStart() = default;

std::optional<VectorXd> HullStart::Start() {
  if (!hulls_) hulls_ = std::make_unique<Hulls>(problem_);
  Problem& problem = hulls_->problem;
  problem.tolerances = problem_.tolerances;
  problem.mocap = problem_.mocap;
  problem.q_in = problem_.q_in;
  problem.required = problem_.required;
  problem.size = problem_.size;
  problem.deadline = problem_.deadline;
  problem.norm.SetReference(problem.q_in, problem.mocap);
  problem.finder.SetMocap(problem.mocap);
  problem.finder.Forget();
  const std::vector<NearPair> overlaps = problem.OverlapsAtInput();
  problem.sigma_lower_bound = hulls_->bound.Sigma(problem, overlaps);
  SearchOutcome outcome = hulls_->search.Run(overlaps, std::nullopt);
  if (outcome.free.empty()) return std::nullopt;
  return std::move(outcome.free.front().q);
}

std::int64_t HullStart::queries() const { return hulls_ ? hulls_->problem.finder.queries() : 0; }

}  // namespace mjcf_pdg
