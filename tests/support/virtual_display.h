// A display in memory (Xvfb), real key and mouse events on it (xdotool, which sends them by the
// XTEST extension), and what is to be seen there.
#ifndef MJCF_PDG_TESTS_SUPPORT_VIRTUAL_DISPLAY_H_
#define MJCF_PDG_TESTS_SUPPORT_VIRTUAL_DISPLAY_H_

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tests/support/child_process.h"
#include "tests/support/temporary_folder.h"

namespace mjcf_pdg::test {

struct Pixels {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  // highest line first

  const std::uint8_t* At(int x, int y) const {
    return &rgb[3 * (static_cast<std::size_t>(y) * width + x)];
  }
};

class VirtualDisplay {
 public:
  static constexpr int kWidth = 1280, kHeight = 800;

  // What is not installed of what this needs; empty: nothing.
  static std::string Missing();

  VirtualDisplay();

  // "DISPLAY=:7"
  std::string variable() const { return "DISPLAY=:" + number_; }
  // Sends events: the arguments of xdotool. Returns when they are sent.
  void Send(const std::vector<std::string>& arguments) const;
  Pixels Look() const;

 private:
  TemporaryFolder folder_;
  std::optional<ChildProcess> server_;
  std::string number_;
};

}  // namespace mjcf_pdg::test

#endif  // MJCF_PDG_TESTS_SUPPORT_VIRTUAL_DISPLAY_H_
