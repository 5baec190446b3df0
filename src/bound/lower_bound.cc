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
// Cauchy-Schwarz over all movers at once. κ holds the rest: with y_j = √(S_j/S), |y| = 1,
//   ½ ±n·(w×(w×r)) <= ½|w|² p_j,  p_j = max(0, ∓n·r⊥) for a hinge, (|r| ∓ n·r)/2 for a ball,
//   |(R_<jᵀ - 1) n · s_j| <= Σ_{i<j} |w_i| √S_j ρ_j,
// a quadratic form in y with non-negative entries; κ is at least its largest eigenvalue, by Collatz
// and Wielandt: max_i (Ky)_i / y_i for any y > 0. (2) gives √S >= 2t / (γ + √(γ² + 4κt)), which
// grows with t and falls with γ and κ. The least of that over all n is found by branch and bound on
// the sphere: over a cap of angle ε about n0, n·v >= cos ε n0·v - sin ε |v⊥|,
// γ <= γ(n0) + sin ε √λmax(G).
//
// Pairs whose movers have nothing in common add up, since terms of S do; so do joints outside their
// limits: the least σ_j with which the joint gets back inside.
#include "bound/lower_bound.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "bound/lower_bound_chain.h"
#include "bound/lower_bound_pair.h"

namespace mjcf_pdg {
namespace {

constexpr double kLimitTolerance = 1e-6;  // joint limits count as held up to this [rad or m]
constexpr double kRounding = 1e-9;        // of distances and depths, taken off what we claim [m]

// What is proven of one pair or joint, and the movers it concerns.
struct Claim {
  double S = 0.0;  // [kg m²]
  std::vector<int> movers;
};

std::optional<PairProblem> MakePair(const LowerBoundInput& in, const Chains& chains,
                                    const NearPair& near) {
  const KeptPair& kept = in.tables.pairs[near.pair];
  if (!kept.has_distance || !kept.moves || kept.exact) return std::nullopt;  // convex geoms only
  PairProblem pair;
  pair.required = in.required[near.pair] - in.tolerance - kRounding;
  pair.needed = pair.required - near.distance;
  if (!(pair.needed > 0.0)) return std::nullopt;
  const mjModel& m = *in.posed.model();
  std::vector<int> path1 = chains.Path(m.geom_bodyid[kept.geom1]);
  std::vector<int> path2 = chains.Path(m.geom_bodyid[kept.geom2]);
  const auto common = std::mismatch(path1.begin(), path1.end(), path2.begin(), path2.end());
  path1.erase(path1.begin(), common.first);
  path2.erase(path2.begin(), common.second);
  pair.chain[0] = chains.Along(path1);
  pair.chain[1] = chains.Along(path2);
  if (!Finite(pair.chain[0]) || !Finite(pair.chain[1])) return std::nullopt;
  pair.plane = m.geom_type[kept.geom1] == mjGEOM_PLANE;
  if (pair.plane && !pair.chain[0].empty()) return std::nullopt;
  pair.movers = path1;
  pair.movers.insert(pair.movers.end(), path2.begin(), path2.end());
  pair.geom[0] = ConvexGeomOf(in.posed, *in.tables.support, kept.geom1);
  pair.geom[1] = ConvexGeomOf(in.posed, *in.tables.support, kept.geom2);
  pair.hope = pair.plane ? pair.RootForPlane() : pair.RootFor(near.n_W, 0.0);
  return pair;
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
double SumOfDisjoint(std::vector<Claim>& claims) {
  std::stable_sort(claims.begin(), claims.end(),
                   [](const Claim& a, const Claim& b) { return a.S > b.S; });
  std::vector<int> used;
  double sum = 0.0;
  for (const Claim& claim : claims) {
    if (SharesMover(claim.movers, used)) continue;
    used.insert(used.end(), claim.movers.begin(), claim.movers.end());
    sum += claim.S;
  }
  return sum;
}

// Pair by pair, the most promising first. Those that hardly raise the sum are passed over.
void ClaimPairs(const LowerBoundInput& in, std::vector<Claim>& claims) {
  const Chains chains(in);
  std::vector<PairProblem> pairs;
  for (const NearPair& near : in.overlaps) {
    if (auto pair = MakePair(in, chains, near)) pairs.push_back(std::move(*pair));
  }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const PairProblem& a, const PairProblem& b) { return a.hope > b.hope; });
  double floor = 0.0;  // √S
  int cells_left = in.max_cells;
  for (const PairProblem& pair : pairs) {
    if (pair.hope <= floor && SharesMover(pair.movers, pairs[0].movers)) continue;
    double root = pair.plane ? pair.hope : 0.0;
    if (!pair.plane && pair.hope > floor && cells_left > 0) {
      root = SearchDirections(pair, floor, cells_left);
    }
    const double S = pair.LeverS(root * root);
    floor = std::max(floor, std::sqrt(S));
    claims.push_back({S, pair.movers});
  }
}

void ClaimLimits(const LowerBoundInput& in, std::vector<Claim>& claims) {
  const std::vector<NormTerm>& terms = in.norm.terms();
  for (int i = 0; i < static_cast<int>(terms.size()); ++i) {
    if (terms[i].joint < 0) continue;
    const double S = LimitS(in.tables.joints[terms[i].joint], terms[i], in.norm.q_in());
    if (S > 0.0) claims.push_back({S, {i}});
  }
}

}  // namespace

double SigmaLowerBound(const LowerBoundInput& in) {
  if (!(in.norm.total_mass() > 0.0)) return 0.0;
  std::vector<Claim> claims;
  ClaimPairs(in, claims);
  if (in.metric == Metric::kSequential) ClaimLimits(in, claims);
  return SumOfDisjoint(claims) / in.norm.total_mass();
}

}  // namespace mjcf_pdg
