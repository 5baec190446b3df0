#include "measure.h"

#include <mujoco/mujoco.h>
#include <time.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

namespace mjcf_pdg::bench {
namespace {

constexpr int kBatch = 5;                // solves between two timings of an evaluation
constexpr double kTimingSeconds = 2e-3;  // least duration of one timing [s]

// Times evaluations at the configurations of a set.
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

void HandleMessage(const mjLogMessage* message) {
  if (message->level < mjLOG_WARNING) return;
  if (message->level >= mjLOG_ERROR) throw Error(std::string("MuJoCo: ") + message->subject);
  std::fprintf(stderr, "MuJoCo: %s\n", message->subject);
}

}  // namespace

double CpuSeconds() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void HandleMujocoMessages() {
  mjLogConfig log = mju_getLogConfig();
  log.logto_console = 0;
  log.logto_file = 0;
  mju_setLogConfig(log);
  mju_setLogHandler(HandleMessage);
}

double EvaluationSeconds(const Scene& scene, const std::vector<double>& q) {
  const mjModel* m = scene.model();
  mjData* d = mj_makeData(m);
  std::copy(q.begin(), q.end(), d->qpos);
  std::vector<double> seconds;
  for (int k = 0; k < 21; ++k) {
    const double begin = CpuSeconds();
    mj_kinematics(m, d);
    mj_comPos(m, d);
    mj_collision(m, d);
    seconds.push_back(CpuSeconds() - begin);
  }
  mj_deleteData(d);
  return Quantile(seconds, 0.5);
}

double Quantile(std::vector<double> values, double p) {
  if (values.empty()) return std::nan("");
  std::sort(values.begin(), values.end());
  const double at = p * static_cast<double>(values.size() - 1);
  const std::size_t below = static_cast<std::size_t>(at);
  const double part = at - static_cast<double>(below);
  if (part == 0.0 || values[below] == values[below + 1]) return values[below];
  return values[below] + part * (values[below + 1] - values[below]);
}

Series Measure(const Scene& scene, const ProblemSet& set, Options options, Seeds seeds) {
  Series series;
  options.trajectory = set.consecutive;
  EvaluationTimer timer(scene, set);
  timer.Time();  // warms the caches
  for (int s = 0; s < seeds.count; ++s) {
    options.seed = seeds.first + static_cast<std::uint64_t>(s);
    Solver solver(scene, options);
    for (std::size_t k = 0; k < set.problems.size(); ++k) {
      if (k % kBatch == 0) series.evaluation_seconds.push_back(timer.Time());
      const BenchProblem& problem = set.problems[k];
      Measured solve{static_cast<int>(k), options.seed, {}, false, 0.0};
      const double begin = CpuSeconds();
      solve.result = solver.Solve(problem.q_in, problem.hint);
      solve.seconds = CpuSeconds() - begin;
      const bool claimed = solve.result.status != Status::kUnsolved;
      solve.verified = claimed && Verify(scene, solve.result.q, options, &problem.q_in).free;
      series.solves.push_back(std::move(solve));
    }
    series.evaluation_seconds.push_back(timer.Time());
  }
  return series;
}

std::vector<double> BestGiven(const ProblemSet& set) {
  std::vector<double> best;
  for (const BenchProblem& problem : set.problems) best.push_back(problem.best_known);
  return best;
}

void LowerBest(const Series& series, std::vector<double>& best) {
  for (const Measured& solve : series.solves) {
    if (solve.verified) best[solve.problem] = std::min(best[solve.problem], solve.result.sigma);
  }
}

void Tally::Add(const Series& series, const std::vector<double>& best) {
  const double u = series.EvaluationSeconds();
  for (const Measured& solve : series.solves) {
    ++n;
    ok += solve.verified;
    if (solve.result.status == Status::kAlreadyFree) {
      ++already_free;
      continue;
    }
    ratio.push_back(solve.verified ? solve.result.sigma / best[solve.problem]
                                   : std::numeric_limits<double>::infinity());
    if (solve.verified) {
      bound.push_back(std::sqrt(solve.result.sigma_lower_bound / best[solve.problem]));
    }
    queries.push_back(solve.result.stats.collision_queries);
    evaluations.push_back(solve.seconds / u);
    iterations.push_back(solve.result.stats.iterations);
    starts.push_back(solve.result.stats.starts);
    if (solve.verified) ++winners[solve.result.start];
  }
}

}  // namespace mjcf_pdg::bench
