// What is shown of a motion: a repair, the frames of a trajectory, a path.
#ifndef MJCF_PDG_APPS_PICTURE_MOTION_SHOTS_H_
#define MJCF_PDG_APPS_PICTURE_MOTION_SHOTS_H_

#include <vector>

#include "apps/input/configurations.h"
#include "apps/picture/animation.h"
#include "mjcf_pdg/pdg.h"

namespace mjcf_pdg::app {

// From the configuration to its answer, straight: at a constant rate, quaternions the short way.
// What overlapped is blue where the solver says that the configuration is free, else orange. What
// was free already is shown once. Leaves the row's mocap bodies in the solver.
Shot RepairShot(const Scene& scene, Solver& solver, const Configuration& row, const Result& result);

// The frames as they were, on the left, and as they became; of many some, evenly. At least one.
Shot TrajectoryShot(const std::vector<Configuration>& rows, const std::vector<Result>& results);

// Along the path in equal steps of √σ. What moves is blue.
Shot PathShot(const Scene& scene, const Configuration& start,
              const std::vector<std::vector<double>>& path);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_PICTURE_MOTION_SHOTS_H_
