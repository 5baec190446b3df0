// Solves rows over several threads as they come, told in order.
#ifndef MJCF_PDG_APPS_SOLVE_ROWS_H_
#define MJCF_PDG_APPS_SOLVE_ROWS_H_

#include <cstddef>
#include <functional>

#include "apps/configurations.h"
#include "mjcf_pdg/pdg.h"

namespace mjcf_pdg::app {

// What is left of `rows`, over `threads` solvers (one for frames of a trajectory). `tell` is called
// in the order of the rows, by one thread at a time. Ends between two rows when interrupted, or
// when `rows` throws: those before are told, then it is thrown on.
void SolveRows(const Scene& scene, const Options& options, RowSource& rows, std::size_t threads,
               const std::function<void(const Configuration&, const Result&)>& tell);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_SOLVE_ROWS_H_
