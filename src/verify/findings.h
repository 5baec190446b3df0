// What the verifier has found wrong with a configuration, and how findings become a verdict: its
// contacts and the reason in words.
#ifndef MJCF_PDG_SRC_VERIFY_FINDINGS_H_
#define MJCF_PDG_SRC_VERIFY_FINDINGS_H_

#include <mujoco/mujoco.h>

#include <Eigen/Dense>
#include <vector>

#include "mjcf_pdg/pdg.h"

namespace mjcf_pdg::verify {

// A pair of geoms that is nearer than the tolerance or than required.
struct Finding {
  Contact contact;
  double required = 0.0;  // signed distance that it must keep, within the tolerance [m]
  bool violates = false;  // it does not keep that, so the configuration is not free
  bool frozen = false;    // no movable joint can separate the two geoms
  bool unproven = false;  // counts as a violation because no certificate was found
};

// A joint outside its range.
struct LimitExcess {
  int joint = 0;        // id in the model
  double excess = 0.0;  // how far outside [rad or m]
};

// An equality constraint that does not hold.
struct EqualityExcess {
  int equality = 0;       // id in the model
  double residual = 0.0;  // [m or rad]
};

// A tendon whose length is outside its range [m; of a fixed tendon in units of its joints times
// their coefficients].
struct TendonExcess {
  int tendon = 0;  // id in the model
  double length = 0.0, excess = 0.0;
};

struct Findings {
  std::vector<Finding> pairs;
  std::vector<LimitExcess> limits;
  std::vector<EqualityExcess> equalities;
  std::vector<TendonExcess> tendons;
  bool arena_full = false;  // MuJoCo dropped contacts for want of memory

  void Clear();
};

// Sets the normal and the position of `contact`, not its geoms and distance. n_W is a unit normal
// from geom 1 to geom 2, p1_W and p2_W are the witness points.
void SetPlace(const Eigen::Vector3d& n_W, const Eigen::Vector3d& p1_W, const Eigen::Vector3d& p2_W,
              Contact& contact);
// Sets the normal, the position and the distance of `contact` from MuJoCo's contact of the same two
// geoms, which may have them in the other order.
void SetFromContact(const mjContact& source, Contact& contact);

// Whether the verdict's reason is written, which allocates memory.
enum class Words { kWritten, kSkipped };

// Sets the verdict's contacts (deepest first), its reason and `free`: true if nothing violates.
// Sorts findings.pairs.
void WriteVerdict(const mjModel& m, Words words, Findings& findings, Verdict& verdict);

}  // namespace mjcf_pdg::verify

#endif  // MJCF_PDG_SRC_VERIFY_FINDINGS_H_
