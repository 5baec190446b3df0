#include "start/pair_by_pair.h"

#include <algorithm>
#include <limits>

#include "base/tuning.h"
#include "optimize/contact_matrix.h"

namespace mjcf_pdg {

namespace tune = tuning::exact_meshes;

namespace {

// A pair whose joints would cost more than 1/kImmovable to part by 1 m cannot be parted by them.
constexpr double kImmovable = 1e-9;

// The normal that was found, both ways, and the faces and corners of a cube.
std::vector<Vector3d> Directions(const Vector3d& n_W) {
  std::vector<Vector3d> list = {n_W, -n_W};
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        const int nonzero = std::abs(x) + std::abs(y) + std::abs(z);
        if (nonzero == 1 || nonzero == 3) list.push_back(Vector3d(x, y, z).normalized());
      }
    }
  }
  return list;
}

}  // namespace

std::optional<VectorXd> PairByPair::Start(const VectorXd& q) {
  VectorXd at = q;
  bool parted = false;
  for (int round = 0; round < tune::kRounds; ++round) {
    const std::vector<NearPair> overlaps = ExactOverlaps(at);
    if (overlaps.empty()) break;
    for (const NearPair& overlap : overlaps) {
      if (work_.Spent()) return std::nullopt;
      if (!Overlaps(overlap.pair, at)) continue;  // an earlier pair's motion has parted it
      const std::optional<VectorXd> out = Part(at, overlap);
      if (!out) continue;
      at = *out;
      parted = true;
    }
  }
  return parted ? std::optional(at) : std::nullopt;
}

// One entry for each pair, its points and normal from some triangles that cross.
std::vector<NearPair> PairByPair::ExactOverlaps(const VectorXd& q) {
  std::vector<NearPair> overlaps;
  work_.finder.Pose(q);
  for (const NearPair& near : work_.finder.Find(0.0, Depths::kSkipped)) {
    const KeptPair& pair = problem_.tables.pairs[near.pair];
    const bool known = !overlaps.empty() && overlaps.back().pair == near.pair;
    if (NeedsGap(near.kind) && pair.moves && near.distance < 0.0 && !known)
      overlaps.push_back(near);
  }
  return overlaps;
}

bool PairByPair::Overlaps(int pair, const VectorXd& q) {
  work_.finder.Pose(q);
  scratch_.clear();
  work_.finder.AppendFeatures(pair, 0.0, Depths::kSkipped, scratch_);
  return !scratch_.empty();
}

void PairByPair::MoveTo(const VectorXd& q, const VectorXd& dq, double t) {
  Integrate(problem_.tables, q, t * dq, trial_);
  ClampToLimits(problem_.tables, trial_);
}

std::optional<VectorXd> PairByPair::Part(const VectorXd& q, const NearPair& overlap) {
  VectorXd r;
  work_.norm.Linearize(q, r, J_);
  work_.norm.InnerProduct(J_, H_);
  whitening_.Factor(H_, work_.norm.blocks());
  std::optional<VectorXd> best;
  double least = std::numeric_limits<double>::infinity();
  VectorXd dq;
  for (const Vector3d& n_W : Directions(overlap.n_W)) {
    if (!Motion(q, overlap, n_W, dq)) continue;
    const std::optional<double> t = PartedAt(q, overlap.pair, dq, least);
    if (!t) continue;
    MoveTo(q, dq, *t);
    const double sigma = work_.norm.Sigma(trial_);
    if (sigma >= least) continue;
    least = sigma;
    best = trial_;
  }
  return best;
}

// dq = H⁻¹ cᵀ / (c H⁻¹ cᵀ) moves the points apart along n_W by 1 m to first order, c being their
// row of C. False where no joint can.
bool PairByPair::Motion(const VectorXd& q, const NearPair& overlap, const Vector3d& n_W,
                        VectorXd& dq) {
  work_.finder.Pose(q);
  Eigen::RowVectorXd c(problem_.tables.n);
  const Vector3d p_W = 0.5 * (overlap.p1_W + overlap.p2_W);
  ContactRow(problem_.tables, work_.finder.posed(), overlap.pair, p_W, p_W, n_W, c);
  dq = c.transpose();
  whitening_.SolveLower(dq);
  whitening_.SolveUpper(dq);
  const double mobility = c.dot(dq);
  if (!(mobility > kImmovable)) return false;
  dq /= mobility;
  return true;
}

// How far along dq [m] the pair is apart first; none below `largest_sigma`.
std::optional<double> PairByPair::PartedAt(const VectorXd& q, int pair, const VectorXd& dq,
                                           double largest_sigma) {
  double overlapping = 0.0, apart = tune::kFirstReach * problem_.size;
  for (;; apart *= 2.0) {
    if (apart > tune::kLargestReach * problem_.size) return std::nullopt;
    MoveTo(q, dq, apart);
    if (!Overlaps(pair, trial_)) break;
    if (work_.norm.Sigma(trial_) >= largest_sigma) return std::nullopt;
    overlapping = apart;
  }
  for (int k = 0; k < tune::kBisections; ++k) {
    const double t = 0.5 * (overlapping + apart);
    MoveTo(q, dq, t);
    (Overlaps(pair, trial_) ? overlapping : apart) = t;
  }
  return apart;
}

}  // namespace mjcf_pdg
