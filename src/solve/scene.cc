#include "mjcf_pdg/scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <utility>

#include "base/names.h"
#include "equality/held.h"
#include "model/exact_mesh.h"
#include "solve/make_tables.h"
#include "solve/model_file.h"
#include "solve/options.h"
#include "verify/verifier_model.h"

namespace mjcf_pdg {

Scene::Scene(std::shared_ptr<const mjModel> owner, const mjModel& model,
             const SceneOptions& options)
    : tables_(MakeTables(owner, &model, options)),
      verifier_model_(std::make_shared<const VerifierModel>(std::move(owner), model, options,
                                                            tables_->ignored)) {}

Scene Scene::FromFile(const std::string& path, const SceneOptions& options) {
  std::error_code ec;
  const bool exists = std::filesystem::exists(path, ec);
  if (ec) throw Error(path + ": " + ec.message());  // a folder on the way cannot be read
  if (!exists) throw Error(path + ": no such file");
  if (std::filesystem::is_directory(path, ec)) throw Error(path + ": is a directory");
  if (!std::ifstream(path)) throw Error(path + ": cannot be opened");
  try {
    std::shared_ptr<const mjModel> model = LoadModelFile(path);
    const mjModel* raw = model.get();
    return Scene(std::move(model), *raw, options);
  } catch (const Error& e) {
    throw Error(path + ": " + e.what());
  }
}

Scene Scene::FromString(const std::string& xml, const SceneOptions& options) {
  std::shared_ptr<const mjModel> model = CompileModel(ParseModelText(xml).get());
  const mjModel* raw = model.get();
  return Scene(std::move(model), *raw, options);
}

Scene Scene::FromModel(const mjModel* model, const SceneOptions& options) {
  if (!model) throw Error("the model is null");
  return Scene(nullptr, *model, options);
}

const mjModel* Scene::model() const { return tables_->model; }
const std::vector<std::string>& Scene::Warnings() const { return tables_->warnings; }
int Scene::nq() const { return static_cast<int>(tables_->model->nq); }
int Scene::dof() const { return tables_->n; }
int Scene::num_kept_pairs() const { return static_cast<int>(tables_->pairs.size()); }

bool Scene::HasExactMeshes() const { return mjcf_pdg::HasExactMeshes(*tables_); }

const std::vector<std::array<int, 2>>& Scene::IgnoredPairs() const { return tables_->ignored; }

std::string Scene::GeomName(int geom) const { return NameOrPlace(*model(), geom); }
std::string Scene::JointName(int joint) const { return NameOrId(*model(), mjOBJ_JOINT, joint); }

std::vector<std::string> Scene::KeyNames() const {
  std::vector<std::string> names;
  for (int k = 0; k < model()->nkey; ++k) {
    const char* name = mj_id2name(model(), mjOBJ_KEY, k);
    names.emplace_back(name ? name : "");
  }
  return names;
}

std::vector<double> Scene::KeyQpos(int key) const {
  if (key < 0 || key >= model()->nkey) throw Error("no keyframe " + std::to_string(key));
  const double* q = model()->key_qpos + static_cast<std::ptrdiff_t>(key) * nq();
  return {q, q + nq()};
}

std::vector<double> Scene::DefaultQpos() const { return {model()->qpos0, model()->qpos0 + nq()}; }

void Scene::CheckUnchanged() const {
  const mjModel &now = *model(), &then = tables_->query_model;
  const bool same = now.nq == then.nq && now.nv == then.nv && now.nbody == then.nbody &&
                    now.njnt == then.njnt && now.ngeom == then.ngeom && now.nmesh == then.nmesh &&
                    now.nmeshvert == then.nmeshvert && now.npair == then.npair &&
                    now.nexclude == then.nexclude && now.nmocap == then.nmocap &&
                    now.neq == then.neq && now.qpos0 == then.qpos0;
  if (!same) throw Error("the model has changed since the scene was made: make a new scene");
}

void Scene::CheckConfiguration(std::span<const double> q) const {
  const mjModel* m = model();
  if (static_cast<int>(q.size()) != nq()) {
    throw Error("qpos has " + std::to_string(q.size()) + " values, the model needs " +
                std::to_string(nq()));
  }
  for (int i = 0; i < nq(); ++i) {
    if (!std::isfinite(q[i]) || std::abs(q[i]) > mjMAXVAL) {
      throw Error("qpos[" + std::to_string(i) + "] is not a usable number");
    }
  }
  for (int j = 0; j < m->njnt; ++j) {
    if (m->jnt_type[j] != mjJNT_FREE && m->jnt_type[j] != mjJNT_BALL) continue;
    const int adr = m->jnt_qposadr[j] + (m->jnt_type[j] == mjJNT_FREE ? 3 : 0);
    if (mju_norm(q.data() + adr, 4) < kLeastQuaternion) {
      throw Error("the quaternion of joint " + QuotedNameOrId(*m, mjOBJ_JOINT, j) + " is zero");
    }
  }
}

bool Scene::HoldsTendonLimits() const {
  const std::vector<char>& held = tables_->held_tendons;
  return std::find(held.begin(), held.end(), 1) != held.end();
}

std::vector<std::string> Scene::HeldEqualities() const {
  const mjModel* m = model();
  std::vector<std::string> names;
  for (int e = 0; e < m->neq; ++e) {
    if (m->eq_active0[e] && tables_->held_equalities[e]) names.push_back(DescribeEquality(*m, e));
  }
  return names;
}

}  // namespace mjcf_pdg
