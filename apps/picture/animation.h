// Moving pictures of configurations, drawn without a display as render.h draws pairs.
#ifndef MJCF_PDG_APPS_PICTURE_ANIMATION_H_
#define MJCF_PDG_APPS_PICTURE_ANIMATION_H_

#include <mujoco/mujoco.h>

#include <string>
#include <vector>

#include "apps/picture/render.h"

namespace mjcf_pdg::app {

struct Moment {
  std::vector<RenderSide> sides;  // one picture, or two at half the size, left and right
  double seconds = 0.05;          // for so long it is shown
};

// What one camera that stands still sees. All of an animation's moments have as many sides.
struct Shot {
  std::string title;
  std::vector<int> guilty_geoms;  // drawn in colour (RenderSide::free says in which)
  std::vector<Pose> framed;       // the camera is chosen for these
  std::vector<Moment> moments;
};

// Writes a GIF that shows the shots one after the other. Throws as RenderBeforeAfter.
void RenderAnimation(const mjModel* model, const std::vector<Shot>& shots,
                     const std::string& gif_path);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_PICTURE_ANIMATION_H_
