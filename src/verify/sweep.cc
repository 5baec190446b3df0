#include "verify/sweep.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "verify/posed_pair.h"

namespace mjcf_pdg::verify {

Sweep::Sweep(const VerifierModel& model) : model_(model) {
  const mjModel& m = model.unblinded;
  std::vector<char> is_swept(m.ngeom, 0);
  begin_.assign(m.ngeom + 1, 0);
  for (int k = 0; k < static_cast<int>(model.pairs.size()); ++k) {
    const CheckedPair& pair = model.pairs[k];
    if (pair.sdf) continue;
    if (m.geom_type[pair.geom1] == mjGEOM_PLANE) {
      with_plane_.push_back(k);
      continue;
    }
    is_swept[pair.geom1] = is_swept[pair.geom2] = 1;
    ++begin_[std::min(pair.geom1, pair.geom2) + 1];
  }
  for (int g = 0; g < m.ngeom; ++g) {
    begin_[g + 1] += begin_[g];
    if (is_swept[g]) swept_.push_back({.geom = g});
  }
  // The pairs are sorted by the lower and the higher id of their geoms.
  for (int k = 0; k < static_cast<int>(model.pairs.size()); ++k) {
    const CheckedPair& pair = model.pairs[k];
    if (pair.sdf || m.geom_type[pair.geom1] == mjGEOM_PLANE) continue;
    partners_.push_back({std::max(pair.geom1, pair.geom2), k});
  }
  near_.reserve(model.pairs.size());
}

int Sweep::PairOf(int geom1, int geom2) const {
  const auto [low, high] = std::minmax(geom1, geom2);
  const auto begin = partners_.begin() + begin_[low], end = partners_.begin() + begin_[low + 1];
  const auto it = std::lower_bound(
      begin, end, high, [](const Partner& partner, int geom) { return partner.geom < geom; });
  return it != end && it->geom == high ? it->pair : -1;
}

void Sweep::Place(const mjData& data, double reach) {
  Eigen::AlignedBox3d centers;
  for (Swept& swept : swept_) {
    swept.center_W = VectorAt(data.geom_xpos + 3 * swept.geom);
    centers.extend(swept.center_W);
  }
  int axis = 0;
  centers.sizes().maxCoeff(&axis);
  for (Swept& swept : swept_) {
    swept.radius = model_.shapes[swept.geom].extent + 0.5 * reach;
    const double low = swept.center_W[axis] - swept.radius;
    const double high = swept.center_W[axis] + swept.radius;
    // What is not a number is near everything.
    swept.low = std::isnan(low) ? -mjMAXVAL : low;
    swept.high = std::isnan(high) ? mjMAXVAL : high;
  }
}

// Few are sorted by insertion, since the order of the last call is nearly right: of robots with 20
// to 60 geoms that saves 0.02 to 0.08 evaluations of IsFree. Of many, an order that is not would
// cost their square.
void Sweep::Sort() {
  constexpr std::size_t kFew = 64;
  if (swept_.size() > kFew) {
    std::sort(swept_.begin(), swept_.end(),
              [](const Swept& a, const Swept& b) { return a.low < b.low; });
    return;
  }
  for (std::size_t i = 1; i < swept_.size(); ++i) {
    if (swept_[i - 1].low <= swept_[i].low) continue;
    const Swept moved = swept_[i];
    std::size_t k = i;
    for (; k > 0 && swept_[k - 1].low > moved.low; --k) swept_[k] = swept_[k - 1];
    swept_[k] = moved;
  }
}

const std::vector<int>& Sweep::Near(const mjData& data, double reach) {
  near_ = with_plane_;
  Place(data, reach);
  Sort();
  for (std::size_t i = 0; i < swept_.size(); ++i) {
    const Swept& one = swept_[i];
    for (std::size_t k = i + 1; k < swept_.size() && swept_[k].low <= one.high; ++k) {
      const Swept& other = swept_[k];
      const double nearest = one.radius + other.radius;
      if ((other.center_W - one.center_W).squaredNorm() > nearest * nearest) continue;
      const int pair = PairOf(one.geom, other.geom);
      if (pair >= 0) near_.push_back(pair);
    }
  }
  return near_;
}

}  // namespace mjcf_pdg::verify
