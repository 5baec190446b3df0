// Which joint limits, equality constraints and tendon limits a configuration violates, by the
// verifier's own formulas.
#ifndef MJCF_PDG_SRC_VERIFY_CONSTRAINTS_H_
#define MJCF_PDG_SRC_VERIFY_CONSTRAINTS_H_

#include <mujoco/mujoco.h>

#include <span>
#include <vector>

#include "mjcf_pdg/scene.h"
#include "verify/findings.h"

namespace mjcf_pdg::verify {

// Appends the joints that q (nq entries) puts outside their ranges by more than the verifier's own
// kLimitTolerance, frozen joints too; none if m.opt disables limits. Returns the largest excess of
// any joint, at least 0 [rad or m]. The limit of a ball joint is on its total rotation angle, twist
// included.
double CheckLimits(const mjModel& m, std::span<const double> q, std::vector<LimitExcess>& outside);

// By equality constraint of the model: joint and tendon couplings, connects and welds that the
// options ask to hold, while they are active.
std::vector<char> EqualitiesToHold(const mjModel& m, const SceneOptions& options);

// Appends the constraints, of those with an entry in `active`, that are violated by more than the
// verifier's own kEqualityTolerance at the pose of `d`, for which mj_kinematics has run; where
// tendons are coupled it runs mj_comPos and mj_tendon. Returns the largest violation, of distances
// in m and of angles in rad.
double CheckEqualities(const mjModel& m, const std::vector<char>& active, mjData& d,
                       std::vector<EqualityExcess>& violated);

// By tendon of the model: its length limits count, as the options ask.
std::vector<char> TendonsToHold(const mjModel& m, const SceneOptions& options);

// Appends the tendons, of those with an entry in `held`, whose lengths at the pose of `d`, for
// which mj_kinematics has run, are outside their ranges by more than the verifier's own
// kEqualityTolerance. Runs mj_comPos and mj_tendon if there are some. Returns the largest excess,
// at least 0.
double CheckTendons(const mjModel& m, const std::vector<char>& held, mjData& d,
                    std::vector<TendonExcess>& outside);

}  // namespace mjcf_pdg::verify

#endif  // MJCF_PDG_SRC_VERIFY_CONSTRAINTS_H_
