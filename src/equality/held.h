// Which equality constraints of a model are held while solving.
#ifndef MJCF_PDG_SRC_EQUALITY_HELD_H_
#define MJCF_PDG_SRC_EQUALITY_HELD_H_

#include <mujoco/mujoco.h>

#include <string>
#include <vector>

#include "mjcf_pdg/scene.h"

namespace mjcf_pdg {

// By equality constraint: it is of a kind that `mode` holds. Whether it is active is another
// question, which the model or a mjData answers.
std::vector<char> HeldEqualities(const mjModel& m, EqualityMode mode);

// By tendon: its length limits are held, as the options ask. One whose limits the model disables by
// <flag> is not, if the options honour that.
std::vector<char> HeldTendons(const mjModel& m, const SceneOptions& options);

// Whether all that is held holds along the straight motion between any two configurations that hold
// it: couplings of joints, or of tendons that are sums of joints, by a polynomial of at most first
// degree, and limits of such tendons. The vectors are those that the two above return; equalities
// that the model does not switch on do not count.
bool HoldsAlongStraightMotions(const mjModel& m, const std::vector<char>& equalities,
                               const std::vector<char>& tendons);

// For messages: its kind and its name or "#id".
std::string DescribeEquality(const mjModel& m, int equality);

// Whether a connect or weld drives a robot by a mocap body: that is not structure.
bool JoinsMocapBody(const mjModel& m, int equality);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_EQUALITY_HELD_H_
