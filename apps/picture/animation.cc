#include "apps/picture/animation.h"

#include <cstddef>
#include <utility>

#include "apps/picture/gif_file.h"
#include "apps/picture/stage.h"
#include "apps/picture/viewpoint.h"

namespace mjcf_pdg::app {
namespace {

// Puts `picture` at half its size into `image`, from column `left` on.
void PasteHalf(const Image& picture, int left, Image& image) {
  const std::size_t line = std::size_t{3} * static_cast<std::size_t>(picture.width);
  for (int y = 0; y < picture.height / 2; ++y) {
    const std::uint8_t* const low = &picture.rgb[2 * static_cast<std::size_t>(y) * line];
    std::uint8_t* const to = image.Pixel(left, y);
    for (int i = 0; i < 3 * (picture.width / 2); ++i) {
      const int from = 6 * (i / 3) + i % 3;
      const int sum = low[from] + low[from + 3] + low[line + from] + low[line + from + 3];
      to[i] = static_cast<std::uint8_t>((sum + 2) / 4);
    }
  }
}

Image DrawSide(Stage& stage, mjvCamera& camera, const std::string& title, const RenderSide& side) {
  stage.SetPose(side.pose);
  return stage.Draw(camera, side.free ? Tint::kBlue : Tint::kOrange, side.contacts, title,
                    side.text);
}

Image DrawMoment(Stage& stage, mjvCamera& camera, const std::string& title, const Moment& moment) {
  if (moment.sides.size() == 1) return DrawSide(stage, camera, title, moment.sides.front());
  Image image(Stage::kWidth, Stage::kHeight / 2);
  for (std::size_t side = 0; side < moment.sides.size(); ++side) {
    PasteHalf(DrawSide(stage, camera, title, moment.sides[side]),
              static_cast<int>(side) * Stage::kWidth / 2, image);
  }
  return image;
}

}  // namespace

void RenderAnimation(const mjModel* model, const std::vector<Shot>& shots,
                     const std::string& gif_path) {
  std::vector<GifFrame> frames;
  Stage stage(model);
  for (const Shot& shot : shots) {
    stage.SetGuilty(shot.guilty_geoms);
    mjvCamera camera = ChooseCamera(stage, shot.framed);
    stage.FindCovered(camera);
    for (const Moment& moment : shot.moments) {
      frames.push_back({DrawMoment(stage, camera, shot.title, moment), moment.seconds});
      camera.type = mjCAMERA_USER;  // stays where it is, even if it rides on a body
    }
  }
  WriteGif(frames, gif_path);
}

}  // namespace mjcf_pdg::app
