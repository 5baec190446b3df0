#include "optimize/contact_matrix.h"

#include <algorithm>
#include <cmath>

namespace mjcf_pdg {
namespace {

// The last dof that moves `body`, -1 if none.
int LastDof(const mjModel& m, int body) {
  while (body > 0 && m.body_dofnum[body] == 0) body = m.body_parentid[body];
  return body > 0 ? m.body_dofadr[body] + m.body_dofnum[body] - 1 : -1;
}

// A unit force along n_W at a point p_W of a body, as motion axes see it: about the centre of mass
// of the body's tree.
struct Wrench {
  Wrench(const PosedModel& posed, int body, const Vector3d& p_W, const Vector3d& n_W)
      : torque((p_W - AsVector(posed.data()->subtree_com + 3 * posed.model()->body_rootid[body]))
                   .cross(n_W)),
        force(n_W) {}

  // n · velocity of the point under unit speed of `dof`.
  double Rate(const mjData& d, int dof) const {
    const double* cdof = d.cdof + 6 * dof;
    return torque.dot(AsVector(cdof)) + force.dot(AsVector(cdof + 3));
  }

  Vector3d torque, force;
};

}  // namespace

void ContactRows::Clear(int n) {
  if (C.cols() != n) C.resize(0, n);
  m = 0;
}

void ContactRows::Reserve(int rows, int n) {
  C.resize(rows, n);
  gap.resize(rows);
  sources.resize(rows);
  m = 0;
}

int ContactRows::Append(double gap_value, RowSource source) {
  if (m == C.rows()) {
    const Eigen::Index capacity = std::max<Eigen::Index>(32, 2 * C.rows());
    C.conservativeResize(capacity, C.cols());
    gap.conservativeResize(capacity);
    sources.resize(capacity);
  }
  C.row(m).setZero();
  gap[m] = gap_value;
  sources[m] = source;
  return m++;
}

void ContactRow(const SceneTables& tables, const PosedModel& posed, int pair, const Vector3d& p1_W,
                const Vector3d& p2_W, const Vector3d& n_W, Eigen::Ref<Eigen::RowVectorXd> out) {
  const mjModel& m = *posed.model();
  const mjData& d = *posed.data();
  const int body1 = m.geom_bodyid[tables.pairs[pair].geom1];
  const int body2 = m.geom_bodyid[tables.pairs[pair].geom2];
  const Wrench on1(posed, body1, p1_W, n_W), on2(posed, body2, p2_W, n_W);
  out.setZero();
  int dof1 = LastDof(m, body1), dof2 = LastDof(m, body2);
  while (dof1 != dof2) {
    const bool second = dof2 > dof1;
    int& dof = second ? dof2 : dof1;
    const int col = tables.column_of_dof[dof];
    if (col >= 0) out[col] = second ? on2.Rate(d, dof) : -on1.Rate(d, dof);
    dof = m.dof_parentid[dof];
  }
}

Support RowSupport(const SceneTables& tables, const RowSource& source) {
  const mjModel& m = *tables.model;
  if (source.pair < 0 && source.joint < 0) return {{0, tables.n}, {}};
  if (source.pair < 0) {
    const int size = m.jnt_type[source.joint] == mjJNT_BALL ? 3 : 1;
    return {{tables.column_of_dof[m.jnt_dofadr[source.joint]], size}, {}};
  }
  int dof1 = LastDof(m, m.geom_bodyid[tables.pairs[source.pair].geom1]);
  int dof2 = LastDof(m, m.geom_bodyid[tables.pairs[source.pair].geom2]);
  Support support;
  while (dof1 != dof2) {
    const bool second = dof2 > dof1;
    int& dof = second ? dof2 : dof1;
    ColumnRange& range = second ? support.second : support.first;
    const int col = tables.column_of_dof[dof];
    if (col >= 0) range = {col, range.size == 0 ? 1 : range.begin + range.size - col};
    dof = m.dof_parentid[dof];
  }
  return support;
}

void AppendLimitRows(const SceneTables& tables, const VectorXd& q, const LimitRowOptions& reach,
                     ContactRows& rows) {
  for (const JointEntry& joint : tables.joints) {
    if (!joint.limited) continue;
    const RowSource limit{.joint = joint.id};
    if (joint.type != mjJNT_BALL) {
      const double below = q[joint.qadr] - joint.lo, above = joint.hi - q[joint.qadr];
      const bool slides = joint.type == mjJNT_SLIDE;
      const double near = slides ? reach.slide : reach.turn, arm = slides ? 1.0 : reach.radius;
      if (below < near) rows.C(rows.Append(arm * below, limit), joint.col) = arm;
      if (above < near) rows.C(rows.Append(arm * above, limit), joint.col) = -arm;
      continue;
    }
    const double* quat = q.data() + joint.qadr;
    const double angle = BallAngle(quat);
    if (joint.hi - angle >= reach.turn) continue;
    // The angle grows by axis · w, w the body-frame rotation.
    Vector3d axis = Vector3d(quat[1], quat[2], quat[3]) * (quat[0] < 0.0 ? -1.0 : 1.0);
    if (axis.norm() < 1e-9) continue;
    const int row = rows.Append(reach.radius * (joint.hi - angle), limit);
    rows.C.row(row).segment<3>(joint.col) = -reach.radius * axis.normalized().transpose();
  }
}

void AppendObserved(const SceneTables& tables, const ContactRows& rows, const VectorXd& lambda,
                    std::vector<ObservedRow>& observed) {
  for (int k = 0; k < rows.m; ++k) {
    ObservedRow row{.joint = rows.sources[k].joint, .gap = rows.gap[k], .multiplier = lambda[k]};
    const int pair = rows.sources[k].pair;
    if (pair >= 0) row.geom = {tables.pairs[pair].geom1, tables.pairs[pair].geom2};
    observed.push_back(row);
  }
}

}  // namespace mjcf_pdg
