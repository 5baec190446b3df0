#include "start/motion_coherence.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace mjcf_pdg {

void ConfigurationCache::Add(const VectorXd& q) {
  if (entries_.size() < capacity_) {
    entries_.push_back(q);
    return;
  }
  entries_[next_] = q;
  next_ = (next_ + 1) % capacity_;
}

std::vector<VectorXd> ConfigurationCache::NearestFirst(Workspace& work,
                                                       std::size_t largest_count) const {
  std::vector<VectorXd> poses;
  std::vector<double> sigma;
  for (const VectorXd& q : entries_) {
    poses.push_back(WithMovable(work.problem().tables, work.problem().q_in, q));
    sigma.push_back(work.norm.Sigma(poses.back()));
  }
  std::vector<std::size_t> order(entries_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return sigma[a] < sigma[b]; });
  order.resize(std::min(order.size(), largest_count));
  std::vector<VectorXd> sorted;
  for (const std::size_t k : order) sorted.push_back(std::move(poses[k]));
  return sorted;
}

void MotionCoherence::AddFree(const VectorXd& q) {
  free_.Add(q);
  self_collision_free_.Add(q);
}

void MotionCoherence::Clear() {
  free_.Clear();
  self_collision_free_.Clear();
}

}  // namespace mjcf_pdg
