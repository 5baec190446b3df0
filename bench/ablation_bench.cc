// What each start and step of a method is worth: every component is left out in turn
// (Options::without) and compared with leaving out nothing. README.md beside this file says what
// the columns mean.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "measure.h"
#include "mjcf_pdg/pdg.h"
#include "trajectories.h"
#include "workloads.h"

namespace mjcf_pdg::bench {
namespace {

constexpr double kWorse = 1.01;   // a σ counts as worse from this ratio on
constexpr double kSlower = 1.05;  // a time counts as longer from this ratio on
constexpr double kChance = 0.05;  // a component is needed if its harm has less chance to be luck
constexpr char kEverything[] = "everything on";
constexpr char kLuck[] = "(other seeds)";   // everything on: what other random numbers change
constexpr std::uint64_t kOtherSeeds = 500;  // the first seed of that row

struct Arguments {
  SetArguments sets;
  int seeds = 2;
  int frames = 40;
  std::vector<std::string> methods = {"auto", "paper"};
};

// The problem sets whose solves are added up in the rows of one table.
struct Group {
  std::string name;
  std::vector<Workload> workloads;
};

// One row over all workloads of a group, in their order.
using Row = std::vector<Series>;

// A row compared with the row with everything on, each solve with that of the same problem and
// seed. `lost` and `gained` count problems that are solved only with, or only without, the
// component; queries and evaluations are sums over all solves.
struct Comparison {
  int solves = 0, same = 0, lost = 0, worse = 0, gained = 0, better = 0;
  double queries = 0, queries_on = 0, evaluations = 0, evaluations_on = 0;

  void Add(const Series& off, const Series& on) {
    for (std::size_t k = 0; k < off.solves.size(); ++k) {
      const Measured &a = off.solves[k], &b = on.solves[k];
      if (b.result.status == Status::kAlreadyFree) continue;
      ++solves;
      lost += b.verified && !a.verified;
      gained += a.verified && !b.verified;
      const bool both = a.verified && b.verified;
      worse += both && a.result.sigma > kWorse * b.result.sigma;
      better += both && b.result.sigma > kWorse * a.result.sigma;
      same += a.result.sigma == b.result.sigma &&
              a.result.stats.collision_queries == b.result.stats.collision_queries &&
              a.result.stats.lcp_sweeps == b.result.stats.lcp_sweeps;
      queries += a.result.stats.collision_queries;
      queries_on += b.result.stats.collision_queries;
      evaluations += a.seconds / off.EvaluationSeconds();
      evaluations_on += b.seconds / on.EvaluationSeconds();
    }
  }
  void Add(const Row& off, const Row& on) {
    for (std::size_t w = 0; w < off.size(); ++w) Add(off[w], on[w]);
  }
};

// The rows of one method: everything on, other seeds, and each component off.
struct Ablation {
  Method method = Method::kAuto;
  std::vector<std::string> labels;
  std::vector<std::vector<Row>> rows;  // by group, then by label
};

Workload AsTrajectory(const std::string& folder, const Trajectory& trajectory, int frames) {
  const std::string path = folder + "/" + trajectory.model;
  Workload workload{Scene::FromFile(path), {trajectory.name, path, {}, true}, {}};
  for (std::vector<double>& q : Frames(*workload.scene, trajectory, frames)) {
    workload.set.problems.push_back({"", std::move(q)});
  }
  return workload;
}

// The workload's problems, each with the model's first free keyframe as a hint.
Workload Hinted(Workload workload) {
  const Scene& scene = *workload.scene;
  const std::vector<BenchProblem> keys = Keyframes(scene, workload.set.model_path).problems;
  const auto free = std::find_if(keys.begin(), keys.end(), [&](const BenchProblem& key) {
    return Verify(scene, key.q_in).free;
  });
  if (free == keys.end()) throw Error(workload.set.name + ": no keyframe is free");
  for (BenchProblem& problem : workload.set.problems) problem.hint = free->q_in;
  return workload;
}

std::vector<Group> LoadGroups(const Arguments& arguments) {
  Group alone{"keyframes and random", LoadSoundWorkloads(arguments.sets)};
  Group hinted{"the same, a free pose as hint", {}};
  if (!arguments.sets.models.empty() || !arguments.sets.problems.empty()) return {alone};
  for (const Workload& workload : alone.workloads) hinted.workloads.push_back(Hinted(workload));
  Group frames{"trajectories Puma1, Puma2, Hand", {}};
  for (const Trajectory& trajectory : Trajectories()) {
    frames.workloads.push_back(AsTrajectory(MJCF_PDG_MODEL_DIR, trajectory, arguments.frames));
  }
  return {std::move(alone), std::move(hinted), std::move(frames)};
}

// The rows of one method for a group. The paper's method uses random numbers only as a last resort,
// so it gets one seed.
std::vector<Row> MeasureRows(const Group& group, const Ablation& ablation,
                             const Arguments& arguments) {
  std::vector<Row> rows;
  for (const std::string& label : ablation.labels) {
    Options options;
    options.method = ablation.method;
    options.tolerance = arguments.sets.tolerance;
    if (label != kEverything && label != kLuck) options.without = {label};
    const Seeds seeds{label == kLuck ? kOtherSeeds : 0,
                      ablation.method == Method::kPaper ? 1 : arguments.seeds};
    rows.emplace_back();
    for (const Workload& workload : group.workloads) {
      rows.back().push_back(Measure(*workload.scene, workload.set, options, seeds));
    }
  }
  return rows;
}

void PrintGroup(const std::string& title, const Ablation& ablation, const std::vector<Row>& rows,
                const std::vector<std::vector<double>>& best) {
  std::printf("\n%s\n%-26s %5s %6s %8s %8s %9s %5s %5s %6s %6s %8s %8s\n", title.c_str(), "without",
              "n", "ok%", "ratio", "p95", "max", "lost", "worse", "gained", "better", "queries",
              "evals");
  for (std::size_t k = 0; k < rows.size(); ++k) {
    Tally tally;
    for (std::size_t w = 0; w < best.size(); ++w) tally.Add(rows[k][w], best[w]);
    Comparison c;
    c.Add(rows[k], rows[0]);
    std::printf("%-26s %5d %6.1f %8.4f %8.4f %9.3f %5d %5d %6d %6d %8.0f %8.1f\n",
                ablation.labels[k].c_str(), tally.n, 100.0 * tally.ok / tally.n,
                Quantile(tally.ratio, 0.5), Quantile(tally.ratio, 0.95), Quantile(tally.ratio, 1.0),
                c.lost, c.worse, c.gained, c.better, Quantile(tally.queries, 0.5),
                Quantile(tally.evaluations, 0.5));
  }
  std::fflush(stdout);
}

// Sign test: the probability that, of harm + help solves that change, `harm` or more change for the
// worse if worse and better are equally likely.
double ChanceOf(int harm, int help) {
  const int n = harm + help;
  double chance = 0.0;
  for (int k = harm; k <= n; ++k) {
    chance += std::exp(std::lgamma(n + 1) - std::lgamma(k + 1) - std::lgamma(n - k + 1) -
                       n * std::log(2.0));
  }
  return chance;
}

std::string Verdict(const Comparison& c) {
  const int harm = c.lost + c.worse, help = c.gained + c.better;
  if (c.same == c.solves) return "never came into play";
  std::string verdict = harm == 0                        ? "USELESS: nothing lost or worse"
                        : ChanceOf(harm, help) < kChance ? "needed"
                        : harm > help                    ? "helps no more than luck would"
                                                         : "does not help";
  const double cost = c.evaluations / c.evaluations_on;
  if (cost > kSlower) verdict += ", saves time";
  if (cost * kSlower < 1.0) verdict += ", costs time";
  return verdict;
}

// Prints a line for each component with its comparison over all groups.
void PrintVerdicts(const Ablation& ablation) {
  std::printf("\n%-26s %7s %7s %5s %5s %6s %6s %9s %8s  %s\n", "without", "solves", "changed",
              "lost", "worse", "gained", "better", "queries x", "evals x", "verdict");
  for (std::size_t k = 1; k < ablation.labels.size(); ++k) {
    Comparison c;
    for (const std::vector<Row>& rows : ablation.rows) c.Add(rows[k], rows[0]);
    std::printf("%-26s %7d %7d %5d %5d %6d %6d %9.2f %8.2f  %s\n", ablation.labels[k].c_str(),
                c.solves, c.solves - c.same, c.lost, c.worse, c.gained, c.better,
                c.queries / c.queries_on, c.evaluations / c.evaluations_on,
                ablation.labels[k] == kLuck ? "" : Verdict(c).c_str());
  }
}

void Run(const Arguments& arguments) {
  const std::vector<Group> groups = LoadGroups(arguments);
  std::vector<Ablation> ablations;
  for (const std::string& name : arguments.methods) {
    Ablation& ablation = ablations.emplace_back();
    ablation.method = name == "paper" ? Method::kPaper : Method::kAuto;
    ablation.labels = {kEverything, kLuck};
    const std::vector<std::string> components = Components(ablation.method);
    ablation.labels.insert(ablation.labels.end(), components.begin(), components.end());
    for (const Group& group : groups) {
      ablation.rows.push_back(MeasureRows(group, ablation, arguments));
    }
  }
  for (std::size_t g = 0; g < groups.size(); ++g) {
    std::vector<std::vector<double>> best;
    for (std::size_t w = 0; w < groups[g].workloads.size(); ++w) {
      best.push_back(BestGiven(groups[g].workloads[w].set));
      for (const Ablation& ablation : ablations) {
        for (const Row& row : ablation.rows[g]) LowerBest(row[w], best.back());
      }
    }
    for (std::size_t a = 0; a < ablations.size(); ++a) {
      PrintGroup("Method " + arguments.methods[a] + ", " + groups[g].name, ablations[a],
                 ablations[a].rows[g], best);
    }
  }
  for (std::size_t a = 0; a < ablations.size(); ++a) {
    std::printf("\nMethod %s, all sets together", arguments.methods[a].c_str());
    PrintVerdicts(ablations[a]);
  }
}

}  // namespace

int Main(int argc, char** argv) {
  Arguments arguments;
  arguments.sets.count = 20;
  CLI::App app("Every component off in turn, against everything on.", "ablation_bench");
  AddSetArguments(app, arguments.sets);
  app.add_option("--seeds", arguments.seeds, "solver seeds 0 to N-1 of method auto")
      ->check(CLI::Range(1, 1000));
  app.add_option("--frames", arguments.frames, "of each trajectory")->check(CLI::Range(2, 10000));
  app.add_option("--method", arguments.methods, "auto, paper; both with a comma")
      ->delimiter(',')
      ->check(CLI::IsMember({"auto", "paper"}));
  return RunProgram(app, argc, argv, [&] { Run(arguments); });
}

}  // namespace mjcf_pdg::bench

int main(int argc, char** argv) { return mjcf_pdg::bench::Main(argc, argv); }
