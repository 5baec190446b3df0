// A Tracker at 1 kHz: joints follow sinusoids through obstacles and through the robot itself; each
// command is tracked, and some are solved anew to compare with. One row per model; README.md beside
// this file says what the columns mean.
#include <mujoco/mujoco.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "measure.h"
#include "mjcf_pdg/object_norm.h"
#include "mjcf_pdg/pdg.h"
#include "track_motion.h"
#include "workloads.h"

namespace mjcf_pdg::bench {
namespace {

struct Arguments : MotionArguments {
  int solve_every = 20;  // ticks from one solve to compare with to the next
  TrackOptions track;
};

struct Tally {
  int free = 0, unsolved = 0, jumps = 0, switches = 0, way = 0, late = 0;
  std::vector<double> ticks, free_ticks;  // of commands that overlap, of free ones [s]
  std::vector<double> units, free_units;  // evaluations of such commands [s]
  std::vector<double> queries, worst_step;
  double sigma = 0.0, sigma_solved = 0.0;  // over the ticks that were solved too [m²]
};

// The largest change of a hinge or slide.
double Step(const Q& a, const Q& b) {
  double largest = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) largest = std::max(largest, std::abs(a[k] - b[k]));
  return largest;
}

void Count(const Scene& scene, const Q& command, const Q& last_command, const Q& last,
           const Result& result, Tally& tally) {
  tally.switches += result.switched;
  tally.way += result.under_way;
  const double moved =
      std::sqrt(ObjectNorm(scene, Metric::kSequential, last_command).Sigma(command));
  const double answer = std::sqrt(ObjectNorm(scene, Metric::kSequential, last).Sigma(result.q));
  tally.jumps += !result.switched && !result.under_way && answer > 10.0 * moved + 1e-6;
}

Tally Track(const mjModel& m, const Arguments& a, Random& random) {
  const Scene scene = Scene::FromModel(&m);
  const Commands commands(m, a, random);
  TrackOptions options = a.track;
  Tracker tracker(scene, options);
  Solver solver(scene, options.options);
  Result result, solved;
  Tally tally;
  Q last, last_command;
  const DataPtr d(mj_makeData(&m), mj_deleteData);
  for (int tick = 0; tick < a.ticks; ++tick) {
    const Q command = commands.At(1e-3 * tick);
    const double begin = CpuSeconds();
    tracker.Step(command, result);
    const double seconds = CpuSeconds() - begin;
    tally.unsolved += result.status == Status::kUnsolved;
    tally.free += Verify(scene, result.q).free;
    if (tick > 0) {
      Count(scene, command, last_command, last, result, tally);
      tally.late += seconds > 1e-3;
      (result.status == Status::kAlreadyFree ? tally.free_ticks : tally.ticks).push_back(seconds);
      tally.queries.push_back(result.stats.collision_queries);
      tally.worst_step.push_back(Step(result.q, last));
    }
    if (tick % a.solve_every == 0) {
      std::copy(command.begin(), command.end(), d->qpos);
      const double unit_begin = CpuSeconds();
      mj_kinematics(&m, d.get());
      mj_comPos(&m, d.get());
      mj_collision(&m, d.get());
      const bool free = result.status == Status::kAlreadyFree;
      (free ? tally.free_units : tally.units).push_back(CpuSeconds() - unit_begin);
      if (result.status == Status::kSolved && solver.Solve(command, solved) == Status::kSolved) {
        tally.sigma += result.sigma;
        tally.sigma_solved += solved.sigma;
      }
    }
    last = result.q;
    last_command = command;
  }
  return tally;
}

void PrintRow(const std::string& path, const Arguments& a) {
  Random random(a.seed);
  const ModelPtr model = WithObstacles(path, a, random);
  const Tally t = Track(*model, a, random);
  const double unit = Quantile(t.units, 0.5), free_unit = Quantile(t.free_units, 0.5);
  const std::string name = path.substr(path.find_last_of('/') + 1);
  std::printf(
      "%-24s %6d %6zu %6.2f %5d %5.1f %6.1f %6.1f %6.1f %5.0f %5d %5d %5d %5d %6.3f %6.3f\n",
      name.c_str(), a.ticks, t.ticks.size(), 100.0 * t.free / a.ticks, t.unsolved,
      Quantile(t.free_ticks, 0.5) / free_unit, Quantile(t.ticks, 0.5) / unit,
      Quantile(t.ticks, 0.99) / unit, Quantile(t.ticks, 1.0) / unit, Quantile(t.queries, 1.0),
      t.jumps, t.switches, t.way, t.late, t.sigma / t.sigma_solved, Quantile(t.worst_step, 1.0));
  std::fflush(stdout);
}

void Run(const Arguments& arguments) {
  std::printf("%-24s %6s %6s %6s %5s %5s %6s %6s %6s %5s %5s %5s %5s %5s %6s %6s\n", "model",
              "ticks", "overl.", "free%", "uns.", "free", "p50", "p99", "max", "quer.", "jumps",
              "switch", "way", ">1ms", "sigma", "step");
  const std::vector<std::string> models = arguments.models.empty() ? OwnModels() : arguments.models;
  for (const std::string& path : models) PrintRow(path, arguments);
}

}  // namespace
}  // namespace mjcf_pdg::bench

int main(int argc, char** argv) {
  CLI::App app("A Tracker that follows sinusoids");
  mjcf_pdg::bench::Arguments a;
  a.track.options.report_lower_bound = false;
  AddMotionArguments(app, a);
  app.add_option("--solve-every", a.solve_every,
                 "Ticks from one solve to compare with to the next");
  app.add_option("--queries", a.track.queries, "TrackOptions::queries");
  app.add_option("--switch-gain", a.track.switch_gain,
                 "TrackOptions::switch_gain; 0.999: only switches that are forced");
  app.add_option("--max-step", a.track.max_step, "TrackOptions::max_step [rad or m]");
  app.add_flag("--certify", a.track.certify_motion, "TrackOptions::certify_motion");
  return mjcf_pdg::bench::RunProgram(app, argc, argv, [&] { mjcf_pdg::bench::Run(a); });
}
