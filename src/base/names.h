// How messages and results name an element of the model.
#ifndef MJCF_PDG_SRC_BASE_NAMES_H_
#define MJCF_PDG_SRC_BASE_NAMES_H_

#include <mujoco/mujoco.h>

#include <string>

namespace mjcf_pdg {

// The name of element `id` of `kind` (mjtObj), or "#id" if it has none.
std::string NameOrId(const mjModel& m, int kind, int id);

// The same with the name in single quotes; "#id" stays without.
std::string QuotedNameOrId(const mjModel& m, int kind, int id);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_BASE_NAMES_H_
