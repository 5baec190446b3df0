// Kinematics: how configurations q (MuJoCo's qpos, nq entries) and tangent vectors dq (n entries,
// movable joints only) relate, and private MuJoCo data posed at a configuration.
//
// q ⊕ dq is q moved by dq for unit time; its inverse is ⊖. The entries of dq follow MuJoCo's
// conventions (mjcf_pdg/types.h).
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

// out := q ⊕ dq; frozen joints keep their values. `out` may be q itself. The quaternions of movable
// joints come out normalized.
void Integrate(const SceneTables& tables, const VectorXd& q, const VectorXd& dq, VectorXd& out);

// dq := to ⊖ from, so that from ⊕ dq = to for the movable joints; frozen joints are not compared.
// Balls and free joints turn the short way round, hinges by the difference of their angles.
void Difference(const SceneTables& tables, const VectorXd& from, const VectorXd& to, VectorXd& dq);

// Sets the movable joints of q to their values in `pose` (nq entries), with normalized quaternions.
void SetMovable(const SceneTables& tables, const VectorXd& pose, VectorXd& q);
// Returns a copy of `base` after SetMovable.
VectorXd WithMovable(const SceneTables& tables, const VectorXd& base, const VectorXd& pose);
// Returns a copy of q in which the quaternions of movable joints are normalized.
inline VectorXd Normalized(const SceneTables& tables, const VectorXd& q) {
  return WithMovable(tables, q, q);
}

// The largest violation of a movable joint's limits at q [rad or m], or that of one joint; 0 if all
// hold. The quaternions of limited balls need not be normalized.
double LimitExcess(const SceneTables& tables, const VectorXd& q);
double LimitExcess(const JointEntry& joint, const VectorXd& q);

// Moves every limited movable joint of q to the nearest value in its range. A ball keeps its axis
// of rotation.
void ClampToLimits(const SceneTables& tables, VectorXd& q);

// As ClampToLimits, but a hinge outside its range first makes the whole turns, which cost no σ,
// that bring it inside or nearest to it.
void TurnInsideLimits(const SceneTables& tables, VectorXd& q);

// Brings every movable hinge of q within half a turn of its value in q_in by whole turns, except
// where that would leave its limits.
void Unwind(const SceneTables& tables, const VectorXd& q_in, VectorXd& q);

// The total rotation angle of a ball joint in [0, π] [rad]; `quat` is (w, x, y, z).
double BallAngle(const double* quat);

// The poses of the mocap bodies, in the order of their mocap ids.
struct MocapPoses {
  std::vector<double> pos, quat;  // 3 and 4 entries per mocap body; empty: the model's values

  bool operator==(const MocapPoses&) const = default;
};

// A model with private mjData, posed at a configuration. Use one object per thread.
class PosedModel {
 public:
  // `model` is one of the scene's private copies and must outlive this object. `moving_trees` is
  // SceneTables::moving_trees. `data`: of the same model, see shared_data; null: data of its own.
  // Throws Error if MuJoCo cannot allocate the mjData.
  explicit PosedModel(const mjModel* model, const std::vector<char>& moving_trees = {},
                      std::shared_ptr<mjData> data = nullptr);

  // Takes effect with the next Pose.
  void SetMocap(const MocapPoses& poses);
  // Computes the kinematics at q (nq entries): frames of bodies and geoms, joint anchors and axes,
  // motion axes of all degrees of freedom (cdof). Of an island, only its trees are posed anew: q
  // must have all else as it was when the whole model was posed.
  void Pose(const Eigen::Ref<const VectorXd>& q);
  // The next Pose poses the whole model, as the first one does, and the first with other mocap
  // poses.
  void PoseAllNext() { poses_all_ = true; }
  // Whether the next Pose poses the whole model.
  bool PosesAll() const { return poses_all_; }

  const mjModel* model() const { return model_; }
  mjData* data() { return data_.get(); }
  // For another object that takes turns with this one: who has posed the data keeps the pose until
  // the other poses it, and an island then must begin with PoseAllNext.
  const std::shared_ptr<mjData>& shared_data() const { return data_; }
  const mjData* data() const { return data_.get(); }

 private:
  void LetOthersStay();

  const mjModel* model_;
  std::shared_ptr<mjData> data_;
  std::vector<int> moving_, listed_;  // bodies of an island; those and all that carry them
  bool of_island_ = false;
  bool poses_all_ = true;
};

// The Jacobians of a body at a posed configuration with respect to dq, in the world frame W.
struct BodyJacobians {
  // 3 × n each: of the velocity of a point fixed to the body, and of its angular velocity.
  MatrixXd point, rotation;

  // Computes both for the point that is at p_W [m].
  void Fill(const SceneTables& tables, const PosedModel& posed, int body, const Vector3d& p_W);

 private:
  using AllDofs = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor>;  // 3 × nv
  AllDofs point_of_all_, rotation_of_all_;
};

// The first entry of a ball's or free joint's rotation in qpos and in dq.
inline int QuatAddress(const JointEntry& joint) {
  return joint.qadr + (joint.type == mjJNT_FREE ? 3 : 0);
}
inline int RotationColumn(const JointEntry& joint) {
  return joint.col + (joint.type == mjJNT_FREE ? 3 : 0);
}

// The number of entries of a joint in qpos.
inline int QposEntries(const JointEntry& joint) {
  return joint.type == mjJNT_FREE ? 7 : joint.type == mjJNT_BALL ? 4 : 1;
}

// The quaternion (w, x, y, z) that begins at q[adr], normalized.
inline Eigen::Quaterniond QuatAt(const VectorXd& q, int adr) {
  return Eigen::Quaterniond(q[adr], q[adr + 1], q[adr + 2], q[adr + 3]).normalized();
}

inline Eigen::Map<const Vector3d> AsVector(const mjtNum* p) {
  return Eigen::Map<const Vector3d>(p);
}

// A 3 × 3 matrix from a MuJoCo array, which is row-major.
inline Matrix3d AsMatrix(const mjtNum* p) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(p);
}

// The matrix [v]× for which [v]× x = v × x.
inline Matrix3d Skew(const Vector3d& v) {
  Matrix3d s;
  s << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return s;
}

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_MODEL_KINEMATICS_H_
