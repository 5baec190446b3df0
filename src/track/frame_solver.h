// The frames of a trajectory one after the other (Options::trajectory): a Tracker without a
// deadline, or, for what it does not follow well, a Solver that remembers earlier answers.
#ifndef MJCF_PDG_SRC_TRACK_FRAME_SOLVER_H_
#define MJCF_PDG_SRC_TRACK_FRAME_SOLVER_H_

#include <memory>
#include <vector>

#include "mjcf_pdg/pdg.h"
#include "track/tracker_core.h"

namespace mjcf_pdg {

struct Frame {
  std::vector<double> q;  // nq
  MocapPoses mocap = {};
};

// One per thread.
class FrameSolver {
 public:
  // `searches`: looks for better optima than the one that is followed. Throws Error as Solver does.
  FrameSolver(const Scene& scene, const Options& options, bool searches = true);

  // Solves the next frame. Throws Error for a bad configuration.
  Status Solve(const Frame& frame, Result& result);
  bool follows() const { return tracker_ != nullptr; }

 private:
  std::unique_ptr<Solver> solver_;        // the one or
  std::unique_ptr<TrackerCore> tracker_;  // the other
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_TRACK_FRAME_SOLVER_H_
