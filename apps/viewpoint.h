// From where a pair of poses is looked at.
#ifndef MJCF_PDG_APPS_VIEWPOINT_H_
#define MJCF_PDG_APPS_VIEWPOINT_H_

#include <mujoco/mujoco.h>

#include <vector>

#include "apps/stage.h"

namespace mjcf_pdg::app {

// A camera for both poses: the model's camera named "view", if the guilty geoms fill 3 % of its
// picture at `qpos_in`. Else a free one which frames the kinematic trees of the guilty geoms, and
// comes closer if they are tiny: it looks as "view" does or, if there is none or it sees nothing of
// them, from where they and their overlaps are seen best.
// Leaves the stage at `qpos_in`. `qpos` may be empty.
mjvCamera ChooseCamera(Stage& stage, const std::vector<double>& qpos_in,
                       const std::vector<double>& qpos);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_VIEWPOINT_H_
