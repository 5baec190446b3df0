// Whether a solve keeps its time budget, and whether what it returns is free. There is one row per
// model and budget: a solver gets a free hint, as it would in a control loop, and solves random
// problems within the budget. README.md beside this file says what the columns mean.

#include <CLI/CLI.hpp>
#include <cstdio>
#include <vector>

#include "measure.h"
#include "mjcf_pdg/pdg.h"
#include "workloads.h"

namespace mjcf_pdg::bench {
namespace {

struct Arguments {
  SetArguments sets;
  std::vector<double> budgets = {0.2, 0.5, 1.0};  // [ms]
  int laps = 1;                                   // how often the problems are solved
};

// A free configuration: the answer of the first problem that is solved or free already. Throws
// Error if there is none.
std::vector<double> SomeFree(const Scene& scene, const ProblemSet& set) {
  Solver solver(scene);
  for (const BenchProblem& problem : set.problems) {
    const Result result = solver.Solve(problem.q_in);
    if (result.status != Status::kUnsolved) return result.q;
  }
  throw Error(set.name + ": nothing free to begin with");
}

void PrintRow(const Scene& scene, const ProblemSet& set, double budget_ms, const Arguments& a) {
  Solver solver(scene);
  solver.SetHint(SomeFree(scene, set));
  std::vector<double> times_ms, seconds_of_evaluation;
  Result result;
  int free = 0, by_hint = 0;
  for (int lap = 0; lap <= a.laps; ++lap) {  // the first has no budget and is not counted
    solver.SetBudget({.queries = 0, .seconds = lap == 0 ? 0.0 : 1e-3 * budget_ms});
    for (const BenchProblem& problem : set.problems) {
      solver.Solve(problem.q_in, result);
      if (lap == 0) continue;
      times_ms.push_back(1e3 * result.stats.seconds);
      free += result.status != Status::kUnsolved && solver.IsFree(result.q);
      by_hint += result.start == "user_pose";
    }
  }
  const int n = static_cast<int>(times_ms.size());
  const double p99 = Quantile(times_ms, 0.99);
  std::printf("%-36s %6.1f %6d %7.2f %7.2f %8.3f %8.3f %8.3f %6.2f\n", set.name.c_str(), budget_ms,
              n, 100.0 * free / n, 100.0 * by_hint / n, Quantile(times_ms, 0.5), p99,
              Quantile(times_ms, 1.0), p99 / budget_ms);
  std::fflush(stdout);
}

void Run(const Arguments& arguments) {
  std::printf("%-36s %6s %6s %7s %7s %8s %8s %8s %6s\n", "set", "ms", "n", "free%", "hint%",
              "p50 ms", "p99", "max", "p99/b");
  for (const Workload& workload : LoadSoundWorkloads(arguments.sets)) {
    for (const double budget : arguments.budgets) {
      PrintRow(*workload.scene, workload.set, budget, arguments);
    }
  }
}

}  // namespace
}  // namespace mjcf_pdg::bench

int main(int argc, char** argv) {
  CLI::App app("Solves within budgets of time");
  mjcf_pdg::bench::Arguments arguments;
  mjcf_pdg::bench::AddSetArguments(app, arguments.sets);
  app.add_option("--budgets", arguments.budgets, "Budgets [ms]")->capture_default_str();
  app.add_option("--laps", arguments.laps, "Times that the problems are solved");
  return mjcf_pdg::bench::RunProgram(app, argc, argv, [&] { Run(arguments); });
}
