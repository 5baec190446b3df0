// The command line of `solve`, which `replay` reads again from a trace.
#ifndef MJCF_PDG_APPS_SOLVE_SOLVE_ARGUMENTS_H_
#define MJCF_PDG_APPS_SOLVE_SOLVE_ARGUMENTS_H_

#include <CLI/CLI.hpp>
#include <limits>
#include <string>
#include <vector>

#include "apps/input/configurations.h"
#include "apps/options.h"
#include "mjcf_pdg/types.h"

namespace mjcf_pdg::app {

struct SolveArguments {
  SceneArguments scene;  // of the present model
  std::vector<std::string> models;
  WhichArguments which;
  Options options;
  double time_limit_ms = std::numeric_limits<double>::infinity();
  unsigned long long seed = 0;
  unsigned long long threads = 1;
  double smooth = 0.0;
  bool resume = false;
  std::string json, out_qpos, out_mjcf, png, animation, trace, html;
};

// Adds the options to the command. `arguments` must outlive the parsing.
void AddSolveFlags(CLI::App& command, SolveArguments& arguments);

// Completes `arguments.options` when the command line has been parsed.
void FinishSolveOptions(SolveArguments& arguments);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_SOLVE_SOLVE_ARGUMENTS_H_
