#include "apps/output/repaired_mjcf.h"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <utility>

#include "apps/console/text.h"

namespace mjcf_pdg::app {
namespace {

namespace fs = std::filesystem;

struct ModelDeleter {
  void operator()(mjModel* model) const { mj_deleteModel(model); }
};
struct DataDeleter {
  void operator()(mjData* data) const { mj_deleteData(data); }
};

constexpr int kErrorSize = 2000;

// The name of each row's new keyframe. If a label occurs again, its keyframes are numbered.
std::vector<std::string> KeyNames(const std::vector<Configuration>& rows) {
  std::vector<std::string> names;
  std::map<std::string, int> asked;
  for (const Configuration& row : rows) {
    const int times = ++asked[row.label];
    names.push_back(row.label + "_pdg" + (times > 1 ? "_" + std::to_string(times) : ""));
  }
  return names;
}

// ---- Setpoints ----

// Whether the actuator pulls to a position that its control or activation sets.
bool IsServo(const mjModel& m, int actuator) {
  const double* gainprm = m.actuator_gainprm + std::ptrdiff_t{mjNGAIN} * actuator;
  const double* biasprm = m.actuator_biasprm + std::ptrdiff_t{mjNBIAS} * actuator;
  return m.actuator_outnum[actuator] == 1 && m.actuator_gaintype[actuator] == mjGAIN_FIXED &&
         m.actuator_biastype[actuator] == mjBIAS_AFFINE && gainprm[0] != 0.0 &&
         biasprm[1] == -gainprm[0];
}

// Index in ctrl of the actuator's position setpoint; -1 if it has none.
int PositionControl(const mjModel& m, int actuator) {
  const int dynamics = m.actuator_dyntype[actuator];
  if (m.actuator_outnum[actuator] != 1 || m.actuator_ctrlnum[actuator] < 1) return -1;
  const bool servo = IsServo(m, actuator) && (dynamics == mjDYN_NONE || dynamics == mjDYN_FILTER ||
                                              dynamics == mjDYN_FILTEREXACT);
  // The position comes first among the inputs of a pid actuator.
  const bool pid = m.actuator_gaintype[actuator] == mjGAIN_PID &&
                   (m.actuator_ctrlspec[actuator] & mjINPUT_POS) != 0;
  return servo || pid ? m.actuator_ctrladr[actuator] : -1;
}

// Index in act of the position that the actuator pulls to: a filtered control, or, of an
// intvelocity actuator, the integral of one. -1 if it has none.
int PositionActivation(const mjModel& m, int actuator) {
  const int dynamics = m.actuator_dyntype[actuator];
  const bool holds =
      dynamics == mjDYN_FILTER || dynamics == mjDYN_FILTEREXACT || dynamics == mjDYN_INTEGRATOR;
  return holds && IsServo(m, actuator) && m.actuator_actnum[actuator] == 1
             ? m.actuator_actadr[actuator]
             : -1;
}

std::vector<double> ActuatorLengths(const mjModel& m, const Configuration& row,
                                    const std::vector<double>& q, mjData* d) {
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

struct Setpoints {
  std::vector<double> ctrl, act;
};

// Moves what each position actuator pulls to by the change of the actuator's length from the row's
// q to `q`, within its range. A servo that was off its setpoint stays off by as much, so that the
// scene behaves as its author meant it, without the overlap.
void MoveSetpoints(const mjModel& m, const Configuration& row, const std::vector<double>& q,
                   mjData* d, Setpoints& setpoints) {
  const std::vector<double> before = ActuatorLengths(m, row, row.q, d);
  const std::vector<double> after = ActuatorLengths(m, row, q, d);
  const auto move = [](double& value, double change, const mjtNum* range) {
    value += change;
    if (range) value = std::clamp(value, range[0], range[1]);
  };
  for (int a = 0; a < m.nactuator; ++a) {
    const double change = after[m.actuator_outadr[a]] - before[m.actuator_outadr[a]];
    if (change == 0.0) continue;
    if (const int c = PositionControl(m, a); c >= 0) {
      const mjtNum* range = m.actuator_ctrllimited[c] ? m.actuator_ctrlrange + 2 * c : nullptr;
      move(setpoints.ctrl[static_cast<std::size_t>(c)], change, range);
    }
    if (const int k = PositionActivation(m, a); k >= 0) {
      const mjtNum* range = m.actuator_actlimited[a] ? m.actuator_actrange + 2 * a : nullptr;
      move(setpoints.act[static_cast<std::size_t>(k)], change, range);
    }
  }
}

// ---- Keyframes ----

void SetVector(mjDoubleVec* target, const double* values, mjtSize n) {
  if (n > 0) mjs_setDouble(target, values, static_cast<int>(n));
}

// Sets `target` unless all values are zero, which is the default.
void SetUnlessZero(mjDoubleVec* target, const double* values, mjtSize n) {
  if (std::any_of(values, values + n, [](double v) { return v != 0.0; })) {
    SetVector(target, values, n);
  }
}

mjsKey* AddKey(const std::string& name, mjSpec* spec) {
  if (mjsElement* old = mjs_findElement(spec, mjOBJ_KEY, name.c_str())) mjs_delete(spec, old);
  mjsKey* key = mjs_addKey(spec);
  mjs_setName(key->element, name.c_str());
  return key;
}

void FillKey(const mjModel& m, const Configuration& row, const std::vector<double>& q, mjData* d,
             mjsKey* key) {
  SetVector(key->qpos, q.data(), m.nq);
  Setpoints setpoints{std::vector<double>(static_cast<std::size_t>(m.nu), 0.0),
                      std::vector<double>(static_cast<std::size_t>(m.na), 0.0)};
  if (row.key >= 0) {
    const std::ptrdiff_t k = row.key;
    key->time = m.key_time[k];
    SetUnlessZero(key->qvel, m.key_qvel + k * m.nv, m.nv);
    SetVector(key->plastic, m.key_plastic + k * m.nplastic, m.nplastic);
    std::copy_n(m.key_ctrl + k * m.nu, m.nu, setpoints.ctrl.begin());
    std::copy_n(m.key_act + k * m.na, m.na, setpoints.act.begin());
  }
  if (!row.mocap_pos.empty()) {  // those of the keyframe, unless they were moved since
    SetVector(key->mpos, row.mocap_pos.data(), m.nmocap * 3);
    SetVector(key->mquat, row.mocap_quat.data(), m.nmocap * 4);
  }
  MoveSetpoints(m, row, q, d, setpoints);
  SetUnlessZero(key->ctrl, setpoints.ctrl.data(), m.nu);
  SetUnlessZero(key->act, setpoints.act.data(), m.na);
}

}  // namespace

SpecPtr ParseSpec(const std::string& path) {
  if (fs::path(path).extension() == ".mjb") {
    throw Error(path +
                ": a compiled model cannot be written as MJCF: pass the XML that it is made of");
  }
  try {
    SpecPtr spec = ParseModelFile(path);
    // Only compiling makes keyframes of attached models part of the whole model.
    CompileModel(spec.get());
    return spec;
  } catch (const Error& e) {
    throw Error(path + ": " + e.what());
  }
}

void AddRepairedKeys(const RepairedRows& repaired, mjSpec* spec) {
  const auto& [scene, rows, results, times] = repaired;
  const mjModel& m = *scene.model();
  const std::unique_ptr<mjData, DataDeleter> data(mj_makeData(&m));
  if (!data) throw std::runtime_error("MuJoCo cannot make its data");
  const std::vector<std::string> names = KeyNames(rows);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (results[i].status == Status::kUnsolved) continue;
    mjsKey* const key = AddKey(names[i], spec);
    FillKey(m, rows[i], results[i].q, data.get(), key);
    if (!times.empty()) key->time = times[i];
  }
}

std::string FormatMjcf(mjSpec* spec) {
  // Saves the values as written. Compiled values would be saved with six digits, which moves geoms
  // by up to micrometres and puts keyframes back into contact.
  spec->compiler.savecompiled = 0;
  spec->compiler.savecanonical = 0;
  std::string error(kErrorSize, '\0');
  std::string text(1 << 16, '\0');
  int size = static_cast<int>(text.size());
  while (true) {
    const int result = mj_saveXMLString(spec, text.data(), size, error.data(), kErrorSize);
    if (result == 0) break;
    if (result < size) {
      throw std::runtime_error("MuJoCo cannot write the scene: " + OneLine(error.c_str()));
    }
    size = result + 1;
    text.assign(static_cast<std::size_t>(size), '\0');
  }
  text.resize(text.find('\0'));
  return text;
}

void CheckMjcf(const std::string& path, const mjVFS* vfs, const RepairedRows& repaired) {
  const auto& [scene, rows, results, times] = repaired;
  std::string error(kErrorSize, '\0');
  const std::unique_ptr<mjModel, ModelDeleter> model(
      mj_loadXML(path.c_str(), vfs, error.data(), kErrorSize));
  if (!model) {
    throw std::runtime_error("the written scene does not load: " + OneLine(error.c_str()));
  }
  const std::vector<std::string> names = KeyNames(rows);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (results[i].status == Status::kUnsolved) continue;
    const int key = mj_name2id(model.get(), mjOBJ_KEY, names[i].c_str());
    const std::vector<double>& q = results[i].q;
    const bool same = key >= 0 && static_cast<std::size_t>(model->nq) == q.size() &&
                      std::equal(q.begin(), q.end(), model->key_qpos + key * model->nq);
    if (!same) throw std::runtime_error("the written scene lost keyframe " + names[i]);
  }
}

}  // namespace mjcf_pdg::app
