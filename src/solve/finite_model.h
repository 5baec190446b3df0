// Models whose numbers are none. MuJoCo's compiler refuses them; they come of a compiled model that
// was edited in place.
#ifndef MJCF_PDG_SRC_SOLVE_FINITE_MODEL_H_
#define MJCF_PDG_SRC_SOLVE_FINITE_MODEL_H_

#include <mujoco/mujoco.h>

namespace mjcf_pdg {

// Throws Error, which names the field and the element, if a mass, inertia, place, direction or size
// of a body, joint or geom is NaN or infinite.
void RefuseNonFinite(const mjModel& m);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_SOLVE_FINITE_MODEL_H_
