// Pictures of a penetrating configuration next to its repaired one, drawn without a display.
#ifndef MJCF_PDG_APPS_PICTURE_RENDER_H_
#define MJCF_PDG_APPS_PICTURE_RENDER_H_

#include <mujoco/mujoco.h>

#include <string>
#include <vector>

namespace mjcf_pdg::app {

// One pair of pictures. The sizes and ids must fit the model; they are not checked.
struct RenderRow {
  std::string title;              // Drawn in both pictures; characters outside ASCII become '?'.
  std::vector<double> qpos_in;    // The penetrating configuration.
  std::vector<double> qpos;       // The repaired one; empty if there is none.
  std::vector<int> guilty_geoms;  // Ids of the geoms that overlap at qpos_in.
};

// Writes one PNG, a contact sheet with a pair of pictures per row: on the left the scene at qpos_in
// with the guilty geoms red, on the right the scene at qpos with the same geoms green, both seen
// from the same place. If there are many rows, several pairs share a line. viewpoint.h says which
// camera is used, stage.h which geoms are shown.
//
// Returns the number of rows drawn: all of them, or the first kMaxRenderRows. Throws
// std::runtime_error with a one-line reason (no rows, no EGL, no OpenGL context, unwritable file).
// An error inside MuJoCo throws whatever the installed mju_setLogHandler throws. `model` is not
// modified. Only one call at a time is allowed, because MuJoCo's OpenGL entry points are global.
int RenderBeforeAfter(const mjModel* model, const std::vector<RenderRow>& rows,
                      const std::string& png_path);

inline constexpr int kMaxRenderRows = 64;  // Makes 39 million pixels.

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_PICTURE_RENDER_H_
