// What a solve costs in scenes of many bodies.
//
// First table: N free boxes on a plane, two of them 1 cm in each other. All other boxes stand by;
// the two alone are the scale. Second table: heaps, N bodies of mixed shapes thrown together in a
// box of space that they fill by half, solved, and beside it what people do first: let MuJoCo
// settle them, without gravity and damped, until nothing overlaps.
#include <mujoco/mujoco.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "measure.h"
#include "mjcf_pdg/object_norm.h"
#include "mjcf_pdg/pdg.h"

namespace mjcf_pdg::bench {
namespace {

constexpr double kHalf = 0.05, kApart = 0.2, kDepth = 0.01;  // of the boxes [m]
constexpr double kShift = 0.003;                             // of all, from solve to solve [m]

std::string Body(const std::string& geom) {
  return "<body><freejoint/><geom " + geom + "/></body>";
}

Scene Boxes(int count) {
  std::string xml = "<mujoco><worldbody><geom type=\"plane\" size=\"50 50 1\"/>";
  for (int k = 0; k < count; ++k) xml += Body("type=\"box\" size=\".05 .05 .05\"");
  return Scene::FromString(xml + "</worldbody></mujoco>");
}

// Boxes in a square grid that begins at x = `begin`; box `moved` stands kDepth deep in the one
// before it.
std::vector<double> Grid(int count, int moved, double begin = 0.0) {
  const int side = static_cast<int>(std::ceil(std::sqrt(count)));
  std::vector<double> q;
  for (int k = 0; k < count; ++k) {
    const int cell = k == moved ? k - 1 : k;
    const double shift = k == moved ? 2.0 * kHalf - kDepth : 0.0;
    q.insert(q.end(),
             {begin + kApart * (cell % side) + shift, kApart * (cell / side), kHalf, 1, 0, 0, 0});
  }
  return q;
}

// A row of the first table. The first solve of each pair of boxes makes an island for it, the later
// ones find it made. Returns the time of the later ones [s].
double PrintBoxes(int count, double alone) {
  const Scene scene = Boxes(count);
  Solver solver(scene);
  std::vector<double> first, later, queries, ratio;
  int solved = 0, bystanders = 0;
  constexpr int kPairs = 9, kRepeats = 4;
  for (int k = 0; k < kPairs; ++k) {
    const int moved = count == 2 ? 1 : 1 + 2 * (k * (count - 1) / (2 * kPairs));
    for (int repeat = 0; repeat < kRepeats; ++repeat) {
      const std::vector<double> q = Grid(count, moved, kShift * repeat);
      const double begin = CpuSeconds();
      const Result result = solver.Solve(q);
      (repeat == 0 ? first : later).push_back(CpuSeconds() - begin);
      solved += result.status == Status::kSolved;
      queries.push_back(result.stats.collision_queries);
      // The nearest answer without rotations: each box makes half of the way.
      ratio.push_back(result.sigma * count / (0.5 * kDepth * kDepth));
      for (int body = 0; body < count; ++body) {
        const bool same =
            std::equal(q.begin() + 7 * body, q.begin() + 7 * body + 7, result.q.begin() + 7 * body);
        bystanders += !same && body != moved && body != moved - 1;
      }
    }
  }
  const double unit = EvaluationSeconds(scene, Grid(count, 1)), time = Quantile(later, 0.5);
  std::printf("%5d %8.1f %9.1f %9.1f %9.1f %8.1f %8.0f %8.4f %7d %6d/%d\n", count, 1e6 * unit,
              1e6 * Quantile(first, 0.5), 1e6 * time, time / unit,
              alone > 0.0 ? (time - 3.0 * alone) / unit : 0.0, Quantile(queries, 0.5),
              Quantile(ratio, 0.5), bystanders, solved, kPairs * kRepeats);
  return time;
}

Scene Heap(int count, std::mt19937& random) {
  std::uniform_real_distribution<double> size(0.03, 0.08);
  std::string xml =
      "<mujoco><option gravity=\"0 0 0\"/><worldbody><geom type=\"plane\" size=\"5 5 1\"/>";
  const char* const types[] = {"sphere", "capsule", "ellipsoid", "cylinder", "box"};
  for (int k = 0; k < count; ++k) {
    const auto length = [&] { return std::to_string(size(random)) + " "; };
    xml += Body("type=\"" + std::string(types[k % 5]) + "\" size=\"" + length() + length() +
                length() + "\"");
  }
  return Scene::FromString(xml + "</worldbody></mujoco>");
}

std::vector<double> Thrown(int count, std::mt19937& random) {
  // Bodies of 6 cm fill about half of the cube.
  const double side = 0.12 * std::cbrt(count);
  std::uniform_real_distribution<double> place(0.0, side);
  std::normal_distribution<double> turn;
  std::vector<double> q;
  for (int k = 0; k < count; ++k) {
    double quat[4] = {turn(random), turn(random), turn(random), turn(random)};
    mju_normalize4(quat);
    q.insert(q.end(), {place(random), place(random), 0.05 + place(random)});
    q.insert(q.end(), quat, quat + 4);
  }
  return q;
}

// Steps MuJoCo, velocities damped, until Solver::IsFree; seconds < 0: never.
struct Settled {
  double seconds = -1.0, sigma = 0.0;
};
Settled Settle(const Scene& scene, Solver& solver, const std::vector<double>& q) {
  mjModel* m = mj_copyModel(nullptr, scene.model());
  mjData* d = mj_makeData(m);
  std::copy(q.begin(), q.end(), d->qpos);
  Settled settled;
  const double begin = CpuSeconds();
  constexpr int kSteps = 2000;
  for (int step = 0; step < kSteps && settled.seconds < 0.0; ++step) {
    mj_step(m, d);
    mju_scl(d->qvel, d->qvel, 0.9, static_cast<int>(m->nv));
    if (step % 10 == 9 && solver.IsFree({d->qpos, q.size()}))
      settled.seconds = CpuSeconds() - begin;
  }
  settled.sigma = ObjectNorm(scene, Metric::kSequential, q)
                      .Sigma(std::vector<double>(d->qpos, d->qpos + m->nq));
  mj_deleteData(d);
  mj_deleteModel(m);
  return settled;
}

void PrintHeaps(int count, int seeds, bool settles) {
  std::vector<double> seconds, settling, queries;
  int solved = 0, settled_count = 0, nearer = 0;
  for (int seed = 0; seed < seeds; ++seed) {
    std::mt19937 random(seed);
    const Scene scene = Heap(count, random);
    const std::vector<double> q = Thrown(count, random);
    Solver solver(scene);
    const double begin = CpuSeconds();
    const Result result = solver.Solve(q);
    seconds.push_back(CpuSeconds() - begin);
    queries.push_back(result.stats.collision_queries);
    const bool ok = result.status != Status::kUnsolved && Verify(scene, result.q).free;
    solved += ok;
    if (!settles) continue;
    const Settled settled = Settle(scene, solver, q);
    settled_count += settled.seconds >= 0.0;
    if (settled.seconds >= 0.0) settling.push_back(settled.seconds);
    nearer += ok && (settled.seconds < 0.0 || result.sigma < settled.sigma);
  }
  std::printf("%5d %6d/%d %9.1f %9.0f", count, solved, seeds, 1e3 * Quantile(seconds, 0.5),
              Quantile(queries, 0.5));
  if (settles) {
    std::printf(" %8d/%d %9.1f %7d/%d", settled_count, seeds, 1e3 * Quantile(settling, 0.5), nearer,
                seeds);
  }
  std::printf("\n");
  std::fflush(stdout);
}

}  // namespace
}  // namespace mjcf_pdg::bench

int main(int argc, char** argv) try {
  using namespace mjcf_pdg::bench;
  CLI::App app("Scenes of many bodies: N boxes of which two overlap, and heaps");
  std::vector<int> boxes = {2, 10, 30, 100, 300, 1000}, heaps = {10, 20, 40, 60, 100};
  int seeds = 20;
  bool no_settling = false;
  app.add_option("--boxes", boxes, "Numbers of boxes")->delimiter(',');
  app.add_option("--heaps", heaps, "Numbers of bodies in heaps")->delimiter(',');
  app.add_option("--seeds", seeds, "Heaps of each number");
  app.add_flag("--no-settling", no_settling, "Leave out what MuJoCo settles, the slow part");
  CLI11_PARSE(app, argc, argv);
  HandleMujocoMessages();
  std::printf(
      "    N  eval us  first us    us      evals  -3 alone  queries  s/s_ref  moved  solved\n");
  double alone = 0.0;
  for (const int count : boxes) {
    const double time = PrintBoxes(count, alone);
    if (alone == 0.0) alone = time;
  }
  std::printf("\n heap  solved   median ms  queries  settled  median ms  nearer than settled\n");
  for (const int count : heaps) PrintHeaps(count, seeds, !no_settling);
  return 0;
} catch (const mjcf_pdg::Error& error) {
  std::fprintf(stderr, "many_bodies_bench: %s\n", error.what());
  return 2;
}
