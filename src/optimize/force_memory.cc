#include "optimize/force_memory.h"

namespace mjcf_pdg {

void ForceMemory::Reserve(std::size_t rows, std::size_t pairs, std::size_t joints) {
  joints_at_ = static_cast<int>(pairs);
  first_.assign(pairs + joints, -1);
  slots_.reserve(rows);
  lambda_.reserve(rows);
}

void ForceMemory::Clear() {
  for (const int slot : slots_) {
    if (slot >= 0) first_[slot] = -1;
  }
  slots_.clear();
  lambda_.clear();
}

void ForceMemory::Keep(const ContactRows& rows, const VectorXd& lambda) {
  Clear();
  for (int k = 0; k < rows.m; ++k) {
    const int slot = Slot(rows.sources[k]);
    if (slot >= 0 && first_[slot] < 0) first_[slot] = k;
    slots_.push_back(slot);
    lambda_.push_back(lambda[k]);
  }
}

void ForceMemory::Recall(const ContactRows& rows, Eigen::Ref<VectorXd> lambda) const {
  const int kept = static_cast<int>(slots_.size());
  int place = 0;  // of the row among those of its source
  for (int k = 0; k < rows.m; ++k) {
    const int slot = Slot(rows.sources[k]);
    place = k > 0 && slot == Slot(rows.sources[k - 1]) ? place + 1 : 0;
    const int row = slot < 0 || first_[slot] < 0 ? kept : first_[slot] + place;
    lambda[k] = row < kept && slots_[row] == slot ? lambda_[row] : 0.0;
  }
}

}  // namespace mjcf_pdg
