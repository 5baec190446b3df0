// The problem sets that a benchmark runs on, as its command line names them.
#ifndef MJCF_PDG_BENCH_WORKLOADS_H_
#define MJCF_PDG_BENCH_WORKLOADS_H_

#include <CLI/CLI.hpp>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "problem_sets.h"

namespace mjcf_pdg::bench {

struct SetArguments {
  std::vector<std::string> models;    // MJCF files
  std::vector<std::string> problems;  // JSON Lines files, see ReadProblems
  std::string root = ".";             // folder that the models in `problems` are relative to
  std::uint64_t seed = 1;             // of the random configurations
  int count = 40;                     // random configurations per model
  double tolerance = 1e-6;            // overlap that counts as free [m]
  bool exact_mesh = false;            // as in SceneOptions
};

// Adds the options that fill `arguments`, whose values are the defaults.
void AddSetArguments(CLI::App& app, SetArguments& arguments);

// A problem set with its scene, or with the reason why there is no scene.
struct Workload {
  std::optional<Scene> scene;
  ProblemSet set;
  std::string error;  // empty if there is a scene
};

// The sets of the `problems` files, then the keyframes and the random problems of each of `models`.
// If both are empty, the models are the project's own three scenes.
std::vector<Workload> LoadWorkloads(const SetArguments& arguments);
// The same without empty sets. Throws Error if a scene cannot be loaded or Solver refuses it.
std::vector<Workload> LoadSoundWorkloads(const SetArguments& arguments);

// Parses the command line and calls `run`. An error is written to stderr as one line. Returns the
// exit code.
int RunProgram(CLI::App& app, int argc, char** argv, const std::function<void()>& run);

}  // namespace mjcf_pdg::bench

#endif  // MJCF_PDG_BENCH_WORKLOADS_H_
