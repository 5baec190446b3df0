// The Cholesky factor of the free rows of an LCP, as rows come and go.
//
// L Lᵀ = G_FᵀG_F for the columns G_F of the free rows, in the order in which they were appended.
// Rows that share no coordinate are orthogonal: where many bodies move, L is sparse. Of each row of
// L the entries before its first are zeros and not looked at (its envelope, which no operation here
// widens).
#ifndef MJCF_PDG_SRC_OPTIMIZE_FREE_FACTOR_H_
#define MJCF_PDG_SRC_OPTIMIZE_FREE_FACTOR_H_

#include <Eigen/Dense>
#include <span>
#include <vector>

#include "base/support.h"

namespace mjcf_pdg {

// Orders rows so that neighbours, which share a coordinate, come soon after each other, and L has a
// narrow envelope: Cuthill & McKee's order, of each row its neighbours next. Without supports all
// rows are neighbours, and stay as they are.
void OrderByNeighbours(std::span<const Support> supports, std::vector<int>& rows);

class FreeFactor {
 public:
  // Room for that many rows.
  void Reserve(int rows);

  int size() const { return static_cast<int>(first_.size()); }
  // Keeps the first `rows` rows only.
  void Truncate(int rows) { first_.resize(rows); }
  // Adds the row [forward, diagonal]; `forward` has size() entries, what SolveForward made of the
  // new row's products with the others.
  void Append(const Eigen::Ref<const Eigen::VectorXd>& forward, double diagonal);
  // L of the rows without the k-th.
  void Remove(int k);

  // x becomes L⁻¹ x, and L⁻ᵀ x.
  void SolveForward(Eigen::Ref<Eigen::VectorXd> x) const;
  void SolveBackward(Eigen::Ref<Eigen::VectorXd> x) const;

 private:
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> L_;
  std::vector<int> first_;                                // of each row, the column where it begins
  std::vector<Eigen::JacobiRotation<double>> rotations_;  // scratch of Remove
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_OPTIMIZE_FREE_FACTOR_H_
