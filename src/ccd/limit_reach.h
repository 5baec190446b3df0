// How far a motion goes before a joint leaves its limits.
#ifndef MJCF_PDG_SRC_CCD_LIMIT_REACH_H_
#define MJCF_PDG_SRC_CCD_LIMIT_REACH_H_

#include "model/kinematics.h"

namespace mjcf_pdg {

// The largest t in [0, 1] so that q0 ⊕ t·dq keeps all joint limits; `joint` is then the index into
// SceneTables::joints of the one that ends it, -1 if none. Limits count as held within 1e-9 rad
// (kAngleSlack; half of it for balls), those of slides within `slide_slack` [m]. Hinges and slides
// change monotonically: only balls can leave a limit between two configurations that keep it.
double LimitReach(const SceneTables& tables, const VectorXd& q0, const VectorXd& dq,
                  double slide_slack, int& joint);

// The index of the joint that is farthest outside its limits at q, if by more than `slack` [rad or
// m]; else -1.
int JointOutsideLimits(const SceneTables& tables, const VectorXd& q, double slack);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_CCD_LIMIT_REACH_H_
