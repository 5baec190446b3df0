// Handles MuJoCo's messages. By default MuJoCo appends them to MUJOCO_LOG.TXT in the current folder
// and calls exit(1) after an error.
#ifndef MJCF_PDG_APPS_CONSOLE_MUJOCO_LOG_H_
#define MJCF_PDG_APPS_CONSOLE_MUJOCO_LOG_H_

#include <functional>
#include <string>
#include <vector>

namespace mjcf_pdg::app {

// Installs a handler for the rest of the program. It throws an error inside MuJoCo as a
// std::runtime_error, through MuJoCo's C frames (they have unwind tables), collects warnings, and
// drops all other messages. Nothing is written to the console or to disk.
void InstallMujocoLog();

// Returns the distinct warnings since the last call, at most five, one line each, in order of first
// appearance.
std::vector<std::string> TakeMujocoWarnings();

// Calls `action` and returns MuJoCo's errors during it, one line each, instead of throwing them:
// for what no exception may pass through, as the loading of a library. After an error MuJoCo goes
// on.
std::vector<std::string> MujocoErrorsDuring(const std::function<void()>& action);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_CONSOLE_MUJOCO_LOG_H_
