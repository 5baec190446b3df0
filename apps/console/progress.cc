#include "apps/console/progress.h"

#include <unistd.h>

#include <algorithm>
#include <iostream>

namespace mjcf_pdg::app {

Progress::Progress(const std::string& label, std::optional<std::size_t> total, std::size_t done) {
  const bool terminal = ::isatty(STDERR_FILENO) == 1;
  if (!terminal || !total || *total < 2) return;
  bar_.emplace(*total, std::cerr, label + " (" + std::to_string(*total) + ")\n");
  if (done > 0) *bar_ += done;
}

Progress::~Progress() {
  if (bar_ && bar_->count() < bar_->expected_count()) std::cerr << std::endl;
}

void Progress::Reach(std::size_t done) {
  if (!bar_) return;
  done = std::min<std::size_t>(done, bar_->expected_count());
  if (done > bar_->count()) *bar_ += done - bar_->count();
}

void Progress::Step() {
  if (!bar_) return;
  const std::lock_guard<std::mutex> lock(mutex_);
  ++*bar_;
}

}  // namespace mjcf_pdg::app
