// Pictures of a penetrating configuration next to its repaired one, drawn without a display.
#ifndef MJCF_PDG_APPS_PICTURE_RENDER_H_
#define MJCF_PDG_APPS_PICTURE_RENDER_H_

#include <mujoco/mujoco.h>

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "apps/picture/stage.h"

namespace mjcf_pdg::app {

// One of the two pictures of a pair.
struct RenderSide {
  Pose pose;
  bool free = false;  // The guilty geoms are drawn in blue, else in orange.
  std::string text;   // Drawn beside the title.
  std::vector<std::array<double, 3>> contacts;  // Marked with rings; world frame [m].
};

// One pair of pictures. The sizes and ids must fit the model; they are not checked.
struct RenderRow {
  std::string title;  // Drawn in both pictures; characters outside ASCII become '?'.
  RenderSide before, after;
  std::vector<int> guilty_geoms;  // Ids of the geoms that overlap before.
};

inline constexpr std::size_t kRowsPerPage = 24;  // Makes 15 million pixels.

// Writes PNG files, each a contact sheet of at most kRowsPerPage rows, a pair of pictures for each:
// on the left the scene before, on the right after, both seen from the same place. viewpoint.h says
// which camera is used, stage.h which geoms are shown and how. `png_paths` has a name for each page
// that the rows fill.
//
// Throws std::runtime_error with a one-line reason (no rows, no EGL, no OpenGL context, unwritable
// file). An error inside MuJoCo throws whatever the installed mju_setLogHandler throws. `model` is
// not modified. Only one call at a time is allowed, because MuJoCo's OpenGL entry points are
// global.
void RenderBeforeAfter(const mjModel* model, const std::vector<RenderRow>& rows,
                       const std::vector<std::string>& png_paths);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_PICTURE_RENDER_H_
