// The multipliers of the last step's rows, by what the rows are about: where the next step's LCP
// begins.
#ifndef MJCF_PDG_SRC_OPTIMIZE_FORCE_MEMORY_H_
#define MJCF_PDG_SRC_OPTIMIZE_FORCE_MEMORY_H_

#include <vector>

#include "optimize/contact_matrix.h"

namespace mjcf_pdg {

class ForceMemory {
 public:
  // Room for that many rows; `pairs` kept pairs and `joints` of the model are told apart.
  void Reserve(std::size_t rows, std::size_t pairs, std::size_t joints);

  // Keeps the multipliers of these rows, and no others.
  void Keep(const ContactRows& rows, const VectorXd& lambda);
  // lambda: of each row, what was kept of the row of its pair or joint that came as its first,
  // second, ...; 0 if there was none.
  void Recall(const ContactRows& rows, Eigen::Ref<VectorXd> lambda) const;

 private:
  void Clear();
  // Where first_ has a source's entry; -1: rows of tendons are not remembered.
  int Slot(const RowSource& source) const {
    return source.pair >= 0 ? source.pair : source.joint >= 0 ? joints_at_ + source.joint : -1;
  }

  int joints_at_ = 0;
  std::vector<int> first_;  // per source, its first row of those kept, which follow one another
  std::vector<int> slots_;  // per kept row
  std::vector<double> lambda_;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_OPTIMIZE_FORCE_MEMORY_H_
