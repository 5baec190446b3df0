// Cholesky factorization H = L Lᵀ of a block-diagonal matrix. The object norm's H (Eq. 28) has one
// block per joint.
#ifndef MJCF_PDG_SRC_BASE_BLOCK_CHOLESKY_H_
#define MJCF_PDG_SRC_BASE_BLOCK_CHOLESKY_H_

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "base/support.h"

namespace mjcf_pdg {

class BlockCholesky {
 public:
  // Makes room for an n × n matrix, so that Factor allocates no memory.
  void Reserve(int n) {
    L_.resize(n, n);
    inverse_.resize(n);
  }

  // Factors the n × n matrix H, which must be positive definite. Only its diagonal blocks are used;
  // they cover all columns in order. `blocks` is kept by reference for the solves below.
  void Factor(const Eigen::MatrixXd& H, const std::vector<ColumnRange>& blocks) {
    blocks_ = &blocks;
    L_.resize(H.rows(), H.cols());
    for (const ColumnRange& b : blocks) {
      L_.block(b.begin, b.begin, b.size, b.size) = H.block(b.begin, b.begin, b.size, b.size);
      if (b.size == 1) {
        L_(b.begin, b.begin) = std::sqrt(L_(b.begin, b.begin));
      } else {
        Eigen::Ref<Eigen::MatrixXd> block = L_.block(b.begin, b.begin, b.size, b.size);
        Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> in_place(block);
      }
    }
    inverse_ = L_.diagonal().cwiseInverse();
  }

  // B := L⁻¹ B; B has as many rows as H.
  template <typename Derived>
  void SolveLower(Eigen::MatrixBase<Derived>& B) const {
    if (B.cols() == 0) return;
    for (const ColumnRange& b : *blocks_) {
      auto rows = B.middleRows(b.begin, b.size);
      if (b.size > kSmall) Block(b).template triangularView<Eigen::Lower>().solveInPlace(rows);
    }
    for (Eigen::Index j = 0; j < B.cols(); ++j) {
      for (const ColumnRange& b : *blocks_) {
        if (b.size <= kSmall) SolveSmall(b, &B.coeffRef(b.begin, j));
      }
    }
  }

  // The same for a vector that is 0 but for the entries of `range`, which `x` holds. The range
  // begins and ends with blocks, all of them small.
  void SolveLower(const ColumnRange& range, double* x) const {
    const auto first =
        std::lower_bound(blocks_->begin(), blocks_->end(), range.begin,
                         [](const ColumnRange& block, int begin) { return block.begin < begin; });
    for (auto b = first; b != blocks_->end() && b->begin < range.begin + range.size; ++b) {
      SolveSmall(*b, x + b->begin - range.begin);
    }
  }

  // B := L⁻ᵀ B; B has as many rows as H.
  template <typename Derived>
  void SolveUpper(Eigen::MatrixBase<Derived>& B) const {
    for (const ColumnRange& b : *blocks_) {
      auto rows = B.middleRows(b.begin, b.size);
      if (b.size == 1) {
        rows /= L_(b.begin, b.begin);
      } else {
        Block(b).transpose().template triangularView<Eigen::Upper>().solveInPlace(rows);
      }
    }
  }

  // Blocks up to this size are solved by plain loops: Eigen's overhead exceeds the solve itself.
  static constexpr int kSmall = 6;

 private:
  void SolveSmall(const ColumnRange& b, double* x) const {
    for (int i = 0; i < b.size; ++i) {
      for (int k = 0; k < i; ++k) x[i] -= L_(b.begin + i, b.begin + k) * x[k];
      x[i] *= inverse_[b.begin + i];
    }
  }

  Eigen::Block<const Eigen::MatrixXd> Block(const ColumnRange& b) const {
    return L_.block(b.begin, b.begin, b.size, b.size);
  }

  const std::vector<ColumnRange>* blocks_ = nullptr;
  Eigen::MatrixXd L_;
  Eigen::VectorXd inverse_;  // reciprocals of L's diagonal
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_BASE_BLOCK_CHOLESKY_H_
