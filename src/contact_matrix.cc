#include "contact_matrix.h"

#include <algorithm>
#include <cmath>

namespace mjcf_pdg {
namespace {

// The last dof that moves `body`, -1 if none.
int LastDof(const mjModel& m, int body) {
  while (body > 0 && m.body_dofnum[body] == 0) body = m.body_parentid[body];
  return body > 0 ? m.body_dofadr[body] + m.body_dofnum[body] - 1 : -1;
}

// n · velocity of the point p_W under unit speed of `dof`.
double PointRate(const PosedModel& posed, int dof, const Vector3d& p_W, const Vector3d& n_W) {
  const mjModel& m = *posed.model();
  const mjData& d = *posed.data();
  const int root = m.body_rootid[m.dof_bodyid[dof]];
  const Vector3d lever = p_W - AsVector(d.subtree_com + 3 * root);
  const double* cdof = d.cdof + 6 * dof;
  return n_W.dot(AsVector(cdof + 3) + AsVector(cdof).cross(lever));
}

}  // namespace

void ContactRows::Clear(int n) {
  if (C.cols() != n) C.resize(0, n);
  m = 0;
}

int ContactRows::Append(double gap_value) {
  if (m == C.rows()) {
    const Eigen::Index capacity = std::max<Eigen::Index>(32, 2 * C.rows());
    C.conservativeResize(capacity, C.cols());
    gap.conservativeResize(capacity);
  }
  C.row(m).setZero();
  gap[m] = gap_value;
  return m++;
}

void ContactRow(const SceneTables& tables, const PosedModel& posed, int pair, const Vector3d& p1_W,
                const Vector3d& p2_W, const Vector3d& n_W, Eigen::Ref<Eigen::RowVectorXd> out) {
  const mjModel& m = *posed.model();
  out.setZero();
  int dof1 = LastDof(m, m.geom_bodyid[tables.pairs[pair].geom1]);
  int dof2 = LastDof(m, m.geom_bodyid[tables.pairs[pair].geom2]);
  while (dof1 != dof2) {
    const bool second = dof2 > dof1;
    int& dof = second ? dof2 : dof1;
    const int col = tables.column_of_dof[dof];
    if (col >= 0) {
      out[col] = second ? PointRate(posed, dof, p2_W, n_W) : -PointRate(posed, dof, p1_W, n_W);
    }
    dof = m.dof_parentid[dof];
  }
}

void AppendLimitRows(const SceneTables& tables, const VectorXd& q, double reach,
                     ContactRows& rows) {
  for (const JointEntry& joint : tables.joints) {
    if (!joint.limited) continue;
    if (joint.type != mjJNT_BALL) {
      const double below = q[joint.qadr] - joint.lo, above = joint.hi - q[joint.qadr];
      if (below < reach) rows.C(rows.Append(below), joint.col) = 1.0;
      if (above < reach) rows.C(rows.Append(above), joint.col) = -1.0;
      continue;
    }
    const double* quat = q.data() + joint.qadr;
    const double angle = BallAngle(quat);
    if (joint.hi - angle >= reach) continue;
    // The angle grows by axis · w, w the body-frame rotation.
    Vector3d axis = Vector3d(quat[1], quat[2], quat[3]) * (quat[0] < 0.0 ? -1.0 : 1.0);
    if (axis.norm() < 1e-9) continue;
    const int row = rows.Append(joint.hi - angle);
    rows.C.row(row).segment<3>(joint.col) = -axis.normalized().transpose();
  }
}

}  // namespace mjcf_pdg
