// Pictures of a penetrating configuration next to its repaired one, drawn without a display.
#ifndef MJCF_PDG_APPS_RENDER_H_
#define MJCF_PDG_APPS_RENDER_H_

#include <mujoco/mujoco.h>

#include <string>
#include <vector>

namespace mjcf_pdg::app {

struct RenderRow {
  std::string title;              // Drawn in both pictures; characters outside ASCII become '?'.
  std::vector<double> qpos_in;    // The penetrating configuration.
  std::vector<double> qpos;       // The repaired one; empty if there is none.
  std::vector<int> guilty_geoms;  // Geoms that overlap at qpos_in.
};

// Writes one PNG, a contact sheet with a pair of pictures per row: the scene at qpos_in with the
// guilty geoms red on the left, and at qpos with the same geoms green on the right, both seen from
// the same place. Several pairs share a line when there are many rows.
//
// Point of view: the model's camera named "view" if it has one; else its first camera which does
// not ride on a moving body and shows the guilty geoms well; else a free camera which frames the
// kinematic trees of the guilty geoms, from where these and their overlaps are seen best.
// Shown are geom groups 0 to 2, as in MuJoCo's viewer, and besides: the guilty geoms whatever their
// group (the rest of such a body is then drawn as glass), and the colliding geoms of bodies which
// would show nothing otherwise.
//
// Returns the number of rows drawn: all of them, or the first kMaxRenderRows.
// Throws std::runtime_error with a one-line reason (no EGL, no OpenGL context, unwritable file, a
// row which does not fit the model). An error inside MuJoCo leaves as whatever the installed
// mju_setLogHandler throws. `model` is not modified; the file is written whole or not at all.
// Calls from several threads take turns.
int RenderBeforeAfter(const mjModel* model, const std::vector<RenderRow>& rows,
                      const std::string& png_path);

inline constexpr int kMaxRenderRows = 64;  // 39 million pixels.

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_RENDER_H_
