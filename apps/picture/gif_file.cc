#include "apps/picture/gif_file.h"

#include <fcntl.h>
#include <gif_lib.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <memory>
#include <stdexcept>

namespace mjcf_pdg::app {
namespace {

constexpr int kColors = 255;  // and one index for what stays as it is
constexpr int kStays = kColors;
constexpr std::size_t kMostSamples = 1000000;  // pixels that the palette is made for
constexpr int kBits = 6;  // of each channel that decide a pixel's colour in the palette

using Indices = std::vector<GifByteType>;

// Neighbouring pixels are made a little darker and brighter by turns, which hides the steps between
// the colours of the palette. The same pixel always is, so that what stands still stays the same.
int Rise(int x, int y) {
  constexpr std::array<std::array<int, 4>, 4> kBayer = {
      {{0, 8, 2, 10}, {12, 4, 14, 6}, {3, 11, 1, 9}, {15, 7, 13, 5}}};
  return kBayer[static_cast<std::size_t>(y % 4)][static_cast<std::size_t>(x % 4)] - 8;
}

// The colours that suit all frames best, and which of them each pixel gets.
class Palette {
 public:
  explicit Palette(const std::vector<GifFrame>& frames) : nearest_(1 << (3 * kBits), -1) {
    const std::size_t all = frames.size() * frames.front().image.rgb.size() / 3;
    const std::size_t step = all / kMostSamples + 1;
    std::array<Indices, 3> samples;
    for (std::size_t pixel = 0; pixel < all; pixel += step) {
      const std::vector<std::uint8_t>& rgb = frames[pixel / (all / frames.size())].image.rgb;
      const std::size_t at = 3 * (pixel % (all / frames.size()));
      for (std::size_t k = 0; k < 3; ++k) samples[k].push_back(rgb[at + k]);
    }
    Indices chosen(samples[0].size());
    int colors = kColors;
    if (GifQuantizeBuffer(static_cast<unsigned>(chosen.size()), 1, &colors, samples[0].data(),
                          samples[1].data(), samples[2].data(), chosen.data(),
                          colors_.data()) != GIF_OK) {
      throw std::runtime_error("no palette");
    }
    used_ = colors;
  }

  // `rise` is added to each channel first.
  GifByteType Index(const std::uint8_t* given, int rise) {
    std::array<std::uint8_t, 3> rgb;
    for (std::size_t k = 0; k < 3; ++k) {
      rgb[k] = static_cast<std::uint8_t>(std::clamp(given[k] + rise, 0, 255));
    }
    const auto part = [&rgb](std::size_t k) { return rgb[k] >> (8 - kBits); };
    int& known =
        nearest_[static_cast<std::size_t>((part(0) << 2 * kBits | part(1) << kBits) | part(2))];
    if (known < 0) known = Nearest(rgb.data());
    return static_cast<GifByteType>(known);
  }

  const GifColorType* colors() const { return colors_.data(); }

 private:
  int Nearest(const std::uint8_t* rgb) const {
    int nearest = 0, least = std::numeric_limits<int>::max();
    for (int i = 0; i < used_; ++i) {
      const GifColorType& color = colors_[static_cast<std::size_t>(i)];
      const int red = rgb[0] - color.Red, green = rgb[1] - color.Green, blue = rgb[2] - color.Blue;
      const int distance = red * red + green * green + blue * blue;
      if (distance < least) nearest = i, least = distance;
    }
    return nearest;
  }

  std::array<GifColorType, 256> colors_ = {};
  int used_ = 0;
  std::vector<int> nearest_;  // by the first bits of a colour; -1: not known yet
};

// An open file. giflib says what failed by a number.
class GifFile {
 public:
  explicit GifFile(const std::string& path) {
    // By its name giflib would make a file that only its owner can read.
    const int descriptor = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
    if (descriptor < 0) throw std::runtime_error(path + ": cannot be written");
    int error = 0;
    file_ = EGifOpenFileHandle(descriptor, &error);
    if (!file_) Fail(error);
    EGifSetGifVersion(file_, true);
  }
  ~GifFile() {
    if (file_) EGifCloseFile(file_, nullptr);
  }
  GifFile(const GifFile&) = delete;
  GifFile& operator=(const GifFile&) = delete;

  void Begin(int width, int height, const GifColorType* colors) {
    const std::unique_ptr<ColorMapObject, void (*)(ColorMapObject*)> map(
        GifMakeMapObject(256, colors), GifFreeMapObject);
    Check(map ? EGifPutScreenDesc(file_, width, height, 8, 0, map.get()) : GIF_ERROR);
    constexpr std::array<GifByteType, 3> kForever = {1, 0, 0};
    Check(EGifPutExtensionLeader(file_, APPLICATION_EXT_FUNC_CODE));
    Check(EGifPutExtensionBlock(file_, 11, "NETSCAPE2.0"));
    Check(EGifPutExtensionBlock(file_, kForever.size(), kForever.data()));
    Check(EGifPutExtensionTrailer(file_));
  }

  void Add(int width, int height, Indices& pixels, int hundredths) {
    const GraphicsControlBlock control = {DISPOSE_DO_NOT, false, hundredths, kStays};
    std::array<GifByteType, 4> bytes;
    EGifGCBToExtension(&control, bytes.data());
    Check(EGifPutExtension(file_, GRAPHICS_EXT_FUNC_CODE, bytes.size(), bytes.data()));
    Check(EGifPutImageDesc(file_, 0, 0, width, height, false, nullptr));
    Check(EGifPutLine(file_, pixels.data(), static_cast<int>(pixels.size())));
  }

  void End() {
    int error = 0;
    const int closed = EGifCloseFile(file_, &error);
    file_ = nullptr;
    if (closed != GIF_OK) Fail(error);
  }

 private:
  [[noreturn]] static void Fail(int error) {
    const char* reason = GifErrorString(error);
    throw std::runtime_error(reason ? reason : "out of memory");
  }
  void Check(int code) const {
    if (code != GIF_OK) Fail(file_->Error);
  }

  GifFileType* file_ = nullptr;
};

void Write(const std::vector<GifFrame>& frames, const std::string& path) {
  const int width = frames.front().image.width, height = frames.front().image.height;
  Palette palette(frames);
  GifFile file(path);
  file.Begin(width, height, palette.colors());
  Indices shown(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), kStays),
      changes;
  for (const GifFrame& frame : frames) {
    changes = shown;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        // GIF has the highest line first.
        const std::size_t from = static_cast<std::size_t>(height - 1 - y) * width + x;
        const std::size_t to = static_cast<std::size_t>(y) * width + x;
        const GifByteType index = palette.Index(&frame.image.rgb[3 * from], Rise(x, y));
        changes[to] = index == shown[to] ? kStays : index;
        shown[to] = index;
      }
    }
    file.Add(width, height, changes, static_cast<int>(std::lround(100 * frame.seconds)));
  }
  file.End();
}

}  // namespace

void WriteGif(const std::vector<GifFrame>& frames, const std::string& path) {
  try {
    Write(frames, path);
  } catch (const std::runtime_error& e) {
    std::remove(path.c_str());
    throw std::runtime_error("cannot write " + path + ": " + e.what());
  }
}

}  // namespace mjcf_pdg::app
