#include "plan/plan.h"

#include <ompl/base/PlannerData.h>
#include <ompl/base/ProblemDefinition.h>
#include <ompl/base/ScopedState.h>
#include <ompl/geometric/PathSimplifier.h>
#include <ompl/util/Console.h>

#include <algorithm>
#include <chrono>

#include "equality/held.h"
#include "plan/planners.h"

namespace mjcf_pdg {
namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;
using Clock = std::chrono::steady_clock;

// Contact samples and repaired ends keep this share of a link's size from everything, so that a
// motion along a wall does not run in CCDg's contact band. A passage must be wider by twice that.
// Not tuned.
constexpr double kContactClearance = 1e-3;
constexpr double kRange = 0.1;  // of the largest distance of random configurations; not tuned
// A search that retracts and has not found a path after so many samples, times a term of Luby's
// sequence, begins anew: a few samples in the right place make a path soon or not at all. Seconds
// per path on the bridge, with 60, 125, 250, 500, 1000 and 2000 (PDg in both trees): 0.36, 0.39,
// 0.55, 0.49, 0.62 and 1.0; birrt-r, but for the last, 1.3, 1.4, 1.8, 2.1 and 2.4. Without, three
// and four of eight runs found none in 6000 samples. OMPL's own planners need large trees: birrt
// took 3.7 instead of 1.1 on Placement.
constexpr std::int64_t kSamplesOfARun = 100;

// Term k = 1, 2, ... of 1 1 2 1 1 2 4 1 1 2 1 1 2 4 8 ... (Luby, Sinclair and Zuckerman, Optimal
// speedup of Las Vegas algorithms, 1993).
std::int64_t Luby(std::int64_t k) {
  std::int64_t power = 1;
  while (2 * power - 1 < k) power *= 2;
  return 2 * power - 1 == k ? power : Luby(k - power + 1);
}

class Planning {
 public:
  Planning(const Scene& scene, const PlanOptions& options);
  Path Run(const std::vector<double>& start, const std::vector<double>& goal);

 private:
  bool Repair(const std::vector<double>& q, const char* end, Result& result);
  void Search(const VectorXd& start, const VectorXd& goal);
  void Solve(const ob::ProblemDefinitionPtr& problem, const ob::SpaceInformationPtr& information);
  void Keep(const og::PathGeometric& path);
  void Straighten(std::vector<VectorXd>& q);
  bool Prove(const std::vector<VectorXd>& path);
  bool Ended() const;

  const Scene scene_;
  const PlanOptions options_;
  const Clock::time_point begin_ = Clock::now();
  double clearance_;  // of contact samples [m]
  std::shared_ptr<MotionProver> prover_;
  std::shared_ptr<ConfigurationSpace> space_;
  Path path_;
};

Planning::Planning(const Scene& scene, const PlanOptions& options)
    : scene_(scene),
      options_(options),
      clearance_(options.options.clearance + kContactClearance * scene.tables().size),
      prover_(std::make_shared<MotionProver>(scene, options.options)) {}

bool Planning::Ended() const {
  const std::chrono::duration<double> gone = Clock::now() - begin_;
  return gone.count() > options_.options.time_limit ||
         (options_.max_samples > 0 && space_ && space_->samples() >= options_.max_samples) ||
         (options_.go_on && !options_.go_on());
}

// Moves an end out of collision, so far that motions can begin there, or, where that is not to be
// had, just so far that it is free.
bool Planning::Repair(const std::vector<double>& q, const char* end, Result& result) {
  Options options = options_.options;
  Solver exact(scene_, options);
  result = exact.Solve(q);
  path_.collision_queries += result.stats.collision_queries;
  if (result.status == Status::kAlreadyFree) return true;
  options.clearance = clearance_;
  Result clear = Solver(scene_, options).Solve(q);
  path_.collision_queries += clear.stats.collision_queries;
  if (clear.status == Status::kSolved) result = clear;
  if (result.status == Status::kSolved) return true;
  path_.reason += (path_.reason.empty() ? "the " : "; the ") + std::string(end) +
                  " is not free and cannot be repaired: " + result.reason;
  return false;
}

bool Planning::Prove(const std::vector<VectorXd>& path) {
  if (!std::all_of(path.begin(), path.end(),
                   [this](const VectorXd& q) { return space_->HoldsEqualities(q); })) {
    return false;
  }
  std::vector<EdgeProof> edges;
  for (std::size_t k = 1; k < path.size(); ++k) {
    const std::int64_t before = prover_->queries();
    if (!prover_->IsFree(path[k - 1], path[k])) return false;
    edges.push_back({prover_->certified(), static_cast<int>(prover_->queries() - before),
                     space_->Distance(path[k - 1], path[k])});
  }
  path_.certified =
      std::all_of(edges.begin(), edges.end(), [](const EdgeProof& edge) { return edge.certified; });
  path_.edges = std::move(edges);
  return true;
}

std::vector<VectorXd> Configurations(const og::PathGeometric& path) {
  std::vector<VectorXd> q;
  for (std::size_t k = 0; k < path.getStateCount(); ++k) {
    q.push_back(ConfigurationSpace::Q(path.getState(static_cast<unsigned int>(k))));
  }
  return q;
}

// Takes out configurations whose neighbours can be joined: smoothing leaves some on straight parts,
// and a path that is timed stops at each.
void Planning::Straighten(std::vector<VectorXd>& q) {
  for (std::size_t k = 1; k + 1 < q.size() && !Ended();) {
    if (prover_->IsFree(q[k - 1], q[k + 1])) {
      q.erase(q.begin() + static_cast<std::ptrdiff_t>(k));
    } else {
      ++k;
    }
  }
}

// Shortens the path, each change proven free, and proves what is left once more from end to end.
void Planning::Keep(const og::PathGeometric& path) {
  og::PathGeometric shorter(path);
  og::PathSimplifier simplifier(path.getSpaceInformation());
  if (!Ended()) simplifier.reduceVertices(shorter);
  if (!Ended()) simplifier.shortcutPath(shorter);
  if (!Ended()) simplifier.smoothBSpline(shorter, 2, space_->getMaximumExtent() / 100.0);
  if (!Ended()) simplifier.reduceVertices(shorter);
  std::vector<VectorXd> q = Configurations(shorter);
  Straighten(q);
  if (!Prove(q)) {
    q = Configurations(path);
    if (!Prove(q)) {
      path_.reason = "a path was found, but could not be proven free once more";
      return;
    }
  }
  path_.found = true;
  for (const VectorXd& at : q) path_.q.emplace_back(at.data(), at.data() + at.size());
  for (const EdgeProof& edge : path_.edges) path_.length += edge.length;
}

void Planning::Search(const VectorXd& start, const VectorXd& goal) {
  const Options& options = options_.options;
  space_ = std::make_shared<ConfigurationSpace>(
      scene_, MocapPoses{options.mocap_pos, options.mocap_quat}, start, goal);
  const auto information = std::make_shared<ob::SpaceInformation>(space_);
  UseProver(prover_, information);
  information->setup();
  ob::ScopedState<> first(information->getStateSpace()), last(information->getStateSpace());
  ConfigurationSpace::Q(first.get()) = start;
  ConfigurationSpace::Q(last.get()) = goal;
  const auto problem = std::make_shared<ob::ProblemDefinition>(information);
  problem->setStartAndGoalStates(first, last);
  Solve(problem, information);
  path_.samples = space_->samples();
  if (problem->hasExactSolution()) {
    Keep(*problem->getSolutionPath()->as<og::PathGeometric>());
  } else {
    path_.reason = "none was found within the limit";
  }
}

void Planning::Solve(const ob::ProblemDefinitionPtr& problem,
                     const ob::SpaceInformationPtr& information) {
  const double range = options_.range > 0.0 ? options_.range : kRange * space_->getMaximumExtent();
  const NamedPlanner named =
      MakePlanner(options_.planner, range, {scene_, options_.options, space_, prover_, clearance_},
                  information);
  named.planner->setProblemDefinition(problem);
  named.planner->setup();
  for (std::int64_t run = 1; !problem->hasExactSolution() && !Ended(); ++run) {
    named.planner->clear();
    const std::int64_t last = named.retracting ? space_->samples() + Luby(run) * kSamplesOfARun
                                               : std::numeric_limits<std::int64_t>::max();
    named.planner->solve(ob::PlannerTerminationCondition(
        [this, last] { return space_->samples() >= last || Ended(); }));
    ob::PlannerData data(information);
    named.planner->getPlannerData(data);
    path_.nodes += static_cast<int>(data.numVertices());
  }
  if (named.retracting) path_.collision_queries += named.retracting->retraction_queries();
}

Path Planning::Run(const std::vector<double>& start, const std::vector<double>& goal) {
  const bool from = Repair(start, "start", path_.start), to = Repair(goal, "goal", path_.goal);
  if (from && to) {
    const SceneTables& tables = scene_.tables();
    Search(Normalized(tables, ToEigen(path_.start.q)), Normalized(tables, ToEigen(path_.goal.q)));
  }
  path_.collision_queries += prover_->queries();
  path_.seconds = std::chrono::duration<double>(Clock::now() - begin_).count();
  return std::move(path_);
}

// OMPL draws the seeds of all its generators from one sequence, which must not be 0.
void Seed(std::uint64_t seed) {
  ompl::msg::setLogLevel(ompl::msg::LOG_NONE);
  ompl::RNG::setSeed(static_cast<std::uint_fast32_t>(seed % 0xffffffffu + 1));
}

void CheckEqualities(const Scene& scene) {
  const mjModel& m = *scene.model();
  for (int e = 0; e < m.neq; ++e) {
    if (scene.tables().held_equalities[e] && m.eq_active0[e] && !HoldsAlongStraightMotions(m, e)) {
      throw Error("the model has an equality constraint that straight motions do not hold: " +
                  DescribeEquality(m, e));
    }
  }
}

}  // namespace

Path Plan(const Scene& scene, const std::vector<double>& start, const std::vector<double>& goal,
          const PlanOptions& options) {
  CheckEqualities(scene);
  const std::vector<std::string> names = PlannerNames();
  if (std::find(names.begin(), names.end(), options.planner) == names.end()) {
    MakePlanner(options.planner, 0.0, {scene, {}, nullptr, nullptr}, nullptr);  // throws
  }
  scene.CheckConfiguration(start);
  scene.CheckConfiguration(goal);
  MotionChecker(scene, options.options).Check(start, goal);  // throws for what is frozen
  Seed(options.options.seed);
  return Planning(scene, options).Run(start, goal);
}

}  // namespace mjcf_pdg
