#include "apps/picture/render.h"

#include <algorithm>
#include <cstddef>
#include <stdexcept>

#include "apps/picture/contact_sheet.h"
#include "apps/picture/stage.h"
#include "apps/picture/viewpoint.h"

namespace mjcf_pdg::app {

int RenderBeforeAfter(const mjModel* model, const std::vector<RenderRow>& rows,
                      const std::string& png_path) {
  if (rows.empty()) throw std::runtime_error("cannot render: there is no configuration to draw");
  const int num_rows = static_cast<int>(std::min<std::size_t>(rows.size(), kMaxRenderRows));
  ContactSheet sheet(num_rows, Stage::kWidth, Stage::kHeight);
  Stage stage(model);
  for (int i = 0; i < num_rows; ++i) {
    const RenderRow& row = rows[i];
    stage.SetGuilty(row.guilty_geoms);
    mjvCamera camera = ChooseCamera(stage, row.qpos_in, row.qpos);
    const char* const when = row.qpos.empty() ? "before (no after)" : "before";
    sheet.Paste(i, 0, stage.Draw(camera, Tint::kRed, row.title, when));
    if (row.qpos.empty()) continue;
    camera.type = mjCAMERA_USER;  // Stays where it is, even if it rides on a body.
    stage.SetPose(row.qpos);
    sheet.Paste(i, 1, stage.Draw(camera, Tint::kGreen, row.title, "after"));
  }
  sheet.Write(png_path);
  return num_rows;
}

}  // namespace mjcf_pdg::app
