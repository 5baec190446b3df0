#include "solve/model_numbers.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>

#include "base/names.h"
#include "mjcf_pdg/types.h"
#include "solve/options.h"

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

bool AllFinite(std::span<const mjtNum> values) {
  return std::all_of(values.begin(), values.end(), [](mjtNum v) { return std::isfinite(v); });
}

// False for NaN, too.
bool AllWithinBound(std::span<const mjtNum> values) {
  return std::all_of(values.begin(), values.end(),
                     [](mjtNum v) { return std::abs(v) <= mjMAXVAL; });
}

// MuJoCo normalizes the quaternion 1e308 0 0 0 to zeros.
bool Turns(std::span<const mjtNum> quat) {
  return AllWithinBound(quat) && mju_norm(quat.data(), 4) >= kLeastQuaternion;
}

// `usable` is asked of the numbers of each element.
template <typename Usable>
void Check(const mjModel& m, const Numbers& numbers, const Usable& usable) {
  for (int id = 0; id < numbers.count; ++id) {
    const mjtNum* const values = numbers.values + std::ptrdiff_t{numbers.width} * id;
    if (usable(std::span(values, static_cast<std::size_t>(numbers.width)))) continue;
    const std::string name =
        numbers.kind == mjOBJ_GEOM ? QuotedNameOrPlace(m, id) : QuotedNameOrId(m, numbers.kind, id);
    throw Error("the " + std::string(numbers.what) + " of " + numbers.element + " " + name +
                " is not usable");
  }
}

}  // namespace

void CheckModelNumbers(const mjModel& m) {
  const Numbers lengths[] = {{m.geom_size, m.ngeom, 3, mjOBJ_GEOM, "geom", "size"},
                             {m.geom_rbound, m.ngeom, 1, mjOBJ_GEOM, "geom", "size"},
                             {m.geom_pos, m.ngeom, 3, mjOBJ_GEOM, "geom", "position"},
                             {m.geom_margin, m.ngeom, 1, mjOBJ_GEOM, "geom", "margin"},
                             {m.geom_gap, m.ngeom, 1, mjOBJ_GEOM, "geom", "gap"},
                             {m.body_pos, m.nbody, 3, mjOBJ_BODY, "body", "position"},
                             {m.body_ipos, m.nbody, 3, mjOBJ_BODY, "body", "centre of mass"},
                             {m.jnt_pos, m.njnt, 3, mjOBJ_JOINT, "joint", "position"},
                             {m.jnt_axis, m.njnt, 3, mjOBJ_JOINT, "joint", "axis"}};
  for (const Numbers& numbers : lengths) Check(m, numbers, AllWithinBound);
  // A heavy body of kilometres has an inertia beyond the bound.
  const Numbers others[] = {
      {m.body_mass, m.nbody, 1, mjOBJ_BODY, "body", "mass"},
      {m.body_inertia, m.nbody, 3, mjOBJ_BODY, "body", "inertia"},
      {m.eq_data, m.neq, mjNEQDATA, mjOBJ_EQUALITY, "equality constraint", "data"}};
  for (const Numbers& numbers : others) Check(m, numbers, AllFinite);
  // Infinite ends of a range are none.
  Check(m, {m.jnt_range, m.njnt, 2, mjOBJ_JOINT, "joint", "range"},
        [](std::span<const mjtNum> range) {
          return !std::isnan(range[0]) && !std::isnan(range[1]);
        });
  const Numbers orientations[] = {
      {m.geom_quat, m.ngeom, 4, mjOBJ_GEOM, "geom", "orientation"},
      {m.body_quat, m.nbody, 4, mjOBJ_BODY, "body", "orientation"},
      {m.body_iquat, m.nbody, 4, mjOBJ_BODY, "body", "inertial orientation"}};
  for (const Numbers& numbers : orientations) Check(m, numbers, Turns);
}

}  // namespace mjcf_pdg
