#include "library_call.h"

#include <mujoco/mujoco.h>

#include <atomic>

namespace mjcf_pdg::python {
namespace {

std::atomic<int> g_calls{0};
mjfLogHandler g_before = nullptr;

// Throws through MuJoCo's C frames, which have unwind tables.
void Handle(const mjLogMessage* message) {
  if (message->level >= mjLOG_ERROR && g_calls > 0) throw MujocoError(message->subject);
  if (g_before) g_before(message);
}

}  // namespace

void InstallMujocoErrors() { g_before = mju_setLogHandler(Handle); }

ErrorsThrow::ErrorsThrow() { ++g_calls; }
ErrorsThrow::~ErrorsThrow() { --g_calls; }

}  // namespace mjcf_pdg::python
