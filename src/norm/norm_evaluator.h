// The object norm σ(q_in, q) as a sum of squares, σ = ‖r(q)‖², with J = ∂r/∂dq: what the
// optimization, the paper's method and the public ObjectNorm compute σ from.
//
// Source: Tang & Kim, Eq. 13-19, 26, 28. With the sequential metric, r stacks √(H_j/M) X_j joint by
// joint, so that J is square and block-diagonal and Retract can move along X. H, here and in the
// solver, is JᵀJ: the paper's H (Eq. 28), which is a metric for X, divided by M and transformed to
// dq.
// Differs from the paper: the displacement metric, and another root link than the top body of its
// tree (mjcf_pdg/object_norm.h), fit the same form, with a full J.
#ifndef MJCF_PDG_SRC_NORM_NORM_EVALUATOR_H_
#define MJCF_PDG_SRC_NORM_NORM_EVALUATOR_H_

#include <memory>
#include <string>
#include <vector>

#include "base/block_cholesky.h"
#include "mjcf_pdg/types.h"
#include "model/kinematics.h"

namespace mjcf_pdg {

// One term of Eq. 19. It measures how a rigid piece, a set of bodies as they are posed at q_in, is
// moved by one joint or by the pose of one body (kFree: by a free joint, which sets its body's
// pose).
struct NormTerm {
  enum class Kind { kSlide, kHinge, kBall, kFree, kBodyPose };
  Kind kind = Kind::kSlide;
  int joint = -1;        // index into SceneTables::joints; -1 for kBodyPose
  int body = -1;         // kBodyPose and kFree: the body that carries the piece
  int row = 0;           // first row of r; 1 row (slide, hinge), 3 (ball) or 6 (free, body pose)
  double mass = 0.0;     // of the piece, and a slide's armature [kg]
  double inertia = 0.0;  // hinge: ωᵀ I ω [kg m²]
  // The piece's rotational inertia I at q_in [kg m²]: of a free joint or body pose about the centre
  // of mass, of the others about the joint's anchor, where the armature is added.
  Matrix3d inertia_W = Matrix3d::Zero();
  Matrix3d sqrt_inertia_W = Matrix3d::Zero();  // L with I = L Lᵀ
  Matrix3d R_in = Matrix3d::Identity();        // frame of the joint's body, or of `body`, at q_in
  // Free joint and body pose: the piece's centre of mass at q_in [m], in W and in `body`'s frame.
  Vector3d com_W = Vector3d::Zero();
  Vector3d com_B = Vector3d::Zero();
};

// Poses private mjData and has scratch memory: use one object per thread. Call SetReference before
// all else. n is the length of dq.
class NormEvaluator {
 public:
  // `tables` must outlive this object.
  NormEvaluator(const SceneTables& tables, Metric metric);

  // Sets q_in, poses the model there, and computes the terms: masses, inertias and moment arms.
  // Removes what AddPull has added.
  void SetReference(const VectorXd& q_in, const MocapPoses& mocap = {});
  // The same, with a model that is posed at q_in already, which spares memory where r does not
  // depend on the poses of bodies.
  void SetReference(const VectorXd& q_in, const MocapPoses& mocap, const PosedModel& at_q_in);
  // Adds ‖B X(to, q)‖² to σ: a pull of q towards another configuration `to` (nq) that is weighted
  // by BᵀB, such as H at some configuration. X is Change (norm/change.h). B has n columns, and for
  // a sequential metric without another root link it is block-diagonal, as J is.
  void AddPull(const VectorXd& to, const MatrixXd& B);

  double total_mass() const { return total_mass_; }  // M, of the scene's movable bodies [kg]
  int rows() const { return rows_; }                 // the length of r
  const std::vector<NormTerm>& terms() const { return terms_; }
  const VectorXd& q_in() const { return q_in_; }

  // The column ranges of the blocks of H: one per joint with the sequential metric and no other
  // root link, else one for all joints.
  const std::vector<ColumnRange>& blocks() const { return blocks_; }

  // σ(q_in, q) [m²].
  double Sigma(const VectorXd& q);
  // r (rows() entries) at q [m].
  void Residual(const VectorXd& q, VectorXd& r);
  // r at q and J (rows() × n).
  void Linearize(const VectorXd& q, VectorXd& r, MatrixXd& J);
  // H = JᵀJ (n × n; only the blocks are written), with something small added to the diagonal so
  // that it is positive definite even where a joint moves no mass.
  void InnerProduct(const MatrixXd& J, MatrixXd& H) const;
  // One term's part of σ [m²], from the residual r at q.
  double TermSigma(const NormTerm& term, const VectorXd& r) const;
  // Whether the term belongs to the pose change of another root link.
  bool OfRootPose(const NormTerm& term) const;
  // The name of the term's joint or body; "root" if OfRootPose.
  std::string TermName(const NormTerm& term) const;

  // out := q moved by dq. With the sequential metric and no other root link, hinges, balls and free
  // joints move along X, so that r(out) = r(q) + J dq exactly for them. A rotation Q that would
  // come close to a half turn is shortened by Sec. 3.2's weight w, a free joint's translation with
  // it. All other joints, those of other metrics, and rotations that are near a half turn already
  // (or, for a hinge, would come there) move by q ⊕ dq.
  void Retract(const VectorXd& q, const VectorXd& dq, VectorXd& out) const;

 private:
  void KeepPositive(MatrixXd& H) const;
  struct Piece;
  // The part of a term that does not depend on q_in: a joint (index into SceneTables::joints) or
  // else the body whose pose counts, and the bodies that move with it, parents first.
  struct Moved {
    int joint = -1, body = -1;
    std::vector<int> bodies;
  };
  // These fill moved_: for the sequential metric, for it with another root link, for the
  // displacement metric.
  void ListSequential();
  void ListWithRoot(int root_body);
  void ListDisplacements();
  void ListArmature();
  PosedModel& Own();
  void SetTerms(const VectorXd& q_in, const mjData& at_q_in);
  void AddTerm(NormTerm term);
  NormTerm JointTerm(const mjData& d, int joint_index, const std::vector<int>& bodies) const;
  NormTerm PoseTerm(const mjData& d, int body, const std::vector<int>& bodies) const;
  Piece RigidPiece(const mjData& d, const std::vector<int>& bodies) const;
  // nbody entries: 1 for `body` and all bodies of its subtree.
  std::vector<char> Outboard(int body) const;
  std::vector<int> Moving(const std::vector<char>& marked) const;
  // True if the root link is not the top body of its tree.
  bool HasOtherRoot() const;
  // True if r depends on the poses of bodies, so that J is full and the model must be posed at q.
  bool NeedsPose() const;
  void Fill(const VectorXd& q, VectorXd& r, MatrixXd* J);
  void FillScalar(const NormTerm& term, const VectorXd& q, VectorXd& r, MatrixXd* J) const;
  void FillTranslation(const NormTerm& term, const VectorXd& q, VectorXd& r, MatrixXd* J) const;
  void FillRotation(const NormTerm& term, const VectorXd& q, VectorXd& r, MatrixXd* J) const;
  void FillBodyPose(const NormTerm& term, VectorXd& r, MatrixXd* J);
  void FillPulls(const VectorXd& q, VectorXd& r, MatrixXd* J);
  void RetractHinge(const JointEntry& joint, const VectorXd& q, const VectorXd& dq,
                    VectorXd& out) const;
  void RetractRotation(const NormTerm& term, const VectorXd& q, const VectorXd& dq,
                       VectorXd& out) const;

  const SceneTables& tables_;
  Metric metric_;
  std::unique_ptr<PosedModel> own_;  // made when it is needed first
  VectorXd q_in_;
  std::vector<Moved> moved_;     // one per term, or per massless body (displacement metric)
  std::vector<int> all_moving_;  // the bodies that may move
  double total_mass_ = 0.0;
  double scale_ = 0.0;  // 1/√M [kg^-½]
  int rows_ = 0;
  std::vector<NormTerm> terms_;
  struct Pull {
    VectorXd to;
    MatrixXd B;
    int row = 0;  // first row of r
  };
  std::vector<Pull> pulls_;
  std::vector<ColumnRange> blocks_;
  VectorXd r_, X_;  // scratch
  MatrixXd D_;
  BodyJacobians jacobians_;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_NORM_NORM_EVALUATOR_H_
