// What is written and clicked beside the picture, by Dear ImGui.
#ifndef MJCF_PDG_APPS_VIEW_WINDOW_PANELS_H_
#define MJCF_PDG_APPS_VIEW_WINDOW_PANELS_H_

#include <string>

#include "apps/view/viewer.h"

namespace mjcf_pdg::app {

inline constexpr float kPanelWidth = 330;  // of each side [pixels at scale 1]

class Panels {
 public:
  // Between ImGui::NewFrame and ImGui::Render. `scale`: of the display, 1 usually.
  void Draw(Viewer& viewer, float scale);

 private:
  void DrawRepair(Viewer& viewer);
  void DrawContacts(Viewer& viewer);
  void DrawSearch(Viewer& viewer);
  void DrawRows(Viewer& viewer);
  void DrawSave(Viewer& viewer);
  void DrawLook(Viewer& viewer);
  void DrawJoints(Viewer& viewer);
  void DrawHelp();

  std::string open_path_;
};

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_VIEW_WINDOW_PANELS_H_
