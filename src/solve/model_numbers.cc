#include "solve/model_numbers.h"

#include <cmath>
#include <string>

#include "base/names.h"
#include "mjcf_pdg/types.h"

namespace mjcf_pdg {
namespace {

// An array of the model with `width` numbers for each of `count` elements.
struct Numbers {
  const mjtNum* values;
  mjtSize count;
  int width;
  int kind;  // mjtObj
  const char* element;
  const char* what;
};

bool Usable(double value) { return std::abs(value) <= mjMAXVAL; }  // false for NaN

void Check(const mjModel& m, const Numbers& numbers) {
  for (mjtSize i = 0; i < numbers.count * numbers.width; ++i) {
    if (Usable(numbers.values[i])) continue;
    const int id = static_cast<int>(i / numbers.width);
    const std::string name =
        numbers.kind == mjOBJ_GEOM ? QuotedNameOrPlace(m, id) : QuotedNameOrId(m, numbers.kind, id);
    throw Error("the " + std::string(numbers.what) + " of " + numbers.element + " " + name +
                " is not a usable number");
  }
}

}  // namespace

void CheckModelNumbers(const mjModel& m) {
  const Numbers all[] = {
      {m.geom_size, m.ngeom, 3, mjOBJ_GEOM, "geom", "size"},
      {m.geom_rbound, m.ngeom, 1, mjOBJ_GEOM, "geom", "size"},
      {m.geom_pos, m.ngeom, 3, mjOBJ_GEOM, "geom", "position"},
      {m.geom_quat, m.ngeom, 4, mjOBJ_GEOM, "geom", "orientation"},
      {m.geom_margin, m.ngeom, 1, mjOBJ_GEOM, "geom", "margin"},
      {m.geom_gap, m.ngeom, 1, mjOBJ_GEOM, "geom", "gap"},
      {m.body_pos, m.nbody, 3, mjOBJ_BODY, "body", "position"},
      {m.body_quat, m.nbody, 4, mjOBJ_BODY, "body", "orientation"},
      {m.body_ipos, m.nbody, 3, mjOBJ_BODY, "body", "centre of mass"},
      {m.body_mass, m.nbody, 1, mjOBJ_BODY, "body", "mass"},
      {m.body_inertia, m.nbody, 3, mjOBJ_BODY, "body", "inertia"},
      {m.jnt_pos, m.njnt, 3, mjOBJ_JOINT, "joint", "position"},
      {m.jnt_axis, m.njnt, 3, mjOBJ_JOINT, "joint", "axis"},
      {m.eq_data, m.neq, mjNEQDATA, mjOBJ_EQUALITY, "equality constraint", "data"}};
  for (const Numbers& numbers : all) Check(m, numbers);
}

}  // namespace mjcf_pdg
