// Events from a file instead of a hand: `view --script`. One a line, # begins a comment.
//
//   frames N                  N frames pass, each a 60th of a second
//   key NAME                  a key is pressed (input.h: ParseKey)
//   row NAME                  a row is shown, by its label
//   joint NAME VALUE          a slider is moved [rad or m]
//   drag BODY DX DY DZ N      a body is moved so far within N frames [m, world axes]
//   camera AZIMUTH ELEVATION DISTANCE    the camera turns about where it looks [degrees, m]
//   solve                     a whole solve, of which `key left` and `key right` step through
//   step N                    shows iteration N of it, from 0; -1 is the last one
//   screenshot FILE.png       after the next frame
#ifndef MJCF_PDG_APPS_VIEW_SCRIPT_H_
#define MJCF_PDG_APPS_VIEW_SCRIPT_H_

#include <mujoco/mujoco.h>

#include <array>
#include <string>
#include <vector>

#include "apps/view/input.h"

namespace mjcf_pdg::app {

struct ScriptEvent {
  enum class Kind { kFrames, kKey, kRow, kJoint, kDrag, kCamera, kSolve, kStep, kScreenshot };
  Kind kind = Kind::kFrames;
  int frames = 0;  // how many pass with this event; the step
  int id = -1;     // of the joint or body in the model
  KeyPress key;
  std::string text;                    // the row, the file
  std::array<double, 3> numbers = {};  // value; displacement; azimuth, elevation, distance
};

// The events of a script. Throws Error, which begins with `name` and the line's number, for one
// that is not understood and for unknown names of joints (hinges and slides) and bodies.
std::vector<ScriptEvent> ParseScript(const std::string& text, const std::string& name,
                                     const mjModel& model);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_VIEW_SCRIPT_H_
