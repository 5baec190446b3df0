#include "solve/finite_model.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/names.h"
#include "mjcf_pdg/types.h"

namespace mjcf_pdg {
namespace {

// A field of the model: `width` numbers for each of the `count` elements of `kind` (mjtObj).
struct Field {
  const char* name;
  const mjtNum* values;
  int kind, count, width;
};

}  // namespace

void RefuseNonFinite(const mjModel& m) {
  const int nbody = static_cast<int>(m.nbody), njnt = static_cast<int>(m.njnt);
  const int ngeom = static_cast<int>(m.ngeom);
  const Field fields[] = {
      {"body_mass", m.body_mass, mjOBJ_BODY, nbody, 1},
      {"body_inertia", m.body_inertia, mjOBJ_BODY, nbody, 3},
      {"body_pos", m.body_pos, mjOBJ_BODY, nbody, 3},
      {"body_quat", m.body_quat, mjOBJ_BODY, nbody, 4},
      {"body_ipos", m.body_ipos, mjOBJ_BODY, nbody, 3},
      {"body_iquat", m.body_iquat, mjOBJ_BODY, nbody, 4},
      {"jnt_pos", m.jnt_pos, mjOBJ_JOINT, njnt, 3},
      {"jnt_axis", m.jnt_axis, mjOBJ_JOINT, njnt, 3},
      {"jnt_range", m.jnt_range, mjOBJ_JOINT, njnt, 2},
      {"geom_size", m.geom_size, mjOBJ_GEOM, ngeom, 3},
      {"geom_pos", m.geom_pos, mjOBJ_GEOM, ngeom, 3},
      {"geom_quat", m.geom_quat, mjOBJ_GEOM, ngeom, 4},
      {"geom_rbound", m.geom_rbound, mjOBJ_GEOM, ngeom, 1},
      {"geom_margin", m.geom_margin, mjOBJ_GEOM, ngeom, 1},
  };
  for (const Field& field : fields) {
    const mjtNum* const end = field.values + field.count * field.width;
    const mjtNum* const bad =
        std::find_if(field.values, end, [](mjtNum value) { return !std::isfinite(value); });
    if (bad == end) continue;
    const int id = static_cast<int>(bad - field.values) / field.width;
    throw Error(std::string(field.name) + " of " + mju_type2Str(field.kind) + " " +
                QuotedNameOrId(m, field.kind, id) + " is not a finite number");
  }
}

}  // namespace mjcf_pdg
