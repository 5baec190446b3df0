// Whether two models mean the same by every qpos, wherever they begin.
#ifndef MJCF_PDG_APPS_AUDIT_SAME_MODEL_H_
#define MJCF_PDG_APPS_AUDIT_SAME_MODEL_H_

#include <mujoco/mujoco.h>

#include <memory>
#include <string>

namespace mjcf_pdg::app {

// Of lengths relative to the model's extent, of quaternions, and of angles [rad].
inline constexpr double kSameModel = 1e-9;

using ModelPtr = std::unique_ptr<mjModel, void (*)(mjModel*)>;
using DataPtr = std::unique_ptr<mjData, void (*)(mjData*)>;

// The model of a text that stands in the file `path`, existing or not; null if it does not load.
ModelPtr Compiled(const std::string& text, const std::string& path);

// |a - b| <= tolerance for each of n numbers.
bool Near(const mjtNum* a, const mjtNum* b, mjtSize n, double tolerance);

// Data with the kinematics at q, nq values.
DataPtr At(const mjModel& model, const mjtNum* q);

// Numbers of a joint in qpos.
int Width(const mjModel& model, int joint);

// Bodies stand where they did at qpos0 of `before` and at random configurations, and so do
// keyframes; equality constraints and springs are what they were.
bool IsSameModel(const mjModel& before, const mjModel& after);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_AUDIT_SAME_MODEL_H_
