#include "apps/picture/image.h"

#include <algorithm>
#include <cmath>

namespace mjcf_pdg::app {
namespace {

constexpr Color kWhite = {255, 255, 255};
constexpr Color kBlack = {0, 0, 0};

void Blend(Image& image, int x, int y, Color color, double weight) {
  std::uint8_t* const pixel = image.Pixel(x, y);
  for (int k = 0; k < 3; ++k) {
    pixel[k] = static_cast<std::uint8_t>(std::lround(pixel[k] + weight * (color[k] - pixel[k])));
  }
}

// 1 up to `half_width` from a line, 0 from one pixel farther on.
double Coverage(double distance, double half_width) {
  return std::clamp(half_width + 0.5 - distance, 0.0, 1.0);
}

}  // namespace

void DrawRing(Image& image, double x, double y, double radius) {
  const double reach = radius + 4;
  const int left = static_cast<int>(std::max(0.0, std::floor(x - reach)));
  const int right = static_cast<int>(std::min(image.width - 1.0, std::ceil(x + reach)));
  const int low = static_cast<int>(std::max(0.0, std::floor(y - reach)));
  const int high = static_cast<int>(std::min(image.height - 1.0, std::ceil(y + reach)));
  for (int v = low; v <= high; ++v) {
    for (int u = left; u <= right; ++u) {
      const double distance = std::abs(std::hypot(u - x, v - y) - radius);
      Blend(image, u, v, kWhite, Coverage(distance, 2.5));
      Blend(image, u, v, kBlack, Coverage(distance, 1.25));
    }
  }
}

void DrawOutline(Image& image, const std::vector<bool>& inside, Color color) {
  const auto is_inside = [&](int x, int y) {
    return x >= 0 && y >= 0 && x < image.width && y < image.height &&
           inside[static_cast<std::size_t>(y) * image.width + x];
  };
  // The distance in pixels to the nearest pixel of the other kind, up to 3; 9 if there is none.
  const auto to_border = [&](int x, int y) {
    const bool here = is_inside(x, y);
    for (int reach = 1; reach <= 3; ++reach) {
      for (int dy = -reach; dy <= reach; ++dy) {
        for (int dx = -reach; dx <= reach; ++dx) {
          if (dx * dx + dy * dy <= reach * reach && is_inside(x + dx, y + dy) != here) return reach;
        }
      }
    }
    return 9;
  };
  // The outline is no farther from the set than three pixels.
  int left = image.width, right = -1, low = image.height, high = -1;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      if (!is_inside(x, y)) continue;
      left = std::min(left, x), right = std::max(right, x);
      low = std::min(low, y), high = std::max(high, y);
    }
  }
  for (int y = std::max(low - 3, 0); y <= std::min(high + 3, image.height - 1); ++y) {
    for (int x = std::max(left - 3, 0); x <= std::min(right + 3, image.width - 1); ++x) {
      const int distance = to_border(x, y) - (is_inside(x, y) ? 0 : 1);
      if (distance <= 1) {
        Blend(image, x, y, color, 1);
      } else if (distance <= 2) {
        Blend(image, x, y, kWhite, 0.8);
      }
    }
  }
}

}  // namespace mjcf_pdg::app
