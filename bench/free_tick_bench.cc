// What it costs to be told that a configuration is free, in evaluations: `Solver::IsFree`, and a
// `Solve` that returns its q_in. On configurations that touch (answers of solves) and on random
// ones that are free; asked again and again, as of a robot that stands, and one configuration after
// the other (`anew`), which no memory of the last one helps. And what a Scene of a loaded model and
// a Solver take. README.md beside this file shows results.
#include <mujoco/mujoco.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <limits>
#include <memory>
#include <vector>

#include "measure.h"
#include "mjcf_pdg/pdg.h"
#include "workloads.h"

namespace mjcf_pdg::bench {
namespace {

using Q = std::vector<double>;

// Processor time of one call, the least of several: of interruptions there are enough here.
template <typename Call>
double Microseconds(const Call& call) {
  constexpr int kRuns = 5, kCalls = 100;
  double least = std::numeric_limits<double>::infinity();
  for (int run = 0; run < kRuns; ++run) {
    const double begin = CpuSeconds();
    for (int k = 0; k < kCalls; ++k) call();
    least = std::min(least, 1e6 * (CpuSeconds() - begin) / kCalls);
  }
  return least;
}

void Evaluate(const mjModel& m, const Q& q, mjData* d) {
  mju_copy(d->qpos, q.data(), static_cast<int>(m.nq));
  mj_kinematics(&m, d);
  mj_comPos(&m, d);
  mj_collision(&m, d);
}

void PrintRow(const Scene& scene, const char* name, const char* kind, const std::vector<Q>& rows) {
  Solver solver(scene);
  Result result;
  const mjModel& m = *scene.model();
  const std::unique_ptr<mjData, void (*)(mjData*)> data(mj_makeData(&m), mj_deleteData);
  std::vector<double> is_free, solve, unit;
  for (const Q& q : rows) {
    const double u = Microseconds([&] { Evaluate(m, q, data.get()); });
    unit.push_back(u);
    is_free.push_back(Microseconds([&] { solver.IsFree(q); }) / u);
    solve.push_back(Microseconds([&] { solver.Solve(q, result); }) / u);
  }
  std::size_t next = 0, other = 0;
  const double anew = Microseconds([&] { solver.IsFree(rows[next++ % rows.size()]); }) /
                      Microseconds([&] { Evaluate(m, rows[other++ % rows.size()], data.get()); });
  std::printf("%-40s %-9s %5zu %8.1f %8.2f %8.2f %8.2f %8.2f %8.2f\n", name, kind, rows.size(),
              Quantile(unit, 0.5), Quantile(is_free, 0.5), Quantile(is_free, 0.95),
              Quantile(solve, 0.5), Quantile(solve, 0.95), anew);
}

void PrintRows(const Workload& workload) {
  const Scene& scene = *workload.scene;
  Solver solver(scene);
  std::vector<Q> touching, apart;
  for (const BenchProblem& problem : workload.set.problems) {
    const Result result = solver.Solve(problem.q_in);
    if (result.status == Status::kAlreadyFree) apart.push_back(problem.q_in);
    if (result.status == Status::kSolved) touching.push_back(result.q);
  }
  if (!touching.empty()) PrintRow(scene, workload.set.name.c_str(), "touching", touching);
  if (!apart.empty()) PrintRow(scene, workload.set.name.c_str(), "apart", apart);
}

void PrintConstruction(const Scene& scene, const char* name) {
  const double of_scene = Microseconds([&] { Scene::FromModel(scene.model()); });
  const double of_solver = Microseconds([&] { Solver solver(scene); });
  std::printf("%-40s a Scene of it takes %.2f ms, a Solver %.2f\n", name, 1e-3 * of_scene,
              1e-3 * of_solver);
}

}  // namespace
}  // namespace mjcf_pdg::bench

int main(int argc, char** argv) {
  using namespace mjcf_pdg::bench;
  CLI::App app("What a free configuration costs, in evaluations");
  SetArguments sets;
  AddSetArguments(app, sets);
  return RunProgram(app, argc, argv, [&] {
    std::printf("%-40s %-9s %5s %8s %8s %8s %8s %8s %8s\n", "set", "free", "n", "u [us]", "IsFree",
                "p95", "Solve", "p95", "anew");
    for (const Workload& workload : LoadSoundWorkloads(sets)) {
      PrintRows(workload);
      PrintConstruction(*workload.scene, workload.set.name.c_str());
    }
  });
}
