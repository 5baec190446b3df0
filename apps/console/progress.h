// A progress bar on stderr, shown if stderr is a terminal and there is more than one step.
#ifndef MJCF_PDG_APPS_CONSOLE_PROGRESS_H_
#define MJCF_PDG_APPS_CONSOLE_PROGRESS_H_

#include <chrono>
#include <cstddef>
#include <mutex>
#include <optional>
#include <string>

namespace mjcf_pdg::app {

class Progress {
 public:
  // `total` rows, where that is known, of which `done` are done.
  Progress(std::string label, std::optional<std::size_t> total, std::size_t done = 0);
  ~Progress();  // wipes the bar
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void Step();  // one more step is done; thread-safe

 private:
  void Draw();

  const std::string label_;
  const std::optional<std::size_t> total_;
  const bool shown_;
  std::mutex mutex_;
  std::size_t done_;
  std::chrono::steady_clock::time_point last_draw_;
};

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_CONSOLE_PROGRESS_H_
