#include "apps/picture/stage.h"

#include <algorithm>
#include <cstddef>
#include <stdexcept>

namespace mjcf_pdg::app {
namespace {

constexpr float kBackdrop[3] = {0.72f, 0.77f, 0.83f};
constexpr std::size_t kMaxTitle = 56;  // Characters.

// Reds and greens of guilty geoms. Each has several shades, so that two guilty bodies that touch
// can be told apart.
constexpr int kNumShades = 3;
constexpr float kShades[2][kNumShades][3] = {
    {{0.85f, 0.05f, 0.05f}, {1.00f, 0.27f, 0.16f}, {0.55f, 0.02f, 0.06f}},
    {{0.06f, 0.65f, 0.15f}, {0.25f, 0.84f, 0.28f}, {0.02f, 0.40f, 0.12f}}};

bool IsShownByDefault(const mjModel* model, int geom) {
  const int material = model->geom_matid[geom];
  const bool clear = model->geom_rgba[4 * geom + 3] == 0 ||
                     (material >= 0 && model->mat_rgba[4 * material + 3] == 0);
  return model->geom_group[geom] <= 2 && !clear;
}

void SetQuality(mjModel* model) {
  model->vis.global.offwidth = Stage::kWidth;
  model->vis.global.offheight = Stage::kHeight;
  model->vis.global.orthographic = 0;
  model->vis.quality.offsamples = 4;
  // Coarse balls and capsules shine through each other where they coincide.
  model->vis.quality.numslices = std::max(model->vis.quality.numslices, 40);
  model->vis.quality.numstacks = std::max(model->vis.quality.numstacks, 20);
  // Many models are made for other renderers and would be too dark in this one.
  model->vis.headlight.active = 1;
  for (float& ambient : model->vis.headlight.ambient) ambient = std::max(ambient, 0.45f);
}

// The title in the characters that the font has, cut to kMaxTitle of them.
std::string Ascii(const std::string& title) {
  std::string text;
  for (const char c : title) {
    if ((c & 0xC0) == 0x80) continue;  // Inside a UTF-8 character.
    text += c >= 32 && c < 127 ? c : '?';
  }
  return text.size() <= kMaxTitle ? text : text.substr(0, kMaxTitle) + "...";
}

}  // namespace

Stage::Stage(const mjModel* model) : source_(model), model_(mj_copyModel(nullptr, model)) {
  if (model_) data_.reset(mj_makeData(model_.get()));
  if (!data_) throw std::runtime_error("cannot render: no memory for a copy of the model");
  SetQuality(model_.get());
  mjr_makeContext(model_.get(), &canvas_, mjFONTSCALE_100);
  mjr_setBuffer(mjFB_OFFSCREEN, &canvas_);
  if (canvas_.currentBuffer != mjFB_OFFSCREEN) {
    throw std::runtime_error("cannot render: no offscreen buffer");
  }
  // Twice the room for all objects: a scene that overflows lacks geoms and gives a warning.
  const auto num_objects = model_->ngeom + model_->nsite + model_->ntendon + model_->nwrap;
  mjv_makeScene(model_.get(), &scene_, static_cast<int>(2 * num_objects) + 1000);
  mjv_defaultOption(&option_);
  option_.flags[mjVIS_SKIN] = 0;         // Skins hide the geoms.
  option_.flags[mjVIS_RANGEFINDER] = 0;  // Sensors are not computed.
}

bool Stage::IsUnbounded(int geom) const {
  return model_->geom_type[geom] == mjGEOM_PLANE || model_->geom_type[geom] == mjGEOM_HFIELD;
}

void Stage::SetGuilty(const std::vector<int>& geoms) {
  shade_.assign(source_->ngeom, 0);
  for (const int geom : geoms) shade_[geom] = 1;
  std::vector<bool> has_visible(source_->nbody, false);
  int last_body = -1;
  int num_guilty_bodies = 0;
  for (int geom = 0; geom < source_->ngeom; ++geom) {  // Geoms are sorted by body.
    const int body = source_->geom_bodyid[geom];
    if (IsShownByDefault(source_, geom)) has_visible[body] = true;
    if (!IsGuilty(geom)) continue;
    if (body != last_body) ++num_guilty_bodies;
    last_body = body;
    shade_[geom] = 1 + (num_guilty_bodies - 1) % kNumShades;
  }

  glass_body_.assign(source_->nbody, false);
  for (int geom = 0; geom < source_->ngeom; ++geom) {
    const int body = source_->geom_bodyid[geom];
    const bool collides = source_->geom_contype[geom] != 0 || source_->geom_conaffinity[geom] != 0;
    const bool by_default = IsShownByDefault(source_, geom);
    const bool shown = by_default || IsGuilty(geom) || (collides && !has_visible[body]);
    const bool revealed = shown && !by_default;
    if (revealed && has_visible[body]) glass_body_[body] = true;
    model_->geom_group[geom] = shown ? 0 : mjNGROUP - 1;
    // A geom's own colour and material may be invisible.
    model_->geom_matid[geom] = revealed ? -1 : source_->geom_matid[geom];
    model_->geom_rgba[4 * geom + 3] = revealed ? 1 : source_->geom_rgba[4 * geom + 3];
  }
}

void Stage::SetPose(const std::vector<double>& qpos) {
  std::copy(qpos.begin(), qpos.end(), data_->qpos);
  mj_kinematics(model_.get(), data_.get());
  mj_comPos(model_.get(), data_.get());
  mj_camlight(model_.get(), data_.get());
  mj_flex(model_.get(), data_.get());
  mj_tendon(model_.get(), data_.get());
  mj_collision(model_.get(), data_.get());
}

void Stage::UpdateScene(mjvCamera& camera) {
  // The near clipping plane is a share of the model's extent; a smaller extent lets the camera come
  // close to small things in large worlds.
  if (camera.type != mjCAMERA_USER) model_->stat.extent = source_->stat.extent;
  if (camera.type == mjCAMERA_FREE) {
    model_->stat.extent = std::min(source_->stat.extent, camera.distance);
  }
  mjv_updateScene(model_.get(), data_.get(), &option_, nullptr, &camera, mjCAT_ALL, &scene_);
}

mjvGeom* Stage::AddBall(const mjtNum position[3], double radius) {
  if (scene_.ngeom >= scene_.maxgeom) return nullptr;
  mjvGeom* const ball = &scene_.geoms[scene_.ngeom++];
  const mjtNum size[3] = {radius, radius, radius};
  mjv_initGeom(ball, mjGEOM_SPHERE, size, position, nullptr, nullptr);
  ball->category = mjCAT_DECOR;
  return ball;
}

bool Stage::IsGlass(const mjvGeom& geom) const {
  return geom.objtype == mjOBJ_GEOM && geom.objid >= 0 && !IsGuilty(geom.objid) &&
         glass_body_[model_->geom_bodyid[geom.objid]];
}

void Stage::TintScene(Tint tint) {
  for (int i = 0; i < scene_.ngeom; ++i) {
    mjvGeom& geom = scene_.geoms[i];
    if (IsGlass(geom)) geom.rgba[3] = std::min(geom.rgba[3], 0.35f);
    if (geom.objtype != mjOBJ_GEOM || geom.objid < 0 || !IsGuilty(geom.objid)) continue;
    const float* const shade = kShades[tint == Tint::kGreen][shade_[geom.objid] - 1];
    const bool unbounded = IsUnbounded(geom.objid);
    const float weight = unbounded ? 0.35f : 1.0f;  // A floor that is all red would hide the rest.
    for (int k = 0; k < 3; ++k) geom.rgba[k] += weight * (shade[k] - geom.rgba[k]);
    if (unbounded) continue;
    for (float& size : geom.size) size *= 1.003f;  // In front where surfaces coincide.
    geom.rgba[3] = 1;
    geom.matid = -1;
    geom.texid = -1;
    geom.emission = 0.1f;
    geom.reflectance = 0;
  }
}

// Adds a bright ball around everything, seen from inside, because without a sky box the background
// would be black.
void Stage::AddBackdrop() {
  if (std::count(model_->tex_type, model_->tex_type + model_->ntex, mjTEXTURE_SKYBOX) > 0) return;
  const mjvGLCamera camera = mjv_averageCamera(&scene_.camera[0], &scene_.camera[1]);
  const mjtNum center[3] = {camera.pos[0], camera.pos[1], camera.pos[2]};
  mjvGeom* const ball = AddBall(center, -0.9 * camera.frustum_far);  // Inside out.
  if (ball == nullptr) return;
  // The ball's colour hardly reflects light; its emission makes it bright.
  ball->emission = 100;
  for (int i = 0; i < 3; ++i) ball->rgba[i] = kBackdrop[i] / ball->emission;
  ball->specular = 0;
  ball->reflectance = 0;
  ball->castshadow = 0;
}

Bytes Stage::Draw(mjvCamera& camera, Tint tint, const std::string& title, const std::string& when) {
  UpdateScene(camera);
  TintScene(tint);
  AddBackdrop();
  const mjrRect viewport = {0, 0, kWidth, kHeight};
  mjr_render(viewport, &scene_, &canvas_);
  mjr_overlay(mjFONT_NORMAL, mjGRID_TOPLEFT, viewport, Ascii(title).c_str(), when.c_str(),
              &canvas_);
  Bytes rgb(3 * std::size_t{kWidth} * kHeight);
  mjr_readPixels(rgb.data(), nullptr, viewport, &canvas_);
  return rgb;
}

std::vector<int> Stage::CountPixels(mjvCamera camera, const std::vector<Marker>& markers) {
  UpdateScene(camera);
  // MuJoCo draws each object in the colour segid + 1, and does not draw it if segid is -1.
  const int num_geoms = static_cast<int>(model_->ngeom);
  const int num_ids = num_geoms + static_cast<int>(markers.size());
  for (int i = 0; i < scene_.ngeom; ++i) {
    mjvGeom& geom = scene_.geoms[i];
    geom.segid = geom.objtype == mjOBJ_GEOM && geom.objid >= 0 ? geom.objid : num_ids;
    if (IsGlass(geom)) geom.segid = -1;
  }
  for (int id = num_geoms; id < num_ids; ++id) {
    const Marker& marker = markers[id - num_geoms];
    if (mjvGeom* const ball = AddBall(marker.position, marker.radius)) ball->segid = id;
  }
  for (const int flag : {mjRND_SEGMENT, mjRND_IDCOLOR}) scene_.flags[flag] = 1;
  const mjrRect viewport = {0, 0, kProbeWidth, kProbeHeight};
  mjr_render(viewport, &scene_, &canvas_);
  for (const int flag : {mjRND_SEGMENT, mjRND_IDCOLOR}) scene_.flags[flag] = 0;
  Bytes rgb(std::size_t{3} * kProbeWidth * kProbeHeight);
  mjr_readPixels(rgb.data(), nullptr, viewport, &canvas_);
  std::vector<int> counts(num_ids, 0);
  for (std::size_t i = 0; i < rgb.size(); i += 3) {
    const int id = (rgb[i] | rgb[i + 1] << 8 | rgb[i + 2] << 16) - 1;
    if (id >= 0 && id < num_ids) ++counts[id];
  }
  return counts;
}

}  // namespace mjcf_pdg::app
