#include "apps/png_writer.h"

#include <png.h>

#include <cstdio>
#include <stdexcept>
#include <string>

namespace mjcf_pdg::app {

void WritePng(const RgbImage& image, const std::string& path) {
  png_image png = {};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_RGB;
  if (!png_image_write_to_file(&png, path.c_str(), 0, image.rgb.data(), 3 * image.width, nullptr)) {
    std::remove(path.c_str());
    throw std::runtime_error("cannot write " + path + ": " + png.message);
  }
}

}  // namespace mjcf_pdg::app
