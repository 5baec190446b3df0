// How good and how fast are solves? One row per model, problem set and effort.
//
// Time is counted in evaluations: one mj_kinematics + mj_comPos + mj_collision of the same model at
// the problems' own configurations, timed in the same run between the solves, so that a slower
// machine or a busy one changes both. README.md beside this file says what the columns mean.
#include <mujoco/mujoco.h>
#include <time.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <fstream>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "mjcf_pdg/pdg.h"
#include "problem_sets.h"

namespace mjcf_pdg::bench {
namespace {

constexpr int kBatch = 5;                // solves between two timings of an evaluation
constexpr double kTimingSeconds = 2e-3;  // least duration of one timing
// Seeds of the runs that only look for a lower σ, away from those measured.
constexpr std::uint64_t kFirstPersistentSeed = 1000;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Arguments {
  std::vector<std::string> models;
  std::string problems;
  std::string root = ".";
  std::string json;
  std::vector<std::string> efforts = {"default"};
  std::uint64_t seed = 1;  // of the random configurations
  int count = 40;
  int seeds = 1;
  int persistence = 3;
  double tolerance = 1e-6;
};

// One solve of one problem.
struct Measured {
  int problem = 0;
  std::uint64_t seed = 0;
  Result result;
  bool verified = false;
  double seconds = 0.0;
};

// All solves of a set at one effort.
struct Series {
  std::string effort;
  std::vector<Measured> solves;
  std::vector<double> evaluation_seconds;
};

Effort ParseEffort(const std::string& name) {
  if (name == "fast") return Effort::kFast;
  return name == "max" ? Effort::kMax : Effort::kDefault;
}

const char* StatusName(Status status) {
  if (status == Status::kAlreadyFree) return "already_free";
  return status == Status::kSolved ? "solved" : "unsolved";
}

// Of this thread alone: solves and evaluations wait for nothing, so this is wall time on an idle
// machine, and on a busy one the others do not count.
double CpuSeconds() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// Linear interpolation between order statistics; an infinite neighbour makes it infinite.
double Quantile(std::vector<double> values, double p) {
  if (values.empty()) return std::nan("");
  std::sort(values.begin(), values.end());
  const double at = p * static_cast<double>(values.size() - 1);
  const std::size_t below = static_cast<std::size_t>(at);
  const double part = at - static_cast<double>(below);
  if (part == 0.0 || values[below] == values[below + 1]) return values[below];
  return values[below] + part * (values[below + 1] - values[below]);
}

// Times plain MuJoCo on the configurations of a set.
class EvaluationTimer {
 public:
  EvaluationTimer(const Scene& scene, const ProblemSet& set)
      : model_(*scene.model()), set_(set), data_(mj_makeData(&model_)) {}
  ~EvaluationTimer() { mj_deleteData(data_); }
  EvaluationTimer(const EvaluationTimer&) = delete;
  EvaluationTimer& operator=(const EvaluationTimer&) = delete;

  // Seconds of one evaluation, averaged over whole rounds of the set's configurations.
  double Time() {
    const double begin = CpuSeconds();
    int count = 0;
    do {
      for (const BenchProblem& problem : set_.problems) {
        mju_copy(data_->qpos, problem.q_in.data(), model_.nq);
        mj_kinematics(&model_, data_);
        mj_comPos(&model_, data_);
        mj_collision(&model_, data_);
        ++count;
      }
    } while (CpuSeconds() - begin < kTimingSeconds);
    return (CpuSeconds() - begin) / count;
  }

 private:
  const mjModel& model_;
  const ProblemSet& set_;
  mjData* data_;
};

Series Measure(const Scene& scene, const ProblemSet& set, const std::string& effort,
               const Arguments& arguments) {
  Series series{effort, {}, {}};
  EvaluationTimer timer(scene, set);
  timer.Time();  // warms the caches
  for (int s = 0; s < arguments.seeds; ++s) {
    Options options;
    options.effort = ParseEffort(effort);
    options.tolerance = arguments.tolerance;
    options.seed = static_cast<std::uint64_t>(s);
    Solver solver(scene, options);
    for (std::size_t k = 0; k < set.problems.size(); ++k) {
      if (k % kBatch == 0) series.evaluation_seconds.push_back(timer.Time());
      Measured solve{static_cast<int>(k), options.seed, {}, false, 0.0};
      const double begin = CpuSeconds();
      solve.result = solver.Solve(set.problems[k].q_in);
      solve.seconds = CpuSeconds() - begin;
      const bool claimed = solve.result.status != Status::kUnsolved;
      solve.verified =
          claimed && Verify(scene, solve.result.q, options, &set.problems[k].q_in).free;
      series.solves.push_back(std::move(solve));
    }
    series.evaluation_seconds.push_back(timer.Time());
  }
  return series;
}

// Lowers `best` (one per problem) by what effort max reaches with several seeds.
void Persist(const Scene& scene, const ProblemSet& set, const Arguments& arguments,
             std::vector<double>& best) {
  for (int s = 0; s < arguments.persistence; ++s) {
    Options options;
    options.effort = Effort::kMax;
    options.tolerance = arguments.tolerance;
    options.seed = kFirstPersistentSeed + static_cast<std::uint64_t>(s);
    Solver solver(scene, options);
    for (std::size_t k = 0; k < set.problems.size(); ++k) {
      const Result result = solver.Solve(set.problems[k].q_in);
      if (result.status == Status::kSolved) best[k] = std::min(best[k], result.sigma);
    }
  }
}

void PrintHeader() {
  std::printf("%-36s %-8s %4s %5s %6s %7s %7s %8s %7s %7s %7s %7s %6s %5s %6s  %s\n", "set",
              "effort", "n", "free%", "ok%", "ratio", "p95", "max", "queries", "p99", "evals",
              "p99", "iter", "start", "u [us]", "winning starts");
}

void PrintRow(const ProblemSet& set, const Series& series, const std::vector<double>& best) {
  const double u = Quantile(series.evaluation_seconds, 0.5);
  int n = 0, already_free = 0, ok = 0;
  std::vector<double> ratio, queries, evaluations, iterations, starts;
  std::map<std::string, int> winners;
  for (const Measured& solve : series.solves) {
    ++n;
    ok += solve.verified;
    if (solve.result.status == Status::kAlreadyFree) {
      ++already_free;
      continue;
    }
    ratio.push_back(solve.verified ? solve.result.sigma / best[solve.problem] : kInfinity);
    queries.push_back(solve.result.stats.collision_queries);
    evaluations.push_back(solve.seconds / u);
    iterations.push_back(solve.result.stats.iterations);
    starts.push_back(solve.result.stats.starts);
    if (solve.verified) ++winners[solve.result.start];
  }
  std::printf(
      "%-36s %-8s %4d %5.1f %6.1f %7.4f %7.4f %8.3f %7.0f %7.0f %7.1f %7.0f %6.0f %5.0f "
      "%6.1f ",
      set.name.c_str(), series.effort.c_str(), n, 100.0 * already_free / n, 100.0 * ok / n,
      Quantile(ratio, 0.5), Quantile(ratio, 0.95), Quantile(ratio, 1.0), Quantile(queries, 0.5),
      Quantile(queries, 0.99), Quantile(evaluations, 0.5), Quantile(evaluations, 0.99),
      Quantile(iterations, 0.5), Quantile(starts, 0.5), 1e6 * u);
  for (const auto& [name, count] : winners) std::printf(" %s %d", name.c_str(), count);
  std::printf("\n");
  std::fflush(stdout);
}

void WriteJson(const ProblemSet& set, const Series& series, const std::vector<double>& best,
               std::ofstream& out) {
  const double u = Quantile(series.evaluation_seconds, 0.5);
  for (const Measured& solve : series.solves) {
    const BenchProblem& problem = set.problems[solve.problem];
    const Result& r = solve.result;
    nlohmann::json line = {{"set", set.name},
                           {"model", set.model_path},
                           {"id", problem.id},
                           {"effort", series.effort},
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
  std::vector<double> best;
  for (const BenchProblem& problem : set.problems) best.push_back(problem.best_known);
  for (const std::string& effort : arguments.efforts) {
    all.push_back(Measure(scene, set, effort, arguments));
    for (const Measured& solve : all.back().solves) {
      if (!solve.verified) continue;
      best[solve.problem] = std::min(best[solve.problem], solve.result.sigma);
    }
  }
  Persist(scene, set, arguments, best);
  for (const Series& series : all) {
    PrintRow(set, series, best);
    if (json.is_open()) WriteJson(set, series, best, json);
  }
}

// A scene that cannot be loaded or solved gets a row with the reason; the rest goes on.
void RunModel(const std::string& path, const std::vector<ProblemSet>* given,
              const Arguments& arguments, std::ofstream& json) {
  try {
    const Scene scene = Scene::FromFile(path);
    const Solver accepts(scene);  // or says why not
    if (given) {
      for (const ProblemSet& set : *given) RunSet(scene, set, arguments, json);
      return;
    }
    const ProblemSet keyframes = Keyframes(scene, path);
    if (!keyframes.problems.empty()) RunSet(scene, keyframes, arguments, json);
    RunSet(scene, RandomProblems(scene, path, arguments.count, arguments.seed), arguments, json);
  } catch (const std::exception& error) {
    std::printf("%-36s %s\n", path.c_str(), error.what());
  }
}

void HandleMessage(const mjLogMessage* message) {
  if (message->level < mjLOG_WARNING) return;
  if (message->level >= mjLOG_ERROR) throw Error(std::string("MuJoCo: ") + message->subject);
  std::fprintf(stderr, "MuJoCo: %s\n", message->subject);
}

void Run(const Arguments& arguments) {
  std::ofstream json;
  if (!arguments.json.empty()) {
    json.open(arguments.json);
    if (!json) throw Error("cannot write " + arguments.json);
  }
  PrintHeader();
  if (!arguments.problems.empty()) {
    for (const ProblemSet& set : ReadProblems(arguments.problems, arguments.root)) {
      const std::vector<ProblemSet> one = {set};
      RunModel(set.model_path, &one, arguments, json);
    }
  }
  for (const std::string& path : arguments.models) RunModel(path, nullptr, arguments, json);
}

}  // namespace

int Main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app("Quality and time of solves, one row per model, problem set and effort.");
  app.add_option("models", arguments.models,
                 "MJCF files (default: the project's own three scenes)");
  app.add_option("--problems", arguments.problems, "JSON Lines with model, qpos, best");
  app.add_option("--root", arguments.root, "folder that the models in --problems are relative to");
  app.add_option("--count", arguments.count, "random configurations per model")
      ->check(CLI::Range(0, 1000000));
  app.add_option("--seed", arguments.seed, "seed of the random configurations");
  app.add_option("--seeds", arguments.seeds, "measure with solver seeds 0 to N-1")
      ->check(CLI::Range(1, 1000));
  app.add_option("--persistence", arguments.persistence,
                 "further seeds at effort max that only look for a lower σ")
      ->check(CLI::Range(0, 1000));
  app.add_option("--effort", arguments.efforts, "fast, default, max; several with commas")
      ->delimiter(',')
      ->check(CLI::IsMember({"fast", "default", "max"}));
  app.add_option("--tolerance", arguments.tolerance, "overlap that counts as free [m]");
  app.add_option("--json", arguments.json, "write every solve to this file, as JSON Lines");
  CLI11_PARSE(app, argc, argv);
  if (arguments.models.empty() && arguments.problems.empty()) {
    const std::string folder = MJCF_PDG_MODEL_DIR;
    arguments.models = {folder + "/puma/puma_car.xml", folder + "/hand/hand_bottle.xml",
                        folder + "/figure/figure_bench.xml"};
  }
  mjLogConfig log = mju_getLogConfig();
  log.logto_console = 0;
  log.logto_file = 0;
  mju_setLogConfig(log);
  mju_setLogHandler(HandleMessage);
  try {
    Run(arguments);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "solve_bench: error: %s\n", error.what());
    return 2;
  }
  return 0;
}

}  // namespace mjcf_pdg::bench

int main(int argc, char** argv) { return mjcf_pdg::bench::Main(argc, argv); }
