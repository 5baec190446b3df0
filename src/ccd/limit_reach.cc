#include "ccd/limit_reach.h"

#include <algorithm>
#include <cmath>

namespace mjcf_pdg {
namespace {

// By which the limit of a hinge or a ball counts as held [rad]: far above the rounding of angles of
// a few turns (1e-15), far below what moves anything by a tolerance.
constexpr double kAngleSlack = 1e-9;

double ScalarReach(const JointEntry& joint, double q, double dq, double slack) {
  const double bound = dq > 0.0 ? joint.hi : joint.lo;
  const double beyond = dq > 0.0 ? q + dq - bound : bound - q - dq;
  if (dq == 0.0 || beyond <= slack) return 1.0;
  return std::clamp((bound - q) / dq, 0.0, 1.0);
}

// The scalar part of q0 exp(s dq) is R cos(s φ/2 + ψ), φ = ‖dq‖; the limit holds while it is at
// least cos(hi/2).
double BallReach(const JointEntry& joint, const double* quat, const Vector3d& dq) {
  const double phi = dq.norm(), hi = joint.hi + 0.5 * kAngleSlack;
  if (phi == 0.0 || hi >= M_PI) return 1.0;
  const Eigen::Vector4d q = Eigen::Map<const Eigen::Vector4d>(quat).normalized();
  const double sign = q[0] < 0.0 ? -1.0 : 1.0;
  const double w = sign * q[0], along = sign * q.tail<3>().dot(dq) / phi;
  const double R = std::hypot(w, along), psi = std::atan2(along, w), least = std::cos(hi / 2);
  if (R < least) return 0.0;
  return std::clamp(2.0 * (std::acos(std::min(1.0, least / R)) - psi) / phi, 0.0, 1.0);
}

}  // namespace

double LimitReach(const SceneTables& tables, const VectorXd& q0, const VectorXd& dq,
                  double slide_slack, int& joint) {
  double reach = 1.0;
  joint = -1;
  for (int j = 0; j < static_cast<int>(tables.joints.size()); ++j) {
    const JointEntry& entry = tables.joints[j];
    if (!entry.limited) continue;
    const double slack = entry.type == mjJNT_SLIDE ? slide_slack : kAngleSlack;
    const double own = entry.type == mjJNT_BALL
                           ? BallReach(entry, q0.data() + entry.qadr, dq.segment<3>(entry.col))
                           : ScalarReach(entry, q0[entry.qadr], dq[entry.col], slack);
    if (own >= reach) continue;
    reach = own;
    joint = j;
  }
  return reach;
}

int JointOutsideLimits(const SceneTables& tables, const VectorXd& q, double slack) {
  int worst = -1;
  for (int j = 0; j < static_cast<int>(tables.joints.size()); ++j) {
    const JointEntry& joint = tables.joints[j];
    if (!joint.limited) continue;
    const double excess = joint.type == mjJNT_BALL
                              ? BallAngle(q.data() + joint.qadr) - joint.hi
                              : std::max(joint.lo - q[joint.qadr], q[joint.qadr] - joint.hi);
    if (excess <= slack) continue;
    slack = excess;
    worst = j;
  }
  return worst;
}

}  // namespace mjcf_pdg
