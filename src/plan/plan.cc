#include "plan/plan.h"

#include <ompl/base/ScopedState.h>
#include <ompl/geometric/PathSimplifier.h>
#include <ompl/util/Console.h>

#include <algorithm>
#include <chrono>

#include "plan/motion_prover.h"
#include "plan/planners.h"
#include "plan/runs.h"

namespace mjcf_pdg {
namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;
using Clock = std::chrono::steady_clock;

// Contact samples and repaired ends keep this share of a link's size from everything, so that a
// motion along a wall does not run in CCDg's contact band. Some runs keep less (plan/runs.cc). Not
// tuned.
constexpr double kContactClearance = 1e-3;

class Planning {
 public:
  Planning(const Scene& scene, const PlanOptions& options);
  Path Run(const std::vector<double>& start, const std::vector<double>& goal);

 private:
  bool Repair(const std::vector<double>& q, const char* end, Result& result);
  void Connect(const VectorXd& start, const VectorXd& goal);
  std::vector<VectorXd> Shorten(const std::vector<VectorXd>& corners);
  bool Keep(const std::vector<VectorXd>& corners);
  bool Prove(const std::vector<VectorXd>& path);
  bool Ended();

  const Scene scene_;
  const PlanOptions options_;
  const Clock::time_point begin_ = Clock::now();
  double clearance_;  // of contact samples [m]
  std::shared_ptr<ConfigurationSpace> space_;
  std::shared_ptr<MotionProver> prover_;
  bool stopped_ = false;  // by go_on
  Path path_;
};

Planning::Planning(const Scene& scene, const PlanOptions& options)
    : scene_(scene),
      options_(options),
      clearance_(options.options.clearance + kContactClearance * scene.tables().size) {}

bool Planning::Ended() {
  if (options_.go_on && !options_.go_on()) stopped_ = true;
  const std::chrono::duration<double> gone = Clock::now() - begin_;
  return stopped_ || gone.count() > options_.options.time_limit;
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
    // The one way or the other: a short one that ends at a contact is stopped well before it.
    if (!prover_->IsFree(path[k - 1], path[k]) && !prover_->IsFree(path[k], path[k - 1])) {
      return false;
    }
    edges.push_back({prover_->certified(), static_cast<int>(prover_->queries() - before),
                     space_->Displacement(path[k - 1], path[k])});
  }
  path_.certified =
      std::all_of(edges.begin(), edges.end(), [](const EdgeProof& edge) { return edge.certified; });
  path_.edges = std::move(edges);
  return true;
}

std::vector<VectorXd> Planning::Shorten(const std::vector<VectorXd>& corners) {
  const auto information = std::make_shared<ob::SpaceInformation>(space_);
  UseProver(prover_, [] { return false; }, information);
  information->setup();
  og::PathGeometric path(information);
  ob::ScopedState<> state(information->getStateSpace());
  for (const VectorXd& q : corners) {
    ConfigurationSpace::Q(state.get()) = q;
    path.append(state.get());
  }
  og::PathSimplifier simplifier(information);
  if (!Ended()) simplifier.reduceVertices(path);
  if (!Ended()) simplifier.shortcutPath(path);
  if (!Ended()) simplifier.smoothBSpline(path, 2, 0.01);
  if (!Ended()) simplifier.reduceVertices(path);
  std::vector<VectorXd> shorter = Configurations(path);
  // Smoothing leaves corners on straight parts, and a path that is timed stops at each.
  Straighten(*prover_, [this] { return Ended(); }, shorter);
  return shorter;
}

// Proves the path through the corners once more, from end to end, and keeps it if it can be proven.
bool Planning::Keep(const std::vector<VectorXd>& corners) {
  std::vector<VectorXd> q = {corners.front()};
  std::vector<int> at = {0};
  const auto append = [&q](const ConfigurationSpace::Piece& piece) {
    q.push_back(piece.q);
    return true;
  };
  for (std::size_t k = 1; k < corners.size(); ++k) {
    if (!space_->Follow(corners[k - 1], corners[k], append)) return false;
    at.push_back(static_cast<int>(q.size()) - 1);
  }
  if (!Prove(q)) return false;
  path_.found = true;
  path_.corners = std::move(at);
  for (const VectorXd& each : q) path_.q.emplace_back(each.data(), each.data() + each.size());
  for (const EdgeProof& edge : path_.edges) path_.length += edge.length;
  return true;
}

// OMPL draws the seeds of all its generators from one sequence, which must not be 0.
void Seed(std::uint64_t seed) {
  ompl::msg::setLogLevel(ompl::msg::LOG_NONE);
  ompl::RNG::setSeed(static_cast<std::uint_fast32_t>(seed % 0xffffffffu + 1));
}

void Planning::Connect(const VectorXd& start, const VectorXd& goal) {
  const Options& options = options_.options;
  space_ = std::make_shared<ConfigurationSpace>(
      scene_, MocapPoses{options.mocap_pos, options.mocap_quat}, start, goal);
  prover_ = std::make_shared<MotionProver>(scene_, options, space_);
  Seed(options.seed);
  const Runs runs = Search({.scene = scene_,
                            .options = options_,
                            .space = *space_,
                            .start = start,
                            .goal = goal,
                            .clearance = clearance_,
                            .ended = [this] { return Ended(); }});
  path_.nodes = runs.nodes;
  path_.samples = runs.samples;
  if (runs.path.empty()) {
    path_.reason = stopped_ ? "the search was stopped before one was found"
                            : "none was found within the limit";
  } else {
    Seed(options.seed);  // how many the search has drawn depends on the threads
    if (!Keep(Shorten(runs.path)) && !Keep(runs.path)) {
      path_.reason = "a path was found, but could not be proven free once more";
    }
  }
  path_.collision_queries += runs.collision_queries + prover_->queries();
}

Path Planning::Run(const std::vector<double>& start, const std::vector<double>& goal) {
  const bool from = Repair(start, "start", path_.start), to = Repair(goal, "goal", path_.goal);
  if (from && to) {
    const SceneTables& tables = scene_.tables();
    Connect(Normalized(tables, ToEigen(path_.start.q)), Normalized(tables, ToEigen(path_.goal.q)));
  }
  path_.seconds = std::chrono::duration<double>(Clock::now() - begin_).count();
  return std::move(path_);
}

}  // namespace

Path Plan(const Scene& scene, const std::vector<double>& start, const std::vector<double>& goal,
          const PlanOptions& options) {
  if (options.threads < 1) throw Error("threads: at least 1");
  const std::vector<std::string> names = PlannerNames();
  if (std::find(names.begin(), names.end(), options.planner) == names.end()) {
    MakePlanner(options.planner, 0.0, {scene, {}, nullptr, nullptr}, nullptr);  // throws
  }
  scene.CheckConfiguration(start);
  scene.CheckConfiguration(goal);
  MotionChecker(scene, options.options).Check(start, goal);  // throws for what is frozen
  return Planning(scene, options).Run(start, goal);
}

}  // namespace mjcf_pdg
