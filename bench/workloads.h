// The sets that a benchmark runs on, from its command line.
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
  std::vector<std::string> models;
  std::vector<std::string> problems;
  std::string root = ".";
  std::uint64_t seed = 1;   // of the random configurations
  int count = 40;           // of random configurations per model
  double tolerance = 1e-6;  // overlap that counts as free [m]
  bool exact_mesh = false;  // as in SceneOptions
};

// The defaults of `arguments` are those of the program.
void AddSetArguments(CLI::App& app, SetArguments& arguments);

// A set with the scene that it belongs to, or why there is none.
struct Workload {
  std::optional<Scene> scene;
  ProblemSet set;
  std::string error;
};

// The sets of the files; then the keyframes and the random problems of each model. Without files
// and models: of the project's own three scenes.
std::vector<Workload> LoadWorkloads(const SetArguments& arguments);
// Those with problems. Throws Error if a scene cannot be loaded or solved.
std::vector<Workload> LoadSoundWorkloads(const SetArguments& arguments);

// Parses the command line and runs; an error is one line on stderr. The value for main to return.
int RunProgram(CLI::App& app, int argc, char** argv, const std::function<void()>& run);

}  // namespace mjcf_pdg::bench

#endif  // MJCF_PDG_BENCH_WORKLOADS_H_
