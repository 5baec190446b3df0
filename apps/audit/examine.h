// What is wrong with a model: pairs that overlap wherever its joints go or where it begins, and
// keyframes that penetrate, leave limits or violate equalities.
#ifndef MJCF_PDG_APPS_AUDIT_EXAMINE_H_
#define MJCF_PDG_APPS_AUDIT_EXAMINE_H_

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "apps/input/configurations.h"
#include "mjcf_pdg/pdg.h"
#include "mjcf_pdg/scene.h"

namespace mjcf_pdg::app {

struct AuditOptions {
  std::size_t samples = 1000;  // random configurations inside limits
  std::uint64_t seed = 0;
  double tolerance = 1e-6;  // overlap that is none [m]
};

enum class Overlap {
  kPermanent,  // in every configuration that was looked at
  kDefault,    // at qpos0 or in a keyframe, but not always
  kSometimes,  // in random configurations alone, as any robot's links do
};
const char* NameOf(Overlap kind);

struct AuditedPair {
  int geom1 = -1, geom2 = -1;
  Overlap kind = Overlap::kSometimes;
  std::size_t count = 0;  // of the random configurations: those in which it overlaps
  double share = 0.0;     // the same of all of them
  // The deepest overlap that was seen; its distance is negative. In which configuration: a
  // keyframe, qpos0 or a random one.
  Contact deepest;
  Configuration where;
};

struct AuditedKey {
  Configuration of;                // labelled "qpos0" for the model's default
  std::vector<Contact> contacts;   // overlaps that count, deepest first
  double depth = 0.0;              // deepest overlap that counts, positive [m]
  double limit_excess = 0.0;       // largest violation of a joint limit [rad or m]
  double equality_residual = 0.0;  // largest violation of an active equality [rad or m]
  // Sum of the normal contact forces that MuJoCo applies there, over the weight of what can move:
  // about 1 for a robot that stands, hundreds for one that explodes.
  double force_over_weight = 0.0;
  bool penetrates = false, leaves_limits = false, violates = false;

  bool Wrong() const { return penetrates || leaves_limits || violates; }
};

struct Audit {
  std::size_t samples = 0;
  std::vector<AuditedPair> pairs;  // by class, then share
  std::size_t never = 0;           // kept pairs that never overlapped
  double never_share = 0.0;        // each of those overlaps in less of all, with 95 % confidence
  // Pairs of bodies, by name, whose geoms overlap permanently.
  std::vector<std::pair<std::string, std::string>> exclude;
  // Such pairs, by id, in which a body has no name, so that nothing can be said of it in MJCF.
  std::vector<std::pair<int, int>> unnamed;
  std::vector<AuditedKey> keys;  // qpos0 first
  std::vector<std::string> warnings;

  bool Wrong() const;
};

Audit Examine(const Scene& scene, const AuditOptions& options);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_AUDIT_EXAMINE_H_
