#include "apps/picture/contact_sheet.h"

#include <png.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <stdexcept>

namespace mjcf_pdg::app {
namespace {

constexpr int kSeam = 2;  // Pixels between the pictures of a pair.
constexpr int kGap = 8;   // Pixels between pairs, and around the sheet.
constexpr std::uint8_t kGray = 235;

}  // namespace

ContactSheet::ContactSheet(int num_pairs, int picture_width, int picture_height)
    : picture_width_(picture_width),
      picture_height_(picture_height),
      columns_(std::max(1, static_cast<int>(std::lround(std::sqrt(num_pairs / 2.0))))),
      width_(columns_ * (2 * picture_width + kSeam + kGap) + kGap),
      height_((num_pairs + columns_ - 1) / columns_ * (picture_height + kGap) + kGap),
      rgb_(std::size_t{3} * width_ * height_, kGray) {}

void ContactSheet::Paste(int pair, int side, const Image& picture) {
  const int left = kGap + pair % columns_ * (2 * picture_width_ + kSeam + kGap) +
                   side * (picture_width_ + kSeam);
  const int bottom = (pair / columns_ + 1) * (picture_height_ + kGap) - 1;
  const std::size_t line_size = std::size_t{3} * picture_width_;
  for (int y = 0; y < picture_height_; ++y) {
    std::copy_n(&picture.rgb[line_size * y], line_size,
                &rgb_[3 * (static_cast<std::size_t>(bottom - y) * width_ + left)]);
  }
}

void ContactSheet::Write(const std::string& png_path) const {
  png_image png = {};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(width_);
  png.height = static_cast<png_uint_32>(height_);
  png.format = PNG_FORMAT_RGB;
  if (png_image_write_to_file(&png, png_path.c_str(), 0, rgb_.data(), 0, nullptr)) return;
  std::remove(png_path.c_str());
  throw std::runtime_error("cannot write " + png_path + ": " + png.message);
}

}  // namespace mjcf_pdg::app
