#include "apps/png_writer.h"

#include <png.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <system_error>

namespace mjcf_pdg::app {

void WritePng(const RgbImage& image, const std::string& path) {
  // A device or a pipe must not be replaced by a file, and a link must go on pointing to its file.
  std::error_code error;
  const bool exists = std::filesystem::exists(path, error);
  if (exists && !std::filesystem::is_regular_file(path, error)) {
    throw std::runtime_error("cannot write " + path + ": not a regular file");
  }
  const std::string target = exists ? std::filesystem::canonical(path, error).string() : path;

  png_image png;
  std::memset(&png, 0, sizeof(png));
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_RGB;

  // Next to the target, since a rename is atomic only within one file system.
  const std::string part = target + ".part" + std::to_string(::getpid());
  if (!png_image_write_to_file(&png, part.c_str(), 0, image.rgb.data(), 3 * image.width, nullptr)) {
    const std::string reason = png.message;
    std::remove(part.c_str());
    throw std::runtime_error("cannot write " + path + ": " + reason);
  }
  if (std::rename(part.c_str(), target.c_str()) != 0) {
    const std::string reason = std::strerror(errno);
    std::remove(part.c_str());
    throw std::runtime_error("cannot write " + path + ": " + reason);
  }
}

}  // namespace mjcf_pdg::app
