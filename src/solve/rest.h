// Options::rest: which contacts of q_in may keep their depth, as the verifier measured it.
#ifndef MJCF_PDG_SRC_SOLVE_REST_H_
#define MJCF_PDG_SRC_SOLVE_REST_H_

#include "model/kinematics.h"
#include "verify/verifier.h"

namespace mjcf_pdg {

// Fills `at_rest` with the negative distance that each kept pair may keep, infinite for pairs that
// may not overlap [m]. The verifier's last question must have been about q_in.
void DistancesAtRest(const Verifier& verifier, const SceneTables& tables, VectorXd& at_rest);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_SOLVE_REST_H_
