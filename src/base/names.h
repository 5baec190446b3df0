// What messages and results call an element of the model.
#ifndef MJCF_PDG_SRC_BASE_NAMES_H_
#define MJCF_PDG_SRC_BASE_NAMES_H_

#include <mujoco/mujoco.h>

#include <string>

namespace mjcf_pdg {

// Of an element of `kind` (mjtObj): its name, "#id" if it has none.
std::string NameOrId(const mjModel& m, int kind, int id);

// The same with quotes about a name.
std::string QuotedNameOrId(const mjModel& m, int kind, int id);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_BASE_NAMES_H_
