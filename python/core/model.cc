#include "model.h"

#include <cstdint>
#include <string>

#include "library_call.h"

namespace mjcf_pdg::python {
namespace {

bool IsInstance(nb::handle object, const char* type) {
  const int answer =
      PyObject_IsInstance(object.ptr(), nb::module_::import_("mujoco").attr(type).ptr());
  if (answer < 0) throw nb::python_error();
  return answer == 1;
}

// An object whose constructor never ran (MjModel.__new__) hands out whatever its memory holds. The
// classes of mujoco are made with pybind11, whose objects keep the pointer to their value right
// behind Python's header: null until the constructor has run, or until something asks the object.
void RefuseUnmade(nb::handle object) {
  const auto* const value = reinterpret_cast<void* const*>(object.ptr() + 1);
  if (*value) return;
  throw Error("the mujoco." + nb::cast<std::string>(object.type().attr("__name__")) +
              " was never made: its constructor did not run");
}

template <typename T>
const T* Address(nb::handle object) {
  return reinterpret_cast<const T*>(nb::cast<std::uintptr_t>(object.attr("_address")));
}

}  // namespace

Model ReadModel(nb::handle model, const SceneOptions& options) {
  if (!IsInstance(model, "MjModel")) {
    const std::string words =
        "the model must be a mujoco.MjModel, not " + std::string(nb::repr(model.type()).c_str());
    throw nb::type_error(words.c_str());
  }
  RefuseUnmade(model);
  const auto* const address = Address<mjModel>(model);
  return {nb::borrow(model), CallLibrary([&] { return Scene::FromModel(address, options); })};
}

bool IsData(nb::handle object) { return IsInstance(object, "MjData"); }

const mjData* ReadData(const Model& model, nb::handle data) {
  RefuseUnmade(data);
  if (Address<mjModel>(data.attr("model")) != model.scene.model()) {
    throw Error("the mujoco.MjData belongs to another mujoco.MjModel");
  }
  return Address<mjData>(data);
}

}  // namespace mjcf_pdg::python
