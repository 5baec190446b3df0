#include "apps/contact_sheet.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace mjcf_pdg::app {
namespace {

constexpr int kSeam = 2;  // Pixels between the pictures of a pair.
constexpr int kGap = 8;   // Pixels between pairs, and around the sheet.
constexpr std::uint8_t kGray = 235;

}  // namespace

ContactSheet::ContactSheet(int num_pairs, int picture_width, int picture_height)
    : picture_width_(picture_width),
      picture_height_(picture_height),
      columns_(std::max(1, static_cast<int>(std::lround(std::sqrt(num_pairs / 2.0))))) {
  const int lines = (num_pairs + columns_ - 1) / columns_;
  image_.width = columns_ * (2 * picture_width + kSeam + kGap) + kGap;
  image_.height = lines * (picture_height + kGap) + kGap;
  image_.rgb.assign(std::size_t{3} * image_.width * image_.height, kGray);
}

void ContactSheet::Paste(int pair, Side side, const std::vector<std::uint8_t>& pixels) {
  const int left = kGap + pair % columns_ * (2 * picture_width_ + kSeam + kGap) +
                   (side == kRight ? picture_width_ + kSeam : 0);
  const int top = kGap + pair / columns_ * (picture_height_ + kGap);
  const std::size_t line_size = std::size_t{3} * picture_width_;
  for (int y = 0; y < picture_height_; ++y) {
    const std::uint8_t* const line = &pixels[line_size * (picture_height_ - 1 - y)];
    std::copy_n(line, line_size,
                &image_.rgb[3 * (static_cast<std::size_t>(top + y) * image_.width + left)]);
  }
}

}  // namespace mjcf_pdg::app
