// Options::rest: which contacts of q_in may keep their depth, by the verifier's measure.
#ifndef MJCF_PDG_SRC_SOLVE_REST_H_
#define MJCF_PDG_SRC_SOLVE_REST_H_

#include "model/kinematics.h"
#include "verify/verifier.h"

namespace mjcf_pdg {

// Per kept pair the distance to which it may rest, negative; infinite for pairs that may not [m].
// The verifier was last asked about a q_in.
void DistancesAtRest(const Verifier& verifier, const SceneTables& tables, VectorXd& at_rest);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_SOLVE_REST_H_
