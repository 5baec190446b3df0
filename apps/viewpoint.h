// From where a pair of poses is looked at.
#ifndef MJCF_PDG_APPS_VIEWPOINT_H_
#define MJCF_PDG_APPS_VIEWPOINT_H_

#include <mujoco/mujoco.h>

#include <vector>

#include "apps/stage.h"

namespace mjcf_pdg::app {

// A camera for both poses which shows the guilty geoms and where they overlap at `qpos_in`:
// - the model's camera named "view", if they fill a few percent of its picture;
// - else the model's first camera that does not ride on a moving body and shows them well;
// - else a free camera from the side where they are seen best. It frames the kinematic trees of
//   the guilty geoms, and comes closer as long as these look small.
// Leaves the stage at `qpos_in`. `qpos` may be empty.
mjvCamera ChooseCamera(Stage& stage, const std::vector<double>& qpos_in,
                       const std::vector<double>& qpos);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_VIEWPOINT_H_
