// MuJoCo's messages, kept off the disk: by default it appends to MUJOCO_LOG.TXT in the current
// folder and calls exit(1) on an error.
#ifndef MJCF_PDG_APPS_MUJOCO_LOG_H_
#define MJCF_PDG_APPS_MUJOCO_LOG_H_

#include <string>
#include <vector>

namespace mjcf_pdg::app {

// From here on an error inside MuJoCo is a std::runtime_error thrown through its C frames (they
// carry unwind tables), warnings are collected, and the rest is dropped.
void InstallMujocoLog();

// The different warnings since the last call, one line each, in order of first appearance.
std::vector<std::string> TakeMujocoWarnings();

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_MUJOCO_LOG_H_
