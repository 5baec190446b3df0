// Which joints are outside their ranges.
#ifndef MJCF_PDG_SRC_VERIFY_LIMITS_H_
#define MJCF_PDG_SRC_VERIFY_LIMITS_H_

#include <mujoco/mujoco.h>

#include <span>
#include <vector>

#include "verify/findings.h"

namespace mjcf_pdg::verify {

// Appends the joints that q (nq entries) puts outside their ranges by more than the verifier's own
// kLimitTolerance, frozen joints too. Returns the largest excess of any joint, at least 0 [rad or
// m]. The limit of a ball joint is on its total rotation angle, twist included.
double CheckLimits(const mjModel& m, std::span<const double> q, std::vector<LimitExcess>& outside);

}  // namespace mjcf_pdg::verify

#endif  // MJCF_PDG_SRC_VERIFY_LIMITS_H_
