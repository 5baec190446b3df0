// A picture in memory, and what is drawn on it in its own plane: rings and outlines.
#ifndef MJCF_PDG_APPS_PICTURE_IMAGE_H_
#define MJCF_PDG_APPS_PICTURE_IMAGE_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace mjcf_pdg::app {

using Color = std::array<std::uint8_t, 3>;

// Pixels of three bytes (red, green, blue), the lowest line first, as OpenGL has them.
struct Image {
  Image(int image_width, int image_height)
      : width(image_width),
        height(image_height),
        rgb(std::size_t{3} * static_cast<std::size_t>(image_width) * image_height) {}
  std::uint8_t* Pixel(int x, int y) { return &rgb[3 * (static_cast<std::size_t>(y) * width + x)]; }

  int width, height;  // [pixels]
  std::vector<std::uint8_t> rgb;
};

// Draws a black ring with a white edge on both sides around the pixel (x, y), which may lie outside
// of the image. On any background one of the two is seen.
void DrawRing(Image& image, double x, double y, double radius);

// Draws the outline of a set of pixels, given by lines as in Image (true: inside), three pixels
// wide in `color` between white edges.
void DrawOutline(Image& image, const std::vector<bool>& inside, Color color);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_PICTURE_IMAGE_H_
