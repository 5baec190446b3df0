#include "base/names.h"

namespace mjcf_pdg {
namespace {

std::string Named(const mjModel& m, int kind, int id, const char* quote) {
  const char* name = mj_id2name(&m, kind, id);
  return name && *name ? quote + std::string(name) + quote : "#" + std::to_string(id);
}

}  // namespace

std::string NameOrId(const mjModel& m, int kind, int id) { return Named(m, kind, id, ""); }

std::string QuotedNameOrId(const mjModel& m, int kind, int id) { return Named(m, kind, id, "'"); }

}  // namespace mjcf_pdg
