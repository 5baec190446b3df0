#include "apps/console/mujoco_log.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <mutex>
#include <stdexcept>
#include <utility>

#include "apps/console/text.h"

namespace mjcf_pdg::app {
namespace {

// The collected warnings. They are global because MuJoCo's handler is a plain function without user
// data.
struct Warnings {
  std::mutex mutex;
  std::vector<std::string> lines;
};

Warnings& CollectedWarnings() {
  static Warnings warnings;
  return warnings;
}

// Where errors go instead of being thrown; null: they are thrown.
thread_local std::vector<std::string>* collected_errors = nullptr;

// Most warnings that are kept.
constexpr std::size_t kMaxWarnings = 5;

void HandleMessage(const mjLogMessage* message) {
  if (message->level < mjLOG_WARNING) return;
  const std::string text = OneLine(message->subject);
  if (message->level >= mjLOG_ERROR && collected_errors) {
    collected_errors->push_back(text);
    return;
  }
  if (message->level >= mjLOG_ERROR) throw std::runtime_error("MuJoCo: " + text);
  Warnings& warnings = CollectedWarnings();
  const std::lock_guard<std::mutex> lock(warnings.mutex);
  std::vector<std::string>& lines = warnings.lines;
  if (lines.size() >= kMaxWarnings) return;
  if (std::find(lines.begin(), lines.end(), text) == lines.end()) lines.push_back(text);
}

}  // namespace

void InstallMujocoLog() {
  CollectedWarnings();
  mjLogConfig config = mju_getLogConfig();
  config.logto_console = 0;
  config.logto_file = 0;
  mju_setLogConfig(config);
  mju_setLogHandler(HandleMessage);
}

std::vector<std::string> TakeMujocoWarnings() {
  Warnings& warnings = CollectedWarnings();
  const std::lock_guard<std::mutex> lock(warnings.mutex);
  return std::exchange(warnings.lines, {});
}

std::vector<std::string> MujocoErrorsDuring(const std::function<void()>& action) {
  struct Collecting {
    std::vector<std::string> errors;
    Collecting() { collected_errors = &errors; }
    ~Collecting() { collected_errors = nullptr; }
  } collecting;
  action();
  return std::move(collecting.errors);
}

}  // namespace mjcf_pdg::app
