// The window of `view`. It is a library of its own (mjcf_pdg_view.so, made of apps/view/window),
// which is loaded when a window is asked for and calls the program back: so the program starts on
// machines without GLFW, X11 and OpenGL.
#ifndef MJCF_PDG_APPS_VIEW_WINDOW_H_
#define MJCF_PDG_APPS_VIEW_WINDOW_H_

#include <string>

#include "apps/view/viewer.h"

namespace mjcf_pdg::app {

struct WindowOptions {
  std::string title;
  int width = 1280, height = 800;  // [pixels]
};

// Shows the viewer until it is done or the window is closed. Throws Error if there is no display or
// no OpenGL.
using ShowWindowFunction = void(Viewer& viewer, const WindowOptions& options);

// The name of that function in the library.
inline constexpr char kShowWindow[] = "MjcfPdgShowWindow";

}  // namespace mjcf_pdg::app

// It has C linkage for its name alone.
extern "C" void MjcfPdgShowWindow(mjcf_pdg::app::Viewer& viewer,
                                  const mjcf_pdg::app::WindowOptions& options);

#endif  // MJCF_PDG_APPS_VIEW_WINDOW_H_
