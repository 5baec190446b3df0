#include "track/frame_solver.h"

#include <algorithm>
#include <limits>

#include "solve/options.h"

namespace mjcf_pdg {
namespace {

// Meshes that collide as their triangles need starts on rays, which only a search makes.
bool TrianglesCollide(const Workspace& work) {
  const std::vector<KeptPair>& pairs = work.problem().tables.pairs;
  return std::any_of(pairs.begin(), pairs.end(),
                     [](const KeptPair& pair) { return NeedsGap(pair.kind); });
}

}  // namespace

FrameSolver::FrameSolver(const Scene& scene, const Options& options, bool searches) {
  CheckMujocoVersion();
  if (options.method == Method::kAuto) {
    // Nothing but where a frame's descents end bounds its queries.
    TrackOptions track{.options = options, .queries = std::numeric_limits<int>::max()};
    track.options.trajectory = false;
    const Pace pace{.follow = {.steps = tuning::track::kFrameSteps,
                               .more = tuning::track::kMoreFrameSteps,
                               .enough = 0.0},
                    .searches = searches,
                    .bounds = options.report_lower_bound,
                    .depths = verify::Depths::kMeasured};
    tracker_ = std::make_unique<TrackerCore>(scene, track, pace);
    if (!TrianglesCollide(tracker_->work)) return;
    tracker_.reset();
  }
  solver_ = std::make_unique<Solver>(scene, options);
}

Status FrameSolver::Solve(const Frame& frame, Result& result) {
  if (solver_) {
    solver_->SetMocap(frame.mocap.pos, frame.mocap.quat);
    return solver_->Solve(frame.q, result);
  }
  tracker_->core.CheckInput(frame.q);
  tracker_->SetMocap(frame.mocap);
  return tracker_->Step(frame.q, result);
}

}  // namespace mjcf_pdg
