#include "solver.h"

#include <mujoco/mujoco.h>

#include <utility>
#include <vector>

#include "answers.h"
#include "arrays.h"

namespace mjcf_pdg::python {
namespace {

using namespace nb::literals;

Asked Read(const nb::kwargs& given) {
  Asked asked = CommandLineDefaults();
  ReadOptions(given, kNorm | kVerify | kSolve, asked);
  return asked;
}

// What costs time is not reported in every tick, unless it is asked for.
Asked ReadForTracker(const nb::kwargs& given) {
  Asked asked;
  asked.options.report_lower_bound = false;
  ReadOptions(given, kNorm | kVerify | kSolve | kTrack, asked);
  asked.track.options = asked.options;
  return asked;
}

}  // namespace

SharedSolver::SharedSolver(nb::handle model, const Asked& asked)
    : model_(ReadModel(model, asked.scene)),
      solver_(CallLibrary([&] { return Solver(model_.scene, asked.options); })) {}

SharedSolver::SharedSolver(nb::handle model, const nb::kwargs& options)
    : SharedSolver(model, Read(options)) {}

nb::dict SharedSolver::Solve(nb::handle qpos_or_data) {
  Result result;
  std::vector<double> q;
  if (IsData(qpos_or_data)) {
    const mjData* const data = ReadData(model_, qpos_or_data);
    q.assign(data->qpos, data->qpos + model_.scene.nq());
    Alone([&] { solver_.Solve(data, result); });
  } else {
    q = ReadConfiguration(qpos_or_data, "qpos", model_.scene.nq());
    Alone([&] { solver_.Solve(q, result); });
  }
  return ToDict(model_.scene, q, result);
}

bool SharedSolver::IsFree(nb::handle qpos) {
  const std::vector<double> q = ReadConfiguration(qpos, "qpos", model_.scene.nq());
  return Alone([&] { return solver_.IsFree(q); });
}

void SharedSolver::SetHint(nb::handle qpos) {
  std::vector<double> q;
  if (!qpos.is_none()) q = ReadConfiguration(qpos, "the hint", model_.scene.nq());
  Alone([&] { solver_.SetHint(q); });
}

void SharedSolver::SetBudget(int queries, double seconds) {
  Alone([&] { solver_.SetBudget({queries, seconds}); });
}

void SharedSolver::Reset() {
  Alone([&] { solver_.Reset(); });
}

SharedTracker::SharedTracker(nb::handle model, const Asked& asked)
    : model_(ReadModel(model, asked.scene)),
      tracker_(CallLibrary([&] { return Tracker(model_.scene, asked.track); })) {}

SharedTracker::SharedTracker(nb::handle model, const nb::kwargs& options)
    : SharedTracker(model, ReadForTracker(options)) {}

nb::dict SharedTracker::Step(nb::handle qpos, nb::handle data) {
  const std::vector<double> q = ReadConfiguration(qpos, "qpos", model_.scene.nq());
  const mjData* const obstacles = data.is_none() ? nullptr : ReadData(model_, data);
  Result result;
  Alone([&] { obstacles ? tracker_.Step(obstacles, q, result) : tracker_.Step(q, result); });
  return ToDict(model_.scene, q, result);
}

void SharedTracker::Reset(nb::handle qpos) {
  const std::vector<double> q = ReadConfiguration(qpos, "qpos", model_.scene.nq());
  Alone([&] { tracker_.Reset(q); });
}

void BindSolver(nb::module_& m) {
  nb::class_<SharedTracker>(m, "Tracker")
      .def(nb::init<nb::handle, nb::kwargs>(), "model"_a.none(), "options"_a)
      .def_prop_ro("model", &SharedTracker::model, "The mujoco.MjModel that is tracked in.")
      .def("_step", &SharedTracker::Step, "qpos"_a.none(), "data"_a.none())
      .def("reset", &SharedTracker::Reset, "qpos"_a.none(),
           "Says where the follower stands now, qpos (nq,): the next answer is sought from there.");
  nb::class_<SharedSolver>(m, "Solver")
      .def(nb::init<nb::handle, nb::kwargs>(), "model"_a.none(), "options"_a)
      .def_prop_ro("model", &SharedSolver::model, "The mujoco.MjModel that is solved for.")
      .def("_solve", &SharedSolver::Solve, "qpos_or_data"_a.none())
      .def("is_free", &SharedSolver::IsFree, "qpos"_a.none(),
           "Whether the verifier finds qpos (nq,) free. Nothing else is computed.")
      .def("set_hint", &SharedSolver::SetHint, "qpos"_a.none(),
           "Sets a configuration (nq,) that is known or hoped to be free, for all later solves; "
           "None removes it.\n\nIt becomes a start of the search. If it is free, what a solve "
           "returns is free.")
      .def("set_budget", &SharedSolver::SetBudget, "queries"_a = 0, "seconds"_a = 0.0,
           "Limits what each later solve may cost: collision queries and seconds [s]; 0 is no "
           "bound.\n\nIt takes the place of the option time_limit.")
      .def("reset", &SharedSolver::Reset,
           "Forgets every earlier solve, which matters with trajectory=True. Hint and budget "
           "stay.");
}

}  // namespace mjcf_pdg::python
