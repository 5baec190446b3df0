// The object norm as a least-squares residual, for the solver: σ = ‖r(q)‖², J = ∂r/∂dq.
//
// Source: Tang & Kim, Eq. 13-19, 26, 28. For the paper's metric without another root, r stacks
// √(H_j/M) X_j joint by joint, so J is square and block-diagonal and Retract can move along X.
// H, here and in the solver, is JᵀJ: the paper's H (Eq. 28), a metric for X, divided by M and
// carried over to dq.
// Differs from it: the other metrics of object_norm.h fit the same form with a full J.
#ifndef MJCF_PDG_SRC_NORM_NORM_EVALUATOR_H_
#define MJCF_PDG_SRC_NORM_NORM_EVALUATOR_H_

#include <string>
#include <vector>

#include "base/block_cholesky.h"
#include "mjcf_pdg/types.h"
#include "model/kinematics.h"

namespace mjcf_pdg {

// One term of Eq. 19: a joint, the pose of a rigid piece, or both (a free joint).
struct NormTerm {
  enum class Kind { kSlide, kHinge, kBall, kFree, kBodyPose };
  Kind kind = Kind::kSlide;
  int joint = -1;                         // index into SceneTables::joints; -1 for kBodyPose
  int body = -1;                          // kBodyPose: whose pose carries the piece
  int row = 0;                            // first row of r; 1 (slide, hinge), 3 (ball) or 6 rows
  double mass = 0.0;                      // of the piece that moves [kg]
  double inertia = 0.0;                   // hinge: ωᵀ I ω [kg m²]
  Matrix3d inertia_W = Matrix3d::Zero();  // ball: about the anchor; pose: about the CoM
  Matrix3d sqrt_inertia_W = Matrix3d::Zero();  // L with I = L Lᵀ
  Matrix3d R_in = Matrix3d::Identity();        // frame of the joint's body, or of `body`, at q_in
  Vector3d com_W = Vector3d::Zero();           // the piece's centre of mass at q_in
  Vector3d com_B = Vector3d::Zero();           // the same in the carrying body's frame
};

class NormEvaluator {
 public:
  NormEvaluator(const SceneTables& tables, Metric metric);

  // Poses q_in and evaluates masses, inertias and moment arms there.
  void SetReference(const VectorXd& q_in, const MocapPoses& mocap = {});

  double total_mass() const { return total_mass_; }  // M [kg]
  int rows() const { return rows_; }                 // k
  const std::vector<NormTerm>& terms() const { return terms_; }
  const VectorXd& q_in() const { return q_in_; }

  // Column ranges of the blocks of H: a joint each where H is block-diagonal, else all in one.
  const std::vector<ColumnRange>& blocks() const { return blocks_; }

  double Sigma(const VectorXd& q);
  void Residual(const VectorXd& q, VectorXd& r);
  void Linearize(const VectorXd& q, VectorXd& r, MatrixXd& J);
  // H (n × n, only its blocks are written), made definite where the norm does not see a joint.
  void InnerProduct(const MatrixXd& J, MatrixXd& H) const;
  // σ of one term, given the residual at q.
  double TermSigma(const NormTerm& term, const VectorXd& r) const;
  std::string TermName(const NormTerm& term) const;

  // out = q moved by dq along X where the chart is sound (away from half turns): r(out) = r + J dq
  // exactly for those joints; q ⊕ dq for the others. A rotation that would leave the chart is cut
  // short by Sec. 3.2's weight w, and a free joint's translation with it.
  void Retract(const VectorXd& q, const VectorXd& dq, VectorXd& out) const;

 private:
  void KeepPositive(MatrixXd& H) const;
  struct Piece;
  // What a term is about, whatever q_in: a joint or a body's pose, and the bodies that move with
  // it, parents first.
  struct Moved {
    int joint = -1, body = -1;
    std::vector<int> bodies;
  };
  void ListSequential();
  void ListWithRoot(int root_body);
  void ListDisplacements();
  void AddTerm(NormTerm term);
  NormTerm JointTerm(int joint_index, const std::vector<int>& bodies) const;
  NormTerm PoseTerm(int body, const std::vector<int>& bodies) const;
  Piece RigidPiece(const std::vector<int>& bodies) const;
  std::vector<char> Outboard(int body) const;
  std::vector<int> Moving(const std::vector<char>& marked) const;
  bool NeedsPose() const;
  void Fill(const VectorXd& q, VectorXd& r, MatrixXd* J);
  void FillScalar(const NormTerm& term, const VectorXd& q, VectorXd& r, MatrixXd* J) const;
  void FillTranslation(const NormTerm& term, const VectorXd& q, VectorXd& r, MatrixXd* J) const;
  void FillRotation(const NormTerm& term, const VectorXd& q, VectorXd& r, MatrixXd* J) const;
  void FillBodyPose(const NormTerm& term, VectorXd& r, MatrixXd* J);
  void RetractHinge(const JointEntry& joint, const VectorXd& q, const VectorXd& dq,
                    VectorXd& out) const;
  void RetractRotation(const NormTerm& term, const VectorXd& q, const VectorXd& dq,
                       VectorXd& out) const;

  const SceneTables& tables_;
  Metric metric_;
  PosedModel posed_;
  VectorXd q_in_;
  std::vector<Moved> moved_;     // per term, but for massless ones
  std::vector<int> all_moving_;  // bodies
  double total_mass_ = 0.0;
  double scale_ = 0.0;  // 1/√M
  int rows_ = 0;
  std::vector<NormTerm> terms_;
  std::vector<ColumnRange> blocks_;
  VectorXd r_;  // scratch
  BodyJacobians jacobians_;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_NORM_NORM_EVALUATOR_H_
