#include "norm/norm_evaluator.h"

#include <cmath>

#include "base/names.h"

namespace mjcf_pdg {
namespace {

using Kind = NormTerm::Kind;

// Retract moves along X up to |X| = kHingeChart (hinge) and |Q| = kQuatChart: near a half turn,
// where |X| = 2 and |Q| = 1, a small step in X is a large rotation.
constexpr double kHingeChart = 1.9;
constexpr double kQuatChart = 0.95;

int TermRows(Kind kind) {
  switch (kind) {
    case Kind::kSlide:
    case Kind::kHinge:
      return 1;
    case Kind::kBall:
      return 3;
    case Kind::kFree:
    case Kind::kBodyPose:
      return 6;
  }
  return 0;
}

// conj(a) ⊗ b with non-negative real part: the short way from a to b, in a's frame.
Eigen::Quaterniond Relative(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  Eigen::Quaterniond p = a.conjugate() * b;
  if (p.w() < 0.0) p.coeffs() = -p.coeffs();
  return p;
}

// dQ/dw of Q = R vec(p) when p turns by the body-frame rotation w: Q' = R ½ (p0 w + vec(p) × w).
Matrix3d QuatVectorJacobian(const Matrix3d& R, const Eigen::Quaterniond& p) {
  return 0.5 * R * (p.w() * Matrix3d::Identity() + Skew(p.vec()));
}

// The symmetric square root.
Matrix3d SqrtOf(const Matrix3d& inertia) {
  const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(inertia);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() *
         eigen.eigenvectors().transpose();
}

// The top body of the kinematic tree of `body`; several trees may stand on one static body.
int TopBody(const mjModel& m, int body) { return m.tree_bodyadr[m.body_treeid[body]]; }

// The paper's w (Sec. 3.2): the largest in [0, 1] with ‖Q + w dQ‖ <= radius, for ‖Q‖ < radius.
double WeightWithin(double radius, const Vector3d& Q, const Vector3d& dQ) {
  if ((Q + dQ).norm() <= radius) return 1.0;
  const double a = dQ.squaredNorm(), half_b = Q.dot(dQ), c = Q.squaredNorm() - radius * radius;
  return std::clamp((std::sqrt(half_b * half_b - a * c) - half_b) / a, 0.0, 1.0);
}

}  // namespace

// A set of bodies taken as one rigid body at q_in.
struct NormEvaluator::Piece {
  double mass = 0.0;
  Vector3d com_W = Vector3d::Zero();
  Matrix3d inertia_W = Matrix3d::Zero();  // about com_W

  // The rotational inertia about another point, by the parallel axis theorem.
  Matrix3d About(const Vector3d& p_W) const {
    const Matrix3d s = Skew(com_W - p_W);
    return inertia_W - mass * s * s;
  }
};

NormEvaluator::NormEvaluator(const SceneTables& tables, Metric metric)
    : tables_(tables),
      metric_(metric),
      posed_(&tables.query_model),
      all_moving_(Moving(tables.body_moves)) {
  if (NeedsPose()) {
    blocks_.push_back({0, tables.n});
  } else {
    for (const JointEntry& joint : tables.joints) blocks_.push_back({joint.col, joint.ndof});
  }
  if (metric_ == Metric::kDisplacement) {
    ListDisplacements();
  } else if (HasOtherRoot()) {
    ListWithRoot(tables_.root_body);
  } else {
    ListSequential();
  }
}

void NormEvaluator::SetReference(const VectorXd& q_in, const MocapPoses& mocap) {
  q_in_ = q_in;
  posed_.SetMocap(mocap);
  posed_.Pose(q_in);
  terms_.clear();
  rows_ = 0;
  total_mass_ = RigidPiece(all_moving_).mass;
  scale_ = 1.0 / std::sqrt(total_mass_);
  for (const Moved& moved : moved_) {
    if (moved.joint >= 0) {
      AddTerm(JointTerm(moved.joint, moved.bodies));
    } else if (metric_ != Metric::kDisplacement || tables_.model->body_mass[moved.body] > 0.0) {
      AddTerm(PoseTerm(moved.body, moved.bodies));
    }
  }
}

NormEvaluator::Piece NormEvaluator::RigidPiece(const std::vector<int>& bodies) const {
  const mjModel& m = *posed_.model();
  const mjData& d = *posed_.data();
  Piece piece;
  for (const int b : bodies) {
    piece.mass += m.body_mass[b];
    piece.com_W += m.body_mass[b] * AsVector(d.xipos + 3 * b);
  }
  if (piece.mass > 0.0) piece.com_W /= piece.mass;
  for (const int b : bodies) {
    const Matrix3d R = AsMatrix(d.ximat + 9 * b);
    const Matrix3d s = Skew(AsVector(d.xipos + 3 * b) - piece.com_W);
    piece.inertia_W += R * AsVector(m.body_inertia + 3 * b).asDiagonal() * R.transpose();
    piece.inertia_W -= m.body_mass[b] * s * s;
  }
  return piece;
}

std::vector<char> NormEvaluator::Outboard(int body) const {
  const mjModel& m = *tables_.model;
  std::vector<char> outboard(m.nbody, 0);
  outboard[body] = 1;
  for (int b = body + 1; b < m.nbody; ++b) outboard[b] = outboard[m.body_parentid[b]];
  return outboard;
}

// The marked bodies that may move.
std::vector<int> NormEvaluator::Moving(const std::vector<char>& marked) const {
  std::vector<int> bodies;
  for (int b = 1; b < tables_.model->nbody; ++b) {
    if (marked[b] && tables_.body_moves[b]) bodies.push_back(b);
  }
  return bodies;
}

void NormEvaluator::AddTerm(NormTerm term) {
  term.row = rows_;
  rows_ += TermRows(term.kind);
  term.sqrt_inertia_W = SqrtOf(term.inertia_W);
  terms_.push_back(term);
}

// The term of one joint and the bodies that it moves (Eq. 14-18).
NormTerm NormEvaluator::JointTerm(int joint_index, const std::vector<int>& bodies) const {
  const JointEntry& joint = tables_.joints[joint_index];
  const mjData& d = *posed_.data();
  if (joint.type == mjJNT_FREE) {
    NormTerm term = PoseTerm(joint.body, bodies);
    term.kind = Kind::kFree;
    term.joint = joint_index;
    return term;
  }
  const Piece piece = RigidPiece(bodies);
  NormTerm term;
  term.joint = joint_index;
  term.mass = piece.mass;
  term.inertia_W = piece.About(AsVector(d.xanchor + 3 * joint.id));
  term.R_in = AsMatrix(d.xmat + 9 * joint.body);
  if (joint.type == mjJNT_HINGE) {
    const Vector3d axis_W = AsVector(d.xaxis + 3 * joint.id);
    term.kind = Kind::kHinge;
    term.inertia = axis_W.dot(term.inertia_W * axis_W);
  } else {
    term.kind = joint.type == mjJNT_BALL ? Kind::kBall : Kind::kSlide;
  }
  return term;
}

// The term of bodies that the pose of `body` carries as one rigid piece (Eq. 1).
NormTerm NormEvaluator::PoseTerm(int body, const std::vector<int>& bodies) const {
  const mjData& d = *posed_.data();
  const Piece piece = RigidPiece(bodies);
  NormTerm term;
  term.kind = Kind::kBodyPose;
  term.body = body;
  term.mass = piece.mass;
  term.inertia_W = piece.inertia_W;
  term.R_in = AsMatrix(d.xmat + 9 * body);
  term.com_W = piece.com_W;
  term.com_B = term.R_in.transpose() * (piece.com_W - AsVector(d.xpos + 3 * body));
  return term;
}

void NormEvaluator::ListSequential() {
  for (int i = 0; i < static_cast<int>(tables_.joints.size()); ++i) {
    moved_.push_back({.joint = i, .bodies = Moving(Outboard(tables_.joints[i].body))});
  }
}

// With another root link, its pose change moves the whole tree, and a joint on the path from the
// top body to it moves the other side: the tree without the joint's outboard set.
void NormEvaluator::ListWithRoot(int root_body) {
  const mjModel& m = *tables_.model;
  const int top = TopBody(m, root_body);
  const std::vector<char> tree = Outboard(top);
  std::vector<char> on_path(m.nbody, 0);
  for (int b = root_body; b != 0; b = m.body_parentid[b]) on_path[b] = 1;
  moved_.push_back({.body = root_body, .bodies = Moving(tree)});
  for (int i = 0; i < static_cast<int>(tables_.joints.size()); ++i) {
    const int body = tables_.joints[i].body;
    if (body == top) continue;
    std::vector<char> outboard = Outboard(body);
    if (on_path[body]) {
      for (int b = 0; b < m.nbody; ++b) outboard[b] = tree[b] && !outboard[b];
    }
    moved_.push_back({.joint = i, .bodies = Moving(outboard)});
  }
}

void NormEvaluator::ListDisplacements() {
  for (const int b : all_moving_) moved_.push_back({.body = b, .bodies = {b}});
}

bool NormEvaluator::HasOtherRoot() const {
  const int root = tables_.root_body;
  return root >= 0 && root != TopBody(*tables_.model, root);
}

bool NormEvaluator::NeedsPose() const { return metric_ == Metric::kDisplacement || HasOtherRoot(); }

double NormEvaluator::Sigma(const VectorXd& q) {
  Residual(q, r_);
  return r_.squaredNorm();
}

void NormEvaluator::Residual(const VectorXd& q, VectorXd& r) { Fill(q, r, nullptr); }

void NormEvaluator::Linearize(const VectorXd& q, VectorXd& r, MatrixXd& J) {
  J.setZero(rows_, tables_.n);
  Fill(q, r, &J);
}

// Each function below fills a term's rows of r and, unless J is null, of J, which is zero before.
void NormEvaluator::Fill(const VectorXd& q, VectorXd& r, MatrixXd* J) {
  if (NeedsPose()) posed_.Pose(q);
  r.resize(rows_);
  for (const NormTerm& term : terms_) {
    switch (term.kind) {
      case Kind::kSlide:
      case Kind::kHinge:
        FillScalar(term, q, r, J);
        break;
      case Kind::kFree:
        FillTranslation(term, q, r, J);
        FillRotation(term, q, r, J);
        break;
      case Kind::kBall:
        FillRotation(term, q, r, J);
        break;
      case Kind::kBodyPose:
        FillBodyPose(term, r, J);
        break;
    }
  }
}

void NormEvaluator::FillScalar(const NormTerm& term, const VectorXd& q, VectorXd& r,
                               MatrixXd* J) const {
  const JointEntry& joint = tables_.joints[term.joint];
  const double delta = q[joint.qadr] - q_in_[joint.qadr];
  if (term.kind == Kind::kSlide) {
    const double weight = scale_ * std::sqrt(term.mass);
    r[term.row] = weight * delta;
    if (J) (*J)(term.row, joint.col) = weight;
  } else {
    const double weight = scale_ * std::sqrt(term.inertia);
    r[term.row] = weight * 2.0 * std::sin(delta / 2);
    if (J) (*J)(term.row, joint.col) = weight * std::cos(delta / 2);
  }
}

// The first three rows of a free joint: the move of the piece's centre of mass.
void NormEvaluator::FillTranslation(const NormTerm& term, const VectorXd& q, VectorXd& r,
                                    MatrixXd* J) const {
  const JointEntry& joint = tables_.joints[term.joint];
  const Matrix3d R = QuatAt(q, QuatAddress(joint)).toRotationMatrix();
  const double weight = scale_ * std::sqrt(term.mass);
  const Vector3d com_W = q.segment<3>(joint.qadr) + R * term.com_B;
  r.segment<3>(term.row) = weight * (com_W - term.com_W);
  if (!J) return;
  J->block<3, 3>(term.row, joint.col) = weight * Matrix3d::Identity();
  J->block<3, 3>(term.row, joint.col + 3) = -weight * R * Skew(term.com_B);
}

// The three rows of a ball, or the last three of a free joint: Q.
void NormEvaluator::FillRotation(const NormTerm& term, const VectorXd& q, VectorXd& r,
                                 MatrixXd* J) const {
  const JointEntry& joint = tables_.joints[term.joint];
  const int row = term.row + (term.kind == Kind::kFree ? 3 : 0), adr = QuatAddress(joint);
  const Eigen::Quaterniond p = Relative(QuatAt(q_in_, adr), QuatAt(q, adr));
  r.segment<3>(row) = scale_ * 2.0 * term.sqrt_inertia_W * (term.R_in * p.vec());
  if (!J) return;
  J->block<3, 3>(row, RotationColumn(joint)) =
      scale_ * 2.0 * term.sqrt_inertia_W * QuatVectorJacobian(term.R_in, p);
}

void NormEvaluator::FillBodyPose(const NormTerm& term, VectorXd& r, MatrixXd* J) {
  const mjData& d = *posed_.data();
  const Matrix3d R = AsMatrix(d.xmat + 9 * term.body);
  const Eigen::Quaterniond p = Relative(Eigen::Quaterniond(term.R_in), Eigen::Quaterniond(R));
  const Vector3d com_W = AsVector(d.xpos + 3 * term.body) + R * term.com_B;
  const double weight = scale_ * std::sqrt(term.mass);
  r.segment<3>(term.row) = weight * (com_W - term.com_W);
  r.segment<3>(term.row + 3) = scale_ * 2.0 * term.sqrt_inertia_W * (term.R_in * p.vec());
  if (!J) return;
  jacobians_.Fill(tables_, posed_, term.body, com_W);
  // jacobians_.rotation gives ω in W; QuatVectorJacobian takes it in the body's frame: w = Rᵀ ω.
  const Matrix3d dQ = QuatVectorJacobian(term.R_in, p) * R.transpose();
  J->middleRows<3>(term.row) = weight * jacobians_.point;
  const Matrix3d turn = scale_ * 2.0 * term.sqrt_inertia_W * dQ;
  J->middleRows<3>(term.row + 3).noalias() = turn * jacobians_.rotation;
}

void NormEvaluator::InnerProduct(const MatrixXd& J, MatrixXd& H) const {
  H.resize(tables_.n, tables_.n);
  for (const ColumnRange& block : blocks_) {
    // If H is block-diagonal, so is J: row numbers in r are then column numbers in dq.
    const bool all = NeedsPose();
    const auto own =
        J.block(all ? 0 : block.begin, block.begin, all ? J.rows() : block.size, block.size);
    H.block(block.begin, block.begin, block.size, block.size).noalias() =
        own.transpose().lazyProduct(own);
  }
  KeepPositive(H);
}

// Adds to the diagonal kShare times its mean over all dofs of the same kind (translation or
// rotation), plus a small constant, so that H can be factored even if a dof moves no mass.
void NormEvaluator::KeepPositive(MatrixXd& H) const {
  constexpr double kShare = 1e-8;
  // The constant for translations [1] and for rotations [square of the scene's size].
  constexpr double kSlide = 1e-12, kTurn = 1e-10;
  double sums[2] = {}, counts[2] = {};
  for (const JointEntry& joint : tables_.joints) {
    for (int k = 0; k < joint.ndof; ++k) {
      sums[joint.Slides(k)] += H(joint.col + k, joint.col + k);
      ++counts[joint.Slides(k)];
    }
  }
  const double least[2] = {kTurn * tables_.size * tables_.size, kSlide};
  for (const JointEntry& joint : tables_.joints) {
    for (int k = 0; k < joint.ndof; ++k) {
      const bool slides = joint.Slides(k);
      H(joint.col + k, joint.col + k) += kShare * sums[slides] / counts[slides] + least[slides];
    }
  }
}

double NormEvaluator::TermSigma(const NormTerm& term, const VectorXd& r) const {
  return r.segment(term.row, TermRows(term.kind)).squaredNorm();
}

std::string NormEvaluator::TermName(const NormTerm& term) const {
  const bool is_joint = term.joint >= 0;
  const int id = is_joint ? tables_.joints[term.joint].id : term.body;
  // With the top body as root link, its own joints make the root's pose change.
  const int root = metric_ == Metric::kSequential ? tables_.root_body : -1;
  if (root >= 0 &&
      (!is_joint || tables_.joints[term.joint].body == TopBody(*tables_.model, root))) {
    return "root";
  }
  return NameOrId(*tables_.model, is_joint ? mjOBJ_JOINT : mjOBJ_BODY, id);
}

void NormEvaluator::Retract(const VectorXd& q, const VectorXd& dq, VectorXd& out) const {
  Integrate(tables_, q, dq, out);
  if (NeedsPose()) return;
  for (const NormTerm& term : terms_) {
    const JointEntry& joint = tables_.joints[term.joint];
    if (term.kind == Kind::kHinge) {
      RetractHinge(joint, q, dq, out);
    } else if (term.kind != Kind::kSlide) {
      RetractRotation(term, q, dq, out);
    }
  }
}

void NormEvaluator::RetractHinge(const JointEntry& joint, const VectorXd& q, const VectorXd& dq,
                                 VectorXd& out) const {
  const double turns = std::round((q[joint.qadr] - q_in_[joint.qadr]) / (2 * mjPI));
  const double zero = q_in_[joint.qadr] + turns * 2 * mjPI;
  const double delta = q[joint.qadr] - zero;
  const double X = 2.0 * std::sin(delta / 2) + std::cos(delta / 2) * dq[joint.col];
  if (std::abs(X) < kHingeChart) out[joint.qadr] = zero + 2.0 * std::asin(X / 2);
}

void NormEvaluator::RetractRotation(const NormTerm& term, const VectorXd& q, const VectorXd& dq,
                                    VectorXd& out) const {
  const JointEntry& joint = tables_.joints[term.joint];
  const bool is_free = term.kind == Kind::kFree;
  const int adr = QuatAddress(joint);
  const Vector3d w = dq.segment<3>(RotationColumn(joint));
  const Eigen::Quaterniond from = QuatAt(q, adr);
  const Eigen::Quaterniond p = Relative(QuatAt(q_in_, adr), from);
  if (p.vec().norm() >= kQuatChart) return;
  const Vector3d dQ = QuatVectorJacobian(Matrix3d::Identity(), p) * w;
  const double weight = WeightWithin(kQuatChart, p.vec(), dQ);
  const Vector3d v = p.vec() + weight * dQ;
  const Eigen::Quaterniond moved(std::sqrt(1.0 - v.squaredNorm()), v.x(), v.y(), v.z());
  const Eigen::Quaterniond to = QuatAt(q_in_, adr) * moved;
  out.segment<4>(adr) << to.w(), to.x(), to.y(), to.z();
  if (!is_free) return;
  // The centre of mass moves as dq says, however the piece turns: r is linear in its position.
  const Vector3d com_shift = dq.segment<3>(joint.col) + from * w.cross(term.com_B);
  out.segment<3>(joint.qadr) =
      q.segment<3>(joint.qadr) + from * term.com_B + weight * com_shift - to * term.com_B;
}

}  // namespace mjcf_pdg
