#include "model/kept_pairs.h"

#include <algorithm>
#include <limits>
#include <set>
#include <string>
#include <utility>

#include "base/names.h"
#include "mjcf_pdg/types.h"

namespace mjcf_pdg {
namespace {

bool KnowsType(int type) {
  switch (type) {
    case mjGEOM_PLANE:
    case mjGEOM_HFIELD:
    case mjGEOM_SPHERE:
    case mjGEOM_CAPSULE:
    case mjGEOM_ELLIPSOID:
    case mjGEOM_CYLINDER:
    case mjGEOM_BOX:
    case mjGEOM_MESH:
    case mjGEOM_SDF:
      return true;
    default:
      return false;
  }
}

// MuJoCo has a collision function for the two geom types. Throws Error for a type that we do not
// know: taken for another one, its geom would be called free where it overlaps.
bool Collidable(const mjModel& m, int g1, int g2) {
  for (const int g : {g1, g2}) {
    if (KnowsType(m.geom_type[g])) continue;
    throw Error("geom " + QuotedNameOrPlace(m, g) + " has the type " +
                std::to_string(m.geom_type[g]) + ", which is not supported");
  }
  const int low = std::min(m.geom_type[g1], m.geom_type[g2]);
  const int high = std::max(m.geom_type[g1], m.geom_type[g2]);
  return mjCOLLISIONFUNC[low][high] != nullptr;
}

// MuJoCo's weld, parent-child or <exclude> filter drops all pairs of the two bodies.
bool BodiesFiltered(const mjModel& m, int body1, int body2) {
  const int weld1 = m.body_weldid[body1];
  const int weld2 = m.body_weldid[body2];
  if (weld1 == weld2) return true;
  if (m.body_dofnum[weld1] == 0 && m.body_dofnum[weld2] == 0) return true;
  if (!(m.opt.disableflags & mjDSBL_FILTERPARENT) && weld1 != 0 && weld2 != 0) {
    const int parent1 = m.body_weldid[m.body_parentid[weld1]];
    const int parent2 = m.body_weldid[m.body_parentid[weld2]];
    if (weld1 == parent2 || weld2 == parent1) return true;
  }
  const int signature = (std::min(body1, body2) << 16) + std::max(body1, body2);
  return std::find(m.exclude_signature, m.exclude_signature + m.nexclude, signature) !=
         m.exclude_signature + m.nexclude;
}

// The contype/conaffinity filter keeps the pair.
bool MasksMeet(const mjModel& m, int g1, int g2) {
  return (m.geom_contype[g1] & m.geom_conaffinity[g2]) ||
         (m.geom_contype[g2] & m.geom_conaffinity[g1]);
}

// True if some movable joint lies between the two bodies: at or above exactly one of them.
bool JointBetween(const SceneTables& tables, int body1, int body2) {
  const mjModel& m = *tables.model;
  while (body1 != body2) {
    int& lower = body1 > body2 ? body1 : body2;  // parents have smaller ids
    for (int k = 0; k < m.body_dofnum[lower]; ++k) {
      if (tables.column_of_dof[m.body_dofadr[lower] + k] >= 0) return true;
    }
    lower = m.body_parentid[lower];
  }
  return false;
}

// Of two geoms in the order of a kept pair. A mesh beside an SDF or a height field is never exact:
// MuJoCo collides it as its hull there.
PairKind KindOf(const SceneTables& tables, int g1, int g2) {
  const mjModel& m = *tables.model;
  const auto not_a_hull = [&](int g) { return tables.exact[g] && !tables.convex[g]; };
  if (m.geom_type[g1] == mjGEOM_SDF || m.geom_type[g2] == mjGEOM_SDF) return PairKind::kSdf;
  if (m.geom_type[g1] == mjGEOM_HFIELD) return PairKind::kTerrain;
  return not_a_hull(g1) || not_a_hull(g2) ? PairKind::kExact : PairKind::kConvex;
}

KeptPair MakePair(const SceneTables& tables, int g1, int g2, double margin, double gap) {
  const mjModel& m = *tables.model;
  const int type1 = m.geom_type[g1], type2 = m.geom_type[g2];
  if (type1 > type2 || (type1 == type2 && g1 > g2)) std::swap(g1, g2);
  KeptPair pair;
  pair.geom1 = g1;
  pair.geom2 = g2;
  pair.allowed = std::max(0.0, -(margin + gap));
  pair.kept = std::max(0.0, margin);
  pair.kind = KindOf(tables, g1, g2);
  pair.moves = JointBetween(tables, m.geom_bodyid[g1], m.geom_bodyid[g2]);
  return pair;
}

// A sphere around the bounding spheres of the body's geoms, in the body's frame: of those about the
// centre of their common axis-aligned box, the smallest.
BoundingSphere EncloseBody(const mjModel& m, int body) {
  BoundingSphere sphere;
  const int begin = m.body_geomadr[body], end = begin + m.body_geomnum[body];
  if (begin < 0 || begin == end) return sphere;
  Eigen::AlignedBox3d box;
  for (int g = begin; g < end; ++g) {
    if (m.geom_type[g] == mjGEOM_PLANE) {
      sphere.radius = std::numeric_limits<double>::infinity();
      return sphere;
    }
    const Eigen::Map<const Eigen::Vector3d> pos(m.geom_pos + 3 * g);
    const Eigen::Vector3d reach = Eigen::Vector3d::Constant(m.geom_rbound[g]);
    box.extend(Eigen::AlignedBox3d(pos - reach, pos + reach));
  }
  sphere.center_B = box.center();
  for (int g = begin; g < end; ++g) {
    const Eigen::Map<const Eigen::Vector3d> pos(m.geom_pos + 3 * g);
    sphere.radius = std::max(sphere.radius, (pos - sphere.center_B).norm() + m.geom_rbound[g]);
  }
  return sphere;
}

void AppendDynamicPairs(SceneTables& tables, const std::set<std::pair<int, int>>& explicit_pairs) {
  const mjModel& m = *tables.model;
  for (int body1 = 0; body1 < m.nbody; ++body1) {
    for (int body2 = body1 + 1; body2 < m.nbody; ++body2) {
      if (m.body_geomnum[body1] == 0 || m.body_geomnum[body2] == 0) continue;
      if (BodiesFiltered(m, body1, body2)) continue;
      for (int i = 0; i < m.body_geomnum[body1]; ++i) {
        for (int j = 0; j < m.body_geomnum[body2]; ++j) {
          const int g1 = m.body_geomadr[body1] + i, g2 = m.body_geomadr[body2] + j;
          if (!MasksMeet(m, g1, g2) || !Collidable(m, g1, g2)) continue;
          if (explicit_pairs.count(std::minmax(g1, g2))) continue;
          const double margin = m.geom_margin[g1] + m.geom_margin[g2];
          const double gap = m.geom_gap[g1] + m.geom_gap[g2];
          tables.pairs.push_back(MakePair(tables, g1, g2, margin, gap));
        }
      }
    }
  }
}

void GroupByBodies(SceneTables& tables) {
  const mjModel& m = *tables.model;
  auto key = [&m](const KeptPair& p) {
    const int body1 = m.geom_bodyid[p.geom1], body2 = m.geom_bodyid[p.geom2];
    return std::pair<int, int>(std::min(body1, body2), std::max(body1, body2));
  };
  std::stable_sort(tables.pairs.begin(), tables.pairs.end(),
                   [&key](const KeptPair& a, const KeptPair& b) { return key(a) < key(b); });
  for (int i = 0; i < static_cast<int>(tables.pairs.size()); ++i) {
    const auto [body1, body2] = key(tables.pairs[i]);
    if (tables.body_pairs.empty() || tables.body_pairs.back().body1 != body1 ||
        tables.body_pairs.back().body2 != body2) {
      tables.body_pairs.push_back({body1, body2, i, i});
    }
    tables.body_pairs.back().end = i + 1;
  }
}

bool LeftOut(const SceneTables& tables, const KeptPair& pair) {
  const std::array<int, 2> geoms = {std::min(pair.geom1, pair.geom2),
                                    std::max(pair.geom1, pair.geom2)};
  return std::binary_search(tables.excluded.begin(), tables.excluded.end(), geoms) ||
         std::binary_search(tables.ignored.begin(), tables.ignored.end(), geoms);
}

void Allow(const AllowedOverlap& overlap, SceneTables& tables) {
  const std::vector<int> one = GeomsNamed(*tables.model, overlap.names[0]);
  const std::vector<int> other = GeomsNamed(*tables.model, overlap.names[1]);
  const auto is_in = [](const std::vector<int>& geoms, int geom) {
    return std::binary_search(geoms.begin(), geoms.end(), geom);
  };
  for (KeptPair& pair : tables.pairs) {
    const bool meant = (is_in(one, pair.geom1) && is_in(other, pair.geom2)) ||
                       (is_in(one, pair.geom2) && is_in(other, pair.geom1));
    if (meant) pair.allowed = std::max(pair.allowed, overlap.depth);
  }
}

}  // namespace

void FillKeptPairs(const SceneOptions& options, SceneTables& tables) {
  const mjModel& m = *tables.model;
  std::set<std::pair<int, int>> explicit_pairs;
  for (int k = 0; k < m.npair; ++k) {
    const int g1 = m.pair_geom1[k], g2 = m.pair_geom2[k];
    if (!Collidable(m, g1, g2)) continue;
    if (!explicit_pairs.insert({std::min(g1, g2), std::max(g1, g2)}).second) continue;
    tables.pairs.push_back(MakePair(tables, g1, g2, m.pair_margin[k], m.pair_gap[k]));
  }
  AppendDynamicPairs(tables, explicit_pairs);
  std::erase_if(tables.pairs, [&tables](const KeptPair& pair) { return LeftOut(tables, pair); });
  if (options.model_flags && (m.opt.disableflags & (mjDSBL_CONTACT | mjDSBL_CONSTRAINT))) {
    tables.pairs.clear();
  }
  for (const AllowedOverlap& overlap : options.allow) Allow(overlap, tables);
  GroupByBodies(tables);
  for (int body = 0; body < m.nbody; ++body) {
    tables.body_spheres.push_back(EncloseBody(m, body));
  }
  for (KeptPair& pair : tables.pairs) {
    if (!options.keep_margins) pair.kept = 0.0;
    if (pair.kind == PairKind::kSdf) tables.has_sdf_pairs = true;
    tables.largest_kept = std::max(tables.largest_kept, pair.kept);
  }
}

}  // namespace mjcf_pdg
