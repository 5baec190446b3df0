// The geoms of a model and the poses of its bodies, for a report.
#ifndef MJCF_PDG_APPS_HTML_SCENE_BLOCK_H_
#define MJCF_PDG_APPS_HTML_SCENE_BLOCK_H_

#include <mujoco/mujoco.h>

#include <string>
#include <vector>

#include "apps/input/configurations.h"
#include "mjcf_pdg/scene.h"

namespace mjcf_pdg::app {

// The scene as web/bodies.js draws it, packed. Each mesh is there once, its vertices rounded to
// 1/65535 of its size.
std::string SceneBlock(const mjModel& m);

// Appends the poses of all bodies at q (nq): position and quaternion (w, x, y, z). Mocap bodies are
// where `row` has them.
void AppendPoses(const mjModel& m, mjData* d, const Configuration& row,
                 const std::vector<double>& q, std::vector<float>& poses);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_HTML_SCENE_BLOCK_H_
