// How far one configuration is from another in the coordinates X of the norm's quadratic form
// XᵀHX (Tang & Kim, Eq. 26), for two configurations of which neither is q_in.
#ifndef MJCF_PDG_SRC_NORM_CHANGE_H_
#define MJCF_PDG_SRC_NORM_CHANGE_H_

#include "model/kinematics.h"

namespace mjcf_pdg {

// X (n) has, per joint, Δq of a slide [m], 2 sin(Δq/2) of a hinge and 2 vec(conj(from) ⊗ to) of a
// ball, in the body's frame (q_in to q, types.h has it in world axes); of a free joint the
// translation of its body [m] and then that. X(to, from) = -X(from, to). If `D` is not null it
// becomes ∂X/∂dq at `to` (n × n).
void Change(const SceneTables& tables, const VectorXd& from, const VectorXd& to, VectorXd& X,
            MatrixXd* D);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_NORM_CHANGE_H_
