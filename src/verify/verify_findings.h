// What the independent check has found, and how findings become a verdict: contacts and words.
#ifndef MJCF_PDG_SRC_VERIFY_VERIFY_FINDINGS_H_
#define MJCF_PDG_SRC_VERIFY_VERIFY_FINDINGS_H_

#include <mujoco/mujoco.h>

#include <string>
#include <vector>

#include "mjcf_pdg/pdg.h"

namespace mjcf_pdg {

// Witness points nearer than this give no normal [m].
inline constexpr double kNoDirection = 1e-8;

// What both witnesses say of one kept pair, or of a contact that is in no kept pair.
struct Finding {
  Contact contact;
  double required = 0.0;  // smallest distance that counts as free, tolerance aside [m]
  bool violates = false;
  bool frozen = false;  // no movable joint lies between the two geoms
};

// Both fill all of `contact` but its geoms, which are set already: from MuJoCo's contact of them in
// either order, or from their signed distance and its witness points.
void FillFromContact(const mjContact& source, Contact& contact);
void FillFromWitnesses(const mjData& d, double distance, const double fromto[6], Contact& contact);

// A joint `excess` outside its range [rad or m], in words.
std::string DescribeExcess(const mjModel& m, int joint, double excess);

// Fills the verdict's contacts, reason and `free`; contacts and reason are empty before. Sorts the
// findings.
void WriteVerdict(const mjModel& m, bool arena_full, std::vector<Finding>& findings,
                  const std::vector<std::string>& limit_reasons, Verdict& verdict);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_VERIFY_VERIFY_FINDINGS_H_
