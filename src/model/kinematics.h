// Configurations and tangents: the only place where qpos (nq) meets dq (n), and private MuJoCo data
// posed at a configuration.
#ifndef MJCF_PDG_SRC_MODEL_KINEMATICS_H_
#define MJCF_PDG_SRC_MODEL_KINEMATICS_H_

#include <Eigen/Dense>
#include <memory>
#include <vector>

#include "model/scene_tables.h"

namespace mjcf_pdg {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

inline VectorXd ToEigen(const std::vector<double>& q) {
  return Eigen::Map<const VectorXd>(q.data(), static_cast<Eigen::Index>(q.size()));
}

// out = q ⊕ dq. `out` may be q. Quaternions of the movable joints come out normalized.
void Integrate(const SceneTables& tables, const VectorXd& q, const VectorXd& dq, VectorXd& out);

// dq = to ⊖ from: from ⊕ dq = to, rotations the short way round. Frozen joints are not compared.
void Difference(const SceneTables& tables, const VectorXd& from, const VectorXd& to, VectorXd& dq);

// The movable joints of q become those of `pose`, their quaternions normalized.
void SetMovable(const SceneTables& tables, const VectorXd& pose, VectorXd& q);
// `base` with the movable joints as in `pose`, those quaternions normalized.
VectorXd WithMovable(const SceneTables& tables, const VectorXd& base, const VectorXd& pose);
inline VectorXd Normalized(const SceneTables& tables, const VectorXd& q) {
  return WithMovable(tables, q, q);
}

// Largest violation of a movable joint's limits at q [rad or m], >= 0.
double LimitExcess(const SceneTables& tables, const VectorXd& q);

// Moves every limited movable joint of q inside its range.
void ClampToLimits(const SceneTables& tables, VectorXd& q);

// The same at the least σ: hinges make whole turns first where that brings them nearer.
void TurnInsideLimits(const SceneTables& tables, VectorXd& q);

// Takes back the whole turns that movable hinges of q have made since q_in, but for those that the
// limits want.
void Unwind(const SceneTables& tables, const VectorXd& q_in, VectorXd& q);

// A ball joint's total rotation angle in [0, π]; `quat` (w, x, y, z).
double BallAngle(const double* quat);

struct MocapPoses {
  std::vector<double> pos, quat;  // 3 and 4 per mocap body; empty: as in the model

  bool operator==(const MocapPoses&) const = default;
};

// Private mjData. One per thread.
class PosedModel {
 public:
  // `model` is one of the scene's private copies and must outlive this object.
  explicit PosedModel(const mjModel* model);

  void SetMocap(const MocapPoses& poses);
  // Kinematics of the whole model at q, motion axes of all dofs (cdof) included.
  void Pose(const Eigen::Ref<const VectorXd>& q);

  const mjModel* model() const { return model_; }
  mjData* data() { return data_.get(); }
  const mjData* data() const { return data_.get(); }

 private:
  struct Deleter {
    void operator()(mjData* d) const { mj_deleteData(d); }
  };
  const mjModel* model_;
  std::unique_ptr<mjData, Deleter> data_;
};

// Jacobians of a point fixed to a body and of the body's rotation, world axes. Keeps its memory.
struct BodyJacobians {
  MatrixXd point, rotation;  // 3 × n each

  void Fill(const SceneTables& tables, const PosedModel& posed, int body, const Vector3d& p_W);

 private:
  using AllDofs = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor>;  // 3 × nv
  AllDofs point_of_all_, rotation_of_all_;
};

// Where the rotation of a ball or a free joint begins, in qpos and in dq.
inline int QuatAddress(const JointEntry& joint) {
  return joint.qadr + (joint.type == mjJNT_FREE ? 3 : 0);
}
inline int RotationColumn(const JointEntry& joint) {
  return joint.col + (joint.type == mjJNT_FREE ? 3 : 0);
}

// Entries of a joint in qpos.
inline int QposEntries(const JointEntry& joint) {
  return joint.type == mjJNT_FREE ? 7 : joint.type == mjJNT_BALL ? 4 : 1;
}

// The unit quaternion (w, x, y, z) at q[adr].
inline Eigen::Quaterniond QuatAt(const VectorXd& q, int adr) {
  return Eigen::Quaterniond(q[adr], q[adr + 1], q[adr + 2], q[adr + 3]).normalized();
}

inline Eigen::Map<const Vector3d> AsVector(const mjtNum* p) {
  return Eigen::Map<const Vector3d>(p);
}

// A row-major 3 × 3 array of MuJoCo's.
inline Matrix3d AsMatrix(const mjtNum* p) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(p);
}

// [v]: the matrix of x -> v × x.
inline Matrix3d Skew(const Vector3d& v) {
  Matrix3d s;
  s << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return s;
}

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_MODEL_KINEMATICS_H_
