#include "verify/pairs.h"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>

#include "base/names.h"

namespace mjcf_pdg::verify {
namespace {

// For each body, the ids of the movable joints between it and the world, ascending.
std::vector<std::vector<int>> MovableJointsAbove(const mjModel& m, const SceneOptions& options) {
  std::vector<char> may_move(m.nbody, options.movable.empty());
  for (const std::string& name : options.movable) {
    const int body = mj_name2id(&m, mjOBJ_BODY, name.c_str());
    if (body < 0) throw Error("no body named '" + name + "'");
    may_move[body] = 1;
  }
  std::vector<char> fixed(m.nbody, 0);
  for (const std::string& name : options.fixed) {
    const int body = mj_name2id(&m, mjOBJ_BODY, name.c_str());
    if (body < 0) throw Error("no body named '" + name + "'");
    fixed[body] = 1;
  }
  std::vector<std::vector<int>> joints(m.nbody);
  for (int body = 1; body < m.nbody; ++body) {  // parents come first
    const int parent = m.body_parentid[body];
    joints[body] = joints[parent];
    may_move[body] |= may_move[parent];
    if (!may_move[body] || fixed[body]) continue;
    for (int k = 0; k < m.body_jntnum[body]; ++k) joints[body].push_back(m.body_jntadr[body] + k);
  }
  return joints;
}

// MuJoCo's filters of bodies and geoms.
class Filter {
 public:
  explicit Filter(const mjModel& m) : m_(m) {}

  bool KeepsBodies(int a, int b) const {
    const int piece_a = m_.body_weldid[a], piece_b = m_.body_weldid[b];  // welded groups of bodies
    if (piece_a == piece_b || (IsStatic(piece_a) && IsStatic(piece_b))) return false;
    const bool filters_parents = !(m_.opt.disableflags & mjDSBL_FILTERPARENT);
    if (filters_parents && (IsParent(piece_a, piece_b) || IsParent(piece_b, piece_a))) return false;
    const auto [low, high] = std::minmax(a, b);
    const int signature = (low << 16) + high;
    return std::none_of(m_.exclude_signature, m_.exclude_signature + m_.nexclude,
                        [signature](int excluded) { return excluded == signature; });
  }

  // By their masks.
  bool KeepsGeoms(int a, int b) const {
    return (m_.geom_contype[a] & m_.geom_conaffinity[b]) != 0 ||
           (m_.geom_contype[b] & m_.geom_conaffinity[a]) != 0;
  }

  bool HasCollisionFunction(int a, int b) const {
    const auto [low, high] = std::minmax(m_.geom_type[a], m_.geom_type[b]);
    if (high >= mjNGEOMTYPES) throw std::logic_error("MuJoCo collides no geoms of this type");
    return mjCOLLISIONFUNC[low][high] != nullptr;
  }

 private:
  bool IsStatic(int piece) const { return m_.body_dofnum[piece] == 0; }
  bool IsParent(int piece, int child) const {
    return piece != 0 && child != 0 && m_.body_weldid[m_.body_parentid[child]] == piece;
  }
  const mjModel& m_;
};

// By geom: the name means it, as geom or as one of a body's.
std::vector<char> Meant(const mjModel& m, const std::string& name) {
  std::vector<char> meant(m.ngeom, 0);
  for (const int geom : GeomsNamed(m, name)) meant[geom] = 1;
  return meant;
}

}  // namespace

LeftOut PairsLeftOut(const mjModel& m, const SceneOptions& options,
                     const std::vector<std::array<int, 2>>& ignored) {
  LeftOut pairs;
  for (const auto& [a, b] : ignored) pairs.insert(std::minmax(a, b));
  for (const NamePair& names : options.exclude) {
    const std::vector<char> one = Meant(m, names[0]), other = Meant(m, names[1]);
    for (int a = 0; a < m.ngeom; ++a) {
      for (int b = 0; b < m.ngeom; ++b) {
        if (one[a] && other[b] && a != b) pairs.insert(std::minmax(a, b));
      }
    }
  }
  return pairs;
}

bool IsSdf(int type) { return type == mjGEOM_SDF; }

std::vector<CheckedPair> FindPairs(const mjModel& m, const SceneOptions& options,
                                   const std::vector<char>& exact) {
  const int no_contacts = mjDSBL_CONTACT | mjDSBL_CONSTRAINT;
  if (options.model_flags && (m.opt.disableflags & no_contacts)) return {};
  const std::vector<std::vector<int>> joints = MovableJointsAbove(m, options);
  const Filter filter(m);
  struct Reach {
    double margin, gap;
  };
  std::map<std::pair<int, int>, Reach> reach;  // of the pairs of geoms (low, high)
  for (int k = 0; k < m.npair; ++k) {
    if (!filter.HasCollisionFunction(m.pair_geom1[k], m.pair_geom2[k])) continue;
    const auto [low, high] = std::minmax(m.pair_geom1[k], m.pair_geom2[k]);
    reach.try_emplace({low, high}, Reach{m.pair_margin[k], m.pair_gap[k]});
  }
  std::map<std::pair<int, int>, bool> kept_bodies;
  for (int a = 0; a < m.ngeom; ++a) {
    for (int b = a + 1; b < m.ngeom; ++b) {
      if (!filter.KeepsGeoms(a, b)) continue;
      const auto [known, is_new] =
          kept_bodies.try_emplace({m.geom_bodyid[a], m.geom_bodyid[b]}, false);
      if (is_new) known->second = filter.KeepsBodies(m.geom_bodyid[a], m.geom_bodyid[b]);
      if (!known->second || !filter.HasCollisionFunction(a, b)) continue;
      reach.try_emplace({a, b},
                        Reach{m.geom_margin[a] + m.geom_margin[b], m.geom_gap[a] + m.geom_gap[b]});
    }
  }
  std::vector<CheckedPair> pairs;
  for (const auto& [geoms, of_model] : reach) {
    CheckedPair pair;
    std::tie(pair.geom1, pair.geom2) = geoms;
    if (m.geom_type[pair.geom1] > m.geom_type[pair.geom2]) std::swap(pair.geom1, pair.geom2);
    pair.allowed = std::max(0.0, -(of_model.margin + of_model.gap));
    pair.margin = of_model.margin;
    pair.sdf = IsSdf(m.geom_type[geoms.first]) || IsSdf(m.geom_type[geoms.second]);
    pair.terrain = !pair.sdf && m.geom_type[pair.geom1] == mjGEOM_HFIELD;
    pair.exact = !pair.sdf && !pair.terrain && (exact[geoms.first] || exact[geoms.second]);
    pair.separable = joints[m.geom_bodyid[geoms.first]] != joints[m.geom_bodyid[geoms.second]];
    pairs.push_back(pair);
  }
  for (const AllowedOverlap& overlap : options.allow) {
    const std::vector<char> one = Meant(m, overlap.names[0]), other = Meant(m, overlap.names[1]);
    for (CheckedPair& pair : pairs) {
      const bool meant =
          (one[pair.geom1] && other[pair.geom2]) || (one[pair.geom2] && other[pair.geom1]);
      if (meant && overlap.depth > pair.allowed) pair.allowed = overlap.depth;
    }
  }
  return pairs;
}

}  // namespace mjcf_pdg::verify
