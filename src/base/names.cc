#include "base/names.h"

#include <algorithm>

#include "mjcf_pdg/types.h"

namespace mjcf_pdg {
namespace {

// Empty if the element has no name.
std::string Named(const mjModel& m, int kind, int id, const char* quote) {
  const char* name = mj_id2name(&m, kind, id);
  return name && *name ? quote + std::string(name) + quote : "";
}

std::string NamedOrId(const mjModel& m, int kind, int id, const char* quote) {
  const std::string name = Named(m, kind, id, quote);
  return name.empty() ? "#" + std::to_string(id) : name;
}

std::string BodyPlace(const mjModel& m, int body) {
  const std::string name = Named(m, mjOBJ_BODY, body, "");
  if (!name.empty() || body == 0) return name;
  const int parent = m.body_parentid[body];
  int siblings = 0;  // before it
  for (int b = parent + 1; b < body; ++b) siblings += m.body_parentid[b] == parent;
  return BodyPlace(m, parent) + "/body" + std::to_string(siblings);
}

std::string NamedOrPlace(const mjModel& m, int geom, const char* quote) {
  const std::string name = Named(m, mjOBJ_GEOM, geom, quote);
  if (!name.empty()) return name;
  const int body = m.geom_bodyid[geom];
  return BodyPlace(m, body) + "/geom" + std::to_string(geom - m.body_geomadr[body]);
}

}  // namespace

std::string NameOrId(const mjModel& m, int kind, int id) { return NamedOrId(m, kind, id, ""); }

std::string QuotedNameOrId(const mjModel& m, int kind, int id) {
  return NamedOrId(m, kind, id, "'");
}

std::string NameOrPlace(const mjModel& m, int geom) { return NamedOrPlace(m, geom, ""); }

std::string QuotedNameOrPlace(const mjModel& m, int geom) { return NamedOrPlace(m, geom, "'"); }

std::vector<int> GeomsNamed(const mjModel& m, const std::string& name) {
  std::vector<int> geoms;
  const int geom = mj_name2id(&m, mjOBJ_GEOM, name.c_str());
  const int body = mj_name2id(&m, mjOBJ_BODY, name.c_str());
  if (geom < 0 && body < 0) {
    throw Error("no geom or body named '" + name + "' (bodies: " + BodyNames(m) + ")");
  }
  if (geom >= 0) geoms.push_back(geom);
  for (int k = 0; body >= 0 && k < m.body_geomnum[body]; ++k) {
    if (m.body_geomadr[body] + k != geom) geoms.push_back(m.body_geomadr[body] + k);
  }
  std::sort(geoms.begin(), geoms.end());
  return geoms;
}

std::string BodyNames(const mjModel& m) {
  std::string names;
  for (int b = 1; b < m.nbody; ++b) {
    const std::string name = Named(m, mjOBJ_BODY, b, "");
    if (!name.empty()) names += (names.empty() ? "" : ", ") + name;
  }
  return names.empty() ? "none has a name" : names;
}

}  // namespace mjcf_pdg
