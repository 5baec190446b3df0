// mjcf-pdg view: a window in which a body is dragged or a joint moved into collision, and the
// repair follows.
#include <dlfcn.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "apps/cli.h"
#include "apps/console/text.h"
#include "apps/input/configurations.h"
#include "apps/input/plugins.h"
#include "apps/input/text_file.h"
#include "apps/options.h"
#include "apps/output/output_files.h"
#include "apps/output/report.h"
#include "apps/solve/scene_output.h"
#include "apps/solve/solve_arguments.h"
#include "apps/view/viewer.h"
#include "apps/view/window.h"

namespace mjcf_pdg::app {
namespace {

struct ViewArguments {
  SceneArguments scene;
  WhichArguments which;
  Options options;
  unsigned long long seed = 0;
  std::string out_mjcf, script, json;
};

// The window's library is in the folder that the program's run path names for it.
ShowWindowFunction* LoadWindow() {
  void* const library = dlopen("mjcf_pdg_view.so", RTLD_NOW | RTLD_LOCAL);
  void* const function = library ? dlsym(library, kShowWindow) : nullptr;
  if (!function) {
    throw Error(std::string("no window: ") + dlerror() +
                " (Debian, Ubuntu: apt-get install libglfw3 libgl1)");
  }
  return reinterpret_cast<ShowWindowFunction*>(function);
}

std::vector<Configuration> ReadRows(const Scene& scene, const WhichArguments& which) {
  RowSource source(scene, which);
  std::vector<Configuration> rows;
  for (Configuration row; source.Next(row);) rows.push_back(row);
  return rows;
}

// Throws Error unless what may be written on the way can be.
void CheckOutputs(const ViewArguments& arguments, const std::vector<ScriptEvent>& script,
                  const std::vector<std::string>& inputs) {
  OutputFiles probe;
  SceneOutput().Add(arguments.out_mjcf, arguments.scene.model, inputs, probe);
  for (const ScriptEvent& event : script) {
    if (event.kind != ScriptEvent::Kind::kScreenshot) continue;
    probe.Add("screenshot", event.text, inputs);
  }
}

// The keyframes that were saved until now. Each file is written anew with all of its own, whole or
// not at all.
class SavedKeys {
 public:
  SavedKeys(const Scene& scene, const std::string& model) : scene_(scene), model_(model) {}

  std::string Save(const std::string& path, const Configuration& row, const Result& result) {
    if (path != path_) rows_.clear(), results_.clear();
    path_ = path;
    rows_.push_back(row);
    results_.push_back(result);
    try {
      Write();
    } catch (...) {
      rows_.pop_back();
      results_.pop_back();
      throw;
    }
    const auto same = [&row](const Configuration& other) { return other.label == row.label; };
    const auto count = std::count_if(rows_.begin(), rows_.end(), same);
    return row.label + "_pdg" + (count > 1 ? "_" + std::to_string(count) : "");
  }

 private:
  void Write() const {
    OutputFiles outputs;
    SceneOutput output;
    output.Add(path_, model_, {model_}, outputs);
    if (!output.wanted()) throw Error("a file name is needed");
    output.Stage(model_, {scene_, rows_, results_}, outputs);
    outputs.Commit();
  }

  const Scene& scene_;
  const std::string model_;
  std::string path_;
  std::vector<Configuration> rows_;
  std::vector<Result> results_;
};

// `mjcf-pdg solve` with the model and the options of this view, for a shell.
std::string SolveCommand(const CLI::App& command, const std::string& model) {
  std::string line = "mjcf-pdg solve";
  std::vector<std::string> words = GivenOptions(command);
  words.insert(words.begin(), model);
  for (const std::string& word : words) {
    const bool plain = word.find_first_of(" '\"\\$`&|;<>()*?[]#~!{}") == std::string::npos;
    std::string quoted;
    for (const char c : word) quoted += c == '\'' ? "'\\''" : std::string(1, c);
    line += plain ? " " + word : " '" + quoted + "'";
  }
  return line;
}

int RunView(const CLI::App& command, ViewArguments& arguments) {
  const Scene scene = LoadScene(arguments.scene);
  arguments.options.seed = arguments.seed;
  arguments.options.report_distances_to = 1.0;
  std::vector<Configuration> rows = ReadRows(scene, arguments.which);

  const std::vector<std::string> inputs = {arguments.scene.model, arguments.which.file,
                                           arguments.script};
  std::vector<ScriptEvent> script;
  if (!arguments.script.empty()) {
    script = ParseScript(ReadTextFile(arguments.script), arguments.script, *scene.model());
  }
  CheckOutputs(arguments, script, inputs);
  OutputFiles outputs;
  outputs.Add("--json", arguments.json, inputs);
  outputs.Stream(arguments.json);
  SavedKeys saved(scene, arguments.scene.model);
  std::size_t ticks = 0;
  ViewServices services;
  services.load = [&scene](const std::string& path) {
    WhichArguments which;
    which.file = path;
    return ReadRows(scene, which);
  };
  services.save = [&saved](const std::string& path, const Configuration& row,
                           const Result& result) { return saved.Save(path, row, result); };
  if (!arguments.json.empty()) {
    services.ticked = [&](const Configuration& row, const Result& result) {
      outputs.Append(arguments.json, SolveJson(scene, {"", ticks++}, row, result));
    };
  }
  Viewer viewer(scene, arguments.options, std::move(rows), std::move(services));
  const std::string stem = std::filesystem::path(arguments.scene.model).stem().string();
  viewer.save_path = arguments.out_mjcf.empty() ? stem + "_view.xml" : arguments.out_mjcf;
  viewer.solve_command = SolveCommand(command, arguments.scene.model);
  if (!arguments.script.empty()) viewer.Run(std::move(script));
  (*LoadWindow())(viewer, {"mjcf-pdg view: " + stem});
  outputs.Commit();
  return kExitFree;
}

}  // namespace

Verb AddViewVerb(CLI::App& program) {
  CLI::App* command = program.add_subcommand(
      "view", "Open a window: drag a body into collision, and the repair follows");
  auto arguments = std::make_shared<ViewArguments>();
  AddModel(*command, arguments->scene);
  AddPlugins(*command);
  AddWhich(*command, arguments->which);
  AddMovable(*command, arguments->scene);
  AddRoot(*command, arguments->scene);
  AddArmature(*command, arguments->scene);
  AddPairs(*command, arguments->scene);
  AddExactMesh(*command, arguments->scene);
  AddModelRules(*command, arguments->scene);
  AddRest(*command, arguments->options);
  AddMetric(*command, arguments->options.metric);
  AddTolerance(*command, arguments->options);
  AddClearance(*command, arguments->scene, arguments->options);
  AddEffort(*command, arguments->options.effort);
  constexpr double kMaxSeed = 18446744073709551615.0;
  AddInteger(*command, {"--seed", "N", "of the random starts", {.high = kMaxSeed}},
             arguments->seed);
  AddPath(*command, "--out-mjcf",
          "where Ctrl+S writes the scene with the repaired keyframes NAME_pdg (default: "
          "MODEL_view.xml); DIR/: with copies of its assets",
          arguments->out_mjcf)
      ->type_name("FILE|DIR/");
  AddPath(*command, "--script", "do what the file says, frame by frame, and end: see docs/view.md",
          arguments->script);
  AddPath(*command, "--json", "write every tick as a line of JSON, as solve does; - is stdout",
          arguments->json)
      ->type_name("FILE|-");
  return {command, [command, arguments] { return RunView(*command, *arguments); }};
}

}  // namespace mjcf_pdg::app
