// A solved configuration in a report: of `solve` and of `regress`.
#ifndef MJCF_PDG_APPS_HTML_SOLVED_ROW_H_
#define MJCF_PDG_APPS_HTML_SOLVED_ROW_H_

#include <vector>

#include "apps/html/page.h"
#include "apps/solve/solve_rows.h"
#include "mjcf_pdg/pdg.h"

namespace mjcf_pdg::app {

// Name of the fact that says how many collision queries the solve took.
inline constexpr const char* kQueriesFact = "collision queries";

// The slider goes from q_in through the descent that led to the answer to the answer. Without
// command and values.
PageRow SolvedPageRow(const Scene& scene, Metric metric, const SolvedRow& solved);

// The answers of a trajectory's frames, one after the other; `unsolved` are those that are none.
PageRow TrajectoryPageRow(const std::vector<PageFrame>& answers,
                          const std::vector<std::size_t>& unsolved);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_HTML_SOLVED_ROW_H_
