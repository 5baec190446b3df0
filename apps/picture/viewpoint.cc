#include "apps/picture/viewpoint.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <utility>

namespace mjcf_pdg::app {
namespace {

// Shares of the picture that the guilty geoms fill. Below the first, the camera named "view" is not
// used; below the second, a free camera comes closer.
constexpr double kSmallShare = 0.03;
constexpr double kTinyShare = 0.02;
constexpr double kMarkerRadius = 0.025;  // Share of the subject's radius.
constexpr double kDegree = std::numbers::pi / 180;

// The axis-aligned bounding box of points, world frame [m].
struct Box {
  explicit Box(const std::vector<Point>& points) : low(points.at(0)), high(points.at(0)) {
    for (const Point& point : points) {
      for (int i = 0; i < 3; ++i) {
        low[i] = std::min(low[i], point[i]);
        high[i] = std::max(high[i], point[i]);
      }
    }
  }
  double Radius() const { return mju_dist3(low.data(), high.data()) / 2; }
  Point Middle() const {
    return {(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, (low[2] + high[2]) / 2};
  }
  Point low, high;
};

// ---- What should be in the picture ------------------------------------------

// Corners of the bounding boxes of geoms that should be in the picture, world frame [m].
struct Subject {
  std::vector<Point> whole;
  std::vector<Point> guilty;  // A part of `whole`.
};

bool IsMoving(const mjModel& model, int body) { return model.body_weldid[body] != 0; }

void AppendCorners(const Stage& stage, int geom, std::vector<Point>& points) {
  const mjtNum* aabb = &stage.model().geom_aabb[6 * geom];  // Center and half sizes.
  for (int corner = 0; corner < 8; ++corner) {
    Point local;
    for (int i = 0; i < 3; ++i) {
      local[i] = aabb[i] + ((corner >> i & 1) ? aabb[3 + i] : -aabb[3 + i]);
    }
    Point& world = points.emplace_back();
    mju_mulMatVec3(world.data(), &stage.data().geom_xmat[9 * geom], local.data());
    mju_addTo3(world.data(), &stage.data().geom_xpos[3 * geom]);
  }
}

// Lifts points that are below a guilty floor onto it, because nothing can be seen below it.
void LiftOntoFloors(const Stage& stage, std::vector<Point>& points) {
  for (int geom = 0; geom < stage.model().ngeom; ++geom) {
    if (!stage.IsGuilty(geom) || stage.model().geom_type[geom] != mjGEOM_PLANE) continue;
    const mjtNum* const rotation = &stage.data().geom_xmat[9 * geom];
    const Point normal = {rotation[2], rotation[5], rotation[8]};
    const double floor = mju_dot3(normal.data(), &stage.data().geom_xpos[3 * geom]);
    for (Point& point : points) {
      const double height = mju_dot3(normal.data(), point.data()) - floor;
      if (height < 0) mju_addToScl3(point.data(), normal.data(), -height);
    }
  }
}

// Adds the geoms that should be in the picture at the stage's pose: the shown geoms of the
// kinematic trees with guilty geoms (of all trees, if no guilty geom can move), and fixed bodies
// with guilty geoms. Of a fixed body that is larger than the trees only its guilty geoms are added,
// and of these only those that are no larger.
void AppendPose(const Stage& stage, Subject& subject) {
  const mjModel& model = stage.model();
  std::vector<bool> guilty_tree(model.nbody, false);
  bool any_tree = false;
  for (int geom = 0; geom < model.ngeom; ++geom) {
    const int body = model.geom_bodyid[geom];
    if (!stage.IsGuilty(geom) || !IsMoving(model, body)) continue;
    guilty_tree[model.body_rootid[body]] = any_tree = true;
  }
  for (int geom = 0; geom < model.ngeom; ++geom) {
    const int body = model.geom_bodyid[geom];
    if (!IsMoving(model, body) || !stage.IsShown(geom)) continue;
    if (any_tree && !guilty_tree[model.body_rootid[body]]) continue;
    AppendCorners(stage, geom, subject.whole);
    if (stage.IsGuilty(geom)) AppendCorners(stage, geom, subject.guilty);
  }
  const double radius = subject.whole.empty() ? model.stat.extent : Box(subject.whole).Radius();
  for (int body = 0; body < model.nbody; ++body) {
    if (IsMoving(model, body)) continue;
    std::vector<Point> whole, guilty;
    for (int i = 0; i < model.body_geomnum[body]; ++i) {
      const int geom = model.body_geomadr[body] + i;
      if (stage.IsUnbounded(geom) || !stage.IsShown(geom)) continue;
      AppendCorners(stage, geom, whole);
      const bool small = model.geom_rbound[geom] <= radius;
      if (stage.IsGuilty(geom) && small) AppendCorners(stage, geom, guilty);
    }
    if (guilty.empty()) continue;
    const std::vector<Point>& framed = body != 0 && Box(whole).Radius() <= radius ? whole : guilty;
    subject.whole.insert(subject.whole.end(), framed.begin(), framed.end());
    subject.guilty.insert(subject.guilty.end(), guilty.begin(), guilty.end());
  }
  LiftOntoFloors(stage, subject.whole);
  LiftOntoFloors(stage, subject.guilty);
}

// A marker at each contact of two guilty geoms, larger than `radius` by half the overlap [m].
std::vector<Marker> MarkOverlaps(const Stage& stage, double radius) {
  std::vector<Marker> markers;
  for (int i = 0; i < stage.data().ncon; ++i) {
    const mjContact& contact = stage.data().contact[i];
    if (contact.dist > 0 || contact.geom[0] < 0 || contact.geom[1] < 0) continue;
    if (!stage.IsGuilty(contact.geom[0]) || !stage.IsGuilty(contact.geom[1])) continue;
    markers.push_back(
        {{contact.pos[0], contact.pos[1], contact.pos[2]}, radius - contact.dist / 2});
  }
  return markers;
}

// ---- Cameras ----------------------------------------------------------------

// A free camera that looks in the given direction (degrees), as near as it can be with all points
// in its picture.
mjvCamera FittedCamera(const mjModel& model, const std::vector<Point>& points, double azimuth,
                       double elevation) {
  const double ca = std::cos(azimuth * kDegree), sa = std::sin(azimuth * kDegree);
  const double ce = std::cos(elevation * kDegree), se = std::sin(elevation * kDegree);
  const Point axes[3] = {{sa, -ca, 0}, {-se * ca, -se * sa, ce}, {ce * ca, ce * sa, se}};
  const double tan_up = 0.9 * std::tan(model.vis.global.fovy * kDegree / 2);  // With a margin.
  const double tangents[2] = {tan_up * Stage::kWidth / Stage::kHeight, tan_up};

  // In the camera's axes (right, up, forward) each point p confines the camera's place (x, y, z):
  //   p_x - t (p_z - z) <= x <= p_x + t (p_z - z),
  // where t is the tangent of half the field of view; likewise for y.
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  double low[2] = {-kInfinity, -kInfinity}, high[2] = {kInfinity, kInfinity};
  double nearest = kInfinity, farthest = -kInfinity;
  for (const Point& point : points) {
    const double depth = mju_dot3(axes[2].data(), point.data());
    nearest = std::min(nearest, depth);
    farthest = std::max(farthest, depth);
    for (int i = 0; i < 2; ++i) {
      const double offset = mju_dot3(axes[i].data(), point.data());
      low[i] = std::max(low[i], offset - tangents[i] * depth);
      high[i] = std::min(high[i], offset + tangents[i] * depth);
    }
  }
  double place = kInfinity;
  for (int i = 0; i < 2; ++i) place = std::min(place, (high[i] - low[i]) / (2 * tangents[i]));

  mjvCamera camera;
  mjv_defaultCamera(&camera);
  camera.azimuth = azimuth;
  camera.elevation = elevation;
  camera.distance = (nearest + farthest) / 2 - place;
  mju_scl3(camera.lookat, axes[2].data(), place + camera.distance);
  for (int i = 0; i < 2; ++i) {
    mju_addToScl3(camera.lookat, axes[i].data(), (low[i] + high[i]) / 2);
  }
  return camera;
}

struct View {
  mjvCamera camera;
  double share = 0;   // Share of the picture that guilty geoms fill.
  double score = -1;  // How well guilty geoms, and above all their overlaps, are seen.
};

// Rates a camera by a small picture from it.
View Judge(Stage& stage, const mjvCamera& camera, const std::vector<Marker>& markers) {
  View view = {camera, 0, 0};
  const std::vector<int> counts = stage.CountPixels(camera, markers);
  const int num_geoms = static_cast<int>(stage.model().ngeom);
  for (int geom = 0; geom < num_geoms; ++geom) {
    if (!stage.IsGuilty(geom) || stage.IsUnbounded(geom)) continue;
    view.share += counts[geom] / double{Stage::kProbeWidth * Stage::kProbeHeight};
    // With the square root, a little of another geom counts more than much of the same one.
    view.score += std::sqrt(counts[geom]);
  }
  if (markers.empty()) return view;
  // The seen share of each marker: its pixels over those of its whole disk.
  const double picture_height =
      2 * camera.distance * std::tan(stage.model().vis.global.fovy * kDegree / 2);
  double seen = 0;
  for (std::size_t i = 0; i < markers.size(); ++i) {
    const double radius = markers[i].radius / picture_height * Stage::kProbeHeight;
    seen += std::min(1.0, counts[num_geoms + i] / (std::numbers::pi * radius * radius));
  }
  view.score *= 1 + 4 * seen / static_cast<double>(markers.size());
  return view;
}

View BestFreeView(Stage& stage, const Subject& subject, const std::vector<Marker>& markers) {
  const mjModel& model = stage.model();
  View best;
  for (const auto& [elevation, preference] : {std::pair(-25.0, 1.0), std::pair(-50.0, 0.75)}) {
    for (int turn = 0; turn < 8; ++turn) {
      const double azimuth = model.vis.global.azimuth + 45.0 * turn;
      View view = Judge(stage, FittedCamera(model, subject.whole, azimuth, elevation), markers);
      view.score *= preference;
      if (view.score > best.score) best = view;
    }
  }
  return best;
}

// A free camera that looks in the direction of the model's camera, as near to the points as it can
// be.
mjvCamera Approached(const Stage& stage, int camera, const std::vector<Point>& points) {
  const mjtNum* const rotation = &stage.data().cam_xmat[9 * camera];
  const Point forward = {-rotation[2], -rotation[5], -rotation[8]};
  return FittedCamera(stage.model(), points, std::atan2(forward[1], forward[0]) / kDegree,
                      std::asin(std::clamp(forward[2], -1.0, 1.0)) / kDegree);
}

// The points of the whole subject, drawn in towards the guilty geoms by the factor `zoom` < 1.
std::vector<Point> Zoomed(const Subject& subject, double zoom) {
  const Point middle = Box(subject.guilty).Middle();
  std::vector<Point> points = subject.guilty;
  for (const Point& point : subject.whole) {
    Point& drawn = points.emplace_back(middle);
    for (int i = 0; i < 3; ++i) drawn[i] += zoom * (point[i] - middle[i]);
  }
  return points;
}

}  // namespace

mjvCamera ChooseCamera(Stage& stage, const std::vector<Pose>& poses) {
  const mjModel& model = stage.model();
  Subject subject;
  for (auto pose = poses.rbegin(); pose != poses.rend(); ++pose) {
    stage.SetPose(*pose);
    AppendPose(stage, subject);
  }
  mjvCamera camera;
  mjv_defaultFreeCamera(&model, &camera);
  const int named = mj_name2id(&model, mjOBJ_CAMERA, "view");
  if (named >= 0) {
    camera.type = mjCAMERA_FIXED;
    camera.fixedcamid = named;
  }
  if (subject.whole.empty() || (named >= 0 && subject.guilty.empty())) return camera;

  const std::vector<Marker> markers =
      MarkOverlaps(stage, kMarkerRadius * Box(subject.whole).Radius());
  View best;
  if (named >= 0) {
    best = Judge(stage, camera, markers);
    if (best.share >= kSmallShare) return camera;
    best = Judge(stage, Approached(stage, named, subject.whole), markers);
  }
  if (best.score <= 0) best = BestFreeView(stage, subject, markers);
  for (const double zoom : {0.75, 0.55, 0.4, 0.25, 0.15, 0.08}) {
    if (subject.guilty.empty() || best.share >= kTinyShare) break;
    best = Judge(
        stage,
        FittedCamera(model, Zoomed(subject, zoom), best.camera.azimuth, best.camera.elevation),
        markers);
  }
  return best.camera;
}

}  // namespace mjcf_pdg::app
