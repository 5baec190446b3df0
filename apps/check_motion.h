// mjcf-pdg check --motion: how far the straight motion from one configuration to another is free.
#ifndef MJCF_PDG_APPS_CHECK_MOTION_H_
#define MJCF_PDG_APPS_CHECK_MOTION_H_

#include <CLI/CLI.hpp>
#include <string>

#include "apps/input/configurations.h"
#include "apps/options.h"

namespace mjcf_pdg::app {

struct MotionArguments {
  const SceneArguments& scene;
  const EndsArguments& ends;
  const Options& options;
  const std::string& json;  // a file, "-" for stdout, or empty for none
  const std::string& html;  // the report's file, or empty
};

// Checks the motion and writes the outcome to stdout, unless JSON goes there. `command` is parsed.
// Returns the exit code (cli.h); throws Error for bad input.
int RunCheckMotion(const CLI::App& command, const MotionArguments& arguments);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_CHECK_MOTION_H_
