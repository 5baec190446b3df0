// Columns of which only few entries can be other than 0. Where many bodies move, a contact concerns
// two of them, and its row of C the columns of these two.
#ifndef MJCF_PDG_SRC_BASE_SUPPORT_H_
#define MJCF_PDG_SRC_BASE_SUPPORT_H_

#include <Eigen/Dense>
#include <span>

namespace mjcf_pdg {

// The columns [begin, begin + size) of a matrix, and the rows of the same numbers.
struct ColumnRange {
  int begin = 0, size = 0;
};

// Where a vector may be other than 0: in two ranges of its entries that do not overlap, and may be
// empty. The vector is stored packed: as the entries of the first range and then of the second.
struct Support {
  ColumnRange first, second;

  int size() const { return first.size + second.size; }
};

// How the columns of a matrix are packed: its rows if it were not, and the support of each column.
struct Packing {
  int rows = 0;
  std::span<const Support> supports;  // empty: the matrix is not packed
};

// Calls visit(packed, entries) for each range of `support`: its part of the packed vector and of x,
// as Eigen vectors. Free bodies have six entries, which are worth a loop of their own.
template <typename Vector, typename Visit>
void ForEachRange(const Support& support, const double* packed, Vector& x, const Visit& visit) {
  for (const ColumnRange& range : {support.first, support.second}) {
    if (range.size == 6) {
      auto entries = x.template segment<6>(range.begin);
      visit(Eigen::Map<const Eigen::Vector<double, 6>>(packed), entries);
    } else {
      auto entries = x.segment(range.begin, range.size);
      visit(Eigen::Map<const Eigen::VectorXd>(packed, range.size), entries);
    }
    packed += range.size;
  }
}

// v · x of a packed v.
inline double Dot(const Support& support, const double* v, const Eigen::VectorXd& x) {
  double sum = 0.0;
  ForEachRange(support, v, x,
               [&](const auto& packed, const auto& entries) { sum += packed.dot(entries); });
  return sum;
}

// x += factor · v of a packed v.
inline void AddMultiple(double factor, const Support& support, const double* v,
                        Eigen::VectorXd& x) {
  ForEachRange(support, v, x,
               [&](const auto& packed, auto& entries) { entries += factor * packed; });
}

inline void SetZero(const Support& support, Eigen::VectorXd& x) {
  for (const ColumnRange& range : {support.first, support.second}) {
    x.segment(range.begin, range.size).setZero();
  }
}

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_BASE_SUPPORT_H_
