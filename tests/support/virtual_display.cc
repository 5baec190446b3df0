#include "tests/support/virtual_display.h"

#include <unistd.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>

namespace mjcf_pdg::test {
namespace {

bool InPath(const std::string& program) {
  const char* const path = std::getenv("PATH");
  std::istringstream folders(path ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (access((folder + "/" + program).c_str(), X_OK) == 0) return true;
  }
  return false;
}

std::uint32_t BigEndian(const std::string& bytes, std::size_t word) {
  std::uint32_t value = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    value = value << 8 | static_cast<std::uint8_t>(bytes.at(4 * word + k));
  }
  return value;
}

}  // namespace

std::string VirtualDisplay::Missing() {
  std::string missing;
  for (const char* program : {"Xvfb", "xdotool"}) {
    if (!InPath(program)) missing += (missing.empty() ? "" : " and ") + std::string(program);
  }
  return missing;
}

VirtualDisplay::VirtualDisplay() {
  const std::string screen = std::to_string(kWidth) + "x" + std::to_string(kHeight) + "x24";
  const std::string folder = (folder_ / "screen").string();
  std::filesystem::create_directory(folder);
  // It writes the number of the display that it has found free to descriptor 3.
  server_.emplace(ChildProcess::Start{.arguments = {"Xvfb", "-displayfd", "3", "-screen", "0",
                                                    screen, "-fbdir", folder, "-nolisten", "tcp"},
                                      .errors = folder + "/errors",
                                      .output = 3});
  const std::optional<std::string> number = server_->ReadLine();
  if (!number) throw std::runtime_error("Xvfb does not start");
  number_ = *number;
}

void VirtualDisplay::Send(const std::vector<std::string>& arguments) const {
  ChildProcess::Start start = {.arguments = {"xdotool"}, .variables = {variable()}};
  start.arguments.insert(start.arguments.end(), arguments.begin(), arguments.end());
  if (ChildProcess(start).Wait() != 0) throw std::runtime_error("xdotool fails");
}

// Xvfb keeps its screen in a file of the format XWD: words of the header, a palette, pixels.
Pixels VirtualDisplay::Look() const {
  std::ifstream file(folder_ / "screen/Xvfb_screen0", std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  constexpr std::size_t kHeaderSize = 0, kPixelWidth = 4, kPixelHeight = 5, kByteOrder = 7;
  constexpr std::size_t kBitsPerPixel = 11, kBytesPerLine = 12, kColors = 19, kColorSize = 12;
  if (BigEndian(bytes, kByteOrder) != 0 || BigEndian(bytes, kBitsPerPixel) != 32) {
    throw std::runtime_error("not the pixels that are expected");
  }
  Pixels pixels;
  pixels.width = static_cast<int>(BigEndian(bytes, kPixelWidth));
  pixels.height = static_cast<int>(BigEndian(bytes, kPixelHeight));
  const std::size_t begin = BigEndian(bytes, kHeaderSize) + kColorSize * BigEndian(bytes, kColors);
  const std::size_t line = BigEndian(bytes, kBytesPerLine);
  for (int y = 0; y < pixels.height; ++y) {
    for (int x = 0; x < pixels.width; ++x) {
      const std::size_t at =
          begin + line * static_cast<std::size_t>(y) + 4 * static_cast<std::size_t>(x);
      for (const std::size_t k : std::array<std::size_t, 3>{2, 1, 0}) {  // blue comes first
        pixels.rgb.push_back(static_cast<std::uint8_t>(bytes.at(at + k)));
      }
    }
  }
  return pixels;
}

}  // namespace mjcf_pdg::test
