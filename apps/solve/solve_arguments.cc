#include "apps/solve/solve_arguments.h"

#include "apps/input/plugins.h"

namespace mjcf_pdg::app {
namespace {

constexpr double kReportedDistances = 1.0;  // Options::report_distances_to [m]

}  // namespace

void AddSolveFlags(CLI::App& command, SolveArguments& arguments) {
  AddModels(command, arguments.models);
  AddPlugins(command);
  AddWhich(command, arguments.which);
  command.add_flag("--trajectory", arguments.options.trajectory,
                   "rows are frames of one motion: one optimum is followed");
  AddNumber(
      command,
      {"--smooth", "W", "with --trajectory: weight on the change between frames", {.high = 1e6}},
      arguments.smooth);
  AddMovable(command, arguments.scene);
  AddRoot(command, arguments.scene);
  AddArmature(command, arguments.scene);
  AddPairs(command, arguments.scene);
  AddExactMesh(command, arguments.scene);
  AddModelRules(command, arguments.scene);
  AddRest(command, arguments.options);
  AddMetric(command, arguments.options.metric);
  AddTolerance(command, arguments.options);
  AddClearance(command, arguments.scene, arguments.options);
  AddNumber(command,
            {"--time-limit", "MS", "per row; ends with the best so far", {.above_low = true}},
            arguments.time_limit_ms);
  constexpr double kMaxSeed = 18446744073709551615.0;
  AddInteger(command, {"--seed", "N", "of the random starts", {.high = kMaxSeed}}, arguments.seed);
  AddInteger(command, {"--threads", "N", "rows solved at once", {.low = 1.0, .high = 1024.0}},
             arguments.threads);
  AddMethod(command, arguments.options.method);
  AddEffort(command, arguments.options.effort);
  AddJson(command, arguments.json);
  AddPath(command, "--out-qpos",
          "write the configurations, one a row: .npy, .csv, .txt or .jsonl; - is stdout, as text",
          arguments.out_qpos)
      ->type_name("FILE|-");
  command.add_flag("--resume", arguments.resume,
                   "go on after an interruption, behind the rows in the .part of --json");
  AddPath(
      command, "--out-mjcf",
      "write the scene with a keyframe NAME_pdg for every row that is or became free; DIR/: with "
      "copies of its assets",
      arguments.out_mjcf)
      ->type_name("FILE|DIR/");
  AddHtml(command, arguments.html);
  AddPath(command, "--trace",
          "write every iteration of the search as JSON Lines, for mjcf-pdg replay", arguments.trace)
      ->type_name("FILE|-");
#ifdef MJCF_PDG_HAVE_RENDER
  AddPath(command, "--png", "draw every row before and after, 24 a page (F.png, F-2.png, ...)",
          arguments.png);
  AddAnimation(command,
               "show the motion of each of the first 24 rows to its answer, or a --trajectory "
               "beside its answers",
               arguments.animation);
#endif
}

void FinishSolveOptions(SolveArguments& arguments) {
  arguments.options.time_limit = arguments.time_limit_ms / 1e3;
  arguments.options.seed = arguments.seed;
  arguments.options.report_contacts = true;
  arguments.options.report_distances_to = kReportedDistances;
}

}  // namespace mjcf_pdg::app
