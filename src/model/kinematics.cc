#include "model/kinematics.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mjcf_pdg/types.h"

namespace mjcf_pdg {
namespace {

bool Rotates3d(const JointEntry& joint) {
  return joint.type == mjJNT_FREE || joint.type == mjJNT_BALL;
}

}  // namespace

void Integrate(const SceneTables& tables, const VectorXd& q, const VectorXd& dq, VectorXd& out) {
  if (&out != &q) out = q;
  for (const JointEntry& joint : tables.joints) {
    if (!Rotates3d(joint)) {
      out[joint.qadr] += dq[joint.col];
      continue;
    }
    if (joint.type == mjJNT_FREE) out.segment<3>(joint.qadr) += dq.segment<3>(joint.col);
    double* quat = out.data() + QuatAddress(joint);
    mju_normalize4(quat);
    mju_quatIntegrate(quat, dq.data() + RotationColumn(joint), 1.0);
    mju_normalize4(quat);
  }
}

void Difference(const SceneTables& tables, const VectorXd& from, const VectorXd& to, VectorXd& dq) {
  dq.resize(tables.n);
  for (const JointEntry& joint : tables.joints) {
    if (!Rotates3d(joint)) {
      dq[joint.col] = to[joint.qadr] - from[joint.qadr];
      continue;
    }
    if (joint.type == mjJNT_FREE) {
      dq.segment<3>(joint.col) = to.segment<3>(joint.qadr) - from.segment<3>(joint.qadr);
    }
    double unit_to[4], unit_from[4];
    mju_copy4(unit_to, to.data() + QuatAddress(joint));
    mju_copy4(unit_from, from.data() + QuatAddress(joint));
    mju_normalize4(unit_to);
    mju_normalize4(unit_from);
    mju_subQuat(dq.data() + RotationColumn(joint), unit_to, unit_from);
  }
}

void SetMovable(const SceneTables& tables, const VectorXd& pose, VectorXd& q) {
  for (const JointEntry& joint : tables.joints) {
    q.segment(joint.qadr, QposEntries(joint)) = pose.segment(joint.qadr, QposEntries(joint));
    if (Rotates3d(joint)) mju_normalize4(q.data() + QuatAddress(joint));
  }
}

VectorXd WithMovable(const SceneTables& tables, const VectorXd& base, const VectorXd& pose) {
  VectorXd q = base;
  SetMovable(tables, pose, q);
  return q;
}

double BallAngle(const double* quat) {
  const double vector = std::sqrt(quat[1] * quat[1] + quat[2] * quat[2] + quat[3] * quat[3]);
  return 2.0 * std::atan2(vector, std::abs(quat[0]));
}

double LimitExcess(const JointEntry& joint, const VectorXd& q) {
  if (!joint.limited) return 0.0;
  if (joint.type == mjJNT_BALL) return std::max(0.0, BallAngle(q.data() + joint.qadr) - joint.hi);
  return std::max({0.0, joint.lo - q[joint.qadr], q[joint.qadr] - joint.hi});
}

double LimitExcess(const SceneTables& tables, const VectorXd& q) {
  double excess = 0.0;
  for (const JointEntry& joint : tables.joints) excess = std::max(excess, LimitExcess(joint, q));
  return excess;
}

void ClampToLimits(const SceneTables& tables, VectorXd& q) {
  for (const JointEntry& joint : tables.joints) {
    if (!joint.limited) continue;
    if (joint.type != mjJNT_BALL) {
      q[joint.qadr] = std::clamp(q[joint.qadr], joint.lo, joint.hi);
      continue;
    }
    double* quat = q.data() + joint.qadr;
    const double angle = BallAngle(quat);
    if (angle <= joint.hi) continue;
    const double sign = quat[0] < 0.0 ? -1.0 : 1.0;
    Vector3d axis(quat[1], quat[2], quat[3]);
    axis.normalize();
    quat[0] = sign * std::cos(joint.hi / 2);
    Eigen::Map<Vector3d>(quat + 1) = axis * std::sin(joint.hi / 2);
  }
}

void TurnInsideLimits(const SceneTables& tables, VectorXd& q) {
  constexpr double kTurn = 2.0 * mjPI;
  for (const JointEntry& joint : tables.joints) {
    if (!joint.limited || joint.type != mjJNT_HINGE) continue;
    double& angle = q[joint.qadr];
    if (angle >= joint.lo && angle <= joint.hi) continue;
    // The smallest equivalent angle at or above the range's lower end, and the one a turn below.
    const double above = angle + kTurn * std::ceil((joint.lo - angle) / kTurn);
    const double below = above - kTurn;
    angle = above - joint.hi <= joint.lo - below ? above : below;
  }
  ClampToLimits(tables, q);
}

void Unwind(const SceneTables& tables, const VectorXd& q_in, VectorXd& q) {
  for (const JointEntry& joint : tables.joints) {
    if (joint.type != mjJNT_HINGE) continue;
    const double turns = std::round((q[joint.qadr] - q_in[joint.qadr]) / (2.0 * mjPI));
    if (turns == 0.0) continue;
    const double angle = q[joint.qadr] - turns * 2.0 * mjPI;
    if (!joint.limited || (angle >= joint.lo && angle <= joint.hi)) q[joint.qadr] = angle;
  }
}

PosedModel::PosedModel(const mjModel* model, const std::vector<char>& moving_trees,
                       std::shared_ptr<mjData> data)
    : model_(model), data_(std::move(data)), of_island_(!moving_trees.empty()) {
  if (!data_) data_ = {mj_makeData(model), mj_deleteData};
  if (!data_) throw Error("MuJoCo could not allocate its data for this model");
  if (!of_island_) return;
  std::vector<char> listed(model->nbody, 0);
  for (int body = model->nbody - 1; body > 0; --body) {
    const int tree = model->body_treeid[body];
    if (tree >= 0 && moving_trees[tree]) {
      moving_.push_back(body);
      listed[body] = 1;
    }
    listed[model->body_parentid[body]] |= listed[body];
  }
  for (int body = 0; body < model->nbody; ++body) {
    if (listed[body]) listed_.push_back(body);
  }
}

// MuJoCo poses only what is awake (mjENBL_SLEEP, which Pose sets), by lists of that, which its
// simulation updates. What stays counts as static, which spares MuJoCo the look at its joints; the
// bodies that carry the island are listed for their subtree_com. ntree_awake stays as it is: if
// some trees are asleep, a pose of the whole model wakes them and writes the lists anew.
void PosedModel::LetOthersStay() {
  mjData& d = *data_;
  std::fill_n(d.body_awake, model_->nbody, static_cast<int>(mjS_STATIC));
  for (const int body : moving_) d.body_awake[body] = mjS_AWAKE;
  d.nbody_awake = d.nparent_awake = static_cast<int>(listed_.size());
  std::copy(listed_.begin(), listed_.end(), d.body_awake_ind);
  std::copy(listed_.begin(), listed_.end(), d.parent_awake_ind);
}

void PosedModel::SetMocap(const MocapPoses& poses) {
  const auto set = [this](mjtNum* to, const mjtNum* from, int count) {
    poses_all_ |= !std::equal(from, from + count, to);
    std::copy_n(from, count, to);
  };
  for (int b = 1; b < model_->nbody; ++b) {
    const int mocap = model_->body_mocapid[b];
    if (mocap < 0) continue;
    set(data_->mocap_pos + 3 * mocap,
        poses.pos.empty() ? model_->body_pos + 3 * b : poses.pos.data() + 3 * mocap, 3);
    set(data_->mocap_quat + 4 * mocap,
        poses.quat.empty() ? model_->body_quat + 4 * b : poses.quat.data() + 4 * mocap, 4);
  }
}

void PosedModel::Pose(const Eigen::Ref<const VectorXd>& q) {
  mju_copy(data_->qpos, q.data(), static_cast<int>(q.size()));
  if (!of_island_) {
    mj_kinematics(model_, data_.get());
    mj_comPos(model_, data_.get());
    return;
  }
  mjModel model = *model_;  // the struct alone
  if (!poses_all_) model.opt.enableflags |= mjENBL_SLEEP;
  mj_kinematics(&model, data_.get());
  mj_comPos(&model, data_.get());
  if (poses_all_) LetOthersStay();
  poses_all_ = false;
}

void BodyJacobians::Fill(const SceneTables& tables, const PosedModel& posed, int body,
                         const Vector3d& p_W) {
  const int nv = static_cast<int>(posed.model()->nv);
  point_of_all_.resize(3, nv);
  rotation_of_all_.resize(3, nv);
  mj_jac(posed.model(), posed.data(), point_of_all_.data(), rotation_of_all_.data(), p_W.data(),
         body);
  point.resize(3, tables.n);
  rotation.resize(3, tables.n);
  for (int dof = 0; dof < nv; ++dof) {
    const int col = tables.column_of_dof[dof];
    if (col < 0) continue;
    point.col(col) = point_of_all_.col(dof);
    rotation.col(col) = rotation_of_all_.col(dof);
  }
}

}  // namespace mjcf_pdg
