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

bool Finite(const Chain& chain) {
  return std::all_of(chain.begin(), chain.end(), [](const Mover& mover) {
    return std::isfinite(mover.slide) && std::isfinite(mover.turn);
  });
}

Chains::Chains(const LowerBoundInput& in) : in_(in), m_(*in.posed.model()) {
  for (const NormTerm& term : in.norm.terms()) movers_.push_back(MoverOf(term));
  if (in.metric == Metric::kDisplacement) MergeRigidPieces();
}

std::vector<int> Chains::Path(int body) const {
  if (!in_.tables.body_moves[body]) return {};
  if (in_.metric == Metric::kDisplacement) return {Piece(body)};
  return JointPath(body);
}

Chain Chains::Along(const std::vector<int>& path) const {
  Chain chain;
  for (const int i : path) {
    const Mover& mover = movers_[i];
    if (!chain.empty() && mover.turn == 0.0 && chain.back().turn == 0.0) {
      chain.back().T += mover.T;
      const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(chain.back().T);
      chain.back().slide = std::sqrt(eigen.eigenvalues()[2]);
    } else {
      chain.push_back(mover);
    }
  }
  return chain;
}

Mover Chains::MoverOf(const NormTerm& term) const {
  using Kind = NormTerm::Kind;
  if (term.kind == Kind::kFree || term.kind == Kind::kBodyPose) {
    return PoseMover(term.mass, term.com_W, term.inertia_W);
  }
  const int id = in_.tables.joints[term.joint].id;
  const Vector3d anchor = AsVector(in_.posed.data()->xanchor + 3 * id);
  const Vector3d axis = AsVector(in_.posed.data()->xaxis + 3 * id);
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
  while (body != 0 && !HasJoint(body)) body = m_.body_parentid[body];
  return body;
}

bool Chains::HasJoint(int body) const {
  return std::any_of(in_.tables.joints.begin(), in_.tables.joints.end(),
                     [body](const JointEntry& joint) { return joint.body == body; });
}

void Chains::MergeRigidPieces() {
  std::vector<NormTerm> pieces(m_.nbody);
  for (const NormTerm& term : in_.norm.terms()) {
    NormTerm& piece = pieces[Piece(term.body)];
    const double mass = piece.mass + term.mass;
    const Vector3d com = (piece.mass * piece.com_W + term.mass * term.com_W) / mass;
    const Matrix3d s1 = Skew(piece.com_W - com), s2 = Skew(term.com_W - com);
    piece.inertia_W += term.inertia_W - piece.mass * s1 * s1 - term.mass * s2 * s2;
    piece.mass = mass;
    piece.com_W = com;
  }
  movers_.clear();
  for (const NormTerm& piece : pieces) {
    movers_.push_back(PoseMover(piece.mass, piece.com_W, piece.inertia_W));
  }
}

std::vector<int> Chains::JointPath(int body) const {
  const int root = in_.tables.root_body;
  const int root_term = RootTerm();  // none if the root link is its tree's top body
  const bool rerooted = root_term >= 0 && m_.body_treeid[body] == m_.body_treeid[root];
  std::vector<int> above;  // bodies from `body` up
  for (int b = body; b != 0; b = m_.body_parentid[b]) above.push_back(b);
  std::vector<int> path;
  if (rerooted) {
    path.push_back(root_term);
    int b = root;
    for (; std::find(above.begin(), above.end(), b) == above.end(); b = m_.body_parentid[b]) {
      AppendJoints(b, true, path);
    }
    while (above.back() != b) above.pop_back();
    above.pop_back();
  }
  for (auto it = above.rbegin(); it != above.rend(); ++it) AppendJoints(*it, false, path);
  return path;
}

void Chains::AppendJoints(int body, bool reversed, std::vector<int>& path) const {
  const std::size_t begin = path.size();
  const std::vector<NormTerm>& terms = in_.norm.terms();
  for (int i = 0; i < static_cast<int>(terms.size()); ++i) {
    if (terms[i].joint >= 0 && in_.tables.joints[terms[i].joint].body == body) path.push_back(i);
  }
  if (reversed) std::reverse(path.begin() + static_cast<std::ptrdiff_t>(begin), path.end());
}

int Chains::RootTerm() const {
  const std::vector<NormTerm>& terms = in_.norm.terms();
  for (int i = 0; i < static_cast<int>(terms.size()); ++i) {
    if (terms[i].kind == NormTerm::Kind::kBodyPose) return i;
  }
  return -1;
}

}  // namespace mjcf_pdg
