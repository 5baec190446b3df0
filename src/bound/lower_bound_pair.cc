#include "bound/lower_bound_pair.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mjcf_pdg {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kGoodEnough = 0.97;  // stop when within this factor of what can be proven

// A vector whose part across another is no larger than this has no direction across it [its
// length].
constexpr double kAligned = 1e-9;
// All points of a geom of no more points than this are looked at before directions are searched.
constexpr int kFewPoints = 24;

// At least the largest eigenvalue of a symmetric 3 × 3 matrix: mean + √2 standard deviation.
double LambdaMax(const Matrix3d& A) {
  const double mean = A.trace() / 3.0;
  return mean + std::sqrt(2.0 / 3.0 * (A - mean * Matrix3d::Identity()).squaredNorm());
}

// g²: the maximum over the geom of Σ_j ρ_j², or some value beyond `enough`.
double MomentArmSquared(Chain chain, const ConvexGeom& geom, double enough) {
  double most = 0.0;
  if (chain.empty()) return most;
  for (int k = 0; k < geom.num_points(); ++k) {
    const Vector3d p = geom.Point(k);
    double sum = 0.0;
    for (const Mover& mover : chain) sum += ReachSquared(mover, p, geom.radius);
    most = std::max(most, sum);
    if (most > enough) break;
  }
  return most;
}

// κ is nowhere larger, for any point of the geom and unit vectors within a right angle of any n:
// the largest row sum of a matrix whose entries are nowhere smaller.
double KappaAnywhere(Chain chain, const ConvexGeom& geom) {
  constexpr double kMostEps = 0.5 * mjPI;
  double before = 0.0, after = 0.0,
         most = 0.0;  // turns of the movers before, reaches of those after
  for (const Mover& mover : chain) before += mover.turn;
  for (std::size_t j = chain.size(); j-- > 0;) {
    const Mover& mover = chain[j];
    double arm = 0.0, reach_squared = 0.0;
    for (int k = 0; k < geom.num_points(); ++k) {
      const Vector3d r = geom.Point(k) - mover.anchor;
      arm = std::max(arm, mover.hinge ? mover.axis.cross(r).norm() : r.norm());
      reach_squared = std::max(reach_squared, ReachSquared(mover, geom.Point(k), geom.radius));
    }
    arm += geom.radius;
    const double part = mover.hinge ? 0.5 * (1.0 + kMostEps) : 0.25 * (2.0 + kMostEps);
    const double reach = std::sqrt(reach_squared);
    before = std::max(0.0, before - mover.turn);
    most = std::max(
        most, part * mover.turn * mover.turn * arm + 0.5 * (before * reach + mover.turn * after));
    after += reach;
  }
  return most;
}

// At least the largest eigenvalue of the quadratic form that holds what (2) leaves out, for point x
// and the unit vectors within eps of n; n points the way in which x is to move. Below `enough` it
// need not be as small as it could.
double Kappa(Chain chain, const Vector3d& x, const Vector3d& n, double eps, double enough) {
  const int k = static_cast<int>(chain.size());
  if (k == 0) return 0.0;
  constexpr int kStack = 64;
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kStack, kStack>;
  using Column = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kStack, 1>;
  if (k > kStack) return std::numeric_limits<double>::infinity();
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
  double best = std::numeric_limits<double>::infinity();
  for (int iteration = 0; iteration < 6; ++iteration) {
    const Column Ky = K.lazyProduct(y);
    const double bound = (Ky.array() / y.array()).maxCoeff();
    best = std::min(best, bound);
    if (bound <= 0.0 || best <= enough) break;
    y = (Ky / bound + 0.2 * y).cwiseMax(1e-6);
  }
  return best;
}

}  // namespace

double PairProblem::MomentArmS(double floor) const {
  if (!(needed > 0.0)) return floor;
  const double enough = floor > 0.0 ? needed * needed / floor : kInfinity;
  double g = MomentArmSquared(ChainOf(0), geom[0], enough);
  g += MomentArmSquared(ChainOf(1), geom[1], enough - g);
  return g > 0.0 ? std::max(floor, needed * needed / g) : floor;
}

// t of (2), the least in all directions of the cap.
double PairProblem::Overlap(const Vector3d& v, const Cap& cap) const {
  const double along = cap.n.dot(v), across = (v - along * cap.n).norm();
  return required + std::min(along, along * cap.cos) - across * cap.sin;
}

Matrix3d PairProblem::Compliance(const Vector3d& a, const Vector3d& b) const {
  Matrix3d G = Matrix3d::Zero();
  for (const Mover& mover : ChainOf(0)) G += mover.T + TurnCompliance(mover, a);
  for (const Mover& mover : ChainOf(1)) G += mover.T + TurnCompliance(mover, b);
  return G;
}

double PairProblem::RootAt(const Vector3d& a, const Vector3d& b, const Cap& cap,
                           const Wanted& wanted) const {
  const Vector3d& n = cap.n;
  const double floor = wanted.floor;
  const double t = Overlap(a - b, cap);
  if (!(t > 0.0)) return floor;
  if (t >= wanted.overlap) return std::max(floor, wanted.enough);
  const Matrix3d G = Compliance(a, b);
  double gamma = std::sqrt(std::max(0.0, n.dot(G * n)));
  if (cap.eps > 0.0) gamma += cap.sin * std::sqrt(LambdaMax(G));
  if (t <= floor * gamma) return floor;
  // With this κ, or a smaller one, the root is as large as is asked for.
  const double enough = (t / wanted.enough - gamma) / wanted.enough;
  const double kappa =
      std::max(Kappa(ChainOf(0), a, -n, cap.eps, enough), Kappa(ChainOf(1), b, n, cap.eps, enough));
  const double divisor = gamma + std::sqrt(gamma * gamma + 4.0 * kappa * t);
  if (!(divisor > 0.0)) return kInfinity;  // nothing moves it that way
  return std::max(floor, 2.0 * t / divisor);
}

double PairProblem::EnoughOverlap(const Ease& ease, double root) {
  return (ease.gamma + ease.kappa * root) * root;
}

PairProblem::Ease PairProblem::MostEase() const {
  Ease ease;
  for (int i = 0; i < 2; ++i) {
    if (geom[i].num_points() > kFewPoints) return {kInfinity, kInfinity};
    ease.gamma += MomentArmSquared(ChainOf(i), geom[i], kInfinity);
    ease.kappa = std::max(ease.kappa, KappaAnywhere(ChainOf(i), geom[i]));
  }
  ease.gamma = std::sqrt(ease.gamma);
  return ease;
}

// Points whose overlap holds all over the cap, by a few Frank-Wolfe steps from the farthest ones
// along n.
std::pair<Vector3d, Vector3d> PairProblem::FarthestOver(const Cap& cap, double enough) const {
  const Vector3d& n = cap.n;
  Vector3d a = geom[0].Support(n), b = geom[1].Support(-n);
  auto held = [&](const Vector3d& v) {
    const double along = n.dot(v);
    return cap.cos * along - cap.sin * (v - along * n).norm();
  };
  for (int step = 0; cap.eps > 0.0 && step < 3; ++step) {
    const Vector3d v = a - b;
    if (Overlap(v, cap) >= enough) break;
    const Vector3d across = v - n.dot(v) * n;
    if (across.norm() <= kAligned * v.norm()) break;
    const Vector3d gradient = cap.cos * n - cap.sin * across.normalized();
    const Vector3d a2 = geom[0].Support(gradient), b2 = geom[1].Support(-gradient);
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
  return {a, b};
}

double PairProblem::RootFor(const Vector3d& n, double eps, const Wanted& wanted) const {
  const Cap cap = CapOf(n, eps);
  const auto [a, b] = FarthestOver(cap, wanted.overlap);
  return RootAt(a, b, cap, wanted);
}

PairProblem::Cap PairProblem::CapOf(const Vector3d& n, double eps) {
  if (!(eps > 0.0)) return {n};
  return {n, eps, std::cos(eps), std::sin(eps)};
}

double PairProblem::Overlap(const Vector3d& v, const Vector3d& n, double eps) const {
  return Overlap(v, CapOf(n, eps));
}

double PairProblem::MostGamma(const Vector3d& a, const Vector3d& b) const {
  return std::sqrt(LambdaMax(Compliance(a, b)));
}

std::pair<Vector3d, Vector3d> PairProblem::FarthestOver(const Vector3d& n, double eps) const {
  return plane ? FarthestAlong(n, n, n) : FarthestOver(CapOf(n, eps), kInfinity);
}

std::pair<Vector3d, Vector3d> PairProblem::FarthestAlong(const Vector3d& n, const Vector3d& n1,
                                                         const Vector3d& n2) const {
  const Vector3d b = geom[1].Support(-n2);
  if (plane) return {b + n.dot(geom[0].center - b) * n, b};
  return {geom[0].Support(n1), b};
}

double PairProblem::RootIfPlane(const Vector3d& n, double depth) const {
  const Vector3d b = geom[1].Support(-n);
  return RootAt(b + (depth - required) * n, b, {n}, {});
}

double PairProblem::RootForPlane(const BudgetMeter* budget) const {
  const Vector3d n = geom[0].R.col(2);
  double best = 0.0;
  auto look_at = [&](const Vector3d& b) {
    const double at = RootAt(b + n.dot(geom[0].center - b) * n, b, {n}, {.floor = best});
    if (std::isfinite(at)) best = at;  // else there is no way out: no number is a bound
  };
  look_at(geom[1].Support(-n));
  if (geom[1].round) return best;
  constexpr int kBetweenLooks = 32;  // points, at the clock
  for (int k = 0; k < geom[1].num_points(); ++k) {
    if (k % kBetweenLooks == 0 && BoundIsLate(budget)) break;
    look_at(geom[1].Point(k) - geom[1].radius * n);
  }
  return best;
}

Vector3d DirectionCell::Direction(double du, double dv) const {
  Vector3d n;
  n[face % 3] = face < 3 ? 1.0 : -1.0;
  n[(face + 1) % 3] = u + du * half;
  n[(face + 2) % 3] = v + dv * half;
  return n.normalized();
}

double DirectionCell::Radius(const Vector3d& n) const {
  double least = 1.0;
  for (const double du : {-1.0, 1.0}) {
    for (const double dv : {-1.0, 1.0}) least = std::min(least, n.dot(Direction(du, dv)));
  }
  return std::acos(least) + 1e-12;
}

const std::array<FirstCell, kFirstCells>& FirstCells() {
  static const std::array<FirstCell, kFirstCells> kCells = [] {
    std::array<FirstCell, kFirstCells> cells;
    for (int k = 0; k < kFirstCells; ++k) {
      FirstCell& first = cells[k];
      first.cell = {0.0, k / 9, (k / 3 % 3 - 1) * 2.0 / 3.0, (k % 3 - 1) * 2.0 / 3.0, 1.0 / 3.0};
      first.n = first.cell.Direction(0, 0);
      first.radius = first.cell.Radius(first.n);
    }
    return cells;
  }();
  return kCells;
}

double SearchDirections(const PairProblem& pair, double floor, const BudgetMeter* budget,
                        int& cells_left, std::vector<DirectionCell>& heap) {
  heap.clear();
  double reachable = pair.hope;  // nothing above this will be proven
  const PairProblem::Ease ease = pair.MostEase();
  auto push = [&](DirectionCell cell, const Vector3d& n, double radius) {
    PairProblem::Wanted wanted{.floor = cell.root,
                               .enough = reachable,
                               .overlap = PairProblem::EnoughOverlap(ease, reachable)};
    cell.root = pair.RootFor(n, radius, wanted);
    // What is proven all over the cell is proven in its middle, too.
    if (cell.root < reachable) {
      wanted.floor = 0.0;
      reachable = std::min(reachable, pair.RootFor(n, 0.0, wanted));
    }
    heap.push_back(cell);
    std::push_heap(heap.begin(), heap.end());
    --cells_left;
  };
  for (int k = 0; k < kFirstCells; ++k) {
    if (k % 3 == 0 && BoundIsLate(budget)) return 0.0;
    const FirstCell& first = FirstCells()[k];
    push(first.cell, first.n, first.radius);
  }
  while (cells_left > 0 && reachable > floor && heap.front().root < kGoodEnough * reachable) {
    if (BoundIsLate(budget)) break;
    const DirectionCell cell = heap.front();
    std::pop_heap(heap.begin(), heap.end());
    heap.pop_back();
    for (const double du : {-0.5, 0.5}) {
      for (const double dv : {-0.5, 0.5}) {
        const DirectionCell part{cell.root, cell.face, cell.u + du * cell.half,
                                 cell.v + dv * cell.half, 0.5 * cell.half};
        const Vector3d n = part.Direction(0, 0);
        push(part, n, part.Radius(n));
      }
    }
  }
  return heap.front().root;
}

}  // namespace mjcf_pdg
