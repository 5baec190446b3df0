// σ per iteration of the paper's method: how fast it falls, and why the iterations end.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "measure.h"
#include "mjcf_pdg/pdg.h"
#include "paper/paper_method.h"
#include "workloads.h"

namespace mjcf_pdg::bench {
namespace {

// Iterations that get a row of the table.
constexpr int kRows[] = {0, 1, 2, 3, 4, 5, 6, 8, 10, 15, 20, 30, 50, 99};

struct Runs {
  std::vector<std::vector<double>> sigmas;  // by run that found something free, σ per iteration
  std::map<IterationStatus, int> statuses;  // how the runs ended
  int failures = 0;                         // runs that found nothing free
};

const char* Name(IterationStatus status) {
  switch (status) {
    case IterationStatus::kStartNotFree:
      return "start not free";
    case IterationStatus::kConverged:
      return "converged";
    case IterationStatus::kWouldRise:
      return "would rise";
    case IterationStatus::kRefusedByCcd:
      return "refused by CCD";
    case IterationStatus::kIterationLimit:
      return "iteration limit";
    case IterationStatus::kBudget:
      return "budget spent";
  }
  return "";
}

// Runs the paper's method on the workload's problems as Solver does, but without a verification of
// the answer. Problems that are free already are left out.
void Append(const Workload& workload, const Options& options, Runs& runs) {
  const SceneTables& tables = workload.scene->tables();
  Workspace work(tables, options);
  PaperMethod method(work);
  for (const BenchProblem& one : workload.set.problems) {
    if (Verify(*workload.scene, one.q_in).free) continue;
    work.Begin(ToEigen(one.q_in));
    PaperResult result = method.Run();
    ++runs.statuses[result.status];
    if (result.free) {
      runs.sigmas.push_back(std::move(result.sigmas));
    } else {
      ++runs.failures;
    }
  }
}

void Print(const Runs& runs) {
  std::printf("%9s %8s %10s %10s %10s\n", "iteration", "lower %", "median", "p95", "max");
  std::size_t longest = 0;
  for (const std::vector<double>& sigmas : runs.sigmas) longest = std::max(longest, sigmas.size());
  for (const int k : kRows) {
    if (static_cast<std::size_t>(k) >= longest) break;
    std::vector<double> ratio;
    int lower = 0;  // runs that still accept an iterate here
    for (const std::vector<double>& sigmas : runs.sigmas) {
      const std::size_t at = std::min<std::size_t>(k, sigmas.size() - 1);
      lower += sigmas.size() > static_cast<std::size_t>(k);
      ratio.push_back(sigmas.back() > 0.0 ? sigmas[at] / sigmas.back() : 1.0);
    }
    std::printf("%9d %8.1f %10.5f %10.5f %10.3f\n", k, 100.0 * lower / ratio.size(),
                Quantile(ratio, 0.5), Quantile(ratio, 0.95), Quantile(ratio, 1.0));
  }
  std::printf("%zu runs, %d without a free configuration; ended:", runs.sigmas.size(),
              runs.failures);
  for (const auto& [status, count] : runs.statuses) std::printf(" %s %d;", Name(status), count);
  std::printf("\n");
}

void Run(const SetArguments& arguments) {
  const std::vector<Workload> workloads = LoadSoundWorkloads(arguments);
  for (const std::string without : {"", "corrections"}) {
    Options options;
    options.tolerance = arguments.tolerance;
    if (!without.empty()) options.without = {without};
    Runs runs;
    for (const Workload& workload : workloads) Append(workload, options, runs);
    std::printf("sigma / sigma at the end, method paper%s%s\n", without.empty() ? "" : " without ",
                without.c_str());
    Print(runs);
  }
}

}  // namespace

int Main(int argc, char** argv) {
  SetArguments arguments;
  arguments.count = 20;
  CLI::App app("σ per iteration of the paper's method.", "sigma_bench");
  AddSetArguments(app, arguments);
  return RunProgram(app, argc, argv, [&] { Run(arguments); });
}

}  // namespace mjcf_pdg::bench

int main(int argc, char** argv) { return mjcf_pdg::bench::Main(argc, argv); }
