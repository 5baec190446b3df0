// Models and data of the user's `mujoco` package, handed over by address.
#ifndef MJCF_PDG_PYTHON_CORE_MODEL_H_
#define MJCF_PDG_PYTHON_CORE_MODEL_H_

#include <nanobind/nanobind.h>

#include "mjcf_pdg/scene.h"

struct mjData_;
typedef struct mjData_ mjData;

namespace mjcf_pdg::python {

namespace nb = nanobind;

// A scene of a mujoco.MjModel, which lives as long as this does.
struct Model {
  nb::object owner;
  Scene scene;
};

// Throws nb::type_error unless `model` is a mujoco.MjModel, and Error as Scene does.
Model ReadModel(nb::handle model, const SceneOptions& options);

bool IsData(nb::handle object);

// `data` is a mujoco.MjData. Throws Error unless it is of the same model.
const mjData* ReadData(const Model& model, nb::handle data);

}  // namespace mjcf_pdg::python

#endif  // MJCF_PDG_PYTHON_CORE_MODEL_H_
