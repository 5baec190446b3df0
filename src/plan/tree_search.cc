#include "plan/tree_search.h"

#include <ompl/base/PlannerData.h>
#include <ompl/base/ProblemDefinition.h>
#include <ompl/base/ScopedState.h>
#include <ompl/base/StateSampler.h>
#include <ompl/geometric/PathGeometric.h>

#include <unordered_set>
#include <utility>

namespace mjcf_pdg {
namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;

// The length of a step, a share of the largest √σ between random configurations; not tuned.
constexpr double kRange = 0.1;

// Of a search near a motion, in lengths of that: the standard deviation of samples from it, and the
// length of a step. Seconds per path through a hole for a peg, a window, and the slot of
// models/passages (medians of 12 seeds; bench/README.md): 3.9, 5.7 and 1.1 with 1 and 0.5, 1.6, 1.3
// and 1.5 with 4 and 1, 1.1, 0.53 and 1.6 with 8 and 1, 0.85, 0.31 and 1.2 with 8 and 2.
constexpr double kSpread = 8.0, kRangeNear = 2.0;

// How many nodes a planner's trees have. OMPL answers with a copy of them as a graph, which takes
// longer and more memory than the search where they are large; this notes states alone.
class NodeCount : public ob::PlannerData {
 public:
  NodeCount(const ob::SpaceInformationPtr& information, const ob::Planner& planner)
      : ob::PlannerData(information) {
    planner.getPlannerData(*this);
    for (unsigned int k = 0; k < numVertices(); ++k) states_.insert(getVertex(k).getState());
  }
  int nodes() const { return static_cast<int>(states_.size()); }

  using ob::PlannerData::addEdge;
  bool addEdge(const ob::PlannerDataVertex& from, const ob::PlannerDataVertex& to,
               const ob::PlannerDataEdge&, ob::Cost) override {
    states_.insert({from.getState(), to.getState()});
    return true;
  }

 private:
  std::unordered_set<const ob::State*> states_;
};

// Draws from around the motion between two states.
class SamplerNearMotion : public ob::StateSampler {
 public:
  SamplerNearMotion(const ConfigurationSpace* space, const ob::State* from, const ob::State* to)
      : ob::StateSampler(space),
        around_(space->allocDefaultStateSampler()),
        from_(from),
        to_(to),
        spread_(kSpread * space->distance(from, to)),
        middle_(space->allocState()) {
    rng_.setLocalSeed(static_cast<std::uint_fast32_t>(space->NextSeed()));
  }
  ~SamplerNearMotion() override { space_->freeState(middle_); }

  void sampleUniform(ob::State* state) override {
    space_->interpolate(from_, to_, rng_.uniform01(), middle_);
    around_->sampleGaussian(state, middle_, spread_);
  }
  void sampleUniformNear(ob::State* state, const ob::State* near, double distance) override {
    around_->sampleUniformNear(state, near, distance);
  }
  void sampleGaussian(ob::State* state, const ob::State* mean, double deviation) override {
    around_->sampleGaussian(state, mean, deviation);
  }

 private:
  const ob::StateSamplerPtr around_;
  const ob::State *const from_, *const to_;
  const double spread_;
  ob::State* const middle_;
};

}  // namespace

double StepLength(const PlanOptions& options, const ConfigurationSpace& space) {
  return options.range > 0.0 ? options.range : kRange * space.extent();
}

TreeSearch::TreeSearch(const TreeSearchInput& input)
    : input_(input),
      range_(input.step_share * StepLength(input.options, *input.space) / input.space->extent()),
      prover_(std::make_shared<MotionProver>(input.scene, input.options.options, input.space)),
      information_(std::make_shared<ob::SpaceInformation>(input.space)) {
  UseProver(prover_, input.ended, information_);
  information_->setup();
  named_ = MakePlanner(input.options.planner, range_,
                       {input.scene, input.options.options, input.space, prover_, input.slide},
                       information_);
}

std::vector<VectorXd> TreeSearch::Find(const VectorXd& from, const VectorXd& to,
                                       std::int64_t samples) {
  ob::ScopedState<> first(information_->getStateSpace()), last(information_->getStateSpace());
  ConfigurationSpace::Q(first.get()) = from;
  ConfigurationSpace::Q(last.get()) = to;
  const auto problem = std::make_shared<ob::ProblemDefinition>(information_);
  problem->setStartAndGoalStates(first, last);
  if (named_.objective) problem->setOptimizationObjective(named_.objective);
  if (used_) named_.planner->clear();
  used_ = true;
  named_.planner->setProblemDefinition(problem);
  named_.planner->setup();
  const std::int64_t before = input_.space->samples();  // setup may have drawn some
  named_.planner->solve(ob::PlannerTerminationCondition(
      [&] { return input_.space->samples() - before >= samples || input_.ended(); }));
  nodes_ += NodeCount(information_, *named_.planner).nodes();
  if (!problem->hasExactSolution()) return {};
  return Configurations(*problem->getSolutionPath()->as<og::PathGeometric>());
}

std::vector<VectorXd> TreeSearch::FindNear(const VectorXd& from, const VectorXd& to,
                                           std::int64_t samples) {
  ob::ScopedState<> first(information_->getStateSpace()), last(information_->getStateSpace());
  ConfigurationSpace::Q(first.get()) = from;
  ConfigurationSpace::Q(last.get()) = to;
  input_.space->setStateSamplerAllocator([&](const ob::StateSpace*) {
    return std::make_shared<SamplerNearMotion>(input_.space.get(), first.get(), last.get());
  });
  named_.retracting->setRange(kRangeNear * information_->distance(first.get(), last.get()));
  std::vector<VectorXd> path = Find(from, to, samples);
  named_.retracting->setRange(range_);
  input_.space->clearStateSamplerAllocator();
  return path;
}

SearchCost TreeSearch::cost() const {
  return {nodes_,
          prover_->queries() + (named_.retracting ? named_.retracting->retraction_queries() : 0)};
}

}  // namespace mjcf_pdg
