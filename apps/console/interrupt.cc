#include "apps/console/interrupt.h"

#include <atomic>
#include <csignal>

#include "apps/cli.h"
#include "apps/console/text.h"

namespace mjcf_pdg::app {
namespace {

static_assert(std::atomic<int>::is_always_lock_free, "a signal handler must not wait for a lock");
std::atomic<int> g_signal{0};

void Note(int signal) { g_signal = signal; }

}  // namespace

void CatchInterrupts() {
  struct sigaction action = {};
  action.sa_handler = Note;
  sigemptyset(&action.sa_mask);
  action.sa_flags = static_cast<int>(SA_RESETHAND);  // the second time as if nobody had asked
  for (const int signal : {SIGINT, SIGTERM}) sigaction(signal, &action, nullptr);
}

int Interrupted() { return g_signal; }

int SayInterrupted(const std::string& words) {
  WriteWarning("interrupted " + words);
  return kExitSignal + Interrupted();
}

}  // namespace mjcf_pdg::app
