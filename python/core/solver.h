// Solver for Python: any thread may call it, one after the other.
#ifndef MJCF_PDG_PYTHON_CORE_SOLVER_H_
#define MJCF_PDG_PYTHON_CORE_SOLVER_H_

#include <nanobind/nanobind.h>

#include <mutex>
#include <vector>

#include "library_call.h"
#include "mjcf_pdg/pdg.h"
#include "model.h"
#include "options.h"

namespace mjcf_pdg::python {

// Runs without the GIL and, as a solver serves one thread at a time, after those who came before.
class SharedSolver {
 public:
  SharedSolver(nb::handle model, const nb::kwargs& options);

  nb::dict Solve(nb::handle qpos_or_data);
  bool IsFree(nb::handle qpos);
  void SetHint(nb::handle qpos);  // None removes it
  void SetBudget(int queries, double seconds);
  void Reset();
  nb::object model() const { return model_.owner; }

 private:
  SharedSolver(nb::handle model, const Asked& asked);

  // Calls `function` without the GIL while nobody else has the solver. The GIL goes first, so that
  // who waits for the solver does not keep the GIL from who has it.
  template <typename Function>
  auto Alone(const Function& function) {
    return CallLibrary([&] {
      const std::lock_guard<std::mutex> lock(mutex_);
      return function();
    });
  }

  const Model model_;
  std::mutex mutex_;
  Solver solver_;
};

// Tracker for Python, in the same way.
class SharedTracker {
 public:
  SharedTracker(nb::handle model, const nb::kwargs& options);

  // `data` may be None.
  nb::dict Step(nb::handle qpos, nb::handle data);
  void Reset(nb::handle qpos);
  nb::object model() const { return model_.owner; }

 private:
  SharedTracker(nb::handle model, const Asked& asked);

  template <typename Function>
  auto Alone(const Function& function) {
    return CallLibrary([&] {
      const std::lock_guard<std::mutex> lock(mutex_);
      return function();
    });
  }

  const Model model_;
  std::mutex mutex_;
  Tracker tracker_;
};

// Both.
void BindSolver(nb::module_& m);

}  // namespace mjcf_pdg::python

#endif  // MJCF_PDG_PYTHON_CORE_SOLVER_H_
