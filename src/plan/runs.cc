#include "plan/runs.h"

#include <ompl/base/PlannerData.h>
#include <ompl/base/ProblemDefinition.h>
#include <ompl/base/ScopedState.h>
#include <ompl/geometric/PathGeometric.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <mutex>
#include <unordered_set>

#include "base/in_order.h"
#include "base/random.h"
#include "plan/motion_prover.h"
#include "plan/planners.h"

namespace mjcf_pdg {
namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;

// The length of a step, a share of the largest √σ between random configurations; not tuned.
constexpr double kRange = 0.1;

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

// The samples of a run, times a term of Luby's sequence. Of 100, 250, 500 and 1000 this has the
// least product of median times, over four scenes and both planners that retract (bench/README.md,
// plan_bench). In one run without end birrt found 4 of 10 paths on the bridge in 300 s each; begun
// anew, after any of these, it found ten.
constexpr std::int64_t kSamplesOfARun = 250;
constexpr std::int64_t kNoBound = std::numeric_limits<std::int64_t>::max();

// Term k = 1, 2, ... of 1 1 2 1 1 2 4 1 1 2 1 1 2 4 8 ... (Luby, Sinclair and Zuckerman, Optimal
// speedup of Las Vegas algorithms, 1993).
std::int64_t Luby(std::int64_t k) {
  std::int64_t power = 1;
  while (2 * power - 1 < k) power *= 2;
  return 2 * power - 1 == k ? power : Luby(k - power + 1);
}

struct Run {
  std::int64_t number = 0;   // 1, 2, ...
  std::int64_t samples = 0;  // at most so many
  Runs result;
};

class Searching {
 public:
  explicit Searching(const RunsInput& input)
      : input_(input), begins_anew_(BeginsAnew(input.options.planner)) {
    if (input.options.max_samples > 0) samples_left_ = input.options.max_samples;
  }

  Runs Go() {
    InOrder<Run> runs(static_cast<std::size_t>(begins_anew_ ? input_.options.threads : 1));
    runs.Run([this](Run& run) { return Take(run); }, [this](std::size_t, Run& run) { Do(run); },
             [this](std::size_t, const Run& run) { return Tell(run); });
    return std::move(all_);
  }

 private:
  bool Take(Run& run) {
    run.number = ++taken_;
    run.samples = begins_anew_ ? std::min(samples_left_, Luby(run.number) * kSamplesOfARun)
                               : samples_left_;  // a run of OMPL's other planners has no end
    samples_left_ -= run.samples;
    return run.samples > 0 && run.number < found_ && !Ended();
  }

  // Of the random numbers of a run: apart for all runs of all seeds.
  std::uint64_t SeedOf(const Run& run) const {
    const std::uint64_t first = Random(input_.options.options.seed).Bits();
    return Random(first + static_cast<std::uint64_t>(run.number)).Bits();
  }

  bool Ended() const {
    const std::lock_guard<std::mutex> lock(ended_);
    return input_.ended();
  }

  bool IsOver(const Run& run) const { return run.number > found_ || Ended(); }

  void Do(Run& run) {
    const PlanOptions& options = input_.options;
    run.result = {};
    const auto space = std::make_shared<ConfigurationSpace>(input_.space, SeedOf(run));
    const auto prover = std::make_shared<MotionProver>(input_.scene, options.options, space);
    const auto information = std::make_shared<ob::SpaceInformation>(space);
    UseProver(prover, [&run, this] { return IsOver(run); }, information);
    information->setup();
    ob::ScopedState<> first(information->getStateSpace()), last(information->getStateSpace());
    ConfigurationSpace::Q(first.get()) = input_.start;
    ConfigurationSpace::Q(last.get()) = input_.goal;
    const auto problem = std::make_shared<ob::ProblemDefinition>(information);
    problem->setStartAndGoalStates(first, last);

    const double range = options.range > 0.0 ? options.range / space->extent() : kRange;
    const NamedPlanner named =
        MakePlanner(options.planner, range,
                    {input_.scene, options.options, space, prover, input_.clearance}, information);
    if (named.objective) problem->setOptimizationObjective(named.objective);
    named.planner->setProblemDefinition(problem);
    named.planner->setup();
    named.planner->solve(ob::PlannerTerminationCondition(
        [&] { return space->samples() >= run.samples || IsOver(run); }));

    run.result.nodes = NodeCount(information, *named.planner).nodes();
    run.result.samples = space->samples();
    run.result.collision_queries = prover->queries();
    if (named.retracting) run.result.collision_queries += named.retracting->retraction_queries();
    if (!problem->hasExactSolution()) return;
    run.result.path = Configurations(*problem->getSolutionPath()->as<og::PathGeometric>());
    std::int64_t before = found_;
    while (run.number < before && !found_.compare_exchange_weak(before, run.number)) {
    }
  }

  bool Tell(const Run& run) {
    all_.nodes += run.result.nodes;
    all_.samples += run.result.samples;
    all_.collision_queries += run.result.collision_queries;
    all_.path = run.result.path;
    return all_.path.empty();
  }

  const RunsInput& input_;
  const bool begins_anew_;
  std::int64_t taken_ = 0, samples_left_ = kNoBound;
  std::atomic<std::int64_t> found_ = kNoBound;  // the first run that found a path
  mutable std::mutex ended_;
  Runs all_;
};

}  // namespace

Runs Search(const RunsInput& input) { return Searching(input).Go(); }

}  // namespace mjcf_pdg
