// Derivation. S = Mσ. Between the two geoms A, B of an overlapping pair lies a chain of movers:
// joints (or rigid pieces, for the displacement metric) whose terms of S add up. Take the motion
// q_in → q base to terminal, as the norm does: mover j moves its outboard geom as a rigid piece
// that is still posed as at q_in, then the inboard movers' rotation R_<j carries that displacement.
// So
//   x(q) - x(q_in) = Σ_j R_<j s_j(x),   s_j(x) = slide_j + c w×r + ½ w×(w×r),                   (1)
// r = x - anchor_j at q_in, w = 2Q (for a hinge X times its axis), c the quaternion's real part,
// |c| <= 1, and mover j's term is
//   S_j = slideᵀ T⁻¹ slide + wᵀ C⁻¹ w    (T = aaᵀ/m or 1/m; C = ωωᵀ/h or I⁻¹),
// with a slide's axis a, the mass m and the inertia I that the mover carries, a hinge's axis ω and
// h = ωᵀIω. [r] is the matrix of r×, r⊥ the part of r across a hinge's axis.
//
// Moment arms (MomentArmS). |s_j(x)| <= √S_j ρ_j(x), ρ_j² = λmax(T) + λmax([r] C [r]ᵀ), because
// |c w×r + ½w×(w×r)| is exactly |w×r| (a chord). ρ_j is a norm of an affine function of x, so Σρ_j²
// is convex and largest at extreme points of the geom; g_A² is that maximum. Signed distance of
// convex sets changes by no more than their points move: with d the distance at q_in and
// δ = required - tolerance that at q,
//   δ - d <= √S_A g_A + √S_B g_B  =>  S >= (δ - d)² / (g_A² + g_B²).
//
// Directions. Free at q means: some unit n (from A to B, in the frame that carries both) has
// n·(b' - a') >= δ for *all* points a of A and b of B. Hence, for any a, b of our choice,
//   t := δ + n·(a - b) <= n·(b' - b) - n·(a' - a) <= √S γ + S κ, (2)
// γ² = nᵀGn, G = Σ_j T_j + [r] C [r]ᵀ: the part of (1) linear in slide and w (|c| <= 1), by
// Cauchy-Schwarz over all movers at once. κ holds the rest: with y_j = √(S_j/S), |y| = 1,
//   ½ ±n·(w×(w×r)) <= ½|w|² p_j,  p_j = max(0, ∓n·r⊥) for a hinge, (|r| ∓ n·r)/2 for a ball,
//   |(R_<jᵀ - 1) n · s_j| <= Σ_{i<j} |w_i| √S_j ρ_j,
// a quadratic form in y with non-negative entries; κ is at least its largest eigenvalue, by Collatz
// and Wielandt: max_i (Ky)_i / y_i for any y > 0. (2) gives √S >= 2t / (γ + √(γ² + 4κt)), which
// grows with t and falls with γ and κ. The least of that over all n is found by branch and bound on
// the sphere: over a cap of angle ε about n0, n·v >= cos ε n0·v - sin ε |v⊥|,
// γ <= γ(n0) + sin ε √λmax(G).
//
// Of a height field, A is a convex solid inside it (lower_bound_terrain.h).
//
// Several pairs at once: normals_tree.h.
//
// Pairs whose movers have nothing in common add up, since terms of S do; so do joints outside their
// limits: the least σ_j with which the joint gets back inside.
#include "bound/lower_bound.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "bound/least_chord.h"

namespace mjcf_pdg {
namespace {

// Pairs between which more joints lie are parted alone: cross terms (parting_rows.h) grow as their
// square.
constexpr std::size_t kMostMovers = 24;

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

bool Share(std::span<const int> a, std::span<const int> b) {
  return std::find_first_of(a.begin(), a.end(), b.begin(), b.end()) != a.end();
}

// Fills `order` with 0 to size - 1, sorted by falling value(.), equal values by number.
template <typename Value>
void OrderFalling(int size, Value value, std::vector<int>& order) {
  order.resize(size);
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return value(a) > value(b) || (value(a) == value(b) && a < b); });
}

}  // namespace

LowerBound::LowerBound() {
  // Room for so many overlaps that more at once are rare.
  constexpr int kOverlaps = 64, kMoversPerOverlap = 16;
  overlaps_.reserve(kOverlaps);
  claims_.reserve(kOverlaps);
  order_.reserve(kOverlaps);
  group_.reserve(kOverlaps);
  pending_.reserve(kOverlaps);
  pool_.reserve(kOverlaps * kMoversPerOverlap);
  concerned_.reserve(kOverlaps * kMoversPerOverlap);
  used_.reserve(kOverlaps * kMoversPerOverlap);
  inscribed_.reserve(16);
}

// Adds nothing if the pair gives no bound (an SDF, triangles, geoms that move together).
void LowerBound::AddOverlap(const LowerBoundInput& in, const NearPair& near) {
  const KeptPair& kept = in.tables.pairs[near.pair];
  const bool terrain = kept.kind == PairKind::kTerrain;
  if (!kept.moves || !(terrain || PartedByOnePlane(kept.kind))) return;
  Overlap& added = overlaps_.emplace_back();
  PairProblem& pair = added.problem;
  pair.required = in.required[near.pair] - in.tolerance * (1.0 + kRounding);
  pair.needed = pair.required - near.distance;
  const mjModel& m = *in.posed.model();
  pair.plane = m.geom_type[kept.geom1] == mjGEOM_PLANE;
  chains_.Path(m.geom_bodyid[kept.geom1], path1_);
  chains_.Path(m.geom_bodyid[kept.geom2], path2_);
  const auto common = std::mismatch(path1_.begin(), path1_.end(), path2_.begin(), path2_.end());
  const std::span<const int> own1(common.first, path1_.end()), own2(common.second, path2_.end());
  pair.pool = &pool_;
  pair.first[0] = static_cast<int>(pool_.size());
  chains_.AppendAlong(own1, pool_);
  pair.first[1] = static_cast<int>(pool_.size());
  chains_.AppendAlong(own2, pool_);
  pair.first[2] = static_cast<int>(pool_.size());
  const bool proves = pair.needed > 0.0 && Finite(pair.ChainOf(0)) && Finite(pair.ChainOf(1)) &&
                      !(pair.plane && !own1.empty());
  if (!proves) {
    pool_.resize(pair.first[0]);
    overlaps_.pop_back();
    return;
  }
  const auto append = [this](std::span<const int> own) {
    const int begin = static_cast<int>(concerned_.size());
    concerned_.insert(concerned_.end(), own.begin(), own.end());
    return Range{begin, begin + static_cast<int>(own.size())};
  };
  added.movers1 = append(own1);
  added.movers2 = append(own2);
  pair.geom[1].Fill(in.posed, *in.tables.support, kept.geom2);
  if (terrain) {
    added.on_terrain = &near;
    pair.n_W = near.n_W;
    pair.hope = pair.RootIfPlane(near.n_W, pair.needed);
    pair.needed = 0.0;  // how deep the geom is in a solid inside the field is not known
    return;
  }
  pair.geom[0].Fill(in.posed, *in.tables.support, kept.geom1);
  pair.n_W = pair.plane ? Vector3d(pair.geom[0].R.col(2)) : near.n_W;
  pair.hope = pair.plane ? pair.RootForPlane(in.budget) : pair.RootFor(near.n_W, 0.0);
}

// Of the convex solids inside the height field, the one that promises most, by the directions in
// which it might be left for least: those of its top, of the contact, of its sides, and between.
// Nothing is claimed by moment arms.
bool LowerBound::ChooseInscribed(const LowerBoundInput& in, const NearPair& near,
                                 PairProblem& pair) {
  const int field = in.tables.pairs[near.pair].geom1;
  const Matrix3d R = AsMatrix(in.posed.data()->geom_xmat + 9 * field);
  FindInscribed(in.posed, field, near, pair.required - near.distance, inscribed_);
  pair.hope = 0.0;
  const InscribedSolid* best = nullptr;
  for (const InscribedSolid& solid : inscribed_) {
    pair.geom[0].Fill(solid.corners_W);
    double hope = std::numeric_limits<double>::infinity();
    const auto look = [&](const Vector3d& n) {
      hope = std::min(hope, pair.RootFor(n, 0.0, {.enough = hope}));
      return hope > pair.hope;
    };
    bool promises = look(solid.up_W) && look(near.n_W);
    for (int side = 0; side < 4 && promises; ++side) {
      const Vector3d out = (side & 1 ? 1.0 : -1.0) * R.col(side / 2);
      promises = look(out) && look((out + R.col(2)).normalized());
    }
    if (!promises) continue;
    pair.hope = hope;
    best = &solid;
  }
  if (best) pair.geom[0].Fill(best->corners_W);
  return best != nullptr;
}

// Pair by pair, the most promising first. Those that hardly raise the sum are passed over.
void LowerBound::ClaimOverlaps(const LowerBoundInput& in) {
  chains_.Fill(in);
  heap_.reserve(kFirstCells + in.max_cells + 3);
  for (std::vector<int>* path : {&path1_, &path2_}) path->reserve(in.norm.terms().size());
  int before = -1;  // a height field's pair is there once for each of its features
  for (const NearPair& near : in.overlaps) {
    if (BoundIsLate(in.budget)) break;
    if (near.pair != before) AddOverlap(in, near);
    before = near.pair;
  }
  OrderFalling(
      static_cast<int>(overlaps_.size()), [this](int k) { return overlaps_[k].problem.hope; },
      order_);
  double floor = 0.0;  // √S
  int cells_left = in.max_cells;
  for (const int k : order_) {
    PairProblem& pair = overlaps_[k].problem;
    const Range movers = overlaps_[k].movers();
    const NearPair* const on_terrain = overlaps_[k].on_terrain;
    const auto passed_over = [&] {
      return pair.hope <= floor && Share(In(movers), In(overlaps_[order_[0]].movers()));
    };
    if (passed_over()) continue;
    if (on_terrain) {
      overlaps_[k].has_solid = ChooseInscribed(in, *on_terrain, pair);
    }
    if (passed_over()) continue;
    double root = pair.plane ? pair.hope : 0.0;
    if (!pair.plane && pair.hope > floor && cells_left > 0) {
      root = SearchDirections(pair, floor, in.budget, cells_left, heap_);
    }
    const double S = BoundIsLate(in.budget) ? root * root : pair.MomentArmS(root * root);
    floor = std::max(floor, std::sqrt(S));
    claims_.push_back({S, movers});
  }
}

void LowerBound::ClaimLimits(const LowerBoundInput& in) {
  const std::vector<NormTerm>& terms = in.norm.terms();
  for (int i = 0; i < static_cast<int>(terms.size()); ++i) {
    if (terms[i].joint < 0) continue;
    const double S = LimitS(in.tables.joints[terms[i].joint], terms[i], in.norm.q_in());
    if (!(S > 0.0)) continue;
    const int at = static_cast<int>(concerned_.size());
    concerned_.push_back(i);
    claims_.push_back({S, {at, at + 1}});
  }
}

// Adds up, largest first, what concerns different movers.
double LowerBound::SumOfDisjoint() {
  OrderFalling(static_cast<int>(claims_.size()), [this](int k) { return claims_[k].S; }, order_);
  used_.clear();
  double sum = 0.0;
  for (const int k : order_) {
    const std::span<const int> movers = In(claims_[k].movers);
    if (Share(movers, used_)) continue;
    used_.insert(used_.end(), movers.begin(), movers.end());
    sum += claims_[k].S;
  }
  return sum;
}

double LowerBound::Sigma(const LowerBoundInput& in) {
  overlaps_.clear();
  sigma_ = 0.0;
  if (!(in.norm.total_mass() > 0.0)) return 0.0;
  pool_.clear();
  claims_.clear();
  concerned_.clear();
  ClaimOverlaps(in);
  if (in.metric == Metric::kSequential) ClaimLimits(in);
  mass_ = in.norm.total_mass();
  sigma_ = SumOfDisjoint() / mass_;
  return sigma_;
}

// Marks the overlaps that share movers with one of them, and with each other, as this group.
void LowerBound::Group(int first, int group) {
  group_[first] = group;
  pending_.assign(1, first);
  while (!pending_.empty()) {
    const Overlap& overlap = overlaps_[pending_.back()];
    pending_.pop_back();
    for (const int k : order_) {
      if (group_[k] >= 0 || !Share(In(overlap.movers()), In(overlaps_[k].movers()))) continue;
      group_[k] = group;
      pending_.push_back(k);
    }
  }
}

// Groups of overlaps that have no mover in common add up.
double LowerBound::Tighten(double known_sigma, int nodes_per_pair, const BudgetMeter* budget) {
  OrderFalling(
      static_cast<int>(overlaps_.size()), [this](int k) { return overlaps_[k].problem.hope; },
      order_);
  group_.assign(overlaps_.size(), -1);
  const double known = std::sqrt(mass_ * known_sigma);
  double S = 0.0;
  for (const int first : order_) {
    if (group_[first] >= 0) continue;
    Group(first, first);
    tree_.Begin(chains_.movers(), known);
    for (const int k : order_) {
      const Overlap& overlap = overlaps_[k];
      if (group_[k] != first || tree_.rows().num_pairs() == NormalsTree::kMostTogether) continue;
      if (overlap.on_terrain && !overlap.has_solid) continue;
      if (In(overlap.movers()).size() > kMostMovers) continue;
      tree_.rows().AddPair(overlap.problem, In(overlap.movers1), In(overlap.movers2));
    }
    const double root = tree_.Search(nodes_per_pair * tree_.rows().num_pairs(), budget);
    S += root * root;
  }
  return std::max(sigma_, std::min(known_sigma, S / mass_));
}

}  // namespace mjcf_pdg
