// What the independent check has found, and how findings become a verdict: contacts and words.
#ifndef MJCF_PDG_SRC_VERIFY_FINDINGS_H_
#define MJCF_PDG_SRC_VERIFY_FINDINGS_H_

#include <mujoco/mujoco.h>

#include <Eigen/Dense>
#include <vector>

#include "mjcf_pdg/pdg.h"

namespace mjcf_pdg::verify {

// A pair that violates or touches.
struct Finding {
  Contact contact;
  double required = 0.0;  // smallest distance that counts as free, tolerance aside [m]
  bool violates = false;
  bool frozen = false;    // no movable joint lies between the two geoms
  bool unproven = false;  // it violates for want of a certificate
};

struct LimitExcess {
  int joint = 0;
  double excess = 0.0;  // [rad or m]
};

struct Findings {
  std::vector<Finding> pairs;
  std::vector<LimitExcess> limits;
  bool arena_full = false;

  void Clear();
};

// All but the geoms and the distance of a contact: n_W points from geom 1 to geom 2, p1_W and p2_W
// are the witness points.
void SetPlace(const Eigen::Vector3d& n_W, const Eigen::Vector3d& p1_W, const Eigen::Vector3d& p2_W,
              Contact& contact);
// From MuJoCo's contact of the geoms in `contact`, in either order; distance included.
void SetFromContact(const mjContact& source, Contact& contact);

// Is the reason wanted, too? Words take from the heap.
enum class Words { kWritten, kSkipped };

// Refills the verdict's contacts, reason and `free`. Sorts the findings.
void WriteVerdict(const mjModel& m, Words words, Findings& findings, Verdict& verdict);

}  // namespace mjcf_pdg::verify

#endif  // MJCF_PDG_SRC_VERIFY_FINDINGS_H_
