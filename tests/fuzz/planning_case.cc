#include <algorithm>
#include <cmath>

#include "model/kinematics.h"
#include "plan/plan.h"
#include "plan/planners.h"
#include "tests/fuzz/cases.h"
#include "tests/fuzz/problem.h"

namespace mjcf_pdg::test {
namespace {

constexpr double kSeconds = 20.0;      // after which a search ends, if nothing else ends it
constexpr int kNodesOfASample = 1000;  // a tree that grows by more goes nowhere: a step is a tenth
constexpr int kPoses = 40;             // of a path that the judge sees

// What the judge says against a place on the path, of kPoses that are drawn.
std::string WrongPlace(const Problem& problem, const Path& path, Random& rng) {
  const SceneTables& tables = problem.scene->tables();
  VectorXd dq(tables.n);
  for (int k = 0; k < kPoses; ++k) {
    const auto edge = static_cast<std::size_t>(rng.Index(static_cast<int>(path.q.size()) - 1));
    const VectorXd from = ToEigen(path.q[edge]), to = ToEigen(path.q[edge + 1]);
    const double t = rng.Uniform(0.0, 1.0);
    Difference(tables, from, to, dq);
    dq *= t;
    VectorXd q = from;
    Integrate(tables, q, dq, q);
    const std::string wrong = Refute(problem, {q.data(), q.data() + q.size()});
    if (!wrong.empty()) {
      return wrong + " at " + Join(&t, 1) + " of edge " + std::to_string(edge) + " of " +
             std::to_string(path.q.size() - 1);
    }
  }
  return "";
}

std::string WrongPath(const Problem& problem, const Path& path, Random& rng) {
  if (path.nodes > kNodesOfASample * (path.samples + 1)) return "a tree grows without end";
  if (path.found != path.reason.empty()) return "the reason does not fit";
  if (!path.found) return path.q.empty() ? "" : "a path that was not found";
  if (path.q.size() < 2 || path.edges.size() + 1 != path.q.size()) return "no path";
  for (const std::vector<double>& q : path.q) {
    if (!Finite(q)) return "a configuration is not finite";
  }
  if (!std::isfinite(path.length) || path.length < 0.0) return "the length is no number";
  return WrongPlace(problem, path, rng);
}

}  // namespace

CaseOutcome PlanningCase(std::uint64_t seed) {
  Random rng(seed);
  const Problem problem(rng);
  if (!problem.scene) return {"refused", ""};
  const std::vector<double> goal =
      DrawConfiguration(*problem.scene->model(), problem.drawn.scale, rng);
  PlanOptions options;
  options.options = problem.options;
  options.options.time_limit = kSeconds;
  const std::vector<std::string> planners = PlannerNames();
  // The two that retract are drawn as often as all others.
  options.planner =
      rng.Chance(0.5)
          ? rng.Chance(0.5) ? "birrt-pdg" : "birrt-r"
          : planners[static_cast<std::size_t>(rng.Index(static_cast<int>(planners.size())))];
  options.threads = 1 + rng.Index(2);
  options.max_samples = 100;
  const Path path = Plan(*problem.scene, problem.q, goal, options);
  CaseOutcome outcome{path.found                               ? "found"
                      : path.start.status == Status::kUnsolved ? "no start"
                      : path.goal.status == Status::kUnsolved  ? "no goal"
                                                               : "not found",
                      WrongPath(problem, path, rng)};
  if (!outcome.wrong.empty()) {
    outcome.wrong += " (" + options.planner + ")" + problem.Words() + ", goal " +
                     Join(goal.data(), static_cast<int>(goal.size()));
  }
  return outcome;
}

}  // namespace mjcf_pdg::test
