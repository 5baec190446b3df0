#include "apps/audit/examine.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <utility>

#include "apps/console/interrupt.h"
#include "apps/input/configurations.h"
#include "apps/input/random_configuration.h"
#include "mjcf_pdg/pdg.h"
#include "model/scene_tables.h"

namespace mjcf_pdg::app {
namespace {

constexpr double kEqualityTolerance = 1e-3;  // equalities, which MuJoCo holds softly [rad or m]
constexpr double kConfidence = 0.95;
constexpr double kGravity = 9.81;  // where a model has none [m/s²]

using DataPtr = std::unique_ptr<mjData, void (*)(mjData*)>;

// How often a pair overlapped, and where it did deepest.
struct Seen {
  std::size_t random = 0, posed = 0;  // random configurations; qpos0 and keyframes
  Contact deepest;
  Configuration where;
};
using SeenPairs = std::map<std::array<int, 2>, Seen>;

// Which contacts count: those deeper than the tolerance and than what the model allows their pair
// by a negative margin + gap.
class Overlaps {
 public:
  Overlaps(const Scene& scene, double tolerance) : tolerance_(tolerance) {
    for (const KeptPair& pair : scene.tables().pairs) {
      if (pair.allowed > 0.0) allowed_[std::minmax(pair.geom1, pair.geom2)] = pair.allowed;
    }
  }

  std::vector<Contact> Of(const Verdict& verdict) const {
    std::vector<Contact> counting;
    for (const Contact& contact : verdict.contacts) {
      const auto allowed = allowed_.find(std::minmax(contact.geom[0], contact.geom[1]));
      const double free = tolerance_ + (allowed == allowed_.end() ? 0.0 : allowed->second);
      if (contact.distance < -free) counting.push_back(contact);
    }
    return counting;
  }

 private:
  const double tolerance_;
  std::map<std::pair<int, int>, double> allowed_;
};

void Note(const Configuration& row, const std::vector<Contact>& contacts, std::size_t Seen::* count,
          SeenPairs& seen) {
  for (const Contact& contact : contacts) {
    Seen& pair = seen[contact.geom];
    ++(pair.*count);
    if (contact.distance >= pair.deepest.distance) continue;
    pair.deepest = contact;
    pair.where = row;
  }
}

// The largest violation of the equality constraints that are active in `d`.
double EqualityResidual(const mjData& d) {
  double largest = 0.0;
  for (int row = 0; row < d.nefc; ++row) {
    if (d.efc_type[row] == mjCNSTR_EQUALITY) {
      largest = std::max(largest, std::abs(d.efc_pos[row]));
    }
  }
  return largest;
}

double ForceOverWeight(const mjModel& m, const mjData& d) {
  double force = 0.0, mass = 0.0;
  for (int c = 0; c < d.ncon; ++c) {
    mjtNum wrench[6];
    mj_contactForce(&m, &d, c, wrench);
    force += wrench[0];
  }
  for (int b = 0; b < m.nbody; ++b) mass += m.body_weldid[b] == 0 ? 0.0 : m.body_mass[b];
  const double gravity = mju_norm3(m.opt.gravity);
  return mass > 0.0 ? force / (mass * (gravity > 0.0 ? gravity : kGravity)) : 0.0;
}

AuditedKey ExamineKey(const mjModel& m, const Configuration& row, const Verdict& verdict,
                      std::vector<Contact> contacts, mjData* d) {
  AuditedKey key;
  key.of = row;
  key.contacts = std::move(contacts);
  if (row.key < 0) {
    mj_resetData(&m, d);
  } else {
    mj_resetDataKeyframe(&m, d, row.key);
  }
  mj_forward(&m, d);
  for (const Contact& contact : key.contacts) key.depth = std::max(key.depth, -contact.distance);
  key.limit_excess = verdict.limit_excess;
  key.equality_residual = EqualityResidual(*d);
  key.force_over_weight = ForceOverWeight(m, *d);
  key.penetrates = key.depth > 0.0;
  key.leaves_limits = key.limit_excess > kLimitTolerance;
  key.violates = key.equality_residual > kEqualityTolerance;
  return key;
}

// qpos0, and every keyframe.
std::vector<Configuration> Poses(const Scene& scene) {
  std::vector<Configuration> poses(1);
  poses[0].label = "qpos0";
  poses[0].q = scene.DefaultQpos();
  if (scene.model()->nkey == 0) return poses;
  RowSource keys(scene, {});
  for (Configuration row; keys.Next(row);) poses.push_back(row);
  return poses;
}

std::vector<AuditedPair> Classify(const SeenPairs& seen, std::size_t samples, std::size_t poses) {
  std::vector<AuditedPair> pairs;
  for (const auto& [geoms, found] : seen) {
    AuditedPair pair{geoms[0], geoms[1],      Overlap::kSometimes, found.random,
                     0.0,      found.deepest, found.where};
    pair.share = static_cast<double>(found.random) / static_cast<double>(samples);
    if (found.random == samples && found.posed == poses) {
      pair.kind = Overlap::kPermanent;
    } else if (found.posed > 0) {
      pair.kind = Overlap::kDefault;
    }
    pairs.push_back(pair);
  }
  std::stable_sort(pairs.begin(), pairs.end(), [](const AuditedPair& a, const AuditedPair& b) {
    return a.kind != b.kind ? a.kind < b.kind : a.share > b.share;
  });
  return pairs;
}

std::string BodyOf(const mjModel& m, int geom) {
  const char* name = mj_id2name(&m, mjOBJ_BODY, m.geom_bodyid[geom]);
  return name ? name : "";
}

void FindExcludes(const Scene& scene, Audit& audit) {
  for (const AuditedPair& pair : audit.pairs) {
    if (pair.kind != Overlap::kPermanent) continue;
    std::pair<std::string, std::string> bodies = {BodyOf(*scene.model(), pair.geom1),
                                                  BodyOf(*scene.model(), pair.geom2)};
    if (bodies.first.empty() || bodies.second.empty()) {
      audit.warnings.push_back(scene.GeomName(pair.geom1) + " and " + scene.GeomName(pair.geom2) +
                               " always overlap, and <exclude> needs names of their bodies: --fix "
                               "gives one to a body that has none");
      const int* body = scene.model()->geom_bodyid;
      audit.unnamed.emplace_back(body[pair.geom1], body[pair.geom2]);
    } else if (std::find(audit.exclude.begin(), audit.exclude.end(), bodies) ==
               audit.exclude.end()) {
      audit.exclude.push_back(std::move(bodies));
    }
  }
}

// What keeps MuJoCo from seeing or pushing contacts.
void WarnOfBlindness(const Scene& scene, Audit& audit) {
  const mjModel& m = *scene.model();
  const auto warn = [&](const std::string& words) { audit.warnings.push_back(words); };
  if (m.opt.disableflags & mjDSBL_FILTERPARENT) {
    warn("the filter of parent and child is off (<flag filterparent>): neighbours collide");
  }
  const std::vector<KeptPair>& pairs = scene.tables().pairs;
  const auto allowing = std::count_if(pairs.begin(), pairs.end(),
                                      [](const KeptPair& pair) { return pair.allowed > 0.0; });
  int blind = 0, gaps = 0;
  for (int g = 0; g < m.ngeom; ++g) {
    blind += m.geom_contype[g] == 0 && m.geom_conaffinity[g] == 0;
    gaps += m.geom_gap[g] > 0.0;
  }
  if (blind == m.ngeom && m.ngeom > 0 && m.npair == 0) {
    warn("no geom collides (contype and conaffinity are 0)");
  }
  if (allowing > 0) {
    warn(
        std::to_string(allowing) + (allowing == 1 ? " pair has" : " pairs have") +
        " a negative margin + gap: MuJoCo does not see overlaps up to that, and they do not count");
  }
  if (gaps > 0) {
    warn(std::to_string(gaps) + (gaps == 1 ? " geom has a gap: its" : " geoms have a gap: their") +
         " contacts are listed so much before they push");
  }
}

}  // namespace

const char* NameOf(Overlap kind) {
  switch (kind) {
    case Overlap::kPermanent:
      return "permanent";
    case Overlap::kDefault:
      return "default";
    case Overlap::kSometimes:
      break;
  }
  return "sometimes";
}

bool Audit::Wrong() const {
  return std::any_of(pairs.begin(), pairs.end(),
                     [](const AuditedPair& p) { return p.kind != Overlap::kSometimes; }) ||
         std::any_of(keys.begin(), keys.end(), [](const AuditedKey& k) { return k.Wrong(); });
}

Audit Examine(const Scene& scene, const AuditOptions& options) {
  Audit audit;
  audit.warnings = scene.Warnings();
  SeenPairs seen;
  const DataPtr d(mj_makeData(scene.model()), mj_deleteData);
  if (!d) throw Error("out of memory");
  Options asked;
  asked.tolerance = options.tolerance;
  const Overlaps overlaps(scene, options.tolerance);
  const std::vector<Configuration> poses = Poses(scene);
  for (const Configuration& row : poses) {
    asked.mocap_pos = row.mocap_pos;
    asked.mocap_quat = row.mocap_quat;
    const Verdict verdict = Verify(scene, row.q, asked);
    const std::vector<Contact> contacts = overlaps.Of(verdict);
    Note(row, contacts, &Seen::posed, seen);
    audit.keys.push_back(ExamineKey(*scene.model(), row, verdict, contacts, d.get()));
  }
  asked.mocap_pos.clear();
  asked.mocap_quat.clear();
  Random random(options.seed);
  for (; audit.samples < options.samples && !Interrupted(); ++audit.samples) {
    Configuration row;
    row.label = "random " + std::to_string(audit.samples);
    row.q = RandomConfiguration(scene, random);
    Note(row, overlaps.Of(Verify(scene, row.q, asked)), &Seen::random, seen);
  }
  audit.pairs = Classify(seen, audit.samples, poses.size());
  audit.never = static_cast<std::size_t>(scene.num_kept_pairs()) - audit.pairs.size();
  audit.never_share =
      1.0 - std::pow(1.0 - kConfidence,
                     1.0 / static_cast<double>(std::max<std::size_t>(1, audit.samples)));
  FindExcludes(scene, audit);
  WarnOfBlindness(scene, audit);
  return audit;
}

}  // namespace mjcf_pdg::app
