// A Tracker at 1 kHz: joints follow sinusoids through obstacles and through the robot itself; each
// command is tracked, and some are solved anew to compare with. One row per model; README.md beside
// this file says what the columns mean.
#include <mujoco/mujoco.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "base/random.h"
#include "measure.h"
#include "mjcf_pdg/object_norm.h"
#include "mjcf_pdg/pdg.h"
#include "workloads.h"

namespace mjcf_pdg::bench {
namespace {

struct Arguments {
  std::vector<std::string> models;  // empty: our own three
  int ticks = 10000;
  int obstacles = 12;
  double amplitude = 0.35;  // of a joint's range, which is at most half a turn [1]
  int solve_every = 20;     // ticks from one solve to compare with to the next
  unsigned long long seed = 0;
  TrackOptions track;
};

using ModelPtr = std::unique_ptr<mjModel, void (*)(mjModel*)>;
using DataPtr = std::unique_ptr<mjData, void (*)(mjData*)>;
using Q = std::vector<double>;

struct SpecDeleter {
  void operator()(mjSpec* spec) const { mj_deleteSpec(spec); }
};

Q Home(const mjModel& m) {
  const mjtNum* q = m.nkey > 0 ? m.key_qpos : m.qpos0;
  return {q, q + m.nq};
}

// Uniform between two numbers.
double Between(Random& random, double low, double high) {
  return low + random.Uniform() * (high - low);
}

// Smooth commands about the home configuration; free joints and balls stay.
class Commands {
 public:
  Commands(const mjModel& m, const Arguments& a, Random& random) : home_(Home(m)) {
    for (int j = 0; j < m.njnt; ++j) {
      if (m.jnt_type[j] != mjJNT_HINGE && m.jnt_type[j] != mjJNT_SLIDE) continue;
      const bool limited = m.jnt_limited[j];
      const double low = limited ? m.jnt_range[2 * j] : -1.5;
      const double high = limited ? m.jnt_range[2 * j + 1] : 1.5;
      const double reach = a.amplitude * std::min(high - low, M_PI);
      const double middle =
          std::clamp(home_[m.jnt_qposadr[j]], low + reach, std::max(low + reach, high - reach));
      waves_.push_back({m.jnt_qposadr[j], middle, reach, Between(random, 0.1, 0.4),
                        Between(random, 0.0, 2.0 * M_PI)});
    }
  }
  // At a time [s].
  Q At(double t) const {
    Q q = home_;
    for (const Wave& w : waves_) {
      q[w.qadr] = w.middle + w.amplitude * std::sin(2.0 * M_PI * w.frequency * t + w.phase);
    }
    return q;
  }

 private:
  struct Wave {
    int qadr;
    double middle, amplitude, frequency, phase;
  };
  Q home_;
  std::vector<Wave> waves_;
};

// The model with boxes, balls and capsules of a few centimetres around it, each where some geom
// comes by, and none where the robot is at home.
ModelPtr WithObstacles(const std::string& path, const Arguments& a, Random& random) {
  char error[1000] = "";
  const std::unique_ptr<mjSpec, SpecDeleter> spec(
      mj_parseXML(path.c_str(), nullptr, error, sizeof error));
  if (!spec) throw Error(path + ": " + error);
  ModelPtr model(mj_compile(spec.get(), nullptr), mj_deleteModel);
  if (!model) throw Error(path + ": " + mjs_getError(spec.get()));
  const DataPtr d(mj_makeData(model.get()), mj_deleteData);
  const Commands commands(*model, a, random);
  double radius = 0.0;  // of a typical geom that moves
  std::vector<int> moving;
  for (int g = 0; g < model->ngeom; ++g) {
    const bool collides = model->geom_contype[g] || model->geom_conaffinity[g];
    if (!collides || model->body_weldid[model->geom_bodyid[g]] == 0) continue;
    moving.push_back(g);
    radius += model->geom_rbound[g];
  }
  if (moving.empty()) throw Error(path + ": no geom moves");
  radius *= 0.5 / static_cast<double>(moving.size());
  for (int made = 0, tries = 0; made < a.obstacles && tries < 100 * a.obstacles; ++tries) {
    const Q q = commands.At(Between(random, 0.0, 10.0));
    std::copy(q.begin(), q.end(), d->qpos);
    mj_kinematics(model.get(), d.get());
    const int g = moving[static_cast<std::size_t>(random.Uniform() * 0.999 *
                                                  static_cast<double>(moving.size()))];
    double place[3], apart = 1e9;
    for (int k = 0; k < 3; ++k) {
      place[k] = d->geom_xpos[3 * g + k] + Between(random, -1.0, 1.0) * model->geom_rbound[g];
    }
    const Q home = commands.At(0.0);
    std::copy(home.begin(), home.end(), d->qpos);
    mj_kinematics(model.get(), d.get());
    for (const int other : moving) {
      const double* at = d->geom_xpos + 3 * other;
      const double distance = std::hypot(at[0] - place[0], at[1] - place[1], at[2] - place[2]);
      apart = std::min(apart, distance - model->geom_rbound[other] - 2.0 * radius);
    }
    if (apart < 0.0) continue;
    mjsGeom* geom = mjs_addGeom(mjs_findBody(spec.get(), "world"), nullptr);
    const mjtGeom types[] = {mjGEOM_SPHERE, mjGEOM_BOX, mjGEOM_CAPSULE};
    geom->type = types[made % 3];
    geom->contype = geom->conaffinity = 1;
    for (int k = 0; k < 3; ++k) {
      geom->pos[k] = place[k];
      geom->size[k] = radius * (geom->type == mjGEOM_SPHERE ? 1.0 : Between(random, 0.5, 1.0));
    }
    ++made;
  }
  model.reset(mj_compile(spec.get(), nullptr));
  if (!model) throw Error(path + ": " + mjs_getError(spec.get()));
  return model;
}

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
  app.add_option("models", a.models, "MJCF files (default: our own three)");
  app.add_option("--ticks", a.ticks, "Commands at 1 kHz");
  app.add_option("--obstacles", a.obstacles, "Obstacles around the robot");
  app.add_option("--amplitude", a.amplitude, "Of the sinusoids, share of a joint's range");
  app.add_option("--solve-every", a.solve_every,
                 "Ticks from one solve to compare with to the next");
  app.add_option("--seed", a.seed, "Of obstacles and commands");
  app.add_option("--queries", a.track.queries, "TrackOptions::queries");
  app.add_option("--switch-gain", a.track.switch_gain,
                 "TrackOptions::switch_gain; 0.999: only switches that are forced");
  app.add_option("--max-step", a.track.max_step, "TrackOptions::max_step [rad or m]");
  app.add_flag("--certify", a.track.certify_motion, "TrackOptions::certify_motion");
  return mjcf_pdg::bench::RunProgram(app, argc, argv, [&] { mjcf_pdg::bench::Run(a); });
}
