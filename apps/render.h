// Pictures of a penetrating configuration next to its repaired one, drawn without a display.
#ifndef MJCF_PDG_APPS_RENDER_H_
#define MJCF_PDG_APPS_RENDER_H_

#include <mujoco/mujoco.h>

#include <string>
#include <vector>

namespace mjcf_pdg::app {

// What the model has no place for (a wrong nq or geom) is the caller's mistake.
struct RenderRow {
  std::string title;              // Drawn in both pictures; characters outside ASCII become '?'.
  std::vector<double> qpos_in;    // The penetrating configuration.
  std::vector<double> qpos;       // The repaired one; empty if there is none.
  std::vector<int> guilty_geoms;  // Geoms that overlap at qpos_in.
};

// Writes one PNG, a contact sheet with a pair of pictures per row: the scene at qpos_in with the
// guilty geoms red on the left, and at qpos with the same geoms green on the right, both seen from
// the same place. Several pairs share a line when there are many rows. viewpoint.h tells from where
// they are seen, stage.h which geoms are shown.
//
// Returns the number of rows drawn: all of them, or the first kMaxRenderRows.
// Throws std::runtime_error with a one-line reason (no EGL, no OpenGL context, unwritable file). An
// error inside MuJoCo leaves as whatever the installed mju_setLogHandler throws. `model` is not
// modified. One call at a time: MuJoCo's OpenGL entry points are global.
int RenderBeforeAfter(const mjModel* model, const std::vector<RenderRow>& rows,
                      const std::string& png_path);

inline constexpr int kMaxRenderRows = 64;  // 39 million pixels.

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_RENDER_H_
