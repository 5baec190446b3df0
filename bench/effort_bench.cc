// σ against effort: what more queries gain. There is a row for each effort and number of seeds; of
// several seeds the best σ counts and the queries add up. README.md beside this file says what the
// columns mean.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include "measure.h"
#include "mjcf_pdg/pdg.h"
#include "workloads.h"

namespace mjcf_pdg::bench {
namespace {

struct Level {
  const char* name;
  Effort effort;
  int seeds;  // largest number of seeds that is combined; smaller powers of two are, too
};

constexpr Level kLevels[] = {
    {"fast", Effort::kFast, 4}, {"default", Effort::kDefault, 8}, {"max", Effort::kMax, 4}};

// All workloads at one effort.
struct Measurement {
  Level level;
  std::vector<Series> series;  // one per workload
};

// One problem solved with several seeds: their best σ [m²] and the sum of their queries.
struct Point {
  double sigma = std::numeric_limits<double>::infinity();
  int queries = 0;
};

// Combines the solves of `combined` seeds from index `first` on. Returns one point per problem.
std::vector<Point> Combine(const Series& series, std::size_t problems, int first, int combined) {
  std::vector<Point> points(problems);
  for (int s = first; s < first + combined; ++s) {
    for (std::size_t k = 0; k < problems; ++k) {
      const Measured& solve = series.solves[s * problems + k];
      points[k].queries += solve.result.stats.collision_queries;
      if (solve.verified) points[k].sigma = std::min(points[k].sigma, solve.result.sigma);
    }
  }
  return points;
}

void PrintRow(const Measurement& measurement, int combined, const std::vector<Workload>& workloads,
              const std::vector<std::vector<double>>& best) {
  std::vector<double> ratio, queries;
  for (std::size_t w = 0; w < workloads.size(); ++w) {
    const Series& series = measurement.series[w];
    const std::size_t problems = workloads[w].set.problems.size();
    for (int first = 0; first + combined <= measurement.level.seeds; first += combined) {
      const std::vector<Point> points = Combine(series, problems, first, combined);
      for (std::size_t k = 0; k < problems; ++k) {
        if (series.solves[k].result.status == Status::kAlreadyFree) continue;
        ratio.push_back(points[k].sigma / best[w][k]);
        queries.push_back(points[k].queries);
      }
    }
  }
  int ok = 0, near = 0;
  double sum = 0.0;
  for (const double r : ratio) {
    ok += r < std::numeric_limits<double>::infinity();
    near += r < 1.01;
  }
  for (const double q : queries) sum += q;
  std::printf("%-8s %5d %5zu %8.0f %8.0f %6.1f %6.1f %8.4f %8.4f %8.4f %9.3f\n",
              measurement.level.name, combined, ratio.size(), Quantile(queries, 0.5),
              sum / ratio.size(), 100.0 * ok / ratio.size(), 100.0 * near / ratio.size(),
              Quantile(ratio, 0.5), Quantile(ratio, 0.95), Quantile(ratio, 0.99),
              Quantile(ratio, 1.0));
}

void PrintTable(const std::vector<Workload>& workloads, const SetArguments& arguments) {
  std::vector<std::vector<double>> best;
  for (const Workload& workload : workloads) best.push_back(BestGiven(workload.set));
  std::vector<Measurement> all;
  for (const Level& level : kLevels) {
    Measurement& measurement = all.emplace_back(Measurement{level, {}});
    Options options;
    options.effort = level.effort;
    options.tolerance = arguments.tolerance;
    for (std::size_t w = 0; w < workloads.size(); ++w) {
      const Workload& workload = workloads[w];
      measurement.series.push_back(
          Measure(*workload.scene, workload.set, options, {0, level.seeds}));
      LowerBest(measurement.series.back(), best[w]);
    }
  }
  std::printf("%-8s %5s %5s %8s %8s %6s %6s %8s %8s %8s %9s\n", "effort", "seeds", "n", "queries",
              "mean", "ok%", "best%", "ratio", "p95", "p99", "max");
  for (const Measurement& measurement : all) {
    for (int combined = 1; combined <= measurement.level.seeds; combined *= 2) {
      PrintRow(measurement, combined, workloads, best);
    }
  }
}

}  // namespace

int Main(int argc, char** argv) {
  SetArguments arguments;
  arguments.count = 20;
  CLI::App app("σ against effort.", "effort_bench");
  AddSetArguments(app, arguments);
  return RunProgram(app, argc, argv, [&] { PrintTable(LoadSoundWorkloads(arguments), arguments); });
}

}  // namespace mjcf_pdg::bench

int main(int argc, char** argv) { return mjcf_pdg::bench::Main(argc, argv); }
