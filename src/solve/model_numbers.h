// Numbers of a model with which nothing can be computed: MuJoCo compiles infinite sizes.
#ifndef MJCF_PDG_SRC_SOLVE_MODEL_NUMBERS_H_
#define MJCF_PDG_SRC_SOLVE_MODEL_NUMBERS_H_

#include <mujoco/mujoco.h>

namespace mjcf_pdg {

// Throws Error, which names the element, if a number of the model is not finite, a length or
// position beyond MuJoCo's own bound for states, 1e10, or an orientation no quaternion.
void CheckModelNumbers(const mjModel& m);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_SOLVE_MODEL_NUMBERS_H_
