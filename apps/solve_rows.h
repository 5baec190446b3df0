// Solves configurations on several threads, each with a solver of its own.
#ifndef MJCF_PDG_APPS_SOLVE_ROWS_H_
#define MJCF_PDG_APPS_SOLVE_ROWS_H_

#include <cstddef>
#include <vector>

#include "apps/configurations.h"
#include "mjcf_pdg/pdg.h"

namespace mjcf_pdg::app {

// Returns the results in the order of `rows`. The number of threads changes nothing but the time; a
// trajectory is solved by one. Shows a progress bar if stderr is a terminal. Throws what a solver
// throws.
std::vector<Result> SolveRows(const Scene& scene, const Options& options,
                              const std::vector<Configuration>& rows, std::size_t threads);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_SOLVE_ROWS_H_
