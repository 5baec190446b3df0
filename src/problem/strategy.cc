#include "problem/strategy.h"

#include <algorithm>

namespace mjcf_pdg {

void Candidates::Reserve(int nq) {
  for (Candidate& slot : slots_) slot.q.resize(nq);
}

void Candidates::Insert(const VectorXd& q, double sigma, Component start) {
  Candidate& added = slots_[count_];
  added.q = q;
  added.sigma = sigma;
  added.start = start;
  const auto end = slots_.begin() + static_cast<std::ptrdiff_t>(count_);
  const auto place =
      std::upper_bound(slots_.begin(), end, added,
                       [](const Candidate& a, const Candidate& b) { return a.sigma < b.sigma; });
  std::rotate(place, end, end + 1);
  count_ = std::min(count_ + 1, kSlots);
}

void Outcome::Reserve(int nq) {
  free.Reserve(nq);
  least_overlap.q.resize(nq);
  nearest_overlap.q.resize(nq);
}

void Outcome::Clear() {
  free.Clear();
  has_overlap = false;
  least_overlap.start = Component::kNone;
  nearest_overlap.sigma = std::numeric_limits<double>::infinity();
  starts = iterations = 0;
  sigma_lower_bound = 0.0;
}

}  // namespace mjcf_pdg
