#include "apps/view/ghost_scene.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace mjcf_pdg::app {
namespace {

// How much of a geom's own colour is left in its grey.
constexpr float kColorShare = 0.08f;
// A grey brighter than this would pass for a ghost that is not free.
constexpr float kBrightest = 0.75f;
constexpr float kGhostAlpha = 0.6f;
// A floor in full orange would hide what stands on it; its own texture is gone.
constexpr float kGuiltyFloorShare = 0.35f, kFloorTone = 0.25f;
// What overlaps is drawn larger by this, in front of surfaces that coincide with its own.
constexpr float kLarger = 1.003f;
// A geom of the ghost that is nearer to its place in the command than this share of the model's
// size is not drawn: surfaces that coincide flicker. Half a pixel in a usual window.
constexpr double kApart = 1e-3;

bool IsUnbounded(const mjModel& m, int geom) {
  return m.geom_type[geom] == mjGEOM_PLANE || m.geom_type[geom] == mjGEOM_HFIELD;
}

// How far the points of a geom lie apart in two poses of it [m], at most.
double Apart(const mjModel& m, const mjData& a, const mjData& b, int geom) {
  const double turned = std::sqrt(2.0) * m.geom_rbound[geom];  // per unit of the matrix
  double twist[9];
  mju_sub(twist, a.geom_xmat + 9 * geom, b.geom_xmat + 9 * geom, 9);
  return mju_dist3(a.geom_xpos + 3 * geom, b.geom_xpos + 3 * geom) + turned * mju_norm(twist, 9);
}

void Tint(mjvGeom& geom, const std::array<float, 3>& color, float share, float alpha) {
  geom.matid = -1;
  geom.texid = -1;
  geom.reflectance = 0;
  for (int k = 0; k < 3; ++k) geom.rgba[k] = (1 - share) * geom.rgba[k] + share * color[k];
  geom.rgba[3] = alpha;
}

}  // namespace

GhostScene::GhostScene(const mjModel& model)
    : model_(model), command_(mj_makeData(&model)), ghost_(mj_makeData(&model)), owner_(scene) {
  if (!command_ || !ghost_) throw std::runtime_error("no memory for the data of the model");
  // Room for all objects twice, and for frames, labels and contacts.
  const auto num_objects = model.ngeom + model.nsite + model.ntendon + model.nwrap + model.njnt;
  mjv_makeScene(&model, &scene, static_cast<int>(4 * num_objects) + 2000);
  mjv_defaultOption(&option);
  option.flags[mjVIS_RANGEFINDER] = 0;  // sensors are not computed
  mjv_defaultPerturb(&perturb);
  mjv_defaultFreeCamera(&model, &camera);
  Pose(*command_);
  Pose(*ghost_);
}

void GhostScene::Pose(mjData& data) const {
  if (option.flags[mjVIS_CONTACTFORCE] || option.flags[mjVIS_ISLAND]) {
    mj_forward(&model_, &data);
    return;
  }
  mj_kinematics(&model_, &data);
  mj_comPos(&model_, &data);
  mj_camlight(&model_, &data);
  mj_flex(&model_, &data);
  mj_tendon(&model_, &data);
  data.ncon = 0;
  if (option.flags[mjVIS_CONTACTPOINT]) mj_collision(&model_, &data);
}

void GhostScene::SetCommand(const Configuration& row) {
  std::copy(row.q.begin(), row.q.end(), command_->qpos);
  for (mjData* data : {command_.get(), ghost_.get()}) {
    std::copy(row.mocap_pos.begin(), row.mocap_pos.end(), data->mocap_pos);
    std::copy(row.mocap_quat.begin(), row.mocap_quat.end(), data->mocap_quat);
  }
  Pose(*command_);
}

void GhostScene::SetGhost(std::span<const double> q, bool free) {
  std::copy(q.begin(), q.end(), ghost_->qpos);
  mj_kinematics(&model_, ghost_.get());
  mj_comPos(&model_, ghost_.get());
  ghost_shown_ = true;
  ghost_free_ = free;
}

template <typename Keep>
void GhostScene::Add(mjData& data, const mjvOption& groups, int categories, Keep keep) {
  mjvOption plain = groups;
  std::fill_n(plain.flags, mjNVISFLAG, mjtByte{0});
  plain.flags[mjVIS_CONVEXHULL] = option.flags[mjVIS_CONVEXHULL];
  plain.flags[mjVIS_STATIC] = 1;
  plain.frame = mjFRAME_NONE;
  plain.label = mjLABEL_NONE;
  std::fill_n(plain.sitegroup, mjNGROUP, mjtByte{0});
  const int first = scene.ngeom;
  mjv_addGeoms(&model_, &data, &plain, nullptr, categories, &scene);
  int kept = first;
  for (int i = first; i < scene.ngeom; ++i) {
    const mjvGeom& geom = scene.geoms[i];
    if (geom.objtype == mjOBJ_GEOM && geom.objid >= 0 && keep(geom.objid)) {
      scene.geoms[kept++] = geom;
    }
  }
  scene.ngeom = kept;
}

void GhostScene::AddHidden(const std::vector<int>& guilty) {
  std::vector<int> hidden;
  for (const int geom : guilty) {
    const auto shows = [geom](const mjvGeom& shown) {
      return shown.objtype == mjOBJ_GEOM && shown.objid == geom;
    };
    if (std::none_of(scene.geoms, scene.geoms + scene.ngeom, shows)) hidden.push_back(geom);
  }
  if (hidden.empty()) return;
  mjvOption all = option;
  std::fill_n(all.geomgroup, mjNGROUP, mjtByte{1});
  const int first = scene.ngeom;
  Add(*command_, all, mjCAT_ALL, [&hidden](int geom) {
    return std::find(hidden.begin(), hidden.end(), geom) != hidden.end();
  });
  for (int i = first; i < scene.ngeom; ++i) scene.geoms[i].rgba[3] = 1;
}

void GhostScene::Paint(const std::vector<int>& guilty, bool own_colors) {
  for (int i = 0; i < scene.ngeom; ++i) {
    mjvGeom& geom = scene.geoms[i];
    if (geom.objtype != mjOBJ_GEOM || geom.objid < 0 || geom.category == mjCAT_DECOR) continue;
    if (std::find(guilty.begin(), guilty.end(), geom.objid) != guilty.end()) {
      if (IsUnbounded(model_, geom.objid)) {
        std::fill_n(geom.rgba, 3, kFloorTone);
        Tint(geom, kGuiltyColor, kGuiltyFloorShare, geom.rgba[3]);
        continue;
      }
      Tint(geom, kGuiltyColor, 1.0f, geom.rgba[3]);
      geom.emission = std::max(geom.emission, 0.2f);
      for (float& size : geom.size) size *= kLarger;
    } else if (!own_colors) {
      const float gray = 0.3f * geom.rgba[0] + 0.5f * geom.rgba[1] + 0.2f * geom.rgba[2];
      const float tone = kBrightest * gray;
      Tint(geom, {tone, tone, tone}, 1 - kColorShare, geom.rgba[3]);
    }
  }
}

void GhostScene::AddGhost() {
  const double apart = kApart * model_.stat.extent;
  const int first = scene.ngeom;
  Add(*ghost_, option, mjCAT_DYNAMIC,
      [&](int geom) { return Apart(model_, *command_, *ghost_, geom) > apart; });
  for (int i = first; i < scene.ngeom; ++i) {
    mjvGeom& geom = scene.geoms[i];
    Tint(geom, ghost_free_ ? kGhostColor : kUnfreeGhostColor, 1.0f, kGhostAlpha);
    geom.emission = 0.2f;
    geom.castshadow = 0;
  }
}

void GhostScene::Update(const std::vector<int>& guilty, const Shown& shown) {
  mjv_updateScene(&model_, command_.get(), &option, &perturb, &camera,
                  shown.command ? mjCAT_ALL : mjCAT_STATIC, &scene);
  if (shown.command) AddHidden(guilty);
  Paint(guilty, shown.own_colors);
  if (shown.ghost && ghost_shown_) AddGhost();
}

std::optional<GhostScene::Hit> GhostScene::Pick(double aspect, double x, double y) const {
  int geom = -1, flex = -1, skin = -1;
  Hit hit;
  hit.body = mjv_select(&model_, command_.get(), &option, aspect, x, y, &scene, hit.point_W.data(),
                        &geom, &flex, &skin);
  if (hit.body < 0) return std::nullopt;
  return hit;
}

}  // namespace mjcf_pdg::app
