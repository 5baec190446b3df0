// Derivation. S = Mσ. Between the two geoms A, B of an overlapping pair lies a chain of movers:
// joints (or rigid pieces, for the displacement metric) whose terms of S add up. Take the motion
// q_in → q base to terminal, as the norm does: mover j moves its outboard geom as a rigid piece
// that is still posed as at q_in, then the inboard movers' rotation R_<j carries that displacement.
// So
//   x(q) - x(q_in) = Σ_j R_<j s_j(x),   s_j(x) = slide_j + q0 w×r + ½ w×(w×r),                  (1)
// r = x - anchor_j at q_in, w = 2Q (for a hinge X times its axis), |q0| <= 1, and mover j's term is
//   S_j = slideᵀ T⁻¹ slide + wᵀ C⁻¹ w    (T = aaᵀ/m or 1/m; C = ωωᵀ/h or I⁻¹).
//
// Levers. |s_j(x)| <= √S_j ρ_j(x), ρ_j² = λmax(T) + λmax([r] C [r]ᵀ), because |q0 w×r + ½w×(w×r)|
// is exactly |w×r| (a chord). ρ_j is a norm of an affine function of x, so Σρ_j² is convex and
// largest at extreme points of the geom; g_A² is that maximum. Signed distance of convex sets
// changes by no more than their points move: with d the distance at q_in and ρ = required -
// tolerance at q,
//   ρ - d <= √S_A g_A + √S_B g_B  =>  S >= (ρ - d)² / (g_A² + g_B²).
//
// Directions. Free at q means: some unit n (from A to B, in the frame that carries both) has
// n·(b' - a') >= ρ for *all* points a of A and b of B. Hence, for any a, b of our choice,
//   t := ρ + n·(a - b) <= n·(b' - b) - n·(a' - a) <= √S γ + S κ, (2)
// γ² = nᵀGn, G = Σ_j T_j + [r] C [r]ᵀ: the part of (1) linear in slide and w (|q0| <= 1), by
// Cauchy- Schwarz over all movers at once. κ holds the rest: with y_j = √(S_j/S), |y| = 1,
//   ½ ±n·(w×(w×r)) <= ½|w|² p_j,  p_j = max(0, ∓n·r⊥) for a hinge, (|r| ∓ n·r)/2 for a ball,
//   |(R_<jᵀ - 1) n · s_j| <= Σ_{i<j} |w_i| √S_j ρ_j,
// a quadratic form in y with non-negative entries; κ is at least its largest eigenvalue, by Collatz
// and Wielandt: max_i (Ky)_i / y_i for any y > 0. (2) gives √S >= 2t / (γ + √(γ² + 4κt)), which
// grows with t and falls with γ and κ. The least of that over all n is found by branch and bound on
// the sphere: over a cap of angle ε about n0, n·v >= cos ε n0·v - sin ε |v⊥|, γ <= γ(n0) + sin ε
// √λmax(G).
//
// Pairs whose movers have nothing in common add up, since terms of S do; so do joints outside their
// limits: the least σ_j with which the joint gets back inside.
#include "lower_bound.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <queue>

namespace mjcf_pdg {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kLimitTolerance = 1e-6;  // joint limits count as held up to this [rad or m]
constexpr double kRounding = 1e-9;        // of distances and depths, taken off what we claim [m]
constexpr double kGoodEnough = 0.97;      // stop when within this factor of what can be proven

struct Mover {
  Matrix3d T = Matrix3d::Zero(), C = Matrix3d::Zero();
  Vector3d anchor = Vector3d::Zero();
  Vector3d axis = Vector3d::Zero();  // hinge only
  bool hinge = false;
  double slide = 0.0;  // √λmax(T): farthest slide per √S
  double turn = 0.0;   // √λmax(C): largest |w| per √S
};
using Chain = std::vector<Mover>;

// At least the largest eigenvalue of a symmetric 3 × 3 matrix: mean + √2 standard deviation.
double LambdaMax(const Matrix3d& A) {
  const double mean = A.trace() / 3.0;
  return mean + std::sqrt(2.0 / 3.0 * (A - mean * Matrix3d::Identity()).squaredNorm());
}

// The same, exact, if the matrix is semi-definite and one eigenvalue is 0.
double LambdaMaxOfRank2(const Matrix3d& A) {
  const double trace = A.trace();
  return 0.5 * (trace + std::sqrt(std::max(0.0, 2.0 * A.squaredNorm() - trace * trace)));
}

Matrix3d Skew(const Vector3d& r) {
  Matrix3d s;
  s << 0, -r.z(), r.y(), r.z(), 0, -r.x(), -r.y(), r.x(), 0;
  return s;
}

// [r] C [r]ᵀ
Matrix3d TurnCompliance(const Mover& mover, const Vector3d& x) {
  if (mover.hinge) {
    const Vector3d across = mover.turn * mover.axis.cross(x - mover.anchor);
    return across * across.transpose();
  }
  if (mover.turn == 0.0) return Matrix3d::Zero();
  const Matrix3d s = Skew(x - mover.anchor);
  return s * mover.C * s.transpose();
}

double LeverOf(const Mover& mover, const Vector3d& x) {
  const Vector3d r = x - mover.anchor;
  return mover.hinge ? mover.axis.cross(r).norm() : r.norm();
}

// ρ_j² at most, within `radius` of x.
double ReachSquared(const Mover& mover, const Vector3d& x, double radius) {
  double turn = 0.0;
  if (mover.hinge) {
    turn = mover.turn * (LeverOf(mover, x) + radius);
  } else if (mover.turn > 0.0) {
    turn = std::sqrt(LambdaMaxOfRank2(TurnCompliance(mover, x))) + mover.turn * radius;
  }
  return mover.slide * mover.slide + turn * turn;
}

// ---- A convex geom at q_in, world axes ----

struct Shape {
  int type = 0;
  Vector3d center, size;
  Matrix3d R;
  std::vector<Vector3d> points;  // their hull, grown by radius, is the geom; cylinders and
  double radius = 0.0;           // ellipsoids are inside it

  // The geom's farthest point along n.
  Vector3d Support(const Vector3d& n) const {
    if (type == mjGEOM_ELLIPSOID || type == mjGEOM_CYLINDER) return RoundSupport(n);
    const Vector3d* best = &points[0];
    double far = -kInfinity;
    for (const Vector3d& p : points) {
      const double along = n.dot(p);
      if (along > far) {
        far = along;
        best = &p;
      }
    }
    return *best + radius * n.normalized();
  }

  Vector3d RoundSupport(const Vector3d& n) const {
    const Vector3d local = R.transpose() * n;
    if (type == mjGEOM_ELLIPSOID) {
      const Vector3d scaled = size.cwiseProduct(local);
      return center + R * size.cwiseProduct(scaled.normalized());
    }
    const double side = local.head<2>().norm();
    Vector3d p(0, 0, local.z() >= 0.0 ? size[1] : -size[1]);
    if (side > 1e-12) p.head<2>() = size[0] / side * local.head<2>();
    return center + R * p;
  }
};

void AddMeshPoints(const mjModel& m, int geom, Shape& shape) {
  const int mesh = m.geom_dataid[geom];
  const float* vert = m.mesh_vert + 3 * static_cast<std::ptrdiff_t>(m.mesh_vertadr[mesh]);
  // Hull vertices only, where MuJoCo has the hull: counts, edge addresses, then vertex ids.
  const int* graph = m.mesh_graphadr[mesh] < 0 ? nullptr : m.mesh_graph + m.mesh_graphadr[mesh];
  const int n = graph ? graph[0] : m.mesh_vertnum[mesh];
  for (int i = 0; i < n; ++i) {
    const float* v = vert + 3 * static_cast<std::ptrdiff_t>(graph ? graph[2 + n + i] : i);
    shape.points.push_back(shape.center + shape.R * Vector3d(v[0], v[1], v[2]));
  }
}

Shape ShapeOf(const mjModel& m, const mjData& d, int geom) {
  Shape shape;
  shape.type = m.geom_type[geom];
  shape.center = AsVector(d.geom_xpos + 3 * geom);
  shape.R = AsMatrix(d.geom_xmat + 9 * geom);
  shape.size = AsVector(m.geom_size + 3 * geom);
  auto add = [&](double x, double y, double z) {
    shape.points.push_back(shape.center + shape.R * Vector3d(x, y, z));
  };
  const Vector3d& size = shape.size;
  if (shape.type == mjGEOM_MESH) {
    AddMeshPoints(m, geom, shape);
  } else if (shape.type == mjGEOM_BOX) {
    for (int i = 0; i < 8; ++i) {
      add(i & 1 ? size[0] : -size[0], i & 2 ? size[1] : -size[1], i & 4 ? size[2] : -size[2]);
    }
  } else if (shape.type == mjGEOM_CYLINDER) {
    constexpr int kSides = 12;  // of a prism about it
    const double outer = size[0] / std::cos(mjPI / kSides);
    for (int i = 0; i < kSides; ++i) {
      const double x = outer * std::cos(2 * mjPI * i / kSides);
      const double y = outer * std::sin(2 * mjPI * i / kSides);
      add(x, y, size[1]);
      add(x, y, -size[1]);
    }
  } else {
    const double half = shape.type == mjGEOM_CAPSULE ? size[1] : 0.0;
    add(0, 0, half);
    if (half > 0.0) add(0, 0, -half);
    shape.radius = shape.type == mjGEOM_ELLIPSOID ? size.maxCoeff() : size[0];
  }
  return shape;
}

// g²: the maximum over the geom of Σ_j ρ_j².
double LeverSquared(const Chain& chain, const Shape& shape) {
  double most = 0.0;
  if (chain.empty()) return most;
  for (const Vector3d& p : shape.points) {
    double sum = 0.0;
    for (const Mover& mover : chain) sum += ReachSquared(mover, p, shape.radius);
    most = std::max(most, sum);
  }
  return most;
}

// ---- Chains of movers ----

class Chains {
 public:
  explicit Chains(const LowerBoundInput& in) : in_(in), m_(*in.posed.model()) {
    for (const NormTerm& term : in.norm.terms()) movers_.push_back(MoverOf(term));
    if (in.metric == Metric::kDisplacement) MergeRigidPieces();
  }

  // Indices of the movers between the world and a body, base to terminal.
  std::vector<int> Path(int body) const {
    if (!in_.tables.body_moves[body]) return {};
    if (in_.metric == Metric::kDisplacement) return {Piece(body)};
    return JointPath(body);
  }

  // Consecutive slides become one mover: no rotation lies between them.
  Chain Between(const std::vector<int>& path, std::size_t from) const {
    Chain chain;
    for (std::size_t i = from; i < path.size(); ++i) {
      const Mover& mover = movers_[path[i]];
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

 private:
  // Turns about `anchor`, and slides as `mass` does; without mass it is infinitely easy to move.
  static Mover PoseMover(double mass, const Vector3d& anchor, const Matrix3d& inertia) {
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

  Mover MoverOf(const NormTerm& term) const {
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

  // The body that carries `body` rigidly: up to the next movable joint.
  int Piece(int body) const {
    while (body != 0 && !HasJoint(body)) body = m_.body_parentid[body];
    return body;
  }

  bool HasJoint(int body) const {
    return std::any_of(in_.tables.joints.begin(), in_.tables.joints.end(),
                       [body](const JointEntry& joint) { return joint.body == body; });
  }

  // The displacement metric of bodies that are welded together is that of one rigid body.
  void MergeRigidPieces() {
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

  // Joints of the bodies on the way from the world, or from the root link, to the body.
  std::vector<int> JointPath(int body) const {
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

  void AppendJoints(int body, bool reversed, std::vector<int>& path) const {
    const std::size_t begin = path.size();
    const std::vector<NormTerm>& terms = in_.norm.terms();
    for (int i = 0; i < static_cast<int>(terms.size()); ++i) {
      if (terms[i].joint >= 0 && in_.tables.joints[terms[i].joint].body == body) path.push_back(i);
    }
    if (reversed) std::reverse(path.begin() + static_cast<std::ptrdiff_t>(begin), path.end());
  }

  int RootTerm() const {
    const std::vector<NormTerm>& terms = in_.norm.terms();
    for (int i = 0; i < static_cast<int>(terms.size()); ++i) {
      if (terms[i].kind == NormTerm::Kind::kBodyPose) return i;
    }
    return -1;
  }

  const LowerBoundInput& in_;
  const mjModel& m_;
  std::vector<Mover> movers_;  // per term of the norm; per body for the displacement metric
};

bool Finite(const Chain& chain) {
  return std::all_of(chain.begin(), chain.end(), [](const Mover& mover) {
    return std::isfinite(mover.slide) && std::isfinite(mover.turn);
  });
}

// ---- One pair ----

// At least the largest eigenvalue of the quadratic form that holds what (2) leaves out, for point x
// and the unit vectors within eps of n; n points the way in which x is to move.
double Kappa(const Chain& chain, const Vector3d& x, const Vector3d& n, double eps) {
  const int k = static_cast<int>(chain.size());
  if (k == 0) return 0.0;
  constexpr int kStack = 64;
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kStack, kStack>;
  using Column = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kStack, 1>;
  if (k > kStack) return kInfinity;
  Square K = Square::Zero(k, k);
  double turns_before = 0.0;
  for (int j = 0; j < k; ++j) {
    const Mover& mover = chain[j];
    const Vector3d r = x - mover.anchor;
    if (mover.hinge) {
      const Vector3d across = r - mover.axis.dot(r) * mover.axis;
      K(j, j) = 0.5 * std::max(0.0, eps * across.norm() - n.dot(across));
    } else {
      K(j, j) = 0.25 * (r.norm() - n.dot(r) + eps * r.norm());
    }
    K(j, j) *= mover.turn * mover.turn;
    const double reach = turns_before > 0.0 ? std::sqrt(ReachSquared(mover, x, 0.0)) : 0.0;
    for (int i = 0; i < j; ++i) K(i, j) = K(j, i) = 0.5 * chain[i].turn * reach;
    turns_before += mover.turn;
  }
  Column y = Column::Ones(k);
  double best = kInfinity;
  for (int iteration = 0; iteration < 6; ++iteration) {
    const Column Ky = K.lazyProduct(y);
    const double bound = (Ky.array() / y.array()).maxCoeff();
    best = std::min(best, bound);
    if (bound <= 0.0) break;
    y = (Ky / bound + 0.2 * y).cwiseMax(1e-6);
  }
  return best;
}

struct PairProblem {
  Chain chain[2];
  Shape shape[2];
  double required = 0.0;              // ρ of the derivation [m]
  double needed = 0.0;                // ρ - d [m]
  Vector3d n_in = Vector3d::UnitX();  // normal at q_in
  std::vector<int> movers;            // of both chains
  double hope = 0.0;   // √S along n_in alone: more will not be proven, levers aside
  double S = 0.0;      // proven so far [kg m²]
  bool plane = false;  // geom 1 is a plane that does not move relative to geom 2's base

  void Levers() {
    const double g = LeverSquared(chain[0], shape[0]) + LeverSquared(chain[1], shape[1]);
    if (g > 0.0 && needed > 0.0) S = needed * needed / g;
  }

  // √S by (2) for the points a and b and all unit vectors within eps of n.
  double RootFor(const Vector3d& a, const Vector3d& b, const Vector3d& n, double eps) const {
    const Vector3d v = a - b;
    const double along = n.dot(v), across = (v - along * n).norm();
    const double t = required + std::min(along, along * std::cos(eps)) - across * std::sin(eps);
    if (!(t > 0.0)) return 0.0;
    Matrix3d G = Matrix3d::Zero();
    for (const Mover& mover : chain[0]) G += mover.T + TurnCompliance(mover, a);
    for (const Mover& mover : chain[1]) G += mover.T + TurnCompliance(mover, b);
    double gamma = std::sqrt(std::max(0.0, n.dot(G * n)));
    if (eps > 0.0) gamma += std::sin(eps) * std::sqrt(LambdaMax(G));
    const double kappa = std::max(Kappa(chain[0], a, -n, eps), Kappa(chain[1], b, n, eps));
    const double divisor = gamma + std::sqrt(gamma * gamma + 4.0 * kappa * t);
    return divisor > 0.0 ? 2.0 * t / divisor : 0.0;  // 0: nothing moves it; we do not say infinite
  }

  // The best of the points tried. For a cap, points whose overlap holds all over it are sought by a
  // few Frank-Wolfe steps from the farthest ones along n.
  double RootFor(const Vector3d& n, double eps) const {
    Vector3d a = shape[0].Support(n), b = shape[1].Support(-n);
    auto held = [&](const Vector3d& v) {
      const double along = n.dot(v);
      return std::cos(eps) * along - std::sin(eps) * (v - along * n).norm();
    };
    for (int step = 0; eps > 0.0 && step < 3; ++step) {
      const Vector3d v = a - b, across = v - n.dot(v) * n;
      if (across.norm() < 1e-9) break;
      const Vector3d gradient = std::cos(eps) * n - std::sin(eps) * across.normalized();
      const Vector3d a2 = shape[0].Support(gradient), b2 = shape[1].Support(-gradient);
      double best = held(v), share = 0.0;
      for (const double s : {0.15, 0.3, 0.5, 0.7, 0.85, 1.0}) {
        const double value = held(v + s * ((a2 - b2) - v));
        if (value > best) {
          best = value;
          share = s;
        }
      }
      if (share == 0.0) break;
      a += share * (a2 - a);
      b += share * (b2 - b);
    }
    return RootFor(a, b, n, eps);
  }

  // A half-space is left along its normal only.
  double RootForPlane() const {
    const Vector3d n = shape[0].R.col(2);
    auto root = [&](const Vector3d& b) {
      return RootFor(b + n.dot(shape[0].center - b) * n, b, n, 0.0);
    };
    double best = root(shape[1].Support(-n));
    if (shape[1].type == mjGEOM_ELLIPSOID || shape[1].type == mjGEOM_CYLINDER) return best;
    for (const Vector3d& p : shape[1].points) best = std::max(best, root(p - shape[1].radius * n));
    return best;
  }
};

// A piece of a cube's face seen from its centre, as a part of the sphere of directions.
struct Cell {
  double root = 0.0;  // √S proven for all directions in it
  int face = 0;
  double u = 0.0, v = 0.0, half = 1.0;

  Vector3d Direction(double du, double dv) const {
    Vector3d n;
    n[face % 3] = face < 3 ? 1.0 : -1.0;
    n[(face + 1) % 3] = u + du * half;
    n[(face + 2) % 3] = v + dv * half;
    return n.normalized();
  }
  double Radius(const Vector3d& n) const {
    double least = 1.0;
    for (const double du : {-1.0, 1.0}) {
      for (const double dv : {-1.0, 1.0}) least = std::min(least, n.dot(Direction(du, dv)));
    }
    return std::acos(least) + 1e-12;
  }
  bool operator<(const Cell& other) const { return root > other.root; }  // least on top of a heap
};

// Branch and bound over all directions. Gives up once the pair cannot beat `floor` (√S).
void SearchDirections(PairProblem& pair, double floor, int& cells_left) {
  std::priority_queue<Cell> heap;
  double reachable = pair.hope;  // nothing above this will be proven
  auto push = [&](Cell cell) {
    const Vector3d n = cell.Direction(0, 0);
    cell.root = std::max(cell.root, pair.RootFor(n, cell.Radius(n)));
    reachable = std::min(reachable, pair.RootFor(n, 0.0));
    heap.push(cell);
    --cells_left;
  };
  for (int face = 0; face < 6; ++face) {
    for (int i = 0; i < 9; ++i) {
      push({0.0, face, (i % 3 - 1) * 2.0 / 3.0, (i / 3 - 1) * 2.0 / 3.0, 1.0 / 3.0});
    }
  }
  while (cells_left > 0 && reachable > floor && heap.top().root < kGoodEnough * reachable) {
    const Cell cell = heap.top();
    heap.pop();
    for (const double du : {-0.5, 0.5}) {
      for (const double dv : {-0.5, 0.5}) {
        push({cell.root, cell.face, cell.u + du * cell.half, cell.v + dv * cell.half,
              0.5 * cell.half});
      }
    }
  }
  pair.S = std::max(pair.S, heap.top().root * heap.top().root);
}

bool MakePair(const LowerBoundInput& in, const Chains& chains, const NearPair& near,
              PairProblem& pair) {
  const KeptPair& kept = in.tables.pairs[near.pair];
  if (!kept.has_distance || !kept.moves) return false;
  pair.required = in.required[near.pair] - in.tolerance - kRounding;
  pair.needed = pair.required - near.distance;
  if (!(pair.needed > 0.0)) return false;
  const mjModel& m = *in.posed.model();
  const std::vector<int> path1 = chains.Path(m.geom_bodyid[kept.geom1]);
  const std::vector<int> path2 = chains.Path(m.geom_bodyid[kept.geom2]);
  std::size_t common = 0;
  while (common < std::min(path1.size(), path2.size()) && path1[common] == path2[common]) ++common;
  pair.chain[0] = chains.Between(path1, common);
  pair.chain[1] = chains.Between(path2, common);
  if (!Finite(pair.chain[0]) || !Finite(pair.chain[1])) return false;
  pair.plane = m.geom_type[kept.geom1] == mjGEOM_PLANE;
  if (pair.plane && !pair.chain[0].empty()) return false;
  pair.movers.assign(path1.begin() + static_cast<std::ptrdiff_t>(common), path1.end());
  pair.movers.insert(pair.movers.end(), path2.begin() + static_cast<std::ptrdiff_t>(common),
                     path2.end());
  pair.shape[0] = ShapeOf(m, *in.posed.data(), kept.geom1);
  pair.shape[1] = ShapeOf(m, *in.posed.data(), kept.geom2);
  pair.n_in = near.n_W;
  return true;
}

// ---- Joint limits ----

// The least sin²(Δ/2) over Δ in [low, high].
double LeastChord(double low, double high) {
  if (std::floor(high / (2 * mjPI)) >= std::ceil(low / (2 * mjPI))) return 0.0;
  return std::min(std::pow(std::sin(low / 2), 2), std::pow(std::sin(high / 2), 2));
}

// The least S of a joint's term with which it is inside its limits.
double LimitS(const JointEntry& joint, const NormTerm& term, const VectorXd& q_in) {
  if (!joint.limited) return 0.0;
  if (joint.type == mjJNT_BALL) {
    const double excess = BallAngle(q_in.data() + joint.qadr) - joint.hi - kLimitTolerance;
    if (excess <= 0.0) return 0.0;
    const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(term.inertia_W);
    return 4.0 * std::max(0.0, eigen.eigenvalues()[0]) * std::pow(std::sin(excess / 2), 2);
  }
  const double low = joint.lo - kLimitTolerance - q_in[joint.qadr];
  const double high = joint.hi + kLimitTolerance - q_in[joint.qadr];
  if (low <= 0.0 && high >= 0.0) return 0.0;
  if (joint.type == mjJNT_HINGE) return 4.0 * term.inertia * LeastChord(low, high);
  return term.mass * std::pow(low > 0.0 ? low : high, 2);
}

bool SharesMover(const std::vector<int>& a, const std::vector<int>& b) {
  return std::find_first_of(a.begin(), a.end(), b.begin(), b.end()) != a.end();
}

// Adds up, largest first, what concerns different movers.
double SumOfDisjoint(std::vector<PairProblem>& items) {
  std::stable_sort(items.begin(), items.end(),
                   [](const PairProblem& a, const PairProblem& b) { return a.S > b.S; });
  std::vector<int> used;
  double sum = 0.0;
  for (const PairProblem& item : items) {
    if (SharesMover(item.movers, used)) continue;
    used.insert(used.end(), item.movers.begin(), item.movers.end());
    sum += item.S;
  }
  return sum;
}

}  // namespace

double SigmaLowerBound(const LowerBoundInput& in) {
  if (!(in.norm.total_mass() > 0.0)) return 0.0;
  const Chains chains(in);
  std::vector<PairProblem> items;
  for (const NearPair& near : in.overlaps) {
    PairProblem pair;
    if (!MakePair(in, chains, near, pair)) continue;
    pair.hope = pair.plane ? pair.RootForPlane() : pair.RootFor(pair.n_in, 0.0);
    items.push_back(std::move(pair));
  }
  std::stable_sort(items.begin(), items.end(),
                   [](const PairProblem& a, const PairProblem& b) { return a.hope > b.hope; });
  double floor = 0.0;  // √S
  int cells_left = in.max_cells;
  for (PairProblem& pair : items) {
    if (pair.hope <= floor && SharesMover(pair.movers, items[0].movers)) continue;
    pair.Levers();
    if (pair.plane) {
      pair.S = std::max(pair.S, pair.hope * pair.hope);
    } else if (pair.hope > floor && cells_left > 0) {
      SearchDirections(pair, floor, cells_left);
    }
    floor = std::max(floor, std::sqrt(pair.S));
  }
  if (in.metric == Metric::kSequential) {
    for (int i = 0; i < static_cast<int>(in.norm.terms().size()); ++i) {
      const NormTerm& term = in.norm.terms()[i];
      if (term.joint < 0) continue;
      PairProblem limit;
      limit.S = LimitS(in.tables.joints[term.joint], term, in.norm.q_in());
      limit.movers = {i};
      if (limit.S > 0.0) items.push_back(std::move(limit));
    }
  }
  return SumOfDisjoint(items) / in.norm.total_mass();
}

}  // namespace mjcf_pdg
