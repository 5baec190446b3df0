// mjcf-pdg check: which pairs penetrate and which joint limits are exceeded, and by how much; with
// --motion, how far the way from one configuration to another is free.
#include <memory>
#include <string>
#include <vector>

#include "apps/check_motion.h"
#include "apps/cli.h"
#include "apps/console/interrupt.h"
#include "apps/console/progress.h"
#include "apps/console/text.h"
#include "apps/input/configurations.h"
#include "apps/input/plugins.h"
#include "apps/options.h"
#include "apps/output/output_files.h"
#include "apps/output/report.h"
#include "mjcf_pdg/pdg.h"

namespace mjcf_pdg::app {
namespace {

struct CheckArguments {
  SceneArguments scene;  // of the present model
  std::vector<std::string> models;
  WhichArguments which;
  bool motion = false;
  EndsArguments ends;
  Options options;
  std::string json;
};

int RunCheck(CheckArguments& arguments) {
  const bool several = arguments.models.size() > 1;
  if (several && arguments.which.file == "-") {
    throw Error("--qpos-file: stdin can be read for one model only");
  }
  OutputFiles outputs;
  std::vector<std::string> inputs = arguments.models;
  inputs.push_back(arguments.which.file);
  outputs.Add("--json", arguments.json, inputs);
  outputs.Stream(arguments.json);
  CheckTable table(several, arguments.options.tolerance);
  CatchInterrupts();
  for (const std::string& model : arguments.models) {
    arguments.scene.model = model;
    const Scene scene = LoadScene(arguments.scene);
    RowSource rows(scene, arguments.which);
    Progress progress("checking", rows.size());
    Options options = arguments.options;
    RowName name{several ? model : "", 0};
    for (Configuration row; !Interrupted() && rows.Next(row); ++name.index) {
      options.mocap_pos = row.mocap_pos;
      options.mocap_quat = row.mocap_quat;
      const Verdict verdict = Verify(scene, row.q, options, &row.q);
      if (!arguments.json.empty()) {
        outputs.Append(arguments.json, CheckJson(scene, name, row, verdict));
      }
      table.Add(scene, name, row, verdict);
      progress.Step();
    }
  }
  if (Interrupted()) {
    const bool kept = !arguments.json.empty() && arguments.json != "-";
    return SayInterrupted("after " + std::to_string(table.rows()) + " rows" +
                          (kept ? ", which are in " + OutputFiles::PartName(arguments.json) : ""));
  }
  outputs.Commit();
  if (!outputs.uses_stdout()) WriteStdout(table.ToString());
  return table.all_free() ? kExitFree : kExitNotFree;
}

// Adds --motion, --from and --to, which are given all three or not at all, and exclude the flags of
// other configurations.
void AddMotion(CLI::App& command, CheckArguments& arguments) {
  CLI::Option* motion = command.add_flag("--motion", arguments.motion,
                                         "how far is the motion between two configurations free?");
  for (CLI::Option* end : AddEnds(command, arguments.ends)) {
    motion->needs(end);
    end->needs(motion);
  }
  for (const char* other : {"--key", "--qpos", "--qpos-file"}) {
    motion->excludes(command.get_option(other));
  }
}

int Run(CheckArguments& arguments) {
  if (!arguments.motion) return RunCheck(arguments);
  if (arguments.models.size() > 1) throw Error("--motion is for a single model");
  arguments.scene.model = arguments.models.front();
  return RunCheckMotion(arguments.scene, arguments.ends, arguments.options, arguments.json);
}

}  // namespace

Verb AddCheckVerb(CLI::App& program) {
  CLI::App* command = program.add_subcommand(
      "check", "Report penetrating pairs and their depths, or how far a motion is free");
  auto arguments = std::make_shared<CheckArguments>();
  AddModels(*command, arguments->models);
  AddPlugins(*command);
  AddWhich(*command, arguments->which);
  AddMotion(*command, *arguments);
  AddMovable(*command, arguments->scene);
  AddPairs(*command, arguments->scene);
  AddExactMesh(*command, arguments->scene);
  AddModelRules(*command, arguments->scene);
  AddRest(*command, arguments->options);
  AddTolerance(*command, arguments->options);
  AddJson(*command, arguments->json);
  return {command, [arguments] { return Run(*arguments); }};
}

}  // namespace mjcf_pdg::app
