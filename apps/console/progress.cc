#include "apps/console/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <utility>

namespace mjcf_pdg::app {

Progress::Progress(std::string label, std::optional<std::size_t> total, std::size_t done)
    : label_(std::move(label)),
      total_(total),
      shown_(total.value_or(2) > 1 && ::isatty(STDERR_FILENO) == 1),
      done_(done) {
  if (shown_) Draw();
}

Progress::~Progress() {
  if (shown_) std::fputs("\r\x1b[K", stderr);
}

void Progress::Step() {
  constexpr std::chrono::milliseconds kPause(100);
  const std::lock_guard<std::mutex> lock(mutex_);
  ++done_;
  if (shown_ && std::chrono::steady_clock::now() - last_draw_ >= kPause) Draw();
}

void Progress::Draw() {
  if (total_) {
    constexpr std::size_t kWidth = 40;
    const std::size_t filled = kWidth * std::min(done_, *total_) / *total_;
    const std::string bar = std::string(filled, '#') + std::string(kWidth - filled, '.');
    std::fprintf(stderr, "\r%s [%s] %zu/%zu", label_.c_str(), bar.c_str(), done_, *total_);
  } else {
    std::fprintf(stderr, "\r%s %zu", label_.c_str(), done_);
  }
  std::fflush(stderr);
  last_draw_ = std::chrono::steady_clock::now();
}

}  // namespace mjcf_pdg::app
