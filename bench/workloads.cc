#include "workloads.h"

#include <cstdio>
#include <exception>
#include <utility>

#include "measure.h"
#include "mjcf_pdg/pdg.h"

namespace mjcf_pdg::bench {
namespace {

// Adds the sets of a scene, or, if it cannot be loaded or Solver refuses it, one workload with the
// reason.
template <typename Sets>
void Append(const std::string& path, bool exact_mesh, Sets sets, std::vector<Workload>& workloads) {
  try {
    SceneOptions options;
    options.exact_mesh = exact_mesh;
    const Scene scene = Scene::FromFile(path, options);
    const Solver accepts(scene);  // throws if it does not accept the scene
    for (ProblemSet& set : sets(scene)) workloads.push_back({scene, std::move(set), {}});
  } catch (const std::exception& error) {
    workloads.push_back({std::nullopt, {path, path, {}}, error.what()});
  }
}

}  // namespace

void AddSetArguments(CLI::App& app, SetArguments& arguments) {
  app.add_option("models", arguments.models,
                 "MJCF files (default: the project's own three scenes)");
  app.add_option("--problems", arguments.problems, "JSON Lines with model, qpos, best")
      ->allow_extra_args(false);
  app.add_option("--root", arguments.root, "folder that the models in --problems are relative to");
  app.add_option("--count", arguments.count, "random configurations per model")
      ->check(CLI::Range(0, 1000000));
  app.add_option("--seed", arguments.seed, "seed of the random configurations");
  app.add_option("--tolerance", arguments.tolerance, "overlap that counts as free [m]");
  app.add_flag("--exact-mesh", arguments.exact_mesh, "meshes collide as their triangles");
}

std::vector<Workload> LoadWorkloads(const SetArguments& arguments) {
  std::vector<Workload> workloads;
  for (const std::string& file : arguments.problems) {
    for (const ProblemSet& set : ReadProblems(file, arguments.root)) {
      Append(
          set.model_path, arguments.exact_mesh,
          [&](const Scene&) { return std::vector<ProblemSet>{set}; }, workloads);
    }
  }
  std::vector<std::string> models = arguments.models;
  if (models.empty() && arguments.problems.empty()) models = OwnModels();
  for (const std::string& path : models) {
    Append(
        path, arguments.exact_mesh,
        [&](const Scene& scene) {
          return std::vector<ProblemSet>{
              Keyframes(scene, path), RandomProblems(scene, path, arguments.count, arguments.seed)};
        },
        workloads);
  }
  return workloads;
}

std::vector<Workload> LoadSoundWorkloads(const SetArguments& arguments) {
  std::vector<Workload> workloads;
  for (Workload& workload : LoadWorkloads(arguments)) {
    if (!workload.scene) throw Error(workload.set.name + ": " + workload.error);
    if (!workload.set.problems.empty()) workloads.push_back(std::move(workload));
  }
  return workloads;
}

int RunProgram(CLI::App& app, int argc, char** argv, const std::function<void()>& run) {
  CLI11_PARSE(app, argc, argv);
  HandleMujocoMessages();
  try {
    run();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: error: %s\n", app.get_name().c_str(), error.what());
    return 2;
  }
  return 0;
}

}  // namespace mjcf_pdg::bench
