// Chooses the camera for the pictures of a pair of configurations.
#ifndef MJCF_PDG_APPS_PICTURE_VIEWPOINT_H_
#define MJCF_PDG_APPS_PICTURE_VIEWPOINT_H_

#include <mujoco/mujoco.h>

#include <vector>

#include "apps/picture/stage.h"

namespace mjcf_pdg::app {

// Returns a camera for both configurations. It is the model's camera named
// "view" if the guilty geoms (Stage::SetGuilty) fill 3 % of its picture at `qpos_in`. Otherwise it
// is a free camera that frames the kinematic trees of the guilty geoms, and comes closer if these
// are tiny in the picture. It looks in the direction of "view", or, if there is no such camera or
// the guilty geoms cannot be seen so, in the direction from which they and their overlaps are seen
// best. Leaves the stage at `qpos_in`.
mjvCamera ChooseCamera(Stage& stage, const std::vector<double>& qpos_in,
                       const std::vector<double>& qpos);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_PICTURE_VIEWPOINT_H_
