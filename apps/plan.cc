// mjcf-pdg plan: a collision-free path between two configurations.
#include "plan/plan.h"

#include <algorithm>
#include <chrono>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "apps/cli.h"
#include "apps/console/interrupt.h"
#include "apps/console/progress.h"
#include "apps/console/text.h"
#include "apps/html/plan_row.h"
#include "apps/html/shell_command.h"
#include "apps/input/configurations.h"
#include "apps/input/npy.h"
#include "apps/input/plugins.h"
#include "apps/input/qpos_file.h"
#include "apps/options.h"
#include "apps/output/output_files.h"
#include "apps/output/repaired_mjcf.h"
#include "apps/output/report.h"
#include "apps/solve/scene_output.h"
#include "plan/planners.h"
#ifdef MJCF_PDG_HAVE_TIMING
#include "apps/plan/trajectory.h"
#endif
#ifdef MJCF_PDG_HAVE_RENDER
#include "apps/picture/animation.h"
#include "apps/picture/egl_context.h"
#include "apps/picture/motion_shots.h"
#endif

namespace mjcf_pdg::app {
namespace {

constexpr unsigned kMaxThreads = 1024;

unsigned long long AllProcessors() {
  return std::clamp(std::thread::hardware_concurrency(), 1U, kMaxThreads);
}

struct PlanArguments {
  SceneArguments scene;
  std::string start, goal;
  PlanOptions plan;
  double time_limit_ms = 60e3;
  unsigned long long seed = 0, threads = AllProcessors();
  std::string json, out_qpos, out_mjcf, animation, html;
#ifdef MJCF_PDG_HAVE_TIMING
  TrajectoryArguments trajectory;
#endif
};

using Json = nlohmann::ordered_json;

Json EndJson(const Scene& scene, const Result& end) {
  return {{"status", StatusName(end.status)},
          {"sigma", end.sigma},
          {"qpos", end.q},
          {"contacts_in", ContactsJson(scene, end.contacts_in)}};
}

std::string PlanJson(const Scene& scene, const PlanArguments& arguments, const Path& path,
                     const std::vector<double>& times) {
  Json edges = Json::array();
  for (const EdgeProof& edge : path.edges) {
    edges.push_back(
        {{"length", edge.length}, {"certified", edge.certified}, {"poses", edge.poses}});
  }
  Json json = {{"found", path.found},
               {"certified", path.certified},
               {"planner", arguments.plan.planner},
               {"seed", arguments.seed},
               {"time_us", path.seconds * 1e6},
               {"nodes", path.nodes},
               {"samples", path.samples},
               {"collision_queries", path.collision_queries},
               {"length", path.length},
               {"start", EndJson(scene, path.start)},
               {"goal", EndJson(scene, path.goal)},
               {"path", path.q},
               {"edges", std::move(edges)}};
  if (!times.empty()) json["times"] = times;
  if (!path.found) json["reason"] = path.reason;
  return JsonLine(json);
}

std::string PlanText(const Path& path, const std::vector<double>& times) {
  const std::string cost = "nodes " + std::to_string(path.nodes) + ", samples " +
                           std::to_string(path.samples) + ", collision queries " +
                           std::to_string(path.collision_queries) + "\n";
  if (!path.found) return "no path: " + path.reason + "\n" + cost;
  return "path of " + std::to_string(path.q.size()) + " configurations, length " +
         Short(path.length) + " m, " +
         (times.empty() ? "" : "duration " + Short(times.back()) + " s, ") +
         (path.certified ? "proven free" : "free, not certified") + "\n" + cost;
}

void WarnOfRepair(const std::string& end, const Result& result) {
  if (result.status != Status::kSolved) return;
  WriteWarning("the " + end + " is not free: the path has the nearest free configuration, rms " +
               Short(std::sqrt(result.sigma) * 1e3) + " mm away");
}

std::string QposFileContent(const std::vector<std::vector<double>>& path, const std::string& name) {
  std::string content = IsNpyFile(name) ? NpyHeader(path.size(), path.front().size()) : "";
  for (const std::vector<double>& q : path) content += FormatQposRow(q, name);
  return content;
}

std::string PlanPage(const CLI::App& command, const PlanArguments& arguments, const Scene& scene,
                     const PlannedPath& planned) {
  const std::string& model = arguments.scene.model;
  std::vector<std::string> again = {"plan",          model,    "--start",
                                    arguments.start, "--goal", arguments.goal};
  for (const std::string& option : GivenOptions(command)) again.push_back(option);
  again.insert(again.end(), {"--json", "-"});
  Page page({"", {}, OptionsInForce(command)});
  page.BeginModel(model, scene);
  PageRow row = PathPageRow(scene, planned);
  row.content["command"] = ShellCommand(again);
  if (planned.path.found) row.content["norm"] = NormCommand(model, GivenNormOptions(command));
  page.Add(row);
  return page.ToString();
}

// The bar shows how much of the time limit is gone.
Path PlanWithProgress(const Scene& scene, const std::vector<double>& start,
                      const std::vector<double>& goal, PlanOptions& plan) {
  using Clock = std::chrono::steady_clock;
  const auto limit_ms = static_cast<std::size_t>(std::min(1e3 * plan.options.time_limit, 1e15));
  Progress progress("planning, at most so many ms", limit_ms);
  plan.go_on = [&progress, begin = Clock::now()] {
    const std::chrono::duration<double, std::milli> gone = Clock::now() - begin;
    progress.Reach(static_cast<std::size_t>(gone.count()));
    return Interrupted() == 0;
  };
  return Plan(scene, start, goal, plan);
}

struct PlanOutputs {
  OutputFiles files;
  SceneOutput scene;
};

// What cannot be written or drawn is told before any work.
void AddOutputs(const PlanArguments& arguments, PlanOutputs& outputs) {
  const std::vector<std::string> inputs = {arguments.scene.model};
  CheckQposFileName("--out-qpos", arguments.out_qpos);
  outputs.files.Add("--json", arguments.json, inputs);
  outputs.files.Add("--out-qpos", arguments.out_qpos, inputs);
  outputs.files.Add("--html", arguments.html, inputs);
#ifdef MJCF_PDG_HAVE_TIMING
  AddTrajectoryFile(arguments.trajectory, inputs, outputs.files);
#endif
  outputs.scene.Add(arguments.out_mjcf, arguments.scene.model, inputs, outputs.files);
  outputs.files.Add("--animation", arguments.animation, inputs);
  if (outputs.scene.wanted()) ParseSpec(arguments.scene.model);
#ifdef MJCF_PDG_HAVE_RENDER
  if (!arguments.animation.empty()) {
    outputs.files.StagedName(arguments.animation);
    EglContext{};
  }
#endif
}

// A path, and when it is where [s], if that is known.
struct TimedConfigurations {
  const std::vector<std::vector<double>>& q;
  const std::vector<double>& times;
};

// Each configuration of the path becomes a keyframe: path_pdg, path_pdg_2, ...
void StageScene(const Scene& scene, const Configuration& start, const PlanArguments& arguments,
                const TimedConfigurations& path, PlanOutputs& outputs) {
  std::vector<Configuration> rows(path.q.size(), start);
  std::vector<Result> results(path.q.size());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    rows[k].label = "path";
    results[k].q = path.q[k];
    results[k].status = Status::kSolved;
  }
  outputs.scene.Stage(arguments.scene.model, {scene, rows, results, path.times}, outputs.files);
}

void StagePath(const Scene& scene, const Configuration& start, const PlanArguments& arguments,
               const TimedConfigurations& path, PlanOutputs& outputs) {
  if (!arguments.out_qpos.empty()) {
    outputs.files.Stage(arguments.out_qpos, QposFileContent(path.q, arguments.out_qpos));
  }
  if (outputs.scene.wanted()) StageScene(scene, start, arguments, path, outputs);
#ifdef MJCF_PDG_HAVE_RENDER
  if (!arguments.animation.empty()) {
    RenderAnimation(scene.model(), {PathShot(scene, start, path.q)},
                    outputs.files.StagedName(arguments.animation));
  }
#endif
}

void WarnOfGoalMocap(const Configuration& start, const Configuration& goal) {
  if (goal.mocap_pos.empty() ||
      (goal.mocap_pos == start.mocap_pos && goal.mocap_quat == start.mocap_quat)) {
    return;
  }
  WriteWarning("mocap bodies stand as at the start, all along the path, and not as in --goal");
}

#ifdef MJCF_PDG_HAVE_TIMING
// When the path is where, also in the file of the trajectory. Returns what is wrong if it would be
// too long for that, which only the path can tell: all else is to be written then.
std::string StageTimes(const Scene& scene, const Path& path, const TimingLimits& limits,
                       const std::string& file, OutputFiles& outputs, std::vector<double>& times) {
  try {
    const TimedPath timed = TimePath(scene, path.q, path.corners, limits);
    if (!file.empty()) outputs.Stage(file, TrajectoryContent(timed, file));
    times = timed.times;
  } catch (const Error& error) {
    return std::string("--speeds: ") + error.what() + "; the path is written without times";
  }
  return "";
}
#endif

int RunPlan(const CLI::App& command, PlanArguments& arguments) {
  const Scene scene = LoadScene(arguments.scene);
  const Configuration start = ReadConfiguration(scene, arguments.start, "--start");
  const Configuration goal = ReadConfiguration(scene, arguments.goal, "--goal");
  PlanOptions& plan = arguments.plan;
  plan.options.seed = arguments.seed;
  plan.threads = static_cast<int>(arguments.threads);
  plan.options.time_limit = arguments.time_limit_ms / 1e3;
  plan.options.mocap_pos = start.mocap_pos;
  plan.options.mocap_quat = start.mocap_quat;
  plan.options.report_contacts = true;
#ifdef MJCF_PDG_HAVE_TIMING
  const std::optional<TimingLimits> limits = ReadTimingLimits(scene, arguments.trajectory);
  // No path takes less time than the straight one: what is too slow for that is told before any
  // work.
  if (limits) TimePath(scene, {start.q, goal.q}, {0, 1}, *limits);
#endif
  PlanOutputs outputs;
  AddOutputs(arguments, outputs);

  CatchInterrupts();
  const Path path = PlanWithProgress(scene, start.q, goal.q, plan);
  WarnOfGoalMocap(start, goal);
  WarnOfRepair("start", path.start);
  WarnOfRepair("goal", path.goal);
  std::vector<double> times;
  std::string untimed;
#ifdef MJCF_PDG_HAVE_TIMING
  if (path.found && limits) {
    untimed = StageTimes(scene, path, *limits, arguments.trajectory.file, outputs.files, times);
  }
#endif
  outputs.files.Stage(arguments.json, PlanJson(scene, arguments, path, times));
  if (path.found) StagePath(scene, start, arguments, {path.q, times}, outputs);
  if (!arguments.html.empty()) {
    outputs.files.Stage(arguments.html,
                        PlanPage(command, arguments, scene, {start, goal, path, times}));
  }
  outputs.files.Commit();
  if (!outputs.files.uses_stdout()) WriteStdout(PlanText(path, times));
  if (!untimed.empty()) throw std::runtime_error(untimed);
  if (Interrupted())
    return SayInterrupted(path.found ? "after a path was found" : "before a path was found");
  return path.found ? kExitFree : kExitNotFree;
}

std::string PlannerHelp() {
  std::string names;
  for (const std::string& name : PlannerNames()) names += (names.empty() ? "" : ", ") + name;
  return "one of " + names;
}

}  // namespace

Verb AddPlanVerb(CLI::App& program) {
  CLI::App* command =
      program.add_subcommand("plan", "Find a collision-free path between two configurations");
  auto arguments = std::make_shared<PlanArguments>();
  AddModel(*command, arguments->scene);
  AddPlugins(*command);
  for (auto [flag, target] :
       {std::pair{"--start", &arguments->start}, {"--goal", &arguments->goal}}) {
    command->add_option(flag, *target, "a keyframe, or nq numbers in quotes; repaired if not free")
        ->type_name("KEY|\"V V ...\"")
        ->required();
  }
  command->add_option("--planner", arguments->plan.planner, PlannerHelp())
      ->type_name("NAME")
      ->capture_default_str();
  constexpr double kMaxSeed = 18446744073709551615.0;
  AddInteger(*command, {"--seed", "N", "of the random samples", {.high = kMaxSeed}},
             arguments->seed);
  AddNumber(*command, {"--time-limit", "MS", "for all of it", {.above_low = true}},
            arguments->time_limit_ms);
  AddInteger(*command,
             {"--threads",
              "N",
              "of birrt, birrt-r and birrt-pdg, at runs of their own",
              {.low = 1.0, .high = kMaxThreads}},
             arguments->threads)
      ->default_str("all processors");
  AddMovable(*command, arguments->scene);
  AddPairs(*command, arguments->scene);
  AddExactMesh(*command, arguments->scene);
  AddModelRules(*command, arguments->scene);
  AddTolerance(*command, arguments->plan.options);
  AddJson(*command, arguments->json);
  AddPath(*command, "--out-qpos",
          "write the path, a configuration a row: .npy, .csv, .txt or .jsonl; - is stdout, as text",
          arguments->out_qpos)
      ->type_name("FILE|-");
  AddPath(*command, "--out-mjcf",
          "write the scene with the path as keyframes path_pdg, path_pdg_2, ...; DIR/: with copies "
          "of its assets",
          arguments->out_mjcf)
      ->type_name("FILE|DIR/");
#ifdef MJCF_PDG_HAVE_RENDER
  AddAnimation(*command, "show the motion along the path", arguments->animation);
#endif
  AddHtml(*command, arguments->html);
#ifdef MJCF_PDG_HAVE_TIMING
  AddTrajectory(*command, arguments->trajectory);
#endif
  return {command, [command, arguments] { return RunPlan(*command, *arguments); }};
}

}  // namespace mjcf_pdg::app
