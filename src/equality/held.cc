#include "equality/held.h"

#include <algorithm>

#include "base/names.h"

namespace mjcf_pdg {
namespace {

int BodyOf(const mjModel& m, int object_type, int object) {
  if (object < 0) return 0;
  return object_type == mjOBJ_SITE ? m.site_bodyid[object] : object;
}

bool IsSumOfJoints(const mjModel& m, int tendon) {
  return tendon < 0 || m.wrap_type[m.tendon_adr[tendon]] == mjWRAP_JOINT;
}

bool IsStraight(const mjModel& m, int equality) {
  const int type = m.eq_type[equality];
  if (type != mjEQ_JOINT && type != mjEQ_TENDON) return false;
  if (type == mjEQ_TENDON &&
      !(IsSumOfJoints(m, m.eq_obj1id[equality]) && IsSumOfJoints(m, m.eq_obj2id[equality]))) {
    return false;
  }
  // Coefficients of the second to fourth power; without a second joint or tendon they are not used.
  const mjtNum* polynomial = m.eq_data + static_cast<std::ptrdiff_t>(mjNEQDATA) * equality;
  return m.eq_obj2id[equality] < 0 ||
         std::all_of(polynomial + 2, polynomial + 5, [](mjtNum c) { return c == 0.0; });
}

}  // namespace

bool JoinsMocapBody(const mjModel& m, int equality) {
  const int type = m.eq_type[equality];
  if (type != mjEQ_CONNECT && type != mjEQ_WELD) return false;
  for (const int object : {m.eq_obj1id[equality], m.eq_obj2id[equality]}) {
    if (m.body_mocapid[m.body_rootid[BodyOf(m, m.eq_objtype[equality], object)]] >= 0) return true;
  }
  return false;
}

std::string DescribeEquality(const mjModel& m, int equality) {
  static constexpr const char* kKinds[] = {"connect", "weld", "joint", "tendon"};
  const int type = m.eq_type[equality];
  return std::string(type >= 0 && type < 4 ? kKinds[type] : "equality") + " " +
         QuotedNameOrId(m, mjOBJ_EQUALITY, equality);
}

bool HoldsAlongStraightMotions(const mjModel& m, const std::vector<char>& equalities,
                               const std::vector<char>& tendons) {
  for (int e = 0; e < m.neq; ++e) {
    if (equalities[e] && m.eq_active0[e] && !IsStraight(m, e)) return false;
  }
  for (int t = 0; t < m.ntendon; ++t) {
    if (tendons[t] && !IsSumOfJoints(m, t)) return false;
  }
  return true;
}

std::vector<char> HeldEqualities(const mjModel& m, EqualityMode mode) {
  std::vector<char> held(m.neq, 0);
  if (mode == EqualityMode::kIgnore || (m.opt.disableflags & mjDSBL_EQUALITY)) return held;
  for (int e = 0; e < m.neq; ++e) {
    const int type = m.eq_type[e];
    const bool known =
        type == mjEQ_CONNECT || type == mjEQ_WELD || type == mjEQ_JOINT || type == mjEQ_TENDON;
    held[e] = known && (mode == EqualityMode::kAll || !JoinsMocapBody(m, e));
  }
  return held;
}

std::vector<char> HeldTendons(const mjModel& m, const SceneOptions& options) {
  const int disabled = m.opt.disableflags & (mjDSBL_LIMIT | mjDSBL_CONSTRAINT);
  const bool hold = options.hold_tendon_limits && !(options.model_flags && disabled);
  std::vector<char> held(m.ntendon, 0);
  for (int t = 0; t < m.ntendon; ++t) held[t] = hold && m.tendon_limited[t];
  return held;
}

}  // namespace mjcf_pdg
