#include "apps/picture/stage.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>

namespace mjcf_pdg::app {
namespace {

constexpr float kBackdrop[3] = {0.72f, 0.77f, 0.83f};
constexpr std::size_t kMaxTitle = 56;  // Characters.
constexpr double kRingRadius = 9;      // Pixels.

// Colours of guilty geoms, each in several shades of different lightness, so that two guilty bodies
// that touch can be told apart.
constexpr int kNumShades = 3;
constexpr float kShades[2][kNumShades][3] = {
    {{0.95f, 0.45f, 0.00f}, {1.00f, 0.74f, 0.30f}, {0.62f, 0.25f, 0.00f}},
    {{0.05f, 0.42f, 0.85f}, {0.45f, 0.75f, 1.00f}, {0.00f, 0.20f, 0.52f}}};
// All else keeps this share of its colour, the rest is grey.
constexpr float kColorShare = 0.25f;
constexpr float kBrightest = 0.75f;  // Of that grey: in strong light white floors dazzle.
// All lamps together, where 1 shows a surface that faces them in its own colour.
constexpr float kMostLight = 1.2f;
// Opacity of what covers guilty geoms, and of guilty floors, in which things may have sunk.
constexpr float kGlass = 0.2f;
constexpr float kGuiltyFloor = 0.6f;
// A geom counts as covered if less than this share of what it would show alone is seen.
constexpr double kCoveredShare = 0.5;
constexpr int kFewPixels = 4;  // Of a probe; geoms that would show fewer are not looked for.

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

// Where the camera sees a place: pixels from the left and the lower edge of an image of this size.
// Nothing if it lies behind the camera.
std::optional<std::array<double, 2>> Project(const mjvGLCamera& camera, const Point& place,
                                             const Image& image) {
  double from_camera[3], forward[3], up[3], right[3];
  for (int k = 0; k < 3; ++k) {
    from_camera[k] = place[k] - camera.pos[k];
    forward[k] = camera.forward[k];
    up[k] = camera.up[k];
  }
  mju_cross(right, forward, up);
  const double depth = mju_dot3(from_camera, forward);
  if (depth <= camera.frustum_near) return std::nullopt;
  const double scale = camera.orthographic ? 1 : camera.frustum_near / depth;
  const double height = camera.frustum_top - camera.frustum_bottom;
  const double width =
      camera.frustum_width > 0 ? 2 * camera.frustum_width : height * image.width / image.height;
  const double x = scale * mju_dot3(from_camera, right) - camera.frustum_center + width / 2;
  const double y = scale * mju_dot3(from_camera, up) - camera.frustum_bottom;
  return {{x / width * image.width, y / height * image.height}};
}

// Draws a ring around each mark; of marks whose rings would overlap, only around the first.
void DrawMarks(const mjvGLCamera& camera, const std::vector<Point>& marks, Image& image) {
  std::vector<std::array<double, 2>> drawn;
  for (const Point& mark : marks) {
    const std::optional<std::array<double, 2>> pixel = Project(camera, mark, image);
    if (!pixel) continue;
    const auto [x, y] = *pixel;
    const bool is_near = std::any_of(drawn.begin(), drawn.end(), [x, y](const auto& other) {
      return std::hypot(other[0] - x, other[1] - y) < 1.5 * kRingRadius;
    });
    if (is_near) continue;
    DrawRing(image, x, y, kRingRadius);
    drawn.push_back(*pixel);
  }
}

}  // namespace

Stage::Stage(const mjModel* model) : source_(model), model_(mj_copyModel(nullptr, model)) {
  if (model_) data_.reset(mj_makeData(model_.get()));
  if (!data_) throw std::runtime_error("cannot render: no memory for a copy of the model");
  model_pose_.mocap_pos.assign(data_->mocap_pos, data_->mocap_pos + 3 * model_->nmocap);
  model_pose_.mocap_quat.assign(data_->mocap_quat, data_->mocap_quat + 4 * model_->nmocap);
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
  std::fill_n(option_.sitegroup, mjNGROUP, mjtByte{0});
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

void Stage::SetPose(const Pose& pose) {
  const Pose& mocap = pose.mocap_pos.empty() ? model_pose_ : pose;
  std::copy(pose.qpos.begin(), pose.qpos.end(), data_->qpos);
  std::copy(mocap.mocap_pos.begin(), mocap.mocap_pos.end(), data_->mocap_pos);
  std::copy(mocap.mocap_quat.begin(), mocap.mocap_quat.end(), data_->mocap_quat);
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

bool Stage::IsGuiltyGeom(const mjvGeom& geom) const {
  return geom.objtype == mjOBJ_GEOM && geom.objid >= 0 && geom.objid < model_->ngeom &&
         IsGuilty(geom.objid);
}

bool Stage::IsGlass(const mjvGeom& geom) const {
  return geom.objtype == mjOBJ_GEOM && geom.objid >= 0 && geom.objid < model_->ngeom &&
         !IsGuilty(geom.objid) && glass_body_[model_->geom_bodyid[geom.objid]];
}

// In the light of several strong lamps every colour is white, and tinted floors first.
void Stage::DimLights() {
  float light = 0.0f;
  for (const mjvLight& lamp : std::span(scene_.lights, static_cast<std::size_t>(scene_.nlight))) {
    light += *std::max_element(lamp.ambient, lamp.ambient + 3) +
             *std::max_element(lamp.diffuse, lamp.diffuse + 3);
  }
  const float share = kMostLight / std::max(light, kMostLight);
  for (mjvLight& lamp : std::span(scene_.lights, static_cast<std::size_t>(scene_.nlight))) {
    for (int k = 0; k < 3; ++k) {
      lamp.ambient[k] *= share;
      lamp.diffuse[k] *= share;
    }
  }
}

void Stage::TintScene(Tint tint) {
  for (int i = 0; i < scene_.ngeom; ++i) {
    mjvGeom& geom = scene_.geoms[i];
    if (geom.objtype != mjOBJ_GEOM || geom.objid < 0) continue;
    const bool unbounded = IsUnbounded(geom.objid);
    geom.matid = -1;
    geom.texid = -1;
    geom.reflectance = 0;
    const float gray = 0.3f * geom.rgba[0] + 0.5f * geom.rgba[1] + 0.2f * geom.rgba[2];
    for (int k = 0; k < 3; ++k) {
      geom.rgba[k] = kBrightest * (gray + kColorShare * (geom.rgba[k] - gray));
    }
    if (!IsGuilty(geom.objid)) {
      if (IsGlass(geom) || (under_others_ && !unbounded)) {
        geom.rgba[3] = std::min(geom.rgba[3], kGlass);
      }
      continue;
    }
    const float* const shade = kShades[tint == Tint::kBlue][shade_[geom.objid] - 1];
    const float weight = unbounded ? 0.35f : 1.0f;  // A floor in full colour would hide the rest.
    for (int k = 0; k < 3; ++k) geom.rgba[k] += weight * (shade[k] - geom.rgba[k]);
    geom.rgba[3] = unbounded ? kGuiltyFloor : 1;
    if (unbounded) continue;
    for (float& size : geom.size) size *= 1.003f;  // In front where surfaces coincide.
    geom.emission = 0.1f;
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

template <typename Keep>
std::vector<int> Stage::Segment(int width, int height, Keep keep) {
  // MuJoCo draws each object in the colour segid + 1, and does not draw it if segid is -1.
  constexpr int kOther = (1 << 24) - 2;
  for (int i = 0; i < scene_.ngeom; ++i) {
    mjvGeom& geom = scene_.geoms[i];
    const int id = geom.objtype == mjOBJ_GEOM && geom.objid >= 0 ? geom.objid : kOther;
    geom.segid = keep(geom) ? id : -1;
  }
  for (const int flag : {mjRND_SEGMENT, mjRND_IDCOLOR}) scene_.flags[flag] = 1;
  const mjrRect viewport = {0, 0, width, height};
  mjr_render(viewport, &scene_, &canvas_);
  for (const int flag : {mjRND_SEGMENT, mjRND_IDCOLOR}) scene_.flags[flag] = 0;
  Image image(width, height);
  mjr_readPixels(image.rgb.data(), nullptr, viewport, &canvas_);
  std::vector<int> ids(static_cast<std::size_t>(width) * height);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const std::uint8_t* const rgb = &image.rgb[3 * i];
    const int id = (rgb[0] | rgb[1] << 8 | rgb[2] << 16) - 1;
    ids[i] = id < kOther ? id : -1;
  }
  return ids;
}

void Stage::FindCovered(mjvCamera& camera) {
  UpdateScene(camera);
  const auto count = [this](auto keep) {
    std::vector<int> counts(model_->ngeom, 0);
    for (const int id : Segment(kProbeWidth, kProbeHeight, keep)) {
      if (id >= 0 && id < model_->ngeom) ++counts[id];
    }
    return counts;
  };
  const auto is_solid_guilty = [this](const mjvGeom& geom) {
    return IsGuiltyGeom(geom) && !IsUnbounded(geom.objid);
  };
  const std::vector<int> among_all = count([&](const mjvGeom& geom) {
    return !IsGlass(geom) && (!IsGuiltyGeom(geom) || is_solid_guilty(geom));
  });
  const std::vector<int> among_guilty = count(is_solid_guilty);
  under_others_ = false;
  under_guilty_.clear();
  for (int id = 0; id < model_->ngeom; ++id) {
    if (!IsGuilty(id) || IsUnbounded(id)) continue;
    const std::vector<int> alone =
        count([&](const mjvGeom& geom) { return geom.objtype == mjOBJ_GEOM && geom.objid == id; });
    if (alone[id] < kFewPixels) continue;
    if (among_guilty[id] < kCoveredShare * alone[id]) under_guilty_.push_back(id);
    if (among_guilty[id] >= kFewPixels && among_all[id] < kCoveredShare * among_guilty[id]) {
      under_others_ = true;
    }
  }
}

Image Stage::Draw(mjvCamera& camera, Tint tint, const std::vector<Point>& marks,
                  const std::string& title, const std::string& text) {
  UpdateScene(camera);
  DimLights();
  TintScene(tint);
  AddBackdrop();
  const mjrRect viewport = {0, 0, kWidth, kHeight};
  mjr_render(viewport, &scene_, &canvas_);
  mjr_overlay(mjFONT_NORMAL, mjGRID_TOPLEFT, viewport, Ascii(title).c_str(), Ascii(text).c_str(),
              &canvas_);
  Image image(kWidth, kHeight);
  mjr_readPixels(image.rgb.data(), nullptr, viewport, &canvas_);

  for (const int id : under_guilty_) {
    if (tint == Tint::kBlue) break;  // Free: each geom is seen for itself.
    const std::vector<int> ids = Segment(kWidth, kHeight, [id](const mjvGeom& geom) {
      return geom.objtype == mjOBJ_GEOM && geom.objid == id;
    });
    std::vector<bool> inside(ids.size());
    for (std::size_t i = 0; i < ids.size(); ++i) inside[i] = ids[i] == id;
    const float* const shade = kShades[0][shade_[id] - 1];
    Color color;
    for (int k = 0; k < 3; ++k) color[k] = static_cast<std::uint8_t>(255 * shade[k]);
    DrawOutline(image, inside, color);
  }
  DrawMarks(mjv_averageCamera(&scene_.camera[0], &scene_.camera[1]), marks, image);
  return image;
}

std::vector<int> Stage::CountPixels(mjvCamera camera, const std::vector<Marker>& markers) {
  UpdateScene(camera);
  const int num_geoms = static_cast<int>(model_->ngeom);
  const int num_ids = num_geoms + static_cast<int>(markers.size());
  for (int id = num_geoms; id < num_ids; ++id) {
    const Marker& marker = markers[id - num_geoms];
    mjvGeom* const ball = AddBall(marker.position, marker.radius);
    if (ball == nullptr) break;
    ball->objtype = mjOBJ_GEOM;  // With an id after those of the model's geoms.
    ball->objid = id;
  }
  std::vector<int> counts(num_ids, 0);
  const auto keep = [this](const mjvGeom& geom) { return !IsGlass(geom); };
  for (const int id : Segment(kProbeWidth, kProbeHeight, keep)) {
    if (id >= 0 && id < num_ids) ++counts[id];
  }
  return counts;
}

}  // namespace mjcf_pdg::app
