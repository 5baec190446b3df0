// The terms of the object norm: which bodies each joint or body pose moves, as one rigid piece with
// its mass and inertia at q_in.
//
// Part of norm_evaluator.h.
#include <algorithm>
#include <cmath>

#include "base/names.h"
#include "norm/norm_evaluator.h"

namespace mjcf_pdg {
namespace {

using Kind = NormTerm::Kind;

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

// The symmetric square root.
Matrix3d SqrtOf(const Matrix3d& inertia) {
  const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(inertia);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() *
         eigen.eigenvectors().transpose();
}

// The top body of the kinematic tree of `body`; several trees may stand on one static body.
int TopBody(const mjModel& m, int body) { return m.tree_bodyadr[m.body_treeid[body]]; }

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
    : tables_(tables), metric_(metric), all_moving_(Moving(tables.body_moves)) {
  for (const int body : all_moving_) total_mass_ += tables.model->body_mass[body];
  total_mass_ += tables.outside_mass;
  scale_ = 1.0 / std::sqrt(total_mass_);
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
  if (NeedsPose()) ListArmature();
}

void NormEvaluator::SetReference(const VectorXd& q_in, const MocapPoses& mocap) {
  PosedModel& own = Own();
  own.SetMocap(mocap);
  own.Pose(q_in);
  SetTerms(q_in, *own.data());
}

void NormEvaluator::SetReference(const VectorXd& q_in, const MocapPoses& mocap,
                                 const PosedModel& at_q_in) {
  if (NeedsPose()) Own().SetMocap(mocap);
  SetTerms(q_in, *at_q_in.data());
}

PosedModel& NormEvaluator::Own() {
  if (!own_) own_ = std::make_unique<PosedModel>(&tables_.query_model, tables_.moving_trees);
  return *own_;
}

void NormEvaluator::SetTerms(const VectorXd& q_in, const mjData& at_q_in) {
  q_in_ = q_in;
  terms_.clear();
  pulls_.clear();
  rows_ = 0;
  for (const Moved& moved : moved_) {
    if (moved.joint >= 0) {
      AddTerm(JointTerm(at_q_in, moved.joint, moved.bodies));
    } else if (metric_ != Metric::kDisplacement || tables_.model->body_mass[moved.body] > 0.0) {
      AddTerm(PoseTerm(at_q_in, moved.body, moved.bodies));
    }
  }
}

NormEvaluator::Piece NormEvaluator::RigidPiece(const mjData& d,
                                               const std::vector<int>& bodies) const {
  const mjModel& m = *tables_.model;
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
  if (TermRows(term.kind) > 1) term.sqrt_inertia_W = SqrtOf(term.inertia_W);
  terms_.push_back(term);
}

// The term of one joint and the bodies that it moves (Eq. 14-18): mass, ωᵀIω or I, which are the
// entries of H (Eq. 28).
NormTerm NormEvaluator::JointTerm(const mjData& d, int joint_index,
                                  const std::vector<int>& bodies) const {
  const JointEntry& joint = tables_.joints[joint_index];
  if (joint.type == mjJNT_FREE) {
    NormTerm term = PoseTerm(d, joint.body, bodies);
    term.kind = Kind::kFree;
    term.joint = joint_index;
    return term;
  }
  const Piece piece = RigidPiece(d, bodies);
  NormTerm term;
  term.joint = joint_index;
  term.mass = piece.mass + joint.armature;
  term.inertia_W =
      piece.About(AsVector(d.xanchor + 3 * joint.id)) + joint.armature * Matrix3d::Identity();
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
NormTerm NormEvaluator::PoseTerm(const mjData& d, int body, const std::vector<int>& bodies) const {
  const Piece piece = RigidPiece(d, bodies);
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

// Where the terms are those of bodies, joints without one of their own have one for their armature.
void NormEvaluator::ListArmature() {
  for (int i = 0; i < static_cast<int>(tables_.joints.size()); ++i) {
    const bool has_term = std::any_of(moved_.begin(), moved_.end(),
                                      [i](const Moved& moved) { return moved.joint == i; });
    if (tables_.joints[i].armature > 0.0 && !has_term) moved_.push_back({.joint = i, .bodies = {}});
  }
}

bool NormEvaluator::HasOtherRoot() const {
  const int root = tables_.root_body;
  return root >= 0 && root != TopBody(*tables_.model, root);
}

bool NormEvaluator::NeedsPose() const { return metric_ == Metric::kDisplacement || HasOtherRoot(); }

double NormEvaluator::TermSigma(const NormTerm& term, const VectorXd& r) const {
  return r.segment(term.row, TermRows(term.kind)).squaredNorm();
}

bool NormEvaluator::OfRootPose(const NormTerm& term) const {
  // With the top body as root link, its own joints make the root's pose change.
  const int root = metric_ == Metric::kSequential ? tables_.root_body : -1;
  return root >= 0 &&
         (term.joint < 0 || tables_.joints[term.joint].body == TopBody(*tables_.model, root));
}

std::string NormEvaluator::TermName(const NormTerm& term) const {
  if (OfRootPose(term)) return "root";
  const bool is_joint = term.joint >= 0;
  const int id = is_joint ? tables_.joints[term.joint].id : term.body;
  return NameOrId(*tables_.model, is_joint ? mjOBJ_JOINT : mjOBJ_BODY, id);
}

}  // namespace mjcf_pdg
