#include "apps/output/setpoints.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <stdexcept>

namespace mjcf_pdg::app {
namespace {

// Whether the actuator pulls to a position that its control or activation sets.
bool IsServo(const mjModel& m, int actuator) {
  const double* gainprm = m.actuator_gainprm + std::ptrdiff_t{mjNGAIN} * actuator;
  const double* biasprm = m.actuator_biasprm + std::ptrdiff_t{mjNBIAS} * actuator;
  return m.actuator_outnum[actuator] == 1 && m.actuator_gaintype[actuator] == mjGAIN_FIXED &&
         m.actuator_biastype[actuator] == mjBIAS_AFFINE && gainprm[0] != 0.0 &&
         biasprm[1] == -gainprm[0];
}

// Whether the actuator is one of MuJoCo's own plugin mujoco.pid, which pulls to a position, too.
bool IsPidPlugin(const mjModel& m, int actuator) {
  const int instance = m.actuator_plugin[actuator];
  const mjpPlugin* plugin = instance >= 0 ? mjp_getPluginAtSlot(m.plugin[instance]) : nullptr;
  return plugin && std::strcmp(plugin->name, "mujoco.pid") == 0;
}

bool IsConfigured(const mjModel& m, int actuator, const char* what) {
  const char* value = mj_getPluginConfig(&m, m.actuator_plugin[actuator], what);
  return value && *value;
}

// Index in ctrl of the actuator's position setpoint; -1 if it has none.
int PositionControl(const mjModel& m, int actuator) {
  const int dynamics = m.actuator_dyntype[actuator];
  if (m.actuator_outnum[actuator] != 1 || m.actuator_ctrlnum[actuator] < 1) return -1;
  const bool servo =
      (IsServo(m, actuator) || IsPidPlugin(m, actuator)) &&
      (dynamics == mjDYN_NONE || dynamics == mjDYN_FILTER || dynamics == mjDYN_FILTEREXACT);
  // The position comes first among the inputs of a pid actuator.
  const bool pid = m.actuator_gaintype[actuator] == mjGAIN_PID &&
                   (m.actuator_ctrlspec[actuator] & mjINPUT_POS) != 0;
  return servo || pid ? m.actuator_ctrladr[actuator] : -1;
}

// Indices in act of the positions that the actuator pulls to: of a filtered control, or, of an
// intvelocity actuator, of the integral of one. The plugin has before it, if so configured, an
// integral of the error and the control of the last step, from which slewmax counts.
std::vector<int> PositionActivations(const mjModel& m, int actuator) {
  const int dynamics = m.actuator_dyntype[actuator], count = m.actuator_actnum[actuator];
  const bool holds =
      dynamics == mjDYN_FILTER || dynamics == mjDYN_FILTEREXACT || dynamics == mjDYN_INTEGRATOR;
  const bool plugin = IsPidPlugin(m, actuator);
  const int first = m.actuator_actadr[actuator];
  std::vector<int> positions;
  if (plugin && IsConfigured(m, actuator, "slewmax")) {
    positions.push_back(first + (IsConfigured(m, actuator, "ki") ? 1 : 0));
  }
  if (holds && (plugin || (IsServo(m, actuator) && count == 1))) {
    positions.push_back(first + count - 1);
  }
  return positions;
}

void Move(double& value, double change, const mjtNum* range) {
  value += change;
  if (range) value = std::clamp(value, range[0], range[1]);
}

}  // namespace

SetpointMover::SetpointMover(const mjModel& model) : model_(model), data_(mj_makeData(&model)) {
  if (!data_) throw std::runtime_error("MuJoCo cannot make its data");
}

Setpoints SetpointMover::Of(const Configuration& row) const {
  Setpoints setpoints{std::vector<double>(static_cast<std::size_t>(model_.nu), 0.0),
                      std::vector<double>(static_cast<std::size_t>(model_.na), 0.0)};
  if (row.key < 0) return setpoints;
  const std::ptrdiff_t k = row.key;
  std::copy_n(model_.key_ctrl + k * model_.nu, model_.nu, setpoints.ctrl.begin());
  std::copy_n(model_.key_act + k * model_.na, model_.na, setpoints.act.begin());
  return setpoints;
}

std::vector<double> SetpointMover::ActuatorLengths(const Configuration& row,
                                                   const std::vector<double>& q) {
  const mjModel& m = model_;
  mjData* d = data_.get();
  std::copy(q.begin(), q.end(), d->qpos);
  if (!row.mocap_pos.empty()) {
    std::copy(row.mocap_pos.begin(), row.mocap_pos.end(), d->mocap_pos);
    std::copy(row.mocap_quat.begin(), row.mocap_quat.end(), d->mocap_quat);
  }
  mj_kinematics(&m, d);
  mj_comPos(&m, d);
  mj_tendon(&m, d);
  mj_transmission(&m, d);
  return {d->actuator_length, d->actuator_length + m.nout};
}

Setpoints SetpointMover::Moved(const Configuration& row, const std::vector<double>& q) {
  const mjModel& m = model_;
  Setpoints setpoints = Of(row);
  const std::vector<double> before = ActuatorLengths(row, row.q), after = ActuatorLengths(row, q);
  for (int a = 0; a < m.nactuator; ++a) {
    const double change = after[m.actuator_outadr[a]] - before[m.actuator_outadr[a]];
    if (change == 0.0) continue;
    if (const int c = PositionControl(m, a); c >= 0) {
      const mjtNum* range = m.actuator_ctrllimited[c] ? m.actuator_ctrlrange + 2 * c : nullptr;
      Move(setpoints.ctrl[static_cast<std::size_t>(c)], change, range);
    }
    for (const int k : PositionActivations(m, a)) {
      const mjtNum* range = m.actuator_actlimited[a] ? m.actuator_actrange + 2 * a : nullptr;
      Move(setpoints.act[static_cast<std::size_t>(k)], change, range);
    }
  }
  return setpoints;
}

}  // namespace mjcf_pdg::app
