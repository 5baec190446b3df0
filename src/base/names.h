// How messages and results name an element of the model.
#ifndef MJCF_PDG_SRC_BASE_NAMES_H_
#define MJCF_PDG_SRC_BASE_NAMES_H_

#include <mujoco/mujoco.h>

#include <string>
#include <vector>

namespace mjcf_pdg {

// The name of element `id` of `kind` (mjtObj), or "#id" if it has none.
std::string NameOrId(const mjModel& m, int kind, int id);

// The same with the name in single quotes; "#id" stays without.
std::string QuotedNameOrId(const mjModel& m, int kind, int id);

// The name of a geom or, if it has none, its place, by which a reader of the XML finds it:
// "torso/geom1" is the second geom of the body torso. A body without name is told by its place
// among its parent's children: "torso/body0/geom1".
std::string NameOrPlace(const mjModel& m, int geom);

// The same with the name in single quotes; a place stays without.
std::string QuotedNameOrPlace(const mjModel& m, int geom);

// The geoms that a name means, ascending: the geom of that name, and all geoms of the body of that
// name. Throws Error, which lists the bodies, if there is neither.
std::vector<int> GeomsNamed(const mjModel& m, const std::string& name);

// For messages: the names of all bodies that have one, "a, b, c", or that none has.
std::string BodyNames(const mjModel& m);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_BASE_NAMES_H_
