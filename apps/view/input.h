// What keys and the mouse mean, as in MuJoCo's `simulate`. Pure functions: no window, no state.
#ifndef MJCF_PDG_APPS_VIEW_INPUT_H_
#define MJCF_PDG_APPS_VIEW_INPUT_H_

#include <mujoco/mujoco.h>

#include <string>

namespace mjcf_pdg::app {

// Keys that print nothing. The others are the character that they print without Shift, letters as
// capitals.
enum Key : int {
  kKeyEscape = 256,
  kKeyEnter,
  kKeyTab,
  kKeyBackspace,
  kKeyRight,
  kKeyLeft,
  kKeyDown,
  kKeyUp,
  kKeyPageUp,
  kKeyF1,
  kKeyF5,
  kKeyF6,
  kKeyF7,
};

struct KeyPress {
  int key = 0;
  bool ctrl = false, shift = false;
};

enum class Action {
  kNone,
  kPlayPause,       // Space
  kStepBack,        // left
  kStepForward,     // right
  kPreviousRow,     // up
  kNextRow,         // down
  kReset,           // Backspace
  kSolve,           // Enter
  kFreeCamera,      // Escape
  kNextCamera,      // ]
  kPreviousCamera,  // [
  kAlign,           // Ctrl+A
  kSelectParent,    // Page Up
  kToggleLeft,      // Tab
  kToggleRight,     // Shift+Tab
  kHelp,            // F1
  kFullScreen,      // F5
  kNextFrame,       // F6
  kNextLabel,       // F7
  kCopyQpos,        // Ctrl+C; index 1 (Shift): with all digits
  kCopyRepaired,    // Ctrl+R; index 1 (Shift): with all digits
  kPaste,           // Ctrl+V
  kSave,            // Ctrl+S
  kScreenshot,      // Ctrl+P
  kQuit,            // Ctrl+Q
  kGeomGroup,       // 0 to 5, the index
  kSiteGroup,       // the same with Shift
  kVisualFlag,      // index: mjtVisFlag
  kRenderFlag,      // index: mjtRndFlag
};

struct KeyAction {
  Action action = Action::kNone;
  int index = 0;
};

// The letters of the flags are those of MuJoCo's own tables, mjVISSTRING and mjRNDSTRING.
KeyAction ActionOf(const KeyPress& press);

// A key by its name, as in "space", "f1", "c", "ctrl+shift+c". Throws Error for an unknown one.
KeyPress ParseKey(const std::string& name);

// The buttons that are held while the mouse moves.
struct Held {
  bool left = false, right = false, middle = false;
  bool ctrl = false, shift = false;
};

// How the motion moves the camera or the body that is dragged.
mjtMouse MotionOf(const Held& held);

// What pressing a button with Ctrl does to the selected body: mjPERT_TRANSLATE (right button),
// mjPERT_ROTATE (left), or 0.
int DragOf(const Held& held);

enum class DoubleClick { kNone, kSelect, kLookAt, kTrack };
DoubleClick DoubleClickOf(const Held& held);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_VIEW_INPUT_H_
