// mjcf-pdg check: which pairs penetrate and which joint limits are exceeded, and by how much.
#include <algorithm>
#include <memory>
#include <string>
#include <vector>

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

}  // namespace

Verb AddCheckVerb(CLI::App& program) {
  CLI::App* command = program.add_subcommand("check", "Report penetrating pairs and their depths");
  auto arguments = std::make_shared<CheckArguments>();
  AddModel(*command, arguments->scene);
  AddWhich(*command, arguments->which);
  AddMovable(*command, arguments->scene);
  AddExactMesh(*command, arguments->scene);
  AddRest(*command, arguments->options);
  AddTolerance(*command, arguments->options);
  AddJson(*command, arguments->json);
  return {command, [arguments] { return RunCheck(*arguments); }};
}

}  // namespace mjcf_pdg::app
