#include "apps/picture/motion_shots.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <utility>

#include "apps/console/text.h"
#include "apps/picture/row_picture.h"
#include "mjcf_pdg/object_norm.h"

namespace mjcf_pdg::app {
namespace {

constexpr double kFrameSeconds = 0.05;
constexpr double kHoldSeconds = 1.0;  // for the ends of a motion
constexpr int kRepairFrames = 24;
constexpr int kPathFrames = 120;
constexpr std::size_t kMostFrames = 240;  // of a trajectory
constexpr std::size_t kFramedStep = 24;   // of these one in so many decides where the camera is

// The configuration at share t of the straight motion from q0 to q1.
std::vector<double> Between(const mjModel& model, const std::vector<double>& q0,
                            const std::vector<double>& q1, double t) {
  std::vector<double> velocity(static_cast<std::size_t>(model.nv)), q = q0;
  mj_differentiatePos(&model, velocity.data(), 1.0, q0.data(), q1.data());
  mj_integratePos(&model, q.data(), velocity.data(), t);
  return q;
}

// The length of the path up to each of its configurations, Σ√σ [m].
std::vector<double> Reached(const Scene& scene, const std::vector<std::vector<double>>& path) {
  std::vector<double> reached = {0.0};
  for (std::size_t k = 1; k < path.size(); ++k) {
    ObjectNorm norm(scene, Metric::kSequential, path[k - 1]);
    reached.push_back(reached.back() + std::sqrt(norm.Sigma(path[k])));
  }
  return reached;
}

// Geoms of the bodies that stand elsewhere somewhere on the path.
std::vector<int> MovingGeoms(const mjModel& model, const std::vector<std::vector<double>>& path) {
  std::vector<bool> moves(static_cast<std::size_t>(model.nbody));
  std::vector<int> geoms;
  for (int body = 1; body < model.nbody; ++body) {
    bool moved = moves[static_cast<std::size_t>(model.body_parentid[body])];
    const int first = model.body_jntadr[body], last = first + model.body_jntnum[body];
    const int begin = first < 0 ? 0 : model.jnt_qposadr[first];
    const int end = first < 0           ? 0
                    : last < model.njnt ? model.jnt_qposadr[last]
                                        : static_cast<int>(model.nq);
    for (const std::vector<double>& q : path) {
      moved |= !std::equal(q.begin() + begin, q.begin() + end, path.front().begin() + begin);
    }
    moves[static_cast<std::size_t>(body)] = moved;
    for (int k = 0; moved && k < model.body_geomnum[body]; ++k) {
      geoms.push_back(model.body_geomadr[body] + k);
    }
  }
  return geoms;
}

void Hold(Shot& shot) { shot.moments.front().seconds = shot.moments.back().seconds = kHoldSeconds; }

}  // namespace

Shot RepairShot(const Scene& scene, Solver& solver, const Configuration& row,
                const Result& result) {
  const RenderRow picture = PictureRow(row, result);
  Shot shot = {picture.title, picture.guilty_geoms, {picture.before.pose, picture.after.pose}, {}};
  if (result.status == Status::kAlreadyFree) {
    shot.moments.push_back({{picture.after}, kHoldSeconds});
    return shot;
  }
  solver.SetMocap(row.mocap_pos, row.mocap_quat);
  shot.moments.push_back({{picture.before}, kFrameSeconds});
  for (int frame = 1; frame < kRepairFrames; ++frame) {
    RenderSide side = picture.before;
    side.contacts.clear();
    side.pose.qpos = Between(*scene.model(), row.q, result.q, frame / double{kRepairFrames});
    side.free = solver.IsFree(side.pose.qpos);
    side.text = "on the way";
    shot.moments.push_back({{std::move(side)}, kFrameSeconds});
  }
  shot.moments.push_back({{picture.after}, kFrameSeconds});
  Hold(shot);
  return shot;
}

Shot TrajectoryShot(const std::vector<Configuration>& rows, const std::vector<Result>& results) {
  Shot shot;
  std::set<int> guilty;
  const std::size_t frames = std::min(rows.size(), kMostFrames);
  for (std::size_t frame = 0; frame < frames; ++frame) {
    const std::size_t row = frame * rows.size() / frames;
    RenderRow picture = PictureRow(rows[row], results[row]);
    guilty.insert(picture.guilty_geoms.begin(), picture.guilty_geoms.end());
    picture.before.free = results[row].status == Status::kAlreadyFree;
    if (frame % kFramedStep == 0 || frame + 1 == frames) {
      shot.framed.push_back(picture.before.pose);
    }
    shot.moments.push_back({{std::move(picture.before), std::move(picture.after)}, kFrameSeconds});
  }
  shot.title = "frames " + rows.front().label + " to " + rows.back().label;
  shot.guilty_geoms.assign(guilty.begin(), guilty.end());
  Hold(shot);
  return shot;
}

Shot PathShot(const Scene& scene, const Configuration& start,
              const std::vector<std::vector<double>>& path) {
  const mjModel& model = *scene.model();
  Shot shot = {"path", MovingGeoms(model, path), {}, {}};
  const auto pose = [&start](const std::vector<double>& q) {
    return Pose{q, start.mocap_pos, start.mocap_quat};
  };
  for (const std::vector<double>& q : path) shot.framed.push_back(pose(q));
  const std::vector<double> reached = Reached(scene, path);  // at the configurations of the path
  std::size_t edge = 0;
  for (int frame = 0; frame <= kPathFrames; ++frame) {
    const double at = frame * reached.back() / kPathFrames;
    while (edge + 2 < path.size() && at > reached[edge + 1]) ++edge;
    const double length = reached[edge + 1] - reached[edge];
    const double t = length > 0.0 ? std::min((at - reached[edge]) / length, 1.0) : 0.0;
    RenderSide side{pose(Between(model, path[edge], path[edge + 1], t)), true, "", {}};
    side.text = Short(at) + " of " + Short(reached.back()) + " m";
    shot.moments.push_back({{std::move(side)}, kFrameSeconds});
  }
  Hold(shot);
  return shot;
}

}  // namespace mjcf_pdg::app
