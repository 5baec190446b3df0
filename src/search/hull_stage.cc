#include "search/hull_stage.h"

#include <cstdint>
#include <memory>

#include "bound/lower_bound.h"
#include "model/exact_mesh.h"
#include "problem/effort.h"
#include "search/search.h"

namespace mjcf_pdg {
struct HullStage::Hulls {
  explicit Hulls(const Problem& problem)
      : tables(WithHulls(problem.tables)), work(tables, problem.options), search(work) {}

  const SceneTables tables;
  Workspace work;
  LowerBound bound;
  Search search;
};

HullStage::HullStage() = default;
HullStage::~HullStage() = default;

const VectorXd* HullStage::Run(const Workspace& work) {
  if (!hulls_) hulls_ = std::make_unique<Hulls>(work.problem());
  Workspace& own = hulls_->work;
  own.Begin(work);
  const std::int64_t before = own.finder.distances();
  StrategyInput input{.overlaps = own.OverlapsAtInput()};
  input.distances_at_input = static_cast<int>(own.finder.distances() - before);
  const int cells = PlanFor(own.problem().options.effort).bound_cells;
  input.sigma_lower_bound = hulls_->bound.Sigma(own, input.overlaps, cells);
  hulls_->search.Begin(input);
  hulls_->search.Finish(input);
  const Trials& trials = hulls_->search.trials();
  return trials.HasFree() ? &trials.Best() : nullptr;
}

std::int64_t HullStage::queries() const { return hulls_ ? hulls_->work.finder.queries() : 0; }

}  // namespace mjcf_pdg
