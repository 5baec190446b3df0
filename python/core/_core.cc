// The extension module mjcf_pdg._core: what mjcf_pdg/*.py is written on.
#include <mujoco/mujoco.h>
#include <nanobind/nanobind.h>

#include <exception>
#include <optional>
#include <string>
#include <vector>

#include "answers.h"
#include "arrays.h"
#include "audit.h"
#include "batch.h"
#include "gradient.h"
#include "library_call.h"
#include "mjcf_pdg/pdg.h"
#include "model.h"
#include "options.h"
#include "solver.h"

namespace mjcf_pdg::python {
namespace {

using namespace nb::literals;

static_assert(mjVERSION_HEADER / 1000 == 4000, "mjcf_pdg/_libmujoco.py lets MuJoCo 4.0.x in");

double ComputeNorm(nb::handle model, nb::handle q0, nb::handle q1, const nb::kwargs& given) {
  Asked asked;
  ReadOptions(given, kNorm, asked);
  const Model scene = ReadModel(model, asked.scene);
  const std::vector<double> from = ReadConfiguration(q0, "q0", scene.scene.nq());
  const std::vector<double> to = ReadConfiguration(q1, "q1", scene.scene.nq());
  return CallLibrary([&] { return ObjectNorm(scene.scene, asked.options.metric, from).Sigma(to); });
}

nb::dict VerifyConfiguration(nb::handle model, nb::handle qpos, nb::handle q_in,
                             const nb::kwargs& given) {
  Asked asked;
  ReadOptions(given, kVerify, asked);
  const Model scene = ReadModel(model, asked.scene);
  const std::vector<double> q = ReadConfiguration(qpos, "qpos", scene.scene.nq());
  std::optional<std::vector<double>> rests;
  if (!q_in.is_none()) rests = ReadConfiguration(q_in, "q_in", scene.scene.nq());
  const Verdict verdict =
      CallLibrary([&] { return Verify(scene.scene, q, asked.options, rests ? &*rests : nullptr); });
  return ToDict(scene.scene, verdict);
}

nb::dict CheckOneMotion(nb::handle model, nb::handle q0, nb::handle q1, const nb::kwargs& given) {
  Asked asked;
  ReadOptions(given, kVerify, asked);
  const Model scene = ReadModel(model, asked.scene);
  const std::vector<double> from = ReadConfiguration(q0, "q0", scene.scene.nq());
  const std::vector<double> to = ReadConfiguration(q1, "q1", scene.scene.nq());
  const Motion motion =
      CallLibrary([&] { return CheckMotion(scene.scene, from, to, asked.options); });
  return ToDict(scene.scene, motion);
}

void TranslateError(const std::exception_ptr& thrown, void*) {
  try {
    std::rethrow_exception(thrown);
  } catch (const Error& error) {
    PyErr_SetObject(PyExc_ValueError, Text(error.what()).ptr());
  } catch (const MujocoError& error) {
    const nb::object type = nb::module_::import_("mujoco").attr("FatalError");
    PyErr_SetObject(type.ptr(), Text(error.what()).ptr());
  }
}

}  // namespace
}  // namespace mjcf_pdg::python

NB_MODULE(_core, m) {
  using namespace mjcf_pdg::python;  // NOLINT: the module's own names
  using namespace nb::literals;
  m.attr("__version__") = MJCF_PDG_VERSION;
  m.attr("mujoco_version") = mjVERSION_HEADER;
  InstallMujocoErrors();
  nb::register_exception_translator(TranslateError);
  BindSolver(m);
  m.def("solve_rows", &SolveRows, "model"_a.none(), "qpos"_a.none(), "threads"_a,
        "progress"_a.none(), "options"_a);
  m.def("object_norm", &ComputeNorm, "model"_a.none(), "q0"_a.none(), "q1"_a.none(), "options"_a);
  m.def("verify", &VerifyConfiguration, "model"_a.none(), "qpos"_a.none(), "q_in"_a.none(),
        "options"_a);
  m.def("check_motion", &CheckOneMotion, "model"_a.none(), "q0"_a.none(), "q1"_a.none(),
        "options"_a);
  m.def("gradient_rows", &DifferentiateRows, "model"_a.none(), "q_in"_a.none(), "q"_a.none(),
        "status"_a, "threads"_a, "options"_a);
  m.def("audit", &AuditModel, "model"_a.none(), "samples"_a, "seed"_a, "tolerance"_a,
        "exact_mesh"_a);
}
