// The paper's results for articulated models with ours beside them: Fig. 13 and Table III.
//
// Fig. 13: two links over the ground, σ compared with the optimum of Eq. 32, found by a fine
// search. Table III: trajectories of 200 frames made after the paper's description
// (trajectories.h), each with motion coherence (the frames follow each other) and without. Only
// frames that penetrate count. The paper's times are from an Intel i5 of 2.4 GHz, with exact
// triangle meshes.
//
// Run: paper_tables_bench [MODELS], where MODELS is the folder models/ of the project.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "measure.h"
#include "mjcf_pdg/pdg.h"
#include "tests/support/paper_support.h"
#include "trajectories.h"

namespace mjcf_pdg::bench {
namespace {

const char* Name(Method method) { return method == Method::kPaper ? "paper" : "auto"; }

void PrintFigure13() {
  std::printf("Fig. 13: two links of length l over the ground at distance d; sigma in l^2\n");
  std::printf("%6s %10s %12s %10s %12s %10s\n", "d / l", "optimum", "auto", "error", "paper",
              "error");
  double squares[2] = {0.0, 0.0};
  for (int k = 0; k < 10; ++k) {
    const double d = 1.0 + 0.1 * k, optimum = test::TwoLinksOptimum(d);
    std::printf("%6.1f %10.6f", d, optimum);
    for (const Method method : {Method::kAuto, Method::kPaper}) {
      Options options;
      options.method = method;
      const Scene scene = Scene::FromString(test::TwoLinksXml(d));
      const Result result = Solver(scene, options).Solve({0.0, 0.0});
      std::printf(" %12.6f %9.4f%%", result.sigma, 100.0 * (result.sigma / optimum - 1.0));
      const double error = result.sigma - optimum;
      squares[method == Method::kPaper] += 0.1 * error * error;
    }
    std::printf("\n");
  }
  std::printf("mean squared error: auto %.2g, paper %.2g; in the paper 0.0027\n\n", squares[0],
              squares[1]);
}

double Mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return values.empty() ? 0.0 : sum / values.size();
}

// Solves all frames in order with one solver.
std::vector<Result> Solve(const Scene& scene, const std::vector<std::vector<double>>& frames,
                          Method method, bool coherence) {
  Options options;
  options.method = method;
  options.trajectory = coherence;
  options.tolerance = 1e-5;
  Solver solver(scene, options);
  std::vector<Result> results;
  for (const std::vector<double>& q : frames) results.push_back(solver.Solve(q));
  return results;
}

// Prints one row. `best` has the lowest σ of all series for each frame [m²].
void PrintSeries(const char* label, const std::vector<Result>& results,
                 const std::vector<double>& best) {
  std::vector<double> ms, iterations, ratios;
  int solved = 0;
  for (std::size_t k = 0; k < results.size(); ++k) {
    const Result& result = results[k];
    if (result.status == Status::kAlreadyFree) continue;
    ms.push_back(1e3 * result.stats.seconds);
    iterations.push_back(result.stats.iterations);
    if (result.status != Status::kSolved) continue;
    ++solved;
    ratios.push_back(result.sigma / best[k]);
  }
  const double success = ms.empty() ? 0.0 : 100.0 * solved / ms.size();
  std::printf("  %-26s %6zu %8.2f %8.2f %11.1f %10.1f %12.3f %9.3f\n", label, ms.size(),
              Quantile(ms, 0.5), Mean(ms), Mean(iterations), success, Quantile(ratios, 0.5),
              Mean(ratios));
}

void PrintTable3(const std::string& models) {
  std::printf("Table III: per penetrating frame; sigma/best against the lowest of the four rows\n");
  std::printf("  %-26s %6s %8s %8s %11s %10s %12s %9s\n", "", "frames", "median", "mean ms",
              "iterations", "success %", "sigma/best", "mean");
  for (const Trajectory& trajectory : Trajectories()) {
    const Scene scene = Scene::FromFile(models + "/" + trajectory.model);
    const std::vector<std::vector<double>> frames = Frames(scene, trajectory);
    std::vector<std::vector<Result>> series;
    std::vector<std::string> labels;
    std::vector<double> best(frames.size(), std::numeric_limits<double>::infinity());
    for (const Method method : {Method::kPaper, Method::kAuto}) {
      for (const bool coherence : {true, false}) {
        series.push_back(Solve(scene, frames, method, coherence));
        labels.push_back(std::string(Name(method)) + (coherence ? ", coherence" : ""));
        for (std::size_t k = 0; k < frames.size(); ++k) {
          const Result& result = series.back()[k];
          if (result.status == Status::kSolved) best[k] = std::min(best[k], result.sigma);
        }
      }
    }
    std::printf("%s (in the paper: %.1f ms, %.1f iterations)\n", trajectory.name,
                trajectory.paper_ms, trajectory.paper_iterations);
    for (std::size_t s = 0; s < series.size(); ++s) {
      PrintSeries(labels[s].c_str(), series[s], best);
    }
  }
}

}  // namespace

int PaperTablesMain(int argc, char** argv);

int PaperTablesMain(int argc, char** argv) {
  try {
    PrintFigure13();
    PrintTable3(argc > 1 ? argv[1] : MJCF_PDG_MODEL_DIR);
  } catch (const Error& error) {
    std::fprintf(stderr, "mjcf_pdg_paper_tables: error: %s\n", error.what());
    return 2;
  }
  return 0;
}

}  // namespace mjcf_pdg::bench

int main(int argc, char** argv) { return mjcf_pdg::bench::PaperTablesMain(argc, argv); }
