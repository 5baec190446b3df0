#include "bound/lower_bound_chain.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mjcf_pdg {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The largest eigenvalue of a semi-definite matrix that has an eigenvalue 0.
double LambdaMaxOfRank2(const Matrix3d& A) {
  const double trace = A.trace();
  return 0.5 * (trace + std::sqrt(std::max(0.0, 2.0 * A.squaredNorm() - trace * trace)));
}

// False for a slide that moves no mass, too: Finite is to see it.
bool MergesWithSlides(const Mover& mover) {
  return mover.turn == 0.0 && std::isfinite(mover.slide);
}

// Turns about `anchor`, and slides as `mass` does; without mass it is infinitely easy to move.
Mover PoseMover(double mass, const Vector3d& anchor, const Matrix3d& inertia) {
  Mover mover;
  mover.anchor = anchor;
  mover.slide = mass > 0.0 ? 1.0 / std::sqrt(mass) : kInfinity;
  if (mass > 0.0) mover.T = Matrix3d::Identity() / mass;
  const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(inertia);
  const double least = eigen.eigenvalues()[0];
  mover.turn = least > 1e-12 * inertia.trace() ? 1.0 / std::sqrt(least) : kInfinity;
  if (std::isfinite(mover.turn)) mover.C = inertia.inverse();
  return mover;
}

}  // namespace

Matrix3d TurnCompliance(const Mover& mover, const Vector3d& x) {
  if (mover.hinge) {
    const Vector3d across = mover.turn * mover.axis.cross(x - mover.anchor);
    return across * across.transpose();
  }
  if (mover.turn == 0.0) return Matrix3d::Zero();
  const Matrix3d s = Skew(x - mover.anchor);
  return s * mover.C * s.transpose();
}

double ReachSquared(const Mover& mover, const Vector3d& x, double radius) {
  double turn = 0.0;
  if (mover.hinge) {
    turn = mover.turn * (mover.axis.cross(x - mover.anchor).norm() + radius);
  } else if (mover.turn > 0.0) {
    turn = std::sqrt(LambdaMaxOfRank2(TurnCompliance(mover, x))) + mover.turn * radius;
  }
  return mover.slide * mover.slide + turn * turn;
}

bool Finite(Chain chain) {
  return std::all_of(chain.begin(), chain.end(), [](const Mover& mover) {
    return std::isfinite(mover.slide) && std::isfinite(mover.turn);
  });
}

void Chains::Fill(const LowerBoundInput& in) {
  in_ = &in;
  m_ = in.posed.model();
  movers_.clear();
  above_.reserve(m_->nbody);
  for (const NormTerm& term : in.norm.terms()) movers_.push_back(MoverOf(term));
  if (in.metric == Metric::kDisplacement) MergeRigidPieces();
}

void Chains::Path(int body, std::vector<int>& path) {
  path.clear();
  if (!in_->tables.body_moves[body]) return;
  if (in_->metric == Metric::kDisplacement) {
    path.push_back(Piece(body));
  } else {
    JointPath(body, path);
  }
}

void Chains::AppendAlong(std::span<const int> path, MoverPool& pool) const {
  const std::size_t begin = pool.size();
  for (const int i : path) {
    const Mover& mover = movers_[i];
    if (pool.size() > begin && MergesWithSlides(mover) && MergesWithSlides(pool.back())) {
      pool.back().T += mover.T;
      const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(pool.back().T);
      pool.back().slide = std::sqrt(eigen.eigenvalues()[2]);
    } else {
      pool.push_back(mover);
    }
  }
}

Mover Chains::MoverOf(const NormTerm& term) const {
  using Kind = NormTerm::Kind;
  if (term.kind == Kind::kFree || term.kind == Kind::kBodyPose) {
    return PoseMover(term.mass, term.com_W, term.inertia_W);
  }
  const int id = in_->tables.joints[term.joint].id;
  const Vector3d anchor = AsVector(in_->posed.data()->xanchor + 3 * id);
  const Vector3d axis = AsVector(in_->posed.data()->xaxis + 3 * id);
  Mover mover;
  if (term.kind == Kind::kBall) {
    mover = PoseMover(term.mass, anchor, term.inertia_W);
    mover.slide = 0.0;
    mover.T.setZero();
    return mover;
  }
  mover.anchor = anchor;
  mover.axis = axis;
  mover.hinge = term.kind == Kind::kHinge;
  const double h = mover.hinge ? term.inertia : term.mass;
  (mover.hinge ? mover.turn : mover.slide) = h > 0.0 ? 1.0 / std::sqrt(h) : kInfinity;
  if (h > 0.0) (mover.hinge ? mover.C : mover.T) = axis * axis.transpose() / h;
  return mover;
}

int Chains::Piece(int body) const {
  while (body != 0 && !HasJoint(body)) body = m_->body_parentid[body];
  return body;
}

bool Chains::HasJoint(int body) const {
  return std::any_of(in_->tables.joints.begin(), in_->tables.joints.end(),
                     [body](const JointEntry& joint) { return joint.body == body; });
}

void Chains::MergeRigidPieces() {
  pieces_.assign(m_->nbody, NormTerm());
  for (const NormTerm& term : in_->norm.terms()) {
    if (term.joint >= 0) continue;  // armature, which only adds to σ
    NormTerm& piece = pieces_[Piece(term.body)];
    const double mass = piece.mass + term.mass;
    const Vector3d com = (piece.mass * piece.com_W + term.mass * term.com_W) / mass;
    const Matrix3d s1 = Skew(piece.com_W - com), s2 = Skew(term.com_W - com);
    piece.inertia_W += term.inertia_W - piece.mass * s1 * s1 - term.mass * s2 * s2;
    piece.mass = mass;
    piece.com_W = com;
  }
  movers_.clear();
  for (const NormTerm& piece : pieces_) {
    movers_.push_back(PoseMover(piece.mass, piece.com_W, piece.inertia_W));
  }
}

void Chains::JointPath(int body, std::vector<int>& path) {
  const int root = in_->tables.root_body;
  const int root_term = RootTerm();  // none if the root link is its tree's top body
  const bool rerooted = root_term >= 0 && m_->body_treeid[body] == m_->body_treeid[root];
  above_.clear();
  for (int b = body; b != 0; b = m_->body_parentid[b]) above_.push_back(b);
  if (rerooted) {
    path.push_back(root_term);
    int b = root;
    for (; std::find(above_.begin(), above_.end(), b) == above_.end(); b = m_->body_parentid[b]) {
      AppendJoints(b, true, path);
    }
    while (above_.back() != b) above_.pop_back();
    above_.pop_back();
  }
  for (auto it = above_.rbegin(); it != above_.rend(); ++it) AppendJoints(*it, false, path);
}

void Chains::AppendJoints(int body, bool reversed, std::vector<int>& path) const {
  const std::size_t begin = path.size();
  const std::vector<NormTerm>& terms = in_->norm.terms();
  for (int i = 0; i < static_cast<int>(terms.size()); ++i) {
    if (terms[i].joint >= 0 && in_->tables.joints[terms[i].joint].body == body) path.push_back(i);
  }
  if (reversed) std::reverse(path.begin() + static_cast<std::ptrdiff_t>(begin), path.end());
}

int Chains::RootTerm() const {
  const std::vector<NormTerm>& terms = in_->norm.terms();
  for (int i = 0; i < static_cast<int>(terms.size()); ++i) {
    if (terms[i].kind == NormTerm::Kind::kBodyPose) return i;
  }
  return -1;
}

}  // namespace mjcf_pdg
