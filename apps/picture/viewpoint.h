// Chooses the camera for pictures of one scene at several configurations.
#ifndef MJCF_PDG_APPS_PICTURE_VIEWPOINT_H_
#define MJCF_PDG_APPS_PICTURE_VIEWPOINT_H_

#include <mujoco/mujoco.h>

#include <vector>

#include "apps/picture/stage.h"

namespace mjcf_pdg::app {

// Returns a camera for all of the poses, at least one. It is the model's camera named
// "view" if the guilty geoms (Stage::SetGuilty) fill 3 % of its picture at the first. Otherwise it
// is a free camera that frames the kinematic trees of the guilty geoms, and comes closer if these
// are tiny in the picture. It looks in the direction of "view", or, if there is no such camera or
// the guilty geoms cannot be seen so, in the direction from which they and their overlaps are seen
// best. Leaves the stage at the first pose.
mjvCamera ChooseCamera(Stage& stage, const std::vector<Pose>& poses);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_PICTURE_VIEWPOINT_H_
