#include "norm/norm_evaluator.h"

#include <algorithm>
#include <cmath>

#include "norm/change.h"

namespace mjcf_pdg {
namespace {

using Kind = NormTerm::Kind;

// Retract moves along X up to |X| = kHingeChart (hinge) and |Q| = kQuatChart: near a half turn,
// where |X| = 2 and |Q| = 1, a small step in X is a large rotation.
constexpr double kHingeChart = 1.9;
constexpr double kQuatChart = 0.95;

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

// The paper's w (Sec. 3.2): the largest in [0, 1] with ‖Q + w dQ‖ <= radius, for ‖Q‖ < radius.
double WeightWithin(double radius, const Vector3d& Q, const Vector3d& dQ) {
  if ((Q + dQ).norm() <= radius) return 1.0;
  const double a = dQ.squaredNorm(), half_b = Q.dot(dQ), c = Q.squaredNorm() - radius * radius;
  return std::clamp((std::sqrt(half_b * half_b - a * c) - half_b) / a, 0.0, 1.0);
}

}  // namespace

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
  if (NeedsPose()) own_->Pose(q);
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
  if (!pulls_.empty()) FillPulls(q, r, J);
}

void NormEvaluator::AddPull(const VectorXd& to, const MatrixXd& B) {
  pulls_.push_back({to, B, rows_});
  rows_ += static_cast<int>(B.rows());
}

void NormEvaluator::FillPulls(const VectorXd& q, VectorXd& r, MatrixXd* J) {
  for (const Pull& pull : pulls_) {
    Change(tables_, pull.to, q, X_, J ? &D_ : nullptr);
    r.segment(pull.row, pull.B.rows()).noalias() = pull.B * X_;
    if (J) J->middleRows(pull.row, pull.B.rows()).noalias() = pull.B * D_;
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
  const mjData& d = *own_->data();
  const Matrix3d R = AsMatrix(d.xmat + 9 * term.body);
  const Eigen::Quaterniond p = Relative(Eigen::Quaterniond(term.R_in), Eigen::Quaterniond(R));
  const Vector3d com_W = AsVector(d.xpos + 3 * term.body) + R * term.com_B;
  const double weight = scale_ * std::sqrt(term.mass);
  r.segment<3>(term.row) = weight * (com_W - term.com_W);
  r.segment<3>(term.row + 3) = scale_ * 2.0 * term.sqrt_inertia_W * (term.R_in * p.vec());
  if (!J) return;
  jacobians_.Fill(tables_, *own_, term.body, com_W);
  // jacobians_.rotation gives ω in W; QuatVectorJacobian takes it in the body's frame: w = Rᵀ ω.
  const Matrix3d dQ = QuatVectorJacobian(term.R_in, p) * R.transpose();
  J->middleRows<3>(term.row) = weight * jacobians_.point;
  const Matrix3d turn = scale_ * 2.0 * term.sqrt_inertia_W * dQ;
  J->middleRows<3>(term.row + 3).noalias() = turn * jacobians_.rotation;
}

// H = JᵀJ (Eq. 28), divided by M: [1] for translations, [m²/rad²] for turns.
void NormEvaluator::InnerProduct(const MatrixXd& J, MatrixXd& H) const {
  H.resize(tables_.n, tables_.n);
  for (const ColumnRange& block : blocks_) {
    auto own_H = H.block(block.begin, block.begin, block.size, block.size);
    if (NeedsPose()) {
      const auto own = J.middleCols(block.begin, block.size);
      own_H.noalias() = own.transpose().lazyProduct(own);
      continue;
    }
    // H is block-diagonal, and so is J, and B of each pull below it: row numbers in r are, but for
    // multiples of n, column numbers in dq.
    own_H.setZero();
    for (Eigen::Index row = block.begin; row < J.rows(); row += tables_.n) {
      const auto own = J.block(row, block.begin, block.size, block.size);
      own_H += own.transpose().lazyProduct(own);
    }
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
