// Scratch that only grows: a change of size costs no memory once the largest has been seen.
//
// Eigen's own resize gives the memory back at every change of size. Where sizes change from call to
// call, members are grown by these, and their first entries or columns are what is in use.
#ifndef MJCF_PDG_SRC_BASE_GROW_H_
#define MJCF_PDG_SRC_BASE_GROW_H_

#include <Eigen/Dense>
#include <algorithm>

namespace mjcf_pdg {

// At least `size` entries; what was in them is lost where they were fewer.
template <typename Vector>
void GrowTo(Eigen::Index size, Vector& v) {
  if (v.size() < size) v.resize(std::max<Eigen::Index>(size, 2 * v.size()));
}

// `rows` rows and at least `cols` columns, likewise.
inline void GrowTo(Eigen::Index rows, Eigen::Index cols, Eigen::MatrixXd& m) {
  if (m.rows() == rows && m.cols() >= cols) return;
  m.resize(rows, std::max<Eigen::Index>(cols, m.rows() == rows ? 2 * m.cols() : 0));
}

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_BASE_GROW_H_
