// mjcf-pdg check: which pairs penetrate and which joint limits are exceeded, and by how much. With
// --motion: how far the straight motion from one configuration to another is free.
#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "apps/check_motion.h"
#include "apps/cli.h"
#include "apps/configurations.h"
#include "apps/options.h"
#include "apps/output_files.h"
#include "apps/report.h"
#include "apps/text.h"
#include "mjcf_pdg/pdg.h"

namespace mjcf_pdg::app {
namespace {

struct CheckArguments {
  SceneArguments scene;
  WhichArguments which;
  bool motion = false;
  EndsArguments ends;
  Options options;
  std::string json;
};

int RunCheck(const CheckArguments& arguments) {
  const Scene scene = LoadScene(arguments.scene);
  const std::vector<Configuration> rows = ReadConfigurations(scene, arguments.which);
  OutputFiles outputs;
  outputs.Add("--json", arguments.json, {arguments.scene.model, arguments.which.file});
  std::vector<Verdict> verdicts;
  for (const Configuration& row : rows) {
    Options options = arguments.options;
    options.mocap_pos = row.mocap_pos;
    options.mocap_quat = row.mocap_quat;
    verdicts.push_back(Verify(scene, row.q, options, &row.q));
  }
  if (!arguments.json.empty()) outputs.Stage(arguments.json, CheckJson(scene, rows, verdicts));
  outputs.Commit();
  if (!outputs.uses_stdout()) {
    WriteStdout(CheckTable(scene, rows, verdicts, arguments.options.tolerance));
  }
  const bool all_free = std::all_of(verdicts.begin(), verdicts.end(),
                                    [](const Verdict& verdict) { return verdict.free; });
  return all_free ? kExitFree : kExitNotFree;
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

int Run(const CheckArguments& arguments) {
  if (!arguments.motion) return RunCheck(arguments);
  return RunCheckMotion(arguments.scene, arguments.ends, arguments.options, arguments.json);
}

}  // namespace

Verb AddCheckVerb(CLI::App& program) {
  CLI::App* command = program.add_subcommand(
      "check", "Report penetrating pairs and their depths, or how far a motion is free");
  auto arguments = std::make_shared<CheckArguments>();
  AddModel(*command, arguments->scene);
  AddWhich(*command, arguments->which);
  AddMotion(*command, *arguments);
  AddMovable(*command, arguments->scene);
  AddExactMesh(*command, arguments->scene);
  AddRest(*command, arguments->options);
  AddTolerance(*command, arguments->options);
  AddJson(*command, arguments->json);
  return {command, [arguments] { return Run(*arguments); }};
}

}  // namespace mjcf_pdg::app
