#include "optimize/free_factor.h"

#include <algorithm>

namespace mjcf_pdg {
namespace {

// Sums begin at a multiple of this many entries, as many as are added at once at most: leaving out
// zeros then changes no rounding.
constexpr int kAtOnce = 8;

int Begin(int first) { return first - first % kAtOnce; }

// The index of the first entry of x other than 0, x.size() if there is none.
int FirstNonzero(const Eigen::Ref<const Eigen::VectorXd>& x) {
  const double* end = x.data() + x.size();
  return static_cast<int>(std::find_if(x.data(), end, [](double v) { return v != 0.0; }) -
                          x.data());
}

void Rotate(const Eigen::JacobiRotation<double>& rotation, double& left, double& right) {
  const double rotated = rotation.c() * left - rotation.s() * right;
  right = rotation.s() * left + rotation.c() * right;
  left = rotated;
}

bool Overlap(const ColumnRange& a, const ColumnRange& b) {
  return a.begin < b.begin + b.size && b.begin < a.begin + a.size;
}

bool AreNeighbours(const Support& a, const Support& b) {
  return Overlap(a.first, b.first) || Overlap(a.first, b.second) || Overlap(a.second, b.first) ||
         Overlap(a.second, b.second);
}

}  // namespace

// Twice, the second time from the end of the first: a row far from most.
void OrderByNeighbours(std::span<const Support> supports, std::vector<int>& rows) {
  if (supports.empty()) return;
  for (int sweep = 0; sweep < 2; ++sweep) {
    std::reverse(rows.begin(), rows.end());
    std::size_t found = 0;  // so many rows have their places
    for (std::size_t k = 0; k < rows.size(); ++k) {
      found = std::max(found, k + 1);
      for (std::size_t j = found; j < rows.size(); ++j) {
        if (AreNeighbours(supports[rows[k]], supports[rows[j]])) std::swap(rows[found++], rows[j]);
      }
    }
  }
}

void FreeFactor::Reserve(int rows) {
  first_.reserve(rows);
  rotations_.reserve(rows);
  if (L_.rows() < rows) L_.resize(rows, rows);
}

void FreeFactor::Append(const Eigen::Ref<const Eigen::VectorXd>& forward, double diagonal) {
  const int f = size();
  if (L_.rows() <= f) L_.conservativeResize(2 * f + 8, 2 * f + 8);
  L_.row(f).head(f) = forward.transpose();
  L_(f, f) = diagonal;
  first_.push_back(FirstNonzero(forward));
}

// Rotations of neighbouring columns make the rows below triangular again.
void FreeFactor::Remove(int k) {
  first_.erase(first_.begin() + k);
  rotations_.clear();
  for (int i = k; i < size(); ++i) {
    const double* below = L_.row(i + 1).data();
    double* row = L_.row(i).data();
    const int first = first_[i];
    std::copy(below + first, below + i + 2, row + first);
    if (first > k) --first_[i];
    std::fill(row + Begin(first_[i]), row + first, 0.0);
    for (int j = std::max(k, first_[i]); j < i; ++j) Rotate(rotations_[j - k], row[j], row[j + 1]);
    Eigen::JacobiRotation<double> rotation;
    rotation.makeGivens(row[i], row[i + 1]);
    Rotate(rotation, row[i], row[i + 1]);
    rotations_.push_back(rotation);
  }
}

void FreeFactor::SolveForward(Eigen::Ref<Eigen::VectorXd> x) const {
  const int begin = FirstNonzero(x);
  for (int i = begin; i < size(); ++i) {
    const int first = Begin(std::max(begin, first_[i])), count = i - first;
    if (count > 0) x[i] -= L_.row(i).segment(first, count).dot(x.segment(first, count));
    x[i] /= L_(i, i);
  }
}

void FreeFactor::SolveBackward(Eigen::Ref<Eigen::VectorXd> x) const {
  for (int i = size() - 1; i >= 0; --i) {
    x[i] /= L_(i, i);
    const int first = first_[i], count = i - first;
    x.segment(first, count) -= x[i] * L_.row(i).segment(first, count).transpose();
  }
}

}  // namespace mjcf_pdg
