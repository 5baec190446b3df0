#include "verify/sweep.h"

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
    if (pair.contact_only) continue;
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
    if (pair.contact_only || m.geom_type[pair.geom1] == mjGEOM_PLANE) continue;
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

const std::vector<int>& Sweep::Near(const mjData& data, double reach) {
  near_ = with_plane_;
  for (Swept& swept : swept_) {
    const double x = data.geom_xpos[3 * swept.geom];
    const double half = model_.shapes[swept.geom].extent + 0.5 * reach;
    // What is not a number is near everything.
    swept.low = std::isnan(x - half) ? -mjMAXVAL : x - half;
    swept.high = std::isnan(x + half) ? mjMAXVAL : x + half;
  }
  std::sort(swept_.begin(), swept_.end(),
            [](const Swept& a, const Swept& b) { return a.low < b.low; });
  for (std::size_t i = 0; i < swept_.size(); ++i) {
    for (std::size_t k = i + 1; k < swept_.size() && swept_[k].low <= swept_[i].high; ++k) {
      const int geom1 = swept_[i].geom, geom2 = swept_[k].geom;
      const double nearest = model_.shapes[geom1].extent + model_.shapes[geom2].extent + reach;
      const Vector3d between =
          VectorAt(data.geom_xpos + 3 * geom2) - VectorAt(data.geom_xpos + 3 * geom1);
      if (between.squaredNorm() > nearest * nearest) continue;
      const int pair = PairOf(geom1, geom2);
      if (pair >= 0) near_.push_back(pair);
    }
  }
  return near_;
}

}  // namespace mjcf_pdg::verify
