// Scratch vectors and matrices that only grow, so that solving allocates no memory once the largest
// size has occurred.
//
// Eigen's resize reallocates at every change of size. Members whose size changes from call to call
// are grown by these functions instead; the caller uses their first entries or columns.
#ifndef MJCF_PDG_SRC_BASE_GROW_H_
#define MJCF_PDG_SRC_BASE_GROW_H_

#include <Eigen/Dense>
#include <algorithm>

namespace mjcf_pdg {

// Gives v at least `size` entries. If it has fewer, its contents are lost.
template <typename Vector>
void GrowTo(Eigen::Index size, Vector& v) {
  if (v.size() < size) v.resize(std::max<Eigen::Index>(size, 2 * v.size()));
}

// Gives m exactly `rows` rows and at least `cols` columns. If it has fewer columns or another
// number of rows, its contents are lost.
inline void GrowTo(Eigen::Index rows, Eigen::Index cols, Eigen::MatrixXd& m) {
  if (m.rows() == rows && m.cols() >= cols) return;
  m.resize(rows, std::max<Eigen::Index>(cols, m.rows() == rows ? 2 * m.cols() : 0));
}

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_BASE_GROW_H_
