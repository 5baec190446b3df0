// The planners beside each other, as in Table IV of Tang & Kim: Placement and Bridge, and a disc
// and a gap that becomes narrower; and beside them OMPL with MuJoCo's yes or no (birrt-sampled,
// peers/sampled_plan.h). Several seeds each; a run that ends at the time limit counts as that long.
// Every path is looked at again, densely, by MuJoCo.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "measure.h"
#include "peers/sampled_plan.h"
#include "plan/plan.h"

namespace mjcf_pdg::bench {
namespace {

constexpr const char* kSampled = "birrt-sampled";

struct Task {
  std::string name;
  Scene scene;
  std::vector<double> start, goal;
};

struct Runs {
  std::vector<std::string> planners = {kSampled, "birrt", "birrt-r", "birrt-pdg"};
  std::vector<std::string> scenes = {"placement", "bridge"};
  int first_seed = 0, seeds = 5, threads = 1;
  double seconds = 60.0, resolution = kUsualResolution;
  std::int64_t samples = 0;
  bool gaps = false, each = false, all = false;
};

// A run: the path, and the deepest overlap that MuJoCo finds along it [m].
struct Checked {
  Path path;
  double overlap = 0.0;
};

// The least, the median and the largest of a number that each run has.
struct Spread {
  explicit Spread(std::vector<double> values) {
    low = Quantile(values, 0.0);
    middle = Quantile(values, 0.5);
    high = Quantile(std::move(values), 1.0);
  }
  double low, middle, high;
};

// A folder of models/, or a file. What the model marks as exact meshes is that.
Task FromModel(const std::string& name) {
  const std::filesystem::path path = name;
  const std::string file = path.extension() == ".xml"
                               ? name
                               : std::string(MJCF_PDG_MODEL_DIR) + "/" + name + "/" + name + ".xml";
  Scene scene = Scene::FromFile(file);
  if (mj_name2id(scene.model(), mjOBJ_TEXT, "mjcf_pdg.exact_mesh") >= 0) {
    scene = Scene::FromFile(file, {.exact_mesh = true});
  }
  return {path.stem(), scene, scene.KeyQpos(0), scene.KeyQpos(1)};
}

// A disc of radius 0.2 m and a gap in a wall, wider than it by `slack`, a share of its diameter.
Task DiscAndGap(double slack) {
  const std::string y = std::to_string(2.0 + 0.2 * (1.0 + slack));
  const std::string wall = "<geom type=\"box\" size=\".1 2 .5\" pos=\"0 ";
  const std::string slide = "<joint type=\"slide\" range=\"-2 2\" limited=\"true\" axis=\"";
  char name[64];
  std::snprintf(name, sizeof name, "gap +%g %%", 100.0 * slack);
  return {name,
          Scene::FromString("<mujoco><worldbody>" + wall + y + " 0\"/>" + wall + "-" + y +
                            " 0\"/><body>" + slide + "1 0 0\"/>" + slide +
                            "0 1 0\"/><geom type=\"cylinder\" size=\".2 .1\"/></body>"
                            "</worldbody></mujoco>"),
          {-1.0, 0.7},
          {1.0, -0.7}};
}

// "median (least-most)", with so many digits behind the point.
std::string Text(const Spread& spread, int digits) {
  char text[80];
  std::snprintf(text, sizeof text, "%.*f (%.*f-%.*f)", digits, spread.middle, digits, spread.low,
                digits, spread.high);
  return text;
}

// Of the paths that were found [m].
std::string LengthsText(const std::vector<Checked>& runs) {
  std::vector<double> lengths;
  for (const Checked& run : runs) {
    if (run.path.found) lengths.push_back(run.path.length);
  }
  return lengths.empty() ? "" : Text(Spread(lengths), 2);
}

void PrintRow(const std::string& task, const std::string& planner,
              const std::vector<Checked>& runs) {
  const auto spread = [&runs](const std::function<double(const Path&)>& number) {
    std::vector<double> values;
    for (const Checked& run : runs) values.push_back(number(run.path));
    return Spread(values);
  };
  int found = 0, not_free = 0;
  double overlap = 0.0;
  for (const Checked& run : runs) {
    found += run.path.found;
    not_free += run.overlap > 0.0;
    overlap = std::max(overlap, run.overlap);
  }
  const auto text = [&spread](int digits, const std::function<double(const Path&)>& number) {
    return Text(spread(number), digits);
  };
  std::printf("%-10s %-13s %2d/%-2d %24s %23s %27s %20s %8d %8.3f\n", task.c_str(), planner.c_str(),
              found, static_cast<int>(runs.size()),
              text(3, [](const Path& path) { return path.seconds; }).c_str(),
              text(0, [](const Path& path) { return path.nodes; }).c_str(),
              text(0, [](const Path& path) { return double(path.collision_queries); }).c_str(),
              LengthsText(runs).c_str(), not_free, 1e3 * overlap);
  std::fflush(stdout);
}

std::vector<Checked> RunAll(const Task& task, const std::string& planner, const Runs& runs) {
  std::vector<Checked> checked;
  for (int seed = runs.first_seed; seed < runs.first_seed + runs.seeds; ++seed) {
    PlanOptions options;
    options.planner = planner;
    options.options.seed = static_cast<std::uint64_t>(seed);
    options.options.time_limit = runs.seconds;
    options.max_samples = runs.samples;
    options.threads = runs.threads;
    const std::clock_t begin = std::clock();
    Path path = planner == kSampled
                    ? SampledPlan(task.scene, task.start, task.goal, options, runs.resolution)
                    : Plan(task.scene, task.start, task.goal, options);
    if (runs.threads == 1) {  // of the processor, so that other programs do not count
      path.seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    }
    const double overlap = DeepestOverlap(task.scene, path, options.options);
    checked.push_back({std::move(path), overlap});
    if (runs.each) PrintRow(task.name + " " + std::to_string(seed), planner, {checked.back()});
  }
  PrintRow(task.name, planner, checked);
  return checked;
}

void Run(const Runs& runs) {
  std::printf("%-10s %-13s %5s %24s %23s %27s %20s %8s %8s\n", "scene", "planner", "found",
              "s: median (least-most)", "nodes", "queries", "length m", "not free", "mm deep");
  std::vector<Task> tasks;
  if (runs.gaps) {
    for (const double slack : {0.2, 0.1, 0.03, 0.01}) tasks.push_back(DiscAndGap(slack));
  } else {
    for (const std::string& scene : runs.scenes) tasks.push_back(FromModel(scene));
  }
  std::map<std::string, std::vector<Checked>> all;
  for (const Task& task : tasks) {
    for (const std::string& planner : runs.planners) {
      for (Checked& run : RunAll(task, planner, runs)) all[planner].push_back(std::move(run));
    }
  }
  if (runs.all) {
    for (const std::string& planner : runs.planners) PrintRow("all", planner, all[planner]);
  }
  if (!runs.gaps && !runs.all) {
    std::printf(
        "paper, Table IV, ten runs each, mean s: placement 172.8, 154.2, 85.3; bridge 78.3 "
        "and 42.1 as far as legible\n");
  }
}

}  // namespace
}  // namespace mjcf_pdg::bench

int main(int argc, char** argv) {
  CLI::App app("Time, nodes and queries of the planners");
  mjcf_pdg::bench::Runs runs;
  app.add_option("--planner", runs.planners, "these")->delimiter(',');
  app.add_option("--scene", runs.scenes,
                 "these of models/, or files, with keyframes for start and goal")
      ->delimiter(',');
  app.add_option("--first-seed", runs.first_seed, "of the runs");
  app.add_option("--seeds", runs.seeds, "runs of each")->check(CLI::Range(1, 1000));
  app.add_option("--threads", runs.threads, "of a run; seconds are the clock's if several")
      ->check(CLI::Range(1, 1024));
  app.add_option("--seconds", runs.seconds, "time limit of a run");
  app.add_option("--samples", runs.samples, "ends a run, too; 0: no bound");
  app.add_option("--resolution", runs.resolution,
                 "birrt-sampled: between the configurations it looks at, a share of the extent");
  app.add_flag("--gaps", runs.gaps, "the disc and the gap instead of the scenes");
  app.add_flag("--each", runs.each, "print each run, too");
  app.add_flag("--all", runs.all, "a row for all scenes together, too");
  CLI11_PARSE(app, argc, argv);
  mjcf_pdg::bench::Run(runs);
  return 0;
}
