// When a path is where: the options of `plan` that ask for it, and the file that tells it.
#ifndef MJCF_PDG_APPS_PLAN_TRAJECTORY_H_
#define MJCF_PDG_APPS_PLAN_TRAJECTORY_H_

#include <CLI/CLI.hpp>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "apps/output/output_files.h"
#include "plan/timing.h"

namespace mjcf_pdg::app {

struct TrajectoryArguments {
  std::string speeds, accelerations;                      // RATES, empty: not given
  double step = std::numeric_limits<double>::infinity();  // [s]; infinite: the model's time step
  std::string file;
};

// --speeds, --accelerations, --time-step, --out-trajectory
void AddTrajectory(CLI::App& command, TrajectoryArguments& arguments);

// Adds the file to `outputs`. Throws Error if it cannot be written or has no known ending.
void AddTrajectoryFile(const TrajectoryArguments& arguments, const std::vector<std::string>& inputs,
                       OutputFiles& outputs);

// The limits that were given; none if no times are wanted. Throws Error for what is no rate, joints
// that there are not, joints that may move without a speed, and options that need --speeds.
std::optional<TimingLimits> ReadTimingLimits(const Scene& scene,
                                             const TrajectoryArguments& arguments);

// The samples, a row each: time, qpos, qvel; of a .jsonl a line each. `path` tells the kind.
std::string TrajectoryContent(const TimedPath& timed, const std::string& path);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_PLAN_TRAJECTORY_H_
