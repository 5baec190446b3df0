// mjcf-pdg check: which pairs penetrate and which joint limits are exceeded, and by how much; with
// --motion, how far the way from one configuration to another is free.
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/check_motion.h"
#include "apps/cli.h"
#include "apps/console/interrupt.h"
#include "apps/console/progress.h"
#include "apps/console/text.h"
#include "apps/html/checked_row.h"
#include "apps/html/shell_command.h"
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
  std::string json, html;
};

// The report of --html.
class CheckPage {
 public:
  CheckPage(const CLI::App& command, double tolerance)
      : tolerance_(tolerance),
        given_(GivenOptions(command)),
        page_({"", kCheckColumns, OptionsInForce(command)}) {}

  void BeginModel(const std::string& model, const Scene& scene) {
    again_ = {{"check", model}, given_};
    page_.BeginModel(model, scene);
  }
  void Add(const Scene& scene, const Configuration& row, const Verdict& verdict) {
    PageRow shown = CheckedPageRow(scene, tolerance_, {row, verdict});
    shown.content["command"] = again_.Of(row);
    page_.Add(shown);
  }
  std::string ToString() const { return page_.ToString(); }

 private:
  const double tolerance_;
  const std::vector<std::string> given_;
  RowCommand again_;  // of the present model
  Page page_;
};

int RunCheck(const CLI::App& command, CheckArguments& arguments) {
  const bool several = arguments.models.size() > 1;
  if (several && arguments.which.file == "-") {
    throw Error("--qpos-file: stdin can be read for one model only");
  }
  OutputFiles outputs;
  std::vector<std::string> inputs = arguments.models;
  inputs.push_back(arguments.which.file);
  outputs.Add("--json", arguments.json, inputs);
  outputs.Add("--html", arguments.html, inputs);
  outputs.Stream(arguments.json);
  CheckTable table(several, arguments.options.tolerance);
  std::optional<CheckPage> page;
  if (!arguments.html.empty()) page.emplace(command, arguments.options.tolerance);
  CatchInterrupts();
  for (const std::string& model : arguments.models) {
    arguments.scene.model = model;
    const Scene scene = LoadScene(arguments.scene);
    RowSource rows(scene, arguments.which);
    Progress progress("checking", rows.size());
    Options options = arguments.options;
    RowName name{several ? model : "", 0};
    if (page) page->BeginModel(model, scene);
    for (Configuration row; !Interrupted() && rows.Next(row); ++name.index) {
      options.mocap_pos = row.mocap_pos;
      options.mocap_quat = row.mocap_quat;
      const Verdict verdict = Verify(scene, row.q, options, &row.q);
      if (!arguments.json.empty()) {
        outputs.Append(arguments.json, CheckJson(scene, name, row, verdict));
      }
      if (page) page->Add(scene, row, verdict);
      table.Add(scene, name, row, verdict);
      progress.Step();
    }
  }
  if (Interrupted()) {
    const bool kept = !arguments.json.empty() && arguments.json != "-";
    return SayInterrupted("after " + std::to_string(table.rows()) + " rows" +
                          (kept ? ", which are in " + OutputFiles::PartName(arguments.json) : ""));
  }
  if (page) outputs.Stage(arguments.html, page->ToString());
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

int Run(const CLI::App& command, CheckArguments& arguments) {
  if (!arguments.motion) return RunCheck(command, arguments);
  if (arguments.models.size() > 1) throw Error("--motion is for a single model");
  arguments.scene.model = arguments.models.front();
  return RunCheckMotion(command, {arguments.scene, arguments.ends, arguments.options,
                                  arguments.json, arguments.html});
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
  AddHtml(*command, arguments->html);
  return {command, [command, arguments] { return Run(*command, *arguments); }};
}

}  // namespace mjcf_pdg::app
