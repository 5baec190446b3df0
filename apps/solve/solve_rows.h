// Solves rows over several threads as they come, told in order.
#ifndef MJCF_PDG_APPS_SOLVE_SOLVE_ROWS_H_
#define MJCF_PDG_APPS_SOLVE_SOLVE_ROWS_H_

#include <cstddef>
#include <functional>

#include "apps/input/configurations.h"
#include "mjcf_pdg/pdg.h"

namespace mjcf_pdg::app {

// Fills in the next row; false if there is none.
using NextRow = std::function<bool(Configuration&)>;

// Solves the rows that `next` gives, over `threads` solvers (one for frames of a trajectory).
// `tell` is called in the order of the rows. Both are called by one thread at a time. Ends between
// two rows when interrupted, or when `next` throws: rows before are told, then it is thrown on.
void SolveRows(const Scene& scene, const Options& options, std::size_t threads, const NextRow& next,
               const std::function<void(const Configuration&, const Result&)>& tell);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_SOLVE_SOLVE_ROWS_H_
