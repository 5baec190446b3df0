// mjcf-pdg solve: finds the nearest free configuration for every configuration (row) asked about.
#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "apps/cli.h"
#include "apps/configurations.h"
#include "apps/options.h"
#include "apps/output_files.h"
#include "apps/qpos_file.h"
#include "apps/repaired_mjcf.h"
#include "apps/report.h"
#include "apps/solve_rows.h"
#include "apps/text.h"
#include "mjcf_pdg/pdg.h"
#ifdef MJCF_PDG_HAVE_RENDER
#include "apps/render.h"
#endif

namespace mjcf_pdg::app {
namespace {

constexpr double kReportedDistances = 1.0;  // Options::report_distances_to [m]

struct SolveArguments {
  SceneArguments scene;
  WhichArguments which;
  Options options;
  double time_limit_ms = std::numeric_limits<double>::infinity();
  unsigned long long seed = 0;
  unsigned long long threads = 1;
  std::string json, out_qpos, out_mjcf, png;
};

void AddFlags(CLI::App& command, SolveArguments& arguments) {
  AddModel(command, arguments.scene);
  AddWhich(command, arguments.which);
  command.add_flag("--trajectory", arguments.options.trajectory,
                   "rows are frames of one motion: each starts from earlier answers too");
  AddMovable(command, arguments.scene);
  AddRoot(command, arguments.scene);
  AddExactMesh(command, arguments.scene);
  AddRest(command, arguments.options);
  AddMetric(command, arguments.options.metric);
  AddTolerance(command, arguments.options);
  AddNumber(command, {"--clearance", "M", "distance to keep between all pairs", {}},
            arguments.options.clearance);
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
          "write the configurations, one a row: .npy, .csv or .txt; - is stdout, as text",
          arguments.out_qpos)
      ->type_name("FILE|-");
  AddPath(command, "--out-mjcf",
          "write the scene with a keyframe NAME_pdg for every row that is or became free",
          arguments.out_mjcf);
#ifdef MJCF_PDG_HAVE_RENDER
  AddPath(command, "--png", "draw every row before and after", arguments.png);
#endif
}

void AddOutputs(const SolveArguments& arguments, OutputFiles& outputs) {
  std::vector<std::string> inputs = {arguments.scene.model};
  if (!arguments.which.file.empty() && arguments.which.file != "-") {
    inputs.push_back(arguments.which.file);
  }
  CheckQposFileName("--out-qpos", arguments.out_qpos);
  outputs.Add("--json", arguments.json, inputs);
  outputs.Add("--out-qpos", arguments.out_qpos, inputs);
  outputs.Add("--out-mjcf", arguments.out_mjcf, inputs);
  outputs.Add("--png", arguments.png, inputs);
  // Throws Error if one of these is a stream: relative paths in the MJCF and the writer of the PNG
  // need a file.
  for (const std::string& path : {arguments.out_mjcf, arguments.png}) {
    if (!path.empty()) outputs.StagedName(path);
  }
}

void StageMjcf(const Scene& scene, const std::vector<Configuration>& rows,
               const std::vector<Result>& results, const std::string& path, mjSpec* spec,
               OutputFiles& outputs) {
  AddRepairedKeys(scene, rows, results, spec);
  const std::string staged = outputs.StagedName(path);
  const std::string folder = std::filesystem::path(staged).parent_path().string();
  outputs.Stage(path, FormatMjcf(spec, folder));
  CheckMjcf(staged, rows, results);
}

#ifdef MJCF_PDG_HAVE_RENDER
void StagePng(const Scene& scene, const std::vector<Configuration>& rows,
              const std::vector<Result>& results, const std::string& path, OutputFiles& outputs) {
  std::vector<RenderRow> pictures;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    RenderRow picture{rows[i].label, rows[i].q, {}, {}};
    if (results[i].status != Status::kUnsolved) picture.qpos = results[i].q;
    for (const Contact& contact : results[i].contacts_in) {
      picture.guilty_geoms.insert(picture.guilty_geoms.end(), contact.geom.begin(),
                                  contact.geom.end());
    }
    pictures.push_back(std::move(picture));
  }
  RenderBeforeAfter(scene.model(), pictures, outputs.StagedName(path));
}
#endif

Rows Configurations(const std::vector<Result>& results) {
  Rows rows;
  for (const Result& result : results) rows.push_back(result.q);
  return rows;
}

int RunSolve(SolveArguments& arguments) {
  arguments.options.time_limit = arguments.time_limit_ms / 1e3;
  arguments.options.seed = arguments.seed;
  arguments.options.report_contacts = true;
  arguments.options.report_distances_to = kReportedDistances;
  const Scene scene = LoadScene(arguments.scene);
  const std::vector<Configuration> rows = ReadConfigurations(scene, arguments.which);
  OutputFiles outputs;
  AddOutputs(arguments, outputs);
  SpecPtr spec;
  if (!arguments.out_mjcf.empty()) spec = ParseSpec(arguments.scene.model);

  const std::vector<Result> results = SolveRows(scene, arguments.options, rows, arguments.threads);

  const std::size_t width = static_cast<std::size_t>(scene.nq());
  if (!arguments.json.empty()) outputs.Stage(arguments.json, SolveJson(scene, rows, results));
  if (!arguments.out_qpos.empty()) {
    outputs.Stage(arguments.out_qpos,
                  FormatQposFile(Configurations(results), width, arguments.out_qpos));
  }
  if (spec) StageMjcf(scene, rows, results, arguments.out_mjcf, spec.get(), outputs);
#ifdef MJCF_PDG_HAVE_RENDER
  if (!arguments.png.empty()) StagePng(scene, rows, results, arguments.png, outputs);
#endif
  outputs.Commit();
  if (!outputs.uses_stdout()) WriteStdout(SolveTable(scene, rows, results));
  const bool all_free = std::none_of(results.begin(), results.end(), [](const Result& result) {
    return result.status == Status::kUnsolved;
  });
  return all_free ? kExitFree : kExitNotFree;
}

}  // namespace

Verb AddSolveVerb(CLI::App& program) {
  CLI::App* command =
      program.add_subcommand("solve", "Find the nearest collision-free configuration");
  auto arguments = std::make_shared<SolveArguments>();
  AddFlags(*command, *arguments);
  return {command, [arguments] { return RunSolve(*arguments); }};
}

}  // namespace mjcf_pdg::app
