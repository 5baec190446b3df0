#include "solve/options.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string>
#include <vector>

#include "mjcf_pdg/pdg.h"
#include "problem/components.h"

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

template <typename Enum>
bool IsOneOf(Enum value, std::initializer_list<Enum> all) {
  return std::find(all.begin(), all.end(), value) != all.end();
}

}  // namespace

std::vector<std::string> Components(Method method) {
  std::vector<std::string> names;
  for (const Component component : ComponentsOf(method)) names.emplace_back(NameOf(component));
  return names;
}

void CheckOptions(const Options& options, const mjModel& m) {
  Require(Within(options.tolerance, 1e-12, 1.0), "tolerance must lie between 1e-12 and 1 m");
  Require(Within(options.clearance, 0.0, 1e3), "clearance must lie between 0 and 1000 m");
  Require(Within(options.rest, 0.0, 1e3), "rest must lie between 0 and 1000 m");
  Require(options.time_limit > 0.0, "the time limit must be positive");
  Require(Within(options.report_distances_to, 0.0, 1e3),
          "report_distances_to must lie between 0 and 1000 m");
  Require(IsOneOf(options.metric, {Metric::kSequential, Metric::kDisplacement}),
          "the metric is none of its values");
  Require(IsOneOf(options.method, {Method::kAuto, Method::kPaper}),
          "the method is none of its values");
  Require(IsOneOf(options.effort, {Effort::kFast, Effort::kDefault, Effort::kMax}),
          "the effort is none of its values");
  CheckMocap(options.mocap_pos, options.mocap_quat, m);
  ComponentsNamed(options.without, options.method);  // throws for a name that the method has not
}

void CheckMujocoVersion() {
  constexpr int kPatches = 1000;  // mj_version() is major · 1e6 + minor · 1e3 + patch
  Require(mj_version() / kPatches == mjVERSION_HEADER / kPatches,
          std::string("libmujoco is ") + mj_versionString() + ", but this library was built for " +
              std::to_string(mjVERSION_HEADER / 1000000) + "." +
              std::to_string(mjVERSION_HEADER / kPatches % 1000) + ".x");
}

void CheckBudget(const Budget& budget) {
  Require(budget.queries >= 0, "the budget of queries must not be negative");
  Require(budget.seconds >= 0.0, "the budget of seconds must not be negative");
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
