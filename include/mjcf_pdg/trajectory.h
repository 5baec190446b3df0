// All frames of a motion: a mocap clip, a walk, a teleoperated hand.
//
//   mjcf_pdg::SolveTrajectory(scene, {.smooth = 1.0}, q, [&](std::size_t k, const auto& result) {
//     ...
//     return true;
//   });
//
// Source: Tang & Kim, Sec. 5.1 (motion coherence).
// Differs from it: one optimum is followed from frame to frame (mjcf_pdg/tracker.h), and all frames
// may be solved together.
#ifndef MJCF_PDG_TRAJECTORY_H_
#define MJCF_PDG_TRAJECTORY_H_

#include <cstddef>
#include <functional>
#include <span>

#include "mjcf_pdg/export.h"
#include "mjcf_pdg/scene.h"
#include "mjcf_pdg/types.h"

namespace mjcf_pdg {

struct TrajectoryOptions {
  Options options = {};  // Options::trajectory is taken as set
  // W, a weight on the change between frames, 0 to 1e6 [1]. Above 0 the answers of all frames are
  // sought together. They minimize, by descents from where following leads,
  //   Σ_k σ(q_in_k, q_k) + W Σ_k change(q_k, q_k+1)
  // subject to each being free. The change is the norm's quadratic form XᵀHX / M (Eq. 26, 28), with
  // the H of the earlier frame's q_in. Frames that are free already move, too. Frames for which
  // nothing free is found stay as they are, and their neighbours do not heed them.
  double smooth = 0.0;
  // Asked between frames whether to go on; empty: always.
  std::function<bool()> go_on = {};
};

// Solves the frames `q` (n × nq values, frame by frame). `done` gets each frame's number and
// result, in order; if it returns false, that is the end. With `smooth` it gets the first when all
// frames are solved. Method paper and exact meshes are not followed: then each frame is searched
// from earlier answers, as by Solver. Throws Error as Solver does, for `smooth` out of range or
// with method paper, and for a bad frame, whose number it says; no frame is solved then.
MJCF_PDG_API void SolveTrajectory(const Scene& scene, const TrajectoryOptions& options,
                                  std::span<const double> q,
                                  const std::function<bool(std::size_t, const Result&)>& done);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_TRAJECTORY_H_
