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

// ---- Controls ----

// Index in ctrl of the actuator's position setpoint; -1 if it has none. (An intvelocity actuator
// has the gains of a position actuator, but its setpoint is an activation.)
int PositionControl(const mjModel& m, int actuator) {
  const int gain = m.actuator_gaintype[actuator], dynamics = m.actuator_dyntype[actuator];
  const double* gainprm = m.actuator_gainprm + std::ptrdiff_t{mjNGAIN} * actuator;
  const double* biasprm = m.actuator_biasprm + std::ptrdiff_t{mjNBIAS} * actuator;
  if (m.actuator_outnum[actuator] != 1 || m.actuator_ctrlnum[actuator] < 1) return -1;
  const bool servo =
      gain == mjGAIN_FIXED && m.actuator_biastype[actuator] == mjBIAS_AFFINE && gainprm[0] != 0.0 &&
      biasprm[1] == -gainprm[0] &&
      (dynamics == mjDYN_NONE || dynamics == mjDYN_FILTER || dynamics == mjDYN_FILTEREXACT);
  // The position comes first among the inputs of a pid actuator.
  const bool pid = gain == mjGAIN_PID && (m.actuator_ctrlspec[actuator] & mjINPUT_POS) != 0;
  return servo || pid ? m.actuator_ctrladr[actuator] : -1;
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

// Moves the setpoint of each position actuator by the change of the actuator's length from the
// row's q to `q`, within its control range. A servo that was off its setpoint stays off by as much,
// so that the scene behaves as its author meant it, without the overlap.
void MoveControls(const mjModel& m, const Configuration& row, const std::vector<double>& q,
                  mjData* d, std::vector<double>& ctrl) {
  const std::vector<double> before = ActuatorLengths(m, row, row.q, d);
  const std::vector<double> after = ActuatorLengths(m, row, q, d);
  for (int a = 0; a < m.nactuator; ++a) {
    const int c = PositionControl(m, a);
    const double change = after[m.actuator_outadr[a]] - before[m.actuator_outadr[a]];
    if (c < 0 || change == 0.0) continue;
    double& control = ctrl[static_cast<std::size_t>(c)];
    control += change;
    if (!m.actuator_ctrllimited[c]) continue;
    control = std::clamp(control, m.actuator_ctrlrange[2 * c], m.actuator_ctrlrange[2 * c + 1]);
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
  std::vector<double> ctrl(static_cast<std::size_t>(m.nu), 0.0);
  if (row.key >= 0) {
    const std::ptrdiff_t k = row.key;
    key->time = m.key_time[k];
    SetUnlessZero(key->qvel, m.key_qvel + k * m.nv, m.nv);
    SetUnlessZero(key->act, m.key_act + k * m.na, m.na);
    SetVector(key->mpos, m.key_mpos + k * m.nmocap * 3, m.nmocap * 3);
    SetVector(key->mquat, m.key_mquat + k * m.nmocap * 4, m.nmocap * 4);
    SetVector(key->plastic, m.key_plastic + k * m.nplastic, m.nplastic);
    std::copy_n(m.key_ctrl + k * m.nu, m.nu, ctrl.begin());
  }
  MoveControls(m, row, q, d, ctrl);
  SetUnlessZero(key->ctrl, ctrl.data(), m.nu);
}

// ---- Asset files ----

// The name of an asset file relative to `folder`, for the file that MuJoCo finds under the name
// `file`. An attached model has folders of its own, so a single meshdir would not do.
std::string Relocated(mjSpec* spec, mjsElement* element, const char* file, bool texture,
                      const fs::path& folder) {
  const mjsCompiler* compiler = mjs_getCompiler(element);
  const fs::path assets = mjs_getString(texture ? compiler->texturedir : compiler->meshdir);
  const mjSpec* origin = mjs_getOriginSpec(element);
  const fs::path name = spec->strippath ? fs::path(file).filename() : fs::path(file);
  for (const mjSpec* owner : {origin ? origin : spec, static_cast<const mjSpec*>(spec)}) {
    const fs::path found = fs::path(mjs_getString(owner->modelfiledir)) / assets / name;
    std::error_code ec;
    if (!fs::exists(found, ec)) continue;
    // fs::relative makes both paths canonical, since a ".." after a symbolic link leads elsewhere.
    const fs::path relative = fs::relative(found, folder, ec);
    return ec || relative.empty() ? fs::canonical(found).string() : relative.string();
  }
  return name.string();  // not a plain file; CheckMjcf finds out whether it loads
}

template <typename Visit>
void ForEachElement(mjSpec* spec, mjtObj type, Visit visit) {
  for (mjsElement* e = mjs_firstElement(spec, type); e; e = mjs_nextElement(spec, e)) visit(e);
}

void RelocateAssets(mjSpec* spec, const fs::path& folder) {
  auto relocate = [&](mjsElement* element, mjString* file, bool texture) {
    const std::string old = mjs_getString(file);
    if (!old.empty()) {
      mjs_setString(file, Relocated(spec, element, old.c_str(), texture, folder).c_str());
    }
  };
  ForEachElement(spec, mjOBJ_MESH, [&](mjsElement* e) { relocate(e, mjs_asMesh(e)->file, false); });
  ForEachElement(spec, mjOBJ_HFIELD,
                 [&](mjsElement* e) { relocate(e, mjs_asHField(e)->file, false); });
  ForEachElement(spec, mjOBJ_SKIN, [&](mjsElement* e) { relocate(e, mjs_asSkin(e)->file, false); });
  ForEachElement(spec, mjOBJ_TEXTURE, [&](mjsElement* e) {
    mjsTexture* texture = mjs_asTexture(e);
    relocate(e, texture->file, true);
    constexpr int kCubeSides = 6;
    for (int side = 0; side < kCubeSides; ++side) {
      const char* file = mjs_getInStringVec(texture->cubefiles, side);
      if (!file || !*file) continue;
      const std::string moved = Relocated(spec, e, file, true, folder);
      mjs_setInStringVec(texture->cubefiles, side, moved.c_str());
    }
  });
  mjs_setString(spec->compiler.meshdir, "");
  mjs_setString(spec->compiler.texturedir, "");
  spec->strippath = 0;
}

}  // namespace

SpecPtr ParseSpec(const std::string& path) {
  if (fs::path(path).extension() == ".mjb") {
    throw Error(path + ": a compiled model cannot be written as MJCF");
  }
  std::string error(kErrorSize, '\0');
  SpecPtr spec(mj_parse(path.c_str(), nullptr, nullptr, error.data(), kErrorSize));
  if (!spec) throw Error(path + ": " + OneLine(error.c_str()));
  // Only compiling makes keyframes of attached models part of the whole model.
  const std::unique_ptr<mjModel, ModelDeleter> model(mj_compile(spec.get(), nullptr));
  if (!model) throw Error(path + ": " + OneLine(mjs_getError(spec.get())));
  return spec;
}

void AddRepairedKeys(const Scene& scene, const std::vector<Configuration>& rows,
                     const std::vector<Result>& results, mjSpec* spec) {
  const mjModel& m = *scene.model();
  const std::unique_ptr<mjData, DataDeleter> data(mj_makeData(&m));
  if (!data) throw std::runtime_error("MuJoCo cannot make its data");
  const std::vector<std::string> names = KeyNames(rows);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (results[i].status == Status::kUnsolved) continue;
    FillKey(m, rows[i], results[i].q, data.get(), AddKey(names[i], spec));
  }
}

std::string FormatMjcf(mjSpec* spec, const std::string& folder) {
  RelocateAssets(spec, folder);
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

void CheckMjcf(const std::string& path, const std::vector<Configuration>& rows,
               const std::vector<Result>& results) {
  std::string error(kErrorSize, '\0');
  const std::unique_ptr<mjModel, ModelDeleter> model(
      mj_loadXML(path.c_str(), nullptr, error.data(), kErrorSize));
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
