#include "solve/options.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "mjcf_pdg/pdg.h"
#include "paper/free_configuration.h"

namespace mjcf_pdg {
namespace {

void Require(bool holds, const std::string& message) {
  if (!holds) throw Error(message);
}

bool Within(double x, double low, double high) { return x >= low && x <= high; }

void CheckPoses(const std::vector<double>& values, int per_body, const mjModel& m,
                const std::string& name) {
  if (values.empty()) return;
  const std::size_t needed = static_cast<std::size_t>(per_body) * m.nmocap;
  Require(values.size() == needed, name + " has " + std::to_string(values.size()) +
                                       " values, the model needs " + std::to_string(needed));
  for (const double v : values) Require(std::abs(v) < mjMAXVAL, name + " has an unusable value");
}

void CheckComponents(const Options& options) {
  const std::vector<std::string> known = Components(options.method);
  for (const std::string& name : options.without) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    std::string message = "cannot leave out '" + name + "': the method has";
    for (std::size_t k = 0; k < known.size(); ++k) message += (k ? ", " : " ") + known[k];
    throw Error(message);
  }
}

}  // namespace

std::vector<std::string> Components(Method method) {
  if (method == Method::kPaper) {
    std::vector<std::string> names = FreeConfigurationSelection::Names();
    names.insert(names.end(), {"corrections", "reverse_projection"});
    return names;
  }
  return {"direct",
          "mirror",
          "noise",
          "hop",
          "constrained_translation",
          "hulls",
          "pair_by_pair",
          "anywhere",
          "user_pose",
          "polish",
          "early_exit",
          "witness_memory",
          "motion_coherence",
          "damping"};
}

void CheckOptions(const Options& options, const mjModel& m) {
  Require(Within(options.tolerance, 1e-9, 1.0), "tolerance must lie between 1e-9 and 1 m");
  Require(Within(options.clearance, 0.0, 1e3), "clearance must lie between 0 and 1000 m");
  Require(Within(options.rest, 0.0, 1e3), "rest must lie between 0 and 1000 m");
  Require(options.time_limit > 0.0, "the time limit must be positive");
  CheckMocap(options.mocap_pos, options.mocap_quat, m);
  CheckComponents(options);
}

void CheckMocap(const std::vector<double>& pos, const std::vector<double>& quat, const mjModel& m) {
  CheckPoses(pos, 3, m, "mocap_pos");
  CheckPoses(quat, 4, m, "mocap_quat");
  for (std::size_t k = 0; k < quat.size(); k += 4) {
    const bool some = mju_norm(quat.data() + k, 4) >= kLeastQuaternion;
    Require(some, "mocap_quat has a zero quaternion");
  }
}

}  // namespace mjcf_pdg
