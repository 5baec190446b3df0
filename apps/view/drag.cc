#include "apps/view/drag.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

namespace mjcf_pdg::app {
namespace {

// The hand moves some pixels a frame, so a few steps are enough; where the point cannot be reached
// the rest of them is lost.
constexpr int kMostSteps = 20;
// Damping, as a share of the mean of the diagonal of J W Jᵀ: near-singular (stretched) arms need
// some ten steps, others one or two.
constexpr double kDamping = 1e-3;
constexpr double kLargestTurn = 0.3;  // of a step [rad]: the linearization is good to 5 %
// When the grabbed point is near enough: this share of the model's size, and this angle [rad].
constexpr double kEnough = 1e-4;

using Matrix3X = Eigen::Matrix<double, 3, Eigen::Dynamic>;

bool IsTurning(int type) { return type == mjJNT_HINGE || type == mjJNT_BALL; }

void Pose(const mjModel& m, mjData& d) {
  mj_kinematics(&m, &d);
  mj_comPos(&m, &d);
}

// Hinges and slides stay in their range, balls within their total angle.
void ClampJoint(const mjModel& m, int joint, double* q) {
  if (!m.jnt_limited[joint]) return;
  const double low = m.jnt_range[2 * joint], high = m.jnt_range[2 * joint + 1];
  if (m.jnt_type[joint] != mjJNT_BALL) {
    q[0] = std::clamp(q[0], low, high);
    return;
  }
  mju_normalize4(q);
  double turn[3];
  mju_quat2Vel(turn, q, 1.0);  // the short way: at most half a turn
  const double angle = mju_normalize3(turn);
  if (angle > high) mju_axisAngle2Quat(q, turn, high);
}

}  // namespace

Drag::Drag(const mjModel& model, const mjData& data, int body, const std::array<double, 3>& point_W)
    : model_(model), body_(body), point_W_(point_W) {
  double from_body[3];
  mju_sub3(from_body, point_W.data(), data.xpos + 3 * body);
  mju_mulMatTVec3(point_B_.data(), data.xmat + 9 * body, from_body);
  std::copy_n(data.xquat + 4 * body, 4, body_turn_W_.begin());
  bool joints = false;
  for (int b = body; b > 0; b = model.body_parentid[b]) {
    const int first = model.body_jntadr[b], count = model.body_jntnum[b];
    const bool is_free = count > 0 && model.jnt_type[first] == mjJNT_FREE;
    if (model.body_mocapid[b] >= 0 || is_free) {
      if (!joints) {
        carrier_ = is_free ? Carrier::kFreeJoint : Carrier::kMocap;
        carrier_body_ = b;
      }
      break;
    }
    joints = joints || count > 0;
  }
  if (joints) carrier_ = Carrier::kJoints;
  std::copy_n(data.xpos + 3 * carrier_body_, 3, place_W_.begin());
  std::copy_n(data.xquat + 4 * carrier_body_, 4, turn_W_.begin());
}

// The joint moves the body, and no free joint does so between the two.
bool Drag::IsBetween(int joint) const {
  if (model_.jnt_type[joint] == mjJNT_FREE) return false;
  for (int b = body_; b > 0; b = model_.body_parentid[b]) {
    if (b == model_.jnt_bodyid[joint]) return true;
    const int first = model_.body_jntadr[b];
    if (first >= 0 && model_.jnt_type[first] == mjJNT_FREE) return false;
  }
  return false;
}

// About the grabbed point.
void Drag::Carry(mjData& data, const std::array<double, 3>& translation_W,
                 const std::array<double, 4>& rotation_W) const {
  double arm[3], turned[3], place[3], turn[4];
  mju_sub3(arm, place_W_.data(), point_W_.data());
  mju_rotVecQuat(turned, arm, rotation_W.data());
  for (int k = 0; k < 3; ++k) place[k] = point_W_[k] + turned[k] + translation_W[k];
  mju_mulQuat(turn, rotation_W.data(), turn_W_.data());
  mju_normalize4(turn);
  double *position, *quaternion;
  if (carrier_ == Carrier::kMocap) {
    const int mocap = model_.body_mocapid[carrier_body_];
    position = data.mocap_pos + 3 * mocap;
    quaternion = data.mocap_quat + 4 * mocap;
  } else {
    position = data.qpos + model_.jnt_qposadr[model_.body_jntadr[carrier_body_]];
    quaternion = position + 3;
  }
  std::copy_n(place, 3, position);
  std::copy_n(turn, 4, quaternion);
  Pose(model_, data);
}

// `error` returns what is left to go [m], or to turn [rad], world axes.
template <typename Error3>
void Drag::Pull(mjData& data, bool turns, double enough, Error3 error) const {
  std::vector<int> joints, dofs;
  for (int joint = 0; joint < model_.njnt; ++joint) {
    if (!IsBetween(joint) || (turns && !IsTurning(model_.jnt_type[joint]))) continue;
    joints.push_back(joint);
    const int count = model_.jnt_type[joint] == mjJNT_BALL ? 3 : 1;
    for (int k = 0; k < count; ++k) dofs.push_back(model_.jnt_dofadr[joint] + k);
  }
  const Eigen::Index n = static_cast<Eigen::Index>(dofs.size());
  if (n == 0) return;
  Eigen::VectorXd weight(n), dq_all = Eigen::VectorXd::Zero(model_.nv);
  for (Eigen::Index k = 0; k < n; ++k) {
    weight[k] = std::max(mjMINVAL, model_.dof_invweight0[dofs[static_cast<std::size_t>(k)]]);
  }
  std::vector<double> jacobian(3 * static_cast<std::size_t>(model_.nv));
  for (int step = 0; step < kMostSteps; ++step) {
    const Eigen::Vector3d left = error(data);
    if (left.norm() <= enough) return;
    double point[3];
    mju_mulMatVec3(point, data.xmat + 9 * body_, point_B_.data());
    mju_addTo3(point, data.xpos + 3 * body_);
    mj_jac(&model_, &data, turns ? nullptr : jacobian.data(), turns ? jacobian.data() : nullptr,
           point, body_);
    Matrix3X rows(3, n);
    for (int r = 0; r < 3; ++r) {
      for (Eigen::Index k = 0; k < n; ++k) {
        rows(r, k) =
            jacobian[static_cast<std::size_t>(r) * model_.nv + dofs[static_cast<std::size_t>(k)]];
      }
    }
    Eigen::Matrix3d metric = rows * weight.asDiagonal() * rows.transpose();
    metric.diagonal().array() += kDamping * metric.trace() / 3 + mjMINVAL;
    Eigen::VectorXd dq = weight.asDiagonal() * rows.transpose() * metric.ldlt().solve(left);
    const double largest = dq.cwiseAbs().maxCoeff();
    if (IsTurning(model_.jnt_type[joints.back()]) && largest > kLargestTurn) {
      dq *= kLargestTurn / largest;
    }
    for (Eigen::Index k = 0; k < n; ++k) dq_all[dofs[static_cast<std::size_t>(k)]] = dq[k];
    mj_integratePos(&model_, data.qpos, dq_all.data(), 1.0);
    for (const int joint : joints) {
      ClampJoint(model_, joint, data.qpos + model_.jnt_qposadr[joint]);
    }
    Pose(model_, data);
  }
}

void Drag::MoveTo(mjData& data, const std::array<double, 3>& translation_W) const {
  if (stuck()) return;
  if (carrier_ != Carrier::kJoints) return Carry(data, translation_W, {1, 0, 0, 0});
  Pull(data, false, kEnough * model_.stat.extent, [&](const mjData& d) {
    double point[3];
    mju_mulMatVec3(point, d.xmat + 9 * body_, point_B_.data());
    mju_addTo3(point, d.xpos + 3 * body_);
    Eigen::Vector3d left;
    for (int k = 0; k < 3; ++k) left[k] = point_W_[k] + translation_W[k] - point[k];
    return left;
  });
}

void Drag::TurnTo(mjData& data, const std::array<double, 4>& rotation_W) const {
  if (stuck()) return;
  if (carrier_ != Carrier::kJoints) return Carry(data, {0, 0, 0}, rotation_W);
  double target[4];
  mju_mulQuat(target, rotation_W.data(), body_turn_W_.data());
  Pull(data, true, kEnough, [&](const mjData& d) {
    double back[4], rest[4];
    mju_negQuat(back, d.xquat + 4 * body_);
    mju_mulQuat(rest, target, back);
    Eigen::Vector3d left;
    mju_quat2Vel(left.data(), rest, 1.0);
    return left;
  });
}

}  // namespace mjcf_pdg::app
