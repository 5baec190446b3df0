// What continuous collision detection of a motion costs in poses and pair distances, with intervals
// split where proofs are expected to meet (our way) and with intervals halved (the paper's way).
// README.md beside this file says which motions are used.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <numeric>
#include <string>
#include <vector>

#include "ccd/ccdg.h"
#include "measure.h"
#include "mjcf_pdg/pdg.h"
#include "trajectories.h"
#include "workloads.h"

namespace mjcf_pdg::bench {
namespace {

// One way of splitting intervals.
struct Row {
  std::string name;
  CcdOptions options;
  std::vector<double> poses, queries;  // by motion
  double seconds = 0.0;                // processor time of all motions [s]
};

struct Table {
  std::vector<Row> rows;
  int motions = 0, contacts = 0;

  explicit Table(double tolerance) : rows(2) {
    rows[0].name = "split where proofs meet";
    rows[1].name = "halved";
    rows[1].options.halve = true;
    for (Row& row : rows) row.options.tolerance = tolerance;
  }
};

VectorXd AsEigen(const std::vector<double>& q) {
  return Eigen::Map<const VectorXd>(q.data(), static_cast<Eigen::Index>(q.size()));
}

// Checks a motion both ways and returns where the first way stops.
VectorXd Move(Ccdg& ccdg, const VectorXd& q, const VectorXd& dq, Table& table) {
  VectorXd stop;
  for (Row& row : table.rows) {
    const double begin = CpuSeconds();
    const CcdResult& result = ccdg.Move({q, dq}, row.options);
    row.seconds += CpuSeconds() - begin;
    row.poses.push_back(result.poses);
    row.queries.push_back(result.distance_queries);
    if (&row != &table.rows.front()) continue;
    stop = result.q;
    ++table.motions;
    table.contacts += result.outcome == CcdOutcome::kContact;
  }
  return stop;
}

// The motions of Alg. 2 from the free configuration q towards q_in: all joints at once, then one
// joint after the other.
void Project(const SceneTables& tables, Ccdg& ccdg, VectorXd q, const VectorXd& q_in,
             Table& table) {
  VectorXd dq;
  Difference(tables, q, q_in, dq);
  q = Move(ccdg, q, dq, table);
  for (const JointEntry& joint : tables.joints) {
    Difference(tables, q, q_in, dq);
    const VectorXd own = dq.segment(joint.col, joint.ndof);
    dq.setZero();
    dq.segment(joint.col, joint.ndof) = own;
    if (!dq.isZero(0.0)) q = Move(ccdg, q, dq, table);
  }
}

void Print(const std::string& title, const Table& table) {
  std::printf("%s: %d motions, %d end in contact\n%-24s %10s %8s %10s %8s %8s\n", title.c_str(),
              table.motions, table.contacts, "", "poses", "median", "distances", "median", "us");
  for (const Row& row : table.rows) {
    const double n = table.motions;
    std::printf("%-24s %10.0f %8.0f %10.0f %8.0f %8.1f\n", row.name.c_str(),
                std::accumulate(row.poses.begin(), row.poses.end(), 0.0), Quantile(row.poses, 0.5),
                std::accumulate(row.queries.begin(), row.queries.end(), 0.0),
                Quantile(row.queries, 0.5), 1e6 * row.seconds / n);
  }
}

// Adds the motions from the model's first free keyframe to each of `targets`.
void Append(const Scene& scene, const std::string& model_path, const ProblemSet& targets,
            Table& table) {
  const std::vector<BenchProblem> keys = Keyframes(scene, model_path).problems;
  const auto free = std::find_if(keys.begin(), keys.end(), [&](const BenchProblem& key) {
    return Verify(scene, key.q_in).free;
  });
  if (free == keys.end()) throw Error(targets.name + ": no keyframe is free");
  const SceneTables& tables = scene.tables();
  ContactFinder finder(tables);
  Ccdg ccdg(tables, finder);
  const VectorXd q_free = Normalized(tables, AsEigen(free->q_in));
  for (const BenchProblem& problem : targets.problems) {
    Project(tables, ccdg, q_free, Normalized(tables, AsEigen(problem.q_in)), table);
  }
}

void Run(const SetArguments& arguments) {
  Table table(arguments.tolerance);
  for (const Workload& workload : LoadSoundWorkloads(arguments)) {
    Append(*workload.scene, workload.set.model_path, workload.set, table);
  }
  Print("keyframes and random configurations", table);
  if (!arguments.models.empty() || !arguments.problems.empty()) return;
  Table frames(arguments.tolerance);
  for (const Trajectory& trajectory : Trajectories()) {
    const std::string path = std::string(MJCF_PDG_MODEL_DIR) + "/" + trajectory.model;
    const Scene scene = Scene::FromFile(path);
    ProblemSet set{trajectory.name, path, {}, true};
    for (std::vector<double>& q : Frames(scene, trajectory)) {
      set.problems.push_back({"", std::move(q)});
    }
    Append(scene, path, set, frames);
  }
  Print("frames of Puma1, Puma2, Hand", frames);
}

}  // namespace

int Main(int argc, char** argv) {
  SetArguments arguments;
  CLI::App app("Poses and pair distances of the paper's motions.", "ccdg_bench");
  AddSetArguments(app, arguments);
  return RunProgram(app, argc, argv, [&] { Run(arguments); });
}

}  // namespace mjcf_pdg::bench

int main(int argc, char** argv) { return mjcf_pdg::bench::Main(argc, argv); }
