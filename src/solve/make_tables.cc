#include "solve/make_tables.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

#include "base/names.h"
#include "collide/convex/support_points.h"
#include "collide/permanent.h"
#include "equality/held.h"
#include "model/exact_mesh.h"
#include "model/kept_pairs.h"
#include "solve/model_file.h"
#include "solve/model_numbers.h"
#include "solve/options.h"

namespace mjcf_pdg {
namespace {

// Of MuJoCo's convex solver [scene's size]: distances to cylinders jitter by 5e-7 m at its default
// of 1e-6 m in scenes of 0.1 m.
constexpr double kCcdTolerance = 1e-8;

// MuJoCo scales heights to shares of the largest one when it compiles a model. Outside of that they
// would stick out of the field's bounds, by which queries begin.
void RefuseBadHeights(const mjModel& m) {
  for (int field = 0; field < m.nhfield; ++field) {
    const float* heights = m.hfield_data + m.hfield_adr[field];
    const int count = m.hfield_nrow[field] * m.hfield_ncol[field];
    if (std::all_of(heights, heights + count, [](float h) { return h >= 0.0f && h <= 1.0f; })) {
      continue;
    }
    throw Error("height field " + QuotedNameOrId(m, mjOBJ_HFIELD, field) +
                " has a height that is not between 0 and 1 (hfield_data)");
  }
}

void RefuseUnsupported(const mjModel& m, const SceneOptions& options) {
  if (m.nflex > 0 && !options.ignore_flexes) {
    throw Error("flex " + QuotedNameOrId(m, mjOBJ_FLEX, 0) +
                " is not supported (--flex ignore leaves it out)");
  }
  if (m.njnt == 0) throw Error("the model has no joints: nothing can move");
  CheckModelNumbers(m);
  RefuseBadHeights(m);
}

// MuJoCo only warns that it cannot collide these: an overlap would never be seen.
void RefuseUnseenPairs(const SceneTables& tables) {
  const mjModel& m = *tables.model;
  for (const KeptPair& pair : tables.pairs) {
    if (m.geom_type[pair.geom1] == mjGEOM_HFIELD && m.geom_type[pair.geom2] == mjGEOM_SDF) {
      throw Error("height field " + QuotedNameOrPlace(m, pair.geom1) + " against SDF " +
                  QuotedNameOrPlace(m, pair.geom2) + " is not supported: exclude the pair");
    }
  }
}

int BodyByName(const mjModel* m, const std::string& name) {
  const int body = mj_name2id(m, mjOBJ_BODY, name.c_str());
  if (body >= 0) return body;
  throw Error("no body named '" + name + "' (bodies: " + BodyNames(*m) + ")");
}

// Per body: it or an ancestor is named in options.movable (all when none is named).
std::vector<char> SelectedBodies(const mjModel* m, const std::vector<std::string>& names) {
  std::vector<char> selected(m->nbody, names.empty());
  for (const std::string& name : names) selected[BodyByName(m, name)] = 1;
  for (int b = 1; b < m->nbody; ++b) {
    if (selected[m->body_parentid[b]]) selected[b] = 1;
  }
  return selected;
}

std::vector<char> FixedBodies(const mjModel* m, const std::vector<std::string>& names) {
  std::vector<char> fixed(m->nbody, 0);
  for (const std::string& name : names) fixed[BodyByName(m, name)] = 1;
  return fixed;
}

// The bodies that are nothing but vertices or nodes of a flex: they have slides only, and no geom.
std::vector<int> BodiesOfFlexes(const mjModel& m) {
  std::vector<int> bodies(m.flex_vertbodyid, m.flex_vertbodyid + m.nflexvert);
  bodies.insert(bodies.end(), m.flex_nodebodyid, m.flex_nodebodyid + m.nflexnode);
  std::erase_if(bodies, [&m](int body) {
    const int* joints = m.jnt_type + m.body_jntadr[body];
    return body == 0 || m.body_geomnum[body] > 0 ||
           !std::all_of(joints, joints + m.body_jntnum[body],
                        [](int type) { return type == mjJNT_SLIDE; });
  });
  return bodies;
}

bool HonoursDisabled(const mjModel& m, const SceneOptions& options, int flag) {
  return options.model_flags && (m.opt.disableflags & (flag | mjDSBL_CONSTRAINT));
}

void CheckArmature(double armature) {
  if (armature >= 0.0 && armature <= 1000.0) return;
  throw Error("the armature is not between 0 and 1000 kg m²");
}

double Armature(const mjModel& m, const JointEntry& joint, const SceneOptions& options) {
  if (joint.type == mjJNT_FREE) return 0.0;
  return options.armature + (options.model_armature ? m.dof_armature[joint.vadr] : 0.0);
}

void FillJoints(SceneTables& tables, const SceneOptions& options) {
  const mjModel* m = tables.model;
  CheckArmature(options.armature);
  const std::vector<char> selected = SelectedBodies(m, options.movable);
  std::vector<char> fixed = FixedBodies(m, options.fixed);
  for (const int body : BodiesOfFlexes(*m)) fixed[body] = 1;
  const bool limits = !HonoursDisabled(*m, options, mjDSBL_LIMIT);
  tables.column_of_dof.assign(m->nv, -1);
  tables.body_moves.assign(m->nbody, 0);
  for (int j = 0; j < m->njnt; ++j) {
    const int body = m->jnt_bodyid[j];
    if (!selected[body] || fixed[body]) continue;
    JointEntry joint;
    joint.id = j;
    joint.type = m->jnt_type[j];
    joint.body = body;
    joint.qadr = m->jnt_qposadr[j];
    joint.vadr = m->jnt_dofadr[j];
    joint.col = tables.n;
    joint.ndof = joint.type == mjJNT_FREE ? 6 : joint.type == mjJNT_BALL ? 3 : 1;
    joint.limited = limits && m->jnt_limited[j] && joint.type != mjJNT_FREE;
    // A side without limit may be given as infinite; the search needs differences of finite
    // numbers.
    joint.lo = std::max(m->jnt_range[2 * j], -mjMAXVAL);
    joint.hi = std::min(m->jnt_range[2 * j + 1], mjMAXVAL);
    joint.armature = Armature(*m, joint, options);
    for (int k = 0; k < joint.ndof; ++k) tables.column_of_dof[joint.vadr + k] = tables.n++;
    tables.joints.push_back(joint);
    tables.body_moves[body] = 1;
  }
  for (int b = 1; b < m->nbody; ++b) {
    if (tables.body_moves[m->body_parentid[b]]) tables.body_moves[b] = 1;
  }
  if (tables.joints.empty())
    throw Error("no joint may move: the movable bodies have no joints of their own or are fixed");
}

void FillRoot(SceneTables& tables, const std::string& name) {
  if (name.empty()) return;
  tables.root_body = BodyByName(tables.model, name);
  if (tables.model->body_treeid[tables.root_body] < 0) {
    throw Error("root '" + name + "' cannot move: it belongs to no kinematic tree");
  }
}

double TypicalSize(const SceneTables& tables) {
  const mjModel& m = *tables.model;
  std::vector<double> radii;
  for (int g = 0; g < m.ngeom; ++g) {
    const bool collides = m.geom_contype[g] || m.geom_conaffinity[g];
    if (collides && tables.body_moves[m.geom_bodyid[g]] && m.geom_rbound[g] > 0.0) {
      radii.push_back(m.geom_rbound[g]);
    }
  }
  if (radii.empty()) return 1.0;
  const auto middle = radii.begin() + static_cast<std::ptrdiff_t>(radii.size() / 2);
  std::nth_element(radii.begin(), middle, radii.end());
  return *middle;
}

// Settings that blind MuJoCo's collision detection are undone on a private struct.
mjModel UnblindedCopy(const SceneTables& tables) {
  mjModel copy = *tables.model;
  copy.nflex = 0;
  copy.opt.disableflags &= ~(mjDSBL_CONTACT | mjDSBL_CONSTRAINT | mjDSBL_NATIVECCD);
  copy.opt.enableflags &= ~(mjENBL_OVERRIDE | mjENBL_SLEEP | mjENBL_SPECULATIVE | mjENBL_IPC);
  copy.opt.ccd_iterations = std::max(copy.opt.ccd_iterations, 50);
  std::size_t contacts = 0;
  for (const KeptPair& pair : tables.pairs) {
    contacts += mj_maxContact(tables.model, pair.geom1, pair.geom2, 1);
  }
  const std::size_t bodies = tables.model->nbody;
  const std::size_t need = (std::size_t{16} << 20) + contacts * sizeof(mjContact) +
                           tables.pairs.size() * 64 + bodies * bodies * 16;
  copy.narena = std::max<mjtSize>(copy.narena, static_cast<mjtSize>(need));
  return copy;
}

// What is left out is said, once.
void WarnOfEqualities(EqualityMode mode, SceneTables& tables) {
  const mjModel& m = *tables.model;
  if (mode != EqualityMode::kHold || (m.opt.disableflags & mjDSBL_EQUALITY)) return;
  int left_out = 0;
  for (int e = 0; e < m.neq; ++e) left_out += m.eq_active0[e] && JoinsMocapBody(m, e);
  if (left_out == 0) return;
  tables.warnings.push_back(std::to_string(left_out) +
                            (left_out == 1 ? " equality constraint joins a mocap body and is"
                                           : " equality constraints join mocap bodies and are") +
                            " left out: --equality all holds them, too");
}

void WarnOfFlexes(SceneTables& tables) {
  const mjModel& m = *tables.model;
  for (int f = 0; f < m.nflex; ++f) {
    tables.warnings.push_back("flex " + QuotedNameOrId(m, mjOBJ_FLEX, f) +
                              " is left out: it collides with nothing, its vertices stay");
  }
}

void WarnOfFlags(const SceneOptions& options, SceneTables& tables) {
  const mjModel& m = *tables.model;
  const std::array<std::tuple<int, const char*, const char*>, 3> flags = {
      {{mjDSBL_CONTACT, "contact", "contacts"},
       {mjDSBL_LIMIT, "limit", "joint limits"},
       {mjDSBL_CONSTRAINT, "constraint", "contacts, limits and equality constraints"}}};
  for (const auto& [flag, name, what] : flags) {
    if (!(m.opt.disableflags & flag)) continue;
    tables.warnings.push_back(
        std::string("the model disables ") + what + " (<flag " + name + "=\"disable\"/>): they " +
        (options.model_flags ? "do not count" : "count all the same, unless --flags model"));
  }
}

// All pairs of geoms that the names mean, ascending.
std::vector<std::array<int, 2>> PairsNamed(const mjModel& m, const std::vector<NamePair>& names) {
  std::vector<std::array<int, 2>> pairs;
  for (const NamePair& two : names) {
    for (const int a : GeomsNamed(m, two[0])) {
      for (const int b : GeomsNamed(m, two[1])) pairs.push_back({std::min(a, b), std::max(a, b)});
    }
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

void CheckAllowed(const std::vector<AllowedOverlap>& allow) {
  for (const AllowedOverlap& overlap : allow) {
    if (overlap.depth >= 0.0 && overlap.depth <= 1000.0) continue;
    throw Error("the allowed overlap of '" + overlap.names[0] + "' and '" + overlap.names[1] +
                "' is not between 0 and 1000 m");
  }
}

// What is made of the geoms in kept pairs.
void FillShapes(SceneTables& tables) {
  BuildBvhs(tables);
  tables.support = std::make_shared<const SupportPoints>(*tables.model, tables.pairs);
  tables.query_model = UnblindedCopy(tables);
  tables.query_model.opt.disableflags |= mjDSBL_MULTICCD;
  tables.query_model.opt.ccd_tolerance = kCcdTolerance * tables.size;
}

// The kept pairs with all that is made for them.
void FillPairs(const SceneOptions& options, SceneTables& tables) {
  tables.pairs.clear();
  tables.body_pairs.clear();
  tables.body_spheres.clear();
  tables.has_sdf_pairs = false;
  tables.largest_kept = 0.0;
  FillKeptPairs(options, tables);
  RefuseUnseenPairs(tables);
  FillShapes(tables);
}

}  // namespace

std::shared_ptr<const SceneTables> MakeTables(std::shared_ptr<const mjModel> owner,
                                              const mjModel* model, const SceneOptions& options) {
  CheckMujocoVersion();
  RefuseUnsupported(*model, options);
  auto tables = std::make_shared<SceneTables>();
  tables->owner = std::move(owner);
  tables->model = model;
  FillJoints(*tables, options);
  tables->size = TypicalSize(*tables);
  FillRoot(*tables, options.root);
  MarkExactGeoms(options, *tables);
  CheckAllowed(options.allow);
  tables->excluded = PairsNamed(*model, options.exclude);
  FillPairs(options, *tables);
  if (options.ignore_permanent) {
    tables->ignored = FindPermanentOverlaps(*tables);
    if (!tables->ignored.empty()) FillPairs(options, *tables);
  }
  const bool equalities = !(options.model_flags && (model->opt.disableflags & mjDSBL_CONSTRAINT));
  const EqualityMode equality = equalities ? options.equality : EqualityMode::kIgnore;
  tables->held_equalities = HeldEqualities(*model, equality);
  tables->held_tendons = HeldTendons(*model, options);
  WarnOfEqualities(equality, *tables);
  WarnOfFlags(options, *tables);
  WarnOfFlexes(*tables);
  return tables;
}

std::shared_ptr<const SceneTables> ResizedTables(const SceneTables& tables,
                                                 std::shared_ptr<const mjModel> model) {
  auto resized = std::make_shared<SceneTables>(tables);
  resized->model = model.get();
  resized->owner = std::move(model);
  FillShapes(*resized);
  return resized;
}

}  // namespace mjcf_pdg
