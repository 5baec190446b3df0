// A progress bar on stderr (Boost.Timer's), shown if stderr is a terminal and it is known that
// there is more than one step.
#ifndef MJCF_PDG_APPS_CONSOLE_PROGRESS_H_
#define MJCF_PDG_APPS_CONSOLE_PROGRESS_H_

#include <boost/timer/progress_display.hpp>
#include <cstddef>
#include <mutex>
#include <optional>
#include <string>

namespace mjcf_pdg::app {

class Progress {
 public:
  // `total` steps, where that is known, of which `done` are done.
  Progress(const std::string& label, std::optional<std::size_t> total, std::size_t done = 0);
  ~Progress();  // a bar that is not full is left behind in a line of its own
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void Step();                   // one more step is done; thread-safe
  void Reach(std::size_t done);  // so many are done, of more than `total` all

 private:
  std::mutex mutex_;
  std::optional<boost::timer::progress_display> bar_;
};

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_CONSOLE_PROGRESS_H_
