#include "apps/picture/render.h"

#include <algorithm>
#include <stdexcept>

#include "apps/picture/contact_sheet.h"
#include "apps/picture/stage.h"
#include "apps/picture/viewpoint.h"

namespace mjcf_pdg::app {
namespace {

Image Draw(Stage& stage, mjvCamera& camera, const std::string& title, const RenderSide& side) {
  return stage.Draw(camera, side.free ? Tint::kBlue : Tint::kOrange, side.contacts, title,
                    side.text);
}

}  // namespace

void RenderBeforeAfter(const mjModel* model, const std::vector<RenderRow>& rows,
                       const std::vector<std::string>& png_paths) {
  if (rows.empty()) throw std::runtime_error("cannot render: there is no configuration to draw");
  Stage stage(model);
  for (std::size_t page = 0; page < png_paths.size(); ++page) {
    const std::size_t first = page * kRowsPerPage;
    const std::size_t count = std::min(rows.size() - first, kRowsPerPage);
    ContactSheet sheet(static_cast<int>(count), Stage::kWidth, Stage::kHeight);
    for (std::size_t i = 0; i < count; ++i) {
      const RenderRow& row = rows[first + i];
      stage.SetGuilty(row.guilty_geoms);
      mjvCamera camera = ChooseCamera(stage, {row.before.pose, row.after.pose});
      stage.FindCovered(camera);
      sheet.Paste(static_cast<int>(i), 0, Draw(stage, camera, row.title, row.before));
      camera.type = mjCAMERA_USER;  // Stays where it is, even if it rides on a body.
      stage.SetPose(row.after.pose);
      stage.FindCovered(camera);
      sheet.Paste(static_cast<int>(i), 1, Draw(stage, camera, row.title, row.after));
    }
    sheet.Write(png_paths[page]);
  }
}

}  // namespace mjcf_pdg::app
