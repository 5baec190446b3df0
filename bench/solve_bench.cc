// How good and how fast solves are. There is one row per model, problem set and effort.
// README.md beside this file says what the columns mean.

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "measure.h"
#include "mjcf_pdg/pdg.h"
#include "workloads.h"

namespace mjcf_pdg::bench {
namespace {

// First seed of the runs that only look for a lower σ; it is far from the seeds that are measured.
constexpr std::uint64_t kFirstPersistentSeed = 1000;

struct Arguments {
  SetArguments sets;
  std::string json;
  std::vector<std::string> efforts = {"default"};
  int seeds = 1;
  int persistence = 3;
  std::string method = "auto";
};

Effort ParseEffort(const std::string& name) {
  if (name == "fast") return Effort::kFast;
  return name == "max" ? Effort::kMax : Effort::kDefault;
}

const char* StatusName(Status status) {
  if (status == Status::kAlreadyFree) return "already_free";
  return status == Status::kSolved ? "solved" : "unsolved";
}

Series MeasureEffort(const Scene& scene, const ProblemSet& set, const std::string& effort,
                     const Arguments& arguments) {
  Options options;
  options.effort = ParseEffort(effort);
  options.method = arguments.method == "paper" ? Method::kPaper : Method::kAuto;
  options.tolerance = arguments.sets.tolerance;
  Series series = Measure(scene, set, options, {0, arguments.seeds});
  series.label = effort;
  return series;
}

void PrintHeader() {
  std::printf("%-36s %-8s %4s %5s %6s %7s %7s %8s %5s %7s %7s %7s %7s %6s %5s %6s  %s\n", "set",
              "effort", "n", "free%", "ok%", "ratio", "p95", "max", "bound", "queries", "p99",
              "evals", "p99", "iter", "start", "u [us]", "winning starts");
}

void PrintRow(const ProblemSet& set, const Series& series, const std::vector<double>& best) {
  Tally t;
  t.Add(series, best);
  std::printf(
      "%-36s %-8s %4d %5.1f %6.1f %7.4f %7.4f %8.3f %5.2f %7.0f %7.0f %7.1f %7.0f %6.0f %5.0f "
      "%6.1f ",
      set.name.c_str(), series.label.c_str(), t.n, 100.0 * t.already_free / t.n, 100.0 * t.ok / t.n,
      Quantile(t.ratio, 0.5), Quantile(t.ratio, 0.95), Quantile(t.ratio, 1.0),
      Quantile(t.bound, 0.5), Quantile(t.queries, 0.5), Quantile(t.queries, 0.99),
      Quantile(t.evaluations, 0.5), Quantile(t.evaluations, 0.99), Quantile(t.iterations, 0.5),
      Quantile(t.starts, 0.5), 1e6 * series.EvaluationSeconds());
  for (const auto& [name, count] : t.winners) std::printf(" %s %d", name.c_str(), count);
  std::printf("\n");
  std::fflush(stdout);
}

void WriteJson(const ProblemSet& set, const Series& series, const std::vector<double>& best,
               std::ofstream& out) {
  const double u = series.EvaluationSeconds();
  for (const Measured& solve : series.solves) {
    const BenchProblem& problem = set.problems[solve.problem];
    const Result& r = solve.result;
    nlohmann::json line = {{"set", set.name},
                           {"model", set.model_path},
                           {"id", problem.id},
                           {"effort", series.label},
                           {"seed", solve.seed},
                           {"status", StatusName(r.status)},
                           {"verified", solve.verified},
                           {"sigma", r.sigma},
                           {"sigma_lower_bound", r.sigma_lower_bound},
                           {"depth_in", r.depth_in},
                           {"min_distance", r.min_distance},
                           {"start", r.start},
                           {"reason", r.reason},
                           {"iterations", r.stats.iterations},
                           {"starts", r.stats.starts},
                           {"collision_queries", r.stats.collision_queries},
                           {"lcp_sweeps", r.stats.lcp_sweeps},
                           {"evaluations", solve.seconds / u},
                           {"qpos_in", problem.q_in},
                           {"qpos", r.q}};
    if (std::isfinite(best[solve.problem])) line["best"] = best[solve.problem];
    out << line.dump() << "\n";
  }
  out.flush();
}

void RunSet(const Scene& scene, const ProblemSet& set, const Arguments& arguments,
            std::ofstream& json) {
  if (set.problems.empty()) {
    std::printf("%-36s no problems\n", set.name.c_str());
    return;
  }
  std::vector<Series> all;
  std::vector<double> best = BestGiven(set);
  for (const std::string& effort : arguments.efforts) {
    all.push_back(MeasureEffort(scene, set, effort, arguments));
    LowerBest(all.back(), best);
  }
  // Persistence: more seeds at effort max that only look for a lower σ.
  Options options;
  options.effort = Effort::kMax;
  options.tolerance = arguments.sets.tolerance;
  const Seeds seeds{kFirstPersistentSeed, arguments.persistence};
  LowerBest(Measure(scene, set, options, seeds), best);
  for (const Series& series : all) {
    PrintRow(set, series, best);
    if (json.is_open()) WriteJson(set, series, best, json);
  }
}

// A scene that cannot be loaded or solved gets a row with the reason, and the others go on.
void Run(const Arguments& arguments) {
  std::ofstream json;
  if (!arguments.json.empty()) {
    json.open(arguments.json);
    if (!json) throw Error("cannot write " + arguments.json);
  }
  PrintHeader();
  for (const Workload& workload : LoadWorkloads(arguments.sets)) {
    if (workload.scene) {
      RunSet(*workload.scene, workload.set, arguments, json);
    } else {
      std::printf("%-36s %s\n", workload.set.name.c_str(), workload.error.c_str());
    }
  }
}

}  // namespace

int Main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app("Quality and time of solves, one row per model, problem set and effort.",
               "solve_bench");
  AddSetArguments(app, arguments.sets);
  app.add_option("--seeds", arguments.seeds, "measure with solver seeds 0 to N-1")
      ->check(CLI::Range(1, 1000));
  app.add_option("--persistence", arguments.persistence,
                 "further seeds at effort max that only look for a lower σ")
      ->check(CLI::Range(0, 1000));
  app.add_option("--effort", arguments.efforts, "fast, default, max; several with commas")
      ->delimiter(',')
      ->check(CLI::IsMember({"fast", "default", "max"}));
  app.add_option("--method", arguments.method, "auto or paper; the lower σ is sought by auto")
      ->check(CLI::IsMember({"auto", "paper"}));
  app.add_option("--json", arguments.json, "write every solve to this file, as JSON Lines");
  return RunProgram(app, argc, argv, [&] { Run(arguments); });
}

}  // namespace mjcf_pdg::bench

int main(int argc, char** argv) { return mjcf_pdg::bench::Main(argc, argv); }
