// mjcf-pdg check --motion: how far the straight motion from one configuration to another is free.
#ifndef MJCF_PDG_APPS_CHECK_MOTION_H_
#define MJCF_PDG_APPS_CHECK_MOTION_H_

#include <string>

#include "apps/input/configurations.h"
#include "apps/options.h"

namespace mjcf_pdg::app {

// Checks the motion and writes the outcome to stdout, or as JSON to `json`: a file, "-" for stdout,
// or empty for none. Returns the exit code (cli.h); throws Error for bad input.
int RunCheckMotion(const SceneArguments& scene, const EndsArguments& ends, const Options& options,
                   const std::string& json);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_CHECK_MOTION_H_
