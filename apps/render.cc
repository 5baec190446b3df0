#include "apps/render.h"

#define EGL_NO_X11  // NOLINT(readability-identifier-naming): EGL's own switch.
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "apps/png_writer.h"

namespace mjcf_pdg::app {
namespace {

constexpr int kCellWidth = 640;
constexpr int kCellHeight = 480;
constexpr int kProbeWidth = 160;  // Pictures which only serve to compare points of view.
constexpr int kProbeHeight = 120;
constexpr int kSeam = 2;  // Pixels between before and after.
constexpr int kGap = 8;   // Pixels between pairs, and around the sheet.
constexpr int kHiddenGroup = mjNGROUP - 1;

using Rgb = std::array<float, 3>;
// In shades, so that one can tell apart two guilty bodies which touch.
constexpr int kNumShades = 3;
using Tints = std::array<Rgb, kNumShades>;
constexpr Tints kReds = {{{0.85f, 0.05f, 0.05f}, {1.00f, 0.27f, 0.16f}, {0.55f, 0.02f, 0.06f}}};
constexpr Tints kGreens = {{{0.06f, 0.65f, 0.15f}, {0.25f, 0.84f, 0.28f}, {0.02f, 0.40f, 0.12f}}};
constexpr Rgb kBackdrop = {0.20f, 0.23f, 0.28f};
constexpr std::uint8_t kSheetGray = 235;
constexpr float kGlassAlpha = 0.35f;

using Point = std::array<double, 3>;

// ---- OpenGL without a window ------------------------------------------------

// An OpenGL context without a surface, current in this thread while the object lives. What was
// current before becomes current again afterwards.
class EglContext {
 public:
  EglContext();
  ~EglContext();
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;

 private:
  struct Current {
    EGLDisplay display = eglGetCurrentDisplay();
    EGLSurface draw = eglGetCurrentSurface(EGL_DRAW);
    EGLSurface read = eglGetCurrentSurface(EGL_READ);
    EGLContext context = eglGetCurrentContext();
  };

  const char* Open();  // The reason if it fails, else null.
  void Close() noexcept;

  Current previous_;
  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
};

EGLDisplay InitializedDisplay() {
  const auto get_platform_display = reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(
      eglGetProcAddress("eglGetPlatformDisplayEXT"));
  if (get_platform_display != nullptr) {
    const EGLDisplay display =
        get_platform_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    if (display != EGL_NO_DISPLAY && eglInitialize(display, nullptr, nullptr)) return display;
  }
  const EGLDisplay display = eglGetDisplay(EGL_DEFAULT_DISPLAY);
  if (display != EGL_NO_DISPLAY && eglInitialize(display, nullptr, nullptr)) return display;
  return EGL_NO_DISPLAY;
}

EglContext::EglContext() {
  const char* const reason = Open();
  if (reason == nullptr) return;
  Close();
  throw std::runtime_error(std::string("cannot render: ") + reason);
}

EglContext::~EglContext() { Close(); }

const char* EglContext::Open() {
  display_ = InitializedDisplay();
  if (display_ == EGL_NO_DISPLAY) return "no EGL display (is a driver such as Mesa installed?)";
  if (!eglBindAPI(EGL_OPENGL_API)) return "this EGL has no desktop OpenGL";
  const EGLint attributes[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE,
                               EGL_OPENGL_BIT, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint num_configs = 0;
  if (!eglChooseConfig(display_, attributes, &config, 1, &num_configs) || num_configs == 0) {
    return "EGL has no OpenGL configuration";
  }
  context_ = eglCreateContext(display_, config, EGL_NO_CONTEXT, nullptr);
  if (context_ == EGL_NO_CONTEXT) return "EGL cannot create an OpenGL context";
  if (!eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_)) {
    return "the OpenGL context needs a surface";
  }
  return nullptr;
}

void EglContext::Close() noexcept {
  if (display_ == EGL_NO_DISPLAY) return;
  eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  if (context_ != EGL_NO_CONTEXT) eglDestroyContext(display_, context_);
  if (previous_.context != EGL_NO_CONTEXT) {  // Then the display may be in use: do not end it.
    eglMakeCurrent(previous_.display, previous_.draw, previous_.read, previous_.context);
  } else {
    eglTerminate(display_);
    eglReleaseThread();
  }
}

// ---- MuJoCo objects with an owner -------------------------------------------

struct MjDeleter {
  void operator()(mjModel* model) const { mj_deleteModel(model); }
  void operator()(mjData* data) const { mj_deleteData(data); }
};

struct Scene {
  Scene() { mjv_defaultScene(&scene); }
  ~Scene() { mjv_freeScene(&scene); }
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;
  mjvScene scene;
};

struct Canvas {
  Canvas() { mjr_defaultContext(&context); }
  ~Canvas() { mjr_freeContext(&context); }
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;
  EglContext egl;  // Destroyed after `context` is freed.
  mjrContext context;
};

// Where two guilty geoms overlap at qpos_in.
struct Overlap {
  Point position;
  double depth = 0;
};

// Everything needed to draw one model.
struct Studio {
  explicit Studio(const mjModel* source_model);

  const mjModel* source;
  std::unique_ptr<mjModel, MjDeleter> model;  // A copy, with the geom groups of the present row.
  std::unique_ptr<mjData, MjDeleter> data;
  Canvas canvas;
  Scene scene;
  mjvOption option;
  bool has_skybox = false;
  std::vector<int> guilty;  // Per geom, for the present row: 0 if innocent, else 1 + its shade.
  std::vector<Overlap> overlaps;  // As MuJoCo sees them; they only serve to choose a camera.
  std::vector<char> glass;  // Per body: a guilty geom lies hidden in it, usually inside others.
};

Studio::Studio(const mjModel* source_model)
    : source(source_model), model(mj_copyModel(nullptr, source_model)) {
  if (!model) throw std::runtime_error("cannot render: cannot copy the model");
  data.reset(mj_makeData(model.get()));
  if (!data) throw std::runtime_error("cannot render: no memory for the simulation state");

  model->vis.global.offwidth = kCellWidth;
  model->vis.global.offheight = kCellHeight;
  model->vis.global.orthographic = 0;
  model->vis.quality.offsamples = 4;
  model->vis.quality.numslices = std::max(model->vis.quality.numslices, 40);
  model->vis.quality.numstacks = std::max(model->vis.quality.numstacks, 20);
  // Many models are made for other renderers, and dark in this one.
  auto& headlight = model->vis.headlight;
  headlight.active = 1;
  for (int i = 0; i < 3; ++i) {
    headlight.ambient[i] = std::max(headlight.ambient[i], 0.3f);
    headlight.diffuse[i] = std::max(headlight.diffuse[i], 0.6f);
  }
  mjr_makeContext(model.get(), &canvas.context, mjFONTSCALE_100);
  mjr_setBuffer(mjFB_OFFSCREEN, &canvas.context);
  if (canvas.context.currentBuffer != mjFB_OFFSCREEN) {
    throw std::runtime_error("cannot render: no offscreen buffer");
  }

  // Room for everything, and twice, since a scene which overflows is a warning and lacks geoms.
  const auto num_objects = model->ngeom + model->nsite + model->ntendon + model->nwrap;
  mjv_makeScene(model.get(), &scene.scene, static_cast<int>(2 * num_objects) + 1000);
  mjv_defaultOption(&option);
  option.flags[mjVIS_SKIN] = 0;         // Skins hide the geoms.
  option.flags[mjVIS_RANGEFINDER] = 0;  // Sensors are not computed.
  for (int i = 0; i < model->ntex; ++i) {
    has_skybox = has_skybox || model->tex_type[i] == mjTEXTURE_SKYBOX;
  }
}

// ---- Setting the stage ------------------------------------------------------

void CheckRow(const mjModel* model, const RenderRow& row) {
  const auto check_qpos = [&](const std::vector<double>& qpos) {
    const bool finite =
        std::all_of(qpos.begin(), qpos.end(), [](double value) { return std::isfinite(value); });
    if (static_cast<mjtSize>(qpos.size()) != model->nq || !finite) {
      throw std::runtime_error("cannot render \"" + row.title + "\": qpos needs " +
                               std::to_string(model->nq) + " finite numbers");
    }
  };
  check_qpos(row.qpos_in);
  if (!row.qpos.empty()) check_qpos(row.qpos);
  for (const int geom : row.guilty_geoms) {
    if (geom < 0 || geom >= model->ngeom) {
      throw std::runtime_error("cannot render \"" + row.title + "\": the model has no geom " +
                               std::to_string(geom));
    }
  }
}

void SetPose(Studio& studio, const std::vector<double>& qpos) {
  const mjModel* model = studio.model.get();
  mjData* data = studio.data.get();
  std::copy(qpos.begin(), qpos.end(), data->qpos);
  mj_kinematics(model, data);
  mj_comPos(model, data);
  mj_camlight(model, data);
  mj_flex(model, data);
  mj_tendon(model, data);
}

// At the present pose.
void FindOverlaps(Studio& studio) {
  mj_collision(studio.model.get(), studio.data.get());
  studio.overlaps.clear();
  for (int i = 0; i < studio.data->ncon; ++i) {
    const mjContact& contact = studio.data->contact[i];
    if (contact.dist > 0 || contact.geom[0] < 0 || contact.geom[1] < 0) continue;
    if (!studio.guilty[contact.geom[0]] || !studio.guilty[contact.geom[1]]) continue;
    studio.overlaps.push_back({{contact.pos[0], contact.pos[1], contact.pos[2]}, -contact.dist});
  }
}

bool IsShownByDefault(const mjModel* model, int geom) {
  const int material = model->geom_matid[geom];
  const bool clear = model->geom_rgba[4 * geom + 3] == 0 ||
                     (material >= 0 && model->mat_rgba[4 * material + 3] == 0);
  return model->geom_group[geom] <= 2 && !clear;
}

// Shows geoms in the copy by moving them to group 0, and hides the others.
void SetVisibility(Studio& studio, const std::vector<int>& guilty_geoms) {
  const mjModel* source = studio.source;
  mjModel* model = studio.model.get();
  studio.guilty.assign(source->ngeom, 0);
  studio.glass.assign(source->nbody, 0);
  for (const int geom : guilty_geoms) studio.guilty[geom] = 1;
  int last_body = -1;
  int num_guilty_bodies = 0;
  for (int geom = 0; geom < source->ngeom; ++geom) {  // Geoms are sorted by body.
    if (!studio.guilty[geom]) continue;
    if (source->geom_bodyid[geom] != last_body) ++num_guilty_bodies;
    last_body = source->geom_bodyid[geom];
    studio.guilty[geom] = 1 + (num_guilty_bodies - 1) % kNumShades;
  }

  std::vector<char> has_visible(source->nbody, 0);
  for (int geom = 0; geom < source->ngeom; ++geom) {
    if (IsShownByDefault(source, geom)) has_visible[source->geom_bodyid[geom]] = 1;
  }
  for (int geom = 0; geom < source->ngeom; ++geom) {
    const int body = source->geom_bodyid[geom];
    const bool collides = source->geom_contype[geom] != 0 || source->geom_conaffinity[geom] != 0;
    const bool by_default = IsShownByDefault(source, geom);
    const bool shown = by_default || studio.guilty[geom] || (collides && !has_visible[body]);
    model->geom_group[geom] = shown ? 0 : kHiddenGroup;
    model->geom_matid[geom] = source->geom_matid[geom];
    model->geom_rgba[4 * geom + 3] = source->geom_rgba[4 * geom + 3];
    if (!shown || by_default) continue;
    if (studio.guilty[geom] && has_visible[body]) studio.glass[body] = 1;
    model->geom_matid[geom] = -1;  // The material may be invisible.
    model->geom_rgba[4 * geom + 3] = 1;
  }
}

bool IsMoving(const mjModel* model, int body) { return model->body_weldid[body] != 0; }

bool IsUnbounded(const mjModel* model, int geom) {
  return model->geom_type[geom] == mjGEOM_PLANE || model->geom_type[geom] == mjGEOM_HFIELD;
}

void AppendCorners(const Studio& studio, int geom, std::vector<Point>& points) {
  const mjtNum* aabb = &studio.model->geom_aabb[6 * geom];  // Center and half sizes.
  const mjtNum* position = &studio.data->geom_xpos[3 * geom];
  const mjtNum* rotation = &studio.data->geom_xmat[9 * geom];
  for (int corner = 0; corner < 8; ++corner) {
    Point local;
    for (int i = 0; i < 3; ++i) {
      local[i] = aabb[i] + ((corner >> i & 1) ? aabb[3 + i] : -aabb[3 + i]);
    }
    Point& world = points.emplace_back();
    mju_mulMatVec3(world.data(), rotation, local.data());
    mju_addTo3(world.data(), position);
  }
}

double Radius(const std::vector<Point>& points) {
  if (points.empty()) return 0;
  Point low = points[0];
  Point high = points[0];
  for (const Point& point : points) {
    for (int i = 0; i < 3; ++i) {
      low[i] = std::min(low[i], point[i]);
      high[i] = std::max(high[i], point[i]);
    }
  }
  return mju_dist3(low.data(), high.data()) / 2;
}

// The moving bodies of the guilty geoms' trees, or all moving bodies if no guilty geom moves.
void AppendMoving(const Studio& studio, std::vector<Point>& points) {
  const mjModel* model = studio.model.get();
  std::vector<char> guilty_tree(model->nbody, 0);
  bool any_tree = false;
  for (int geom = 0; geom < model->ngeom; ++geom) {
    const int body = model->geom_bodyid[geom];
    if (!studio.guilty[geom] || !IsMoving(model, body)) continue;
    guilty_tree[model->body_rootid[body]] = 1;
    any_tree = true;
  }
  for (int geom = 0; geom < model->ngeom; ++geom) {
    const int body = model->geom_bodyid[geom];
    const bool framed = !any_tree || guilty_tree[model->body_rootid[body]];
    const bool shown = model->geom_group[geom] != kHiddenGroup;
    if (shown && framed && IsMoving(model, body)) AppendCorners(studio, geom, points);
  }
}

// What should be in the picture at the present pose: besides moving bodies, fixed guilty ones as
// long as they are no larger; of large ones the guilty geoms, as long as these are no larger.
void AppendFramed(const Studio& studio, std::vector<Point>& points) {
  const mjModel* model = studio.model.get();
  AppendMoving(studio, points);
  const double radius = points.empty() ? model->stat.extent : Radius(points);
  for (int body = 0; body < model->nbody; ++body) {
    if (IsMoving(model, body)) continue;
    const int first = model->body_geomadr[body];
    std::vector<Point> whole, guilty;
    for (int geom = first; geom < first + model->body_geomnum[body]; ++geom) {
      if (IsUnbounded(model, geom) || model->geom_group[geom] == kHiddenGroup) continue;
      AppendCorners(studio, geom, whole);
      const bool large = model->geom_rbound[geom] > radius;
      if (studio.guilty[geom] && !large) AppendCorners(studio, geom, guilty);
    }
    if (guilty.empty()) continue;
    const std::vector<Point>& framed = body != 0 && Radius(whole) <= radius ? whole : guilty;
    points.insert(points.end(), framed.begin(), framed.end());
  }
}

// ---- Point of view ----------------------------------------------------------

struct Placement {
  Point lookat;         // In the camera's axes: right, up, forward.
  double distance = 0;  // Behind `lookat`.
};

// The nearest place for a camera from which all points (in the camera's axes) are in the picture.
Placement FitPicture(const std::vector<Point>& points, double tan_right, double tan_up) {
  const double tangents[2] = {tan_right, tan_up};
  Placement fit;
  for (int i = 0; i < 3; ++i) {
    const auto [low, high] = std::minmax_element(
        points.begin(), points.end(), [i](const Point& a, const Point& b) { return a[i] < b[i]; });
    fit.lookat[i] = ((*low)[i] + (*high)[i]) / 2;
  }
  // Near points look larger: move the middle of the picture, a few times since the distance
  // changes.
  for (int round = 0; round < 5; ++round) {
    fit.distance = 0;
    for (const Point& point : points) {
      const double depth = point[2] - fit.lookat[2];
      for (int i = 0; i < 2; ++i) {
        const double offset = std::abs(point[i] - fit.lookat[i]);
        fit.distance = std::max(fit.distance, offset / tangents[i] - depth);
      }
    }
    for (int i = 0; i < 2; ++i) {
      double low = 0;
      double high = 0;
      for (const Point& point : points) {
        const double depth = fit.distance + point[2] - fit.lookat[2];
        const double slope = (point[i] - fit.lookat[i]) / std::max(depth, 1e-3 * fit.distance);
        low = std::min(low, slope);
        high = std::max(high, slope);
      }
      fit.lookat[i] += (low + high) / 2 * fit.distance;
    }
  }
  return fit;
}

// A free camera which looks in the given direction (degrees) and has all points in its picture.
mjvCamera FittedCamera(const mjModel* model, const std::vector<Point>& points, double azimuth,
                       double elevation) {
  constexpr double kDegree = std::numbers::pi / 180;
  const double ca = std::cos(azimuth * kDegree), sa = std::sin(azimuth * kDegree);
  const double ce = std::cos(elevation * kDegree), se = std::sin(elevation * kDegree);
  const Point axes[3] = {{sa, -ca, 0}, {-se * ca, -se * sa, ce}, {ce * ca, ce * sa, se}};

  std::vector<Point> seen;  // In the camera's axes: right, up, forward.
  for (const Point& point : points) {
    Point& coordinates = seen.emplace_back();
    for (int i = 0; i < 3; ++i) coordinates[i] = mju_dot3(axes[i].data(), point.data());
  }
  const double tan_up = std::tan(model->vis.global.fovy * kDegree / 2);
  const double tan_right = tan_up * kCellWidth / kCellHeight;
  const Placement placement = FitPicture(seen, tan_right, tan_up);

  mjvCamera camera;
  mjv_defaultCamera(&camera);
  camera.azimuth = azimuth;
  camera.elevation = elevation;
  camera.distance = 1.08 * placement.distance;
  mju_zero3(camera.lookat);
  for (int i = 0; i < 3; ++i) mju_addToScl3(camera.lookat, axes[i].data(), placement.lookat[i]);
  return camera;
}

void UpdateScene(Studio& studio, mjvCamera& camera) {
  // The clipping planes are multiples of the extent; come close to small things in large worlds.
  studio.model->stat.extent = studio.source->stat.extent;
  if (camera.type == mjCAMERA_FREE) {
    studio.model->stat.extent = std::min(studio.source->stat.extent, camera.distance);
  }
  mjv_updateScene(studio.model.get(), studio.data.get(), &studio.option, nullptr, &camera,
                  mjCAT_ALL, &studio.scene.scene);
}

bool IsGuilty(const Studio& studio, const mjvGeom& geom) {
  return geom.objtype == mjOBJ_GEOM && geom.objid >= 0 && studio.guilty[geom.objid];
}

// Whether the geom surrounds, or may surround, a guilty one which would be hidden otherwise.
bool IsGlass(const Studio& studio, const mjvGeom& geom) {
  return geom.objtype == mjOBJ_GEOM && geom.objid >= 0 && !studio.guilty[geom.objid] &&
         studio.glass[studio.model->geom_bodyid[geom.objid]];
}

// A small picture which tells what is seen, and how far away it is.
struct Probe {
  std::vector<int> geom;  // Per pixel: the guilty geom seen there, or -1.
  std::vector<double> depth;
  mjvGLCamera camera;
};

Probe TakeProbe(Studio& studio, mjvCamera camera) {
  UpdateScene(studio, camera);
  mjvScene& scene = studio.scene.scene;
  for (int i = 0; i < scene.ngeom; ++i) {
    if (IsGlass(studio, scene.geoms[i])) scene.geoms[i].segid = -1;  // One sees through it.
  }
  const std::vector<mjtByte> flags(scene.flags, scene.flags + mjNRNDFLAG);
  for (const int flag : {mjRND_SHADOW, mjRND_REFLECTION, mjRND_SKYBOX}) scene.flags[flag] = 0;
  for (const int flag : {mjRND_SEGMENT, mjRND_IDCOLOR}) scene.flags[flag] = 1;
  const mjrRect viewport = {0, 0, kProbeWidth, kProbeHeight};
  mjr_render(viewport, &scene, &studio.canvas.context);
  std::copy(flags.begin(), flags.end(), scene.flags);
  constexpr std::size_t kNumPixels = std::size_t{kProbeWidth} * kProbeHeight;
  std::vector<std::uint8_t> rgb(3 * kNumPixels);
  std::vector<float> zbuffer(kNumPixels);
  mjr_readPixels(rgb.data(), zbuffer.data(), viewport, &studio.canvas.context);

  std::vector<int> geom_of_color(scene.maxgeom + 1, -1);  // The colour is segid + 1.
  for (int i = 0; i < scene.ngeom; ++i) {
    if (IsGuilty(studio, scene.geoms[i])) {
      geom_of_color[scene.geoms[i].segid + 1] = scene.geoms[i].objid;
    }
  }
  Probe probe;
  probe.camera = mjv_averageCamera(&scene.camera[0], &scene.camera[1]);
  const double near = probe.camera.frustum_near;
  const double far = probe.camera.frustum_far;
  for (std::size_t i = 0; i < kNumPixels; ++i) {
    const int color = rgb[3 * i] | rgb[3 * i + 1] << 8 | rgb[3 * i + 2] << 16;
    probe.geom.push_back(color <= scene.maxgeom ? geom_of_color[color] : -1);
    probe.depth.push_back(probe.camera.orthographic
                              ? near + zbuffer[i] * (far - near)
                              : near * far / (far - zbuffer[i] * (far - near)));
  }
  return probe;
}

// Whether the camera sees the place: one of the pixels there shows a guilty geom not before it.
bool IsSeen(const Probe& probe, const Overlap& overlap) {
  const mjvGLCamera& camera = probe.camera;
  Point forward, up, right, offset;
  for (int i = 0; i < 3; ++i) {
    forward[i] = camera.forward[i];
    up[i] = camera.up[i];
    offset[i] = overlap.position[i] - camera.pos[i];
  }
  mju_cross(right.data(), forward.data(), up.data());
  const double depth = mju_dot3(forward.data(), offset.data());
  if (depth < camera.frustum_near) return false;
  const double scale = camera.orthographic ? 1 : depth / camera.frustum_near;
  const double pixel = scale * (camera.frustum_top - camera.frustum_bottom) / kProbeHeight;
  const double middle_x = mju_dot3(right.data(), offset.data()) - scale * camera.frustum_center;
  const double bottom_y = mju_dot3(up.data(), offset.data()) - scale * camera.frustum_bottom;
  const double column = middle_x / pixel + kProbeWidth / 2.0;
  const double row = bottom_y / pixel;
  if (!(column >= 1 && column < kProbeWidth - 1)) return false;
  if (!(row >= 1 && row < kProbeHeight - 1)) return false;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const int i = (static_cast<int>(row) + dy) * kProbeWidth + static_cast<int>(column) + dx;
      const double front = depth - overlap.depth - 2 * pixel;  // The place lies inside both geoms.
      if (probe.geom[i] >= 0 && probe.depth[i] > front) return true;
    }
  }
  return false;
}

// How well the camera shows the guilty geoms and above all where they overlap.
double Score(Studio& studio, const mjvCamera& camera) {
  const Probe probe = TakeProbe(studio, camera);
  std::vector<int> num_pixels(studio.model->ngeom, 0);
  for (const int geom : probe.geom) {
    if (geom >= 0 && !IsUnbounded(studio.model.get(), geom)) ++num_pixels[geom];
  }
  // By the root, a geom seen a little counts for more than much of another one.
  double score = 0;
  for (const int count : num_pixels) score += std::sqrt(count);
  if (studio.overlaps.empty()) return score;
  double num_seen = 0;
  for (const Overlap& overlap : studio.overlaps) num_seen += IsSeen(probe, overlap) ? 1 : 0;
  return score * (1 + 2 * num_seen / static_cast<double>(studio.overlaps.size()));
}

mjvCamera ModelCamera(int id) {
  mjvCamera camera;
  mjv_defaultCamera(&camera);
  camera.type = mjCAMERA_FIXED;
  camera.fixedcamid = id;
  return camera;
}

mjvCamera BestFreeCamera(Studio& studio, const std::vector<Point>& points, double& best_score) {
  const mjModel* model = studio.model.get();
  mjvCamera best;
  mjv_defaultFreeCamera(model, &best);
  best_score = 0;
  if (points.empty()) return best;
  best = FittedCamera(model, points, best.azimuth, -25);
  constexpr std::pair<double, double> kElevations[] = {{-25, 1.0}, {-60, 0.9}, {-5, 0.7}};
  for (const auto& [elevation, preference] : kElevations) {
    for (int turn = 0; turn < 8; ++turn) {
      const double azimuth = model->vis.global.azimuth + 45.0 * turn;
      const mjvCamera camera = FittedCamera(model, points, azimuth, elevation);
      const double score = preference * Score(studio, camera);
      if (score <= best_score) continue;
      best_score = score;
      best = camera;
    }
  }
  return best;
}

// The model's own camera or a free one (see the header), judged at the present pose.
mjvCamera ChooseCamera(Studio& studio, const std::vector<Point>& points) {
  const mjModel* model = studio.model.get();
  const int view = mj_name2id(model, mjOBJ_CAMERA, "view");
  if (view >= 0) return ModelCamera(view);
  double free_score = 0;
  const mjvCamera free_camera = BestFreeCamera(studio, points, free_score);
  for (int i = 0; i < model->ncam; ++i) {
    if (model->cam_mode[i] == mjCAMLIGHT_FIXED && IsMoving(model, model->cam_bodyid[i])) continue;
    if (Score(studio, ModelCamera(i)) >= 0.7 * free_score) return ModelCamera(i);
  }
  return free_camera;
}

// ---- Drawing ----------------------------------------------------------------

void Tint(const Studio& studio, const Tints& tints, mjvScene& scene) {
  for (int i = 0; i < scene.ngeom; ++i) {
    mjvGeom& geom = scene.geoms[i];
    if (IsGuilty(studio, geom)) {
      const Rgb& tint = tints[studio.guilty[geom.objid] - 1];
      const bool unbounded = IsUnbounded(studio.model.get(), geom.objid);
      const float weight = unbounded ? 0.35f : 1.0f;  // A floor all red would drown the rest.
      for (int k = 0; k < 3; ++k) geom.rgba[k] += weight * (tint[k] - geom.rgba[k]);
      if (unbounded) continue;
      for (float& size : geom.size) size *= 1.003f;  // In front where surfaces coincide.
      geom.rgba[3] = 1;
      geom.matid = -1;
      geom.texid = -1;
      geom.emission = 0.1f;
      geom.reflectance = 0;
    } else if (IsGlass(studio, geom)) {
      geom.rgba[3] = std::min(geom.rgba[3], kGlassAlpha);
    }
  }
}

// A wall behind everything, in one even colour: without a sky box the background would be black.
void AddBackdrop(mjvScene& scene) {
  if (scene.ngeom >= scene.maxgeom) return;
  const mjvGLCamera& camera = scene.camera[0];
  Point forward, up, right, position;
  for (int i = 0; i < 3; ++i) {
    forward[i] = camera.forward[i];
    up[i] = camera.up[i];
  }
  mju_cross(right.data(), forward.data(), up.data());
  const double distance = 0.9 * camera.frustum_far;
  for (int i = 0; i < 3; ++i) position[i] = camera.pos[i] + distance * forward[i];
  double half = 4 * camera.frustum_top;
  if (!camera.orthographic) half *= distance / camera.frustum_near;
  const mjtNum size[3] = {half, half, 0.01 * distance};
  const mjtNum rotation[9] = {right[0],    up[0],    -forward[0], right[1],   up[1],
                              -forward[1], right[2], up[2],       -forward[2]};
  // Nearly black to the lights, and bright by itself.
  constexpr float kEmission = 100;
  const float rgba[4] = {kBackdrop[0] / kEmission, kBackdrop[1] / kEmission,
                         kBackdrop[2] / kEmission, 1};
  mjvGeom& wall = scene.geoms[scene.ngeom++];
  mjv_initGeom(&wall, mjGEOM_BOX, size, position.data(), rotation, rgba);
  wall.category = mjCAT_DECOR;
  wall.emission = kEmission;
  wall.specular = 0;
  wall.reflectance = 0;
  wall.castshadow = 0;
}

// The title in the characters which the font has, cut where it would leave the picture.
std::string FittingText(const mjrContext& context, const std::string& title, int max_width) {
  std::string text;
  int width = 0;
  for (const unsigned char c : title) {
    if ((c & 0xC0) == 0x80) continue;  // Inside a UTF-8 character.
    const unsigned char shown = c >= 32 && c < 127 ? c : '?';
    width += context.charWidth[shown];
    if (width > max_width) return text + "...";
    text += static_cast<char>(shown);
  }
  return text;
}

// Copies the finished cell, whose first line is the lowest, into the sheet.
void ReadCell(const mjrContext& context, int left, int top, RgbImage& sheet) {
  constexpr std::size_t kLine = 3 * std::size_t{kCellWidth};  // Bytes.
  std::vector<std::uint8_t> pixels(kLine * kCellHeight);
  mjr_readPixels(pixels.data(), nullptr, {0, 0, kCellWidth, kCellHeight}, &context);
  for (int y = 0; y < kCellHeight; ++y) {
    const std::uint8_t* const line = &pixels[kLine * (kCellHeight - 1 - y)];
    std::copy(line, line + kLine,
              &sheet.rgb[3 * (static_cast<std::size_t>(top + y) * sheet.width + left)]);
  }
}

void DrawLabel(const mjrContext& context, const std::string& title, const char* when) {
  const mjrRect viewport = {0, 0, kCellWidth, kCellHeight};
  const std::string text = FittingText(context, title, kCellWidth - 150);
  mjr_overlay(mjFONT_NORMAL, mjGRID_TOPLEFT, viewport, text.c_str(), when, &context);
}

void DrawCell(Studio& studio, const Tints& tints, mjvCamera& camera) {
  UpdateScene(studio, camera);
  mjvScene& scene = studio.scene.scene;
  Tint(studio, tints, scene);
  if (!studio.has_skybox) AddBackdrop(scene);
  mjr_render({0, 0, kCellWidth, kCellHeight}, &scene, &studio.canvas.context);
}

void DrawRow(Studio& studio, const RenderRow& row, int left, int top, RgbImage& sheet) {
  const mjrContext& context = studio.canvas.context;
  SetVisibility(studio, row.guilty_geoms);
  std::vector<Point> points;
  if (!row.qpos.empty()) {
    SetPose(studio, row.qpos);
    AppendFramed(studio, points);
  }
  SetPose(studio, row.qpos_in);
  FindOverlaps(studio);
  AppendFramed(studio, points);
  mjvCamera camera = ChooseCamera(studio, points);
  DrawCell(studio, kReds, camera);
  DrawLabel(context, row.title, "before");
  ReadCell(context, left, top, sheet);

  if (row.qpos.empty()) {
    mjr_rectangle({0, 0, kCellWidth, kCellHeight}, kBackdrop[0], kBackdrop[1], kBackdrop[2], 1);
  } else {
    // A camera which follows a body would hide how it moved: leave the scene's camera in place.
    if (camera.type == mjCAMERA_FIXED) camera.type = mjCAMERA_USER;
    SetPose(studio, row.qpos);
    DrawCell(studio, kGreens, camera);
  }
  DrawLabel(context, row.title, row.qpos.empty() ? "after: none" : "after");
  ReadCell(context, left + kCellWidth + kSeam, top, sheet);
}

}  // namespace

int RenderBeforeAfter(const mjModel* model, const std::vector<RenderRow>& rows,
                      const std::string& png_path) {
  if (rows.empty()) throw std::runtime_error("cannot render: there is no configuration to draw");
  const int num_rows = static_cast<int>(std::min<std::size_t>(rows.size(), kMaxRenderRows));
  for (int i = 0; i < num_rows; ++i) CheckRow(model, rows[i]);
  static std::mutex mutex;  // MuJoCo's OpenGL entry points are global.
  const std::lock_guard<std::mutex> lock(mutex);

  // A pair is twice as wide as a cell: this many columns give the sheet nearly a cell's shape.
  const int columns = std::max(1, static_cast<int>(std::lround(std::sqrt(num_rows / 2.0))));
  const int lines = (num_rows + columns - 1) / columns;
  constexpr int kPairWidth = 2 * kCellWidth + kSeam;
  RgbImage sheet;
  sheet.width = columns * (kPairWidth + kGap) + kGap;
  sheet.height = lines * (kCellHeight + kGap) + kGap;
  sheet.rgb.assign(3 * static_cast<std::size_t>(sheet.width) * sheet.height, kSheetGray);

  Studio studio(model);
  for (int i = 0; i < num_rows; ++i) {
    const int left = kGap + i % columns * (kPairWidth + kGap);
    const int top = kGap + i / columns * (kCellHeight + kGap);
    DrawRow(studio, rows[i], left, top, sheet);
  }
  WritePng(sheet, png_path);
  return num_rows;
}

}  // namespace mjcf_pdg::app
