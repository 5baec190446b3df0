// Writing an RGB image as a PNG file.
#ifndef MJCF_PDG_APPS_PNG_WRITER_H_
#define MJCF_PDG_APPS_PNG_WRITER_H_

#include <cstdint>
#include <string>
#include <vector>

namespace mjcf_pdg::app {

// Three bytes (red, green, blue) per pixel, row by row from the top left corner.
struct RgbImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;
};

// Throws std::runtime_error with a one-line reason, and then leaves no file.
void WritePng(const RgbImage& image, const std::string& path);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_PNG_WRITER_H_
