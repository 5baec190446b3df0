#include "apps/progress.h"

#include <unistd.h>

#include <cstdio>
#include <utility>

namespace mjcf_pdg::app {

Progress::Progress(std::string label, std::size_t total)
    : label_(std::move(label)), total_(total), shown_(total > 1 && ::isatty(STDERR_FILENO) == 1) {
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
  constexpr std::size_t kWidth = 40;
  const std::size_t filled = kWidth * done_ / total_;
  const std::string bar = std::string(filled, '#') + std::string(kWidth - filled, '.');
  std::fprintf(stderr, "\r%s [%s] %zu/%zu", label_.c_str(), bar.c_str(), done_, total_);
  std::fflush(stderr);
  last_draw_ = std::chrono::steady_clock::now();
}

}  // namespace mjcf_pdg::app
