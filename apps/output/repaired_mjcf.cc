#include "apps/output/repaired_mjcf.h"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <utility>

#include "apps/console/text.h"
#include "apps/output/setpoints.h"

namespace mjcf_pdg::app {
namespace {

namespace fs = std::filesystem;

struct ModelDeleter {
  void operator()(mjModel* model) const { mj_deleteModel(model); }
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

void FillKey(const mjModel& m, const Configuration& row, const std::vector<double>& q,
             const Setpoints& setpoints, mjsKey* key) {
  SetVector(key->qpos, q.data(), m.nq);
  if (row.key >= 0) {
    const std::ptrdiff_t k = row.key;
    key->time = m.key_time[k];
    SetUnlessZero(key->qvel, m.key_qvel + k * m.nv, m.nv);
    SetVector(key->plastic, m.key_plastic + k * m.nplastic, m.nplastic);
  }
  if (!row.mocap_pos.empty()) {  // those of the keyframe, unless they were moved since
    SetVector(key->mpos, row.mocap_pos.data(), m.nmocap * 3);
    SetVector(key->mquat, row.mocap_quat.data(), m.nmocap * 4);
  }
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
  SetpointMover setpoints(m);
  const std::vector<std::string> names = KeyNames(rows);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (results[i].status == Status::kUnsolved) continue;
    mjsKey* const key = AddKey(names[i], spec);
    FillKey(m, rows[i], results[i].q, setpoints.Moved(rows[i], results[i].q), key);
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
