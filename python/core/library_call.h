// What holds while the library works for Python.
#ifndef MJCF_PDG_PYTHON_CORE_LIBRARY_CALL_H_
#define MJCF_PDG_PYTHON_CORE_LIBRARY_CALL_H_

#include <nanobind/nanobind.h>

#include <stdexcept>

namespace mjcf_pdg::python {

namespace nb = nanobind;

// An error inside MuJoCo, in its words. Python gets mujoco.FatalError.
class MujocoError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Installs a handler of MuJoCo's messages that throws MujocoError for errors while an ErrorsThrow
// lives, and leaves all else to the handler before. Without it MuJoCo ends the process. The calls
// of the `mujoco` package have handlers of their own.
void InstallMujocoErrors();

// Counts, so that it holds for threads that the library starts, too.
class ErrorsThrow {
 public:
  ErrorsThrow();
  ~ErrorsThrow();
  ErrorsThrow(const ErrorsThrow&) = delete;
  ErrorsThrow& operator=(const ErrorsThrow&) = delete;
};

// Calls `function` of the library without the GIL.
template <typename Function>
auto CallLibrary(const Function& function) {
  const nb::gil_scoped_release release;
  const ErrorsThrow errors;
  return function();
}

}  // namespace mjcf_pdg::python

#endif  // MJCF_PDG_PYTHON_CORE_LIBRARY_CALL_H_
