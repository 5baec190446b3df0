// A planned path in a report: of `plan`.
#ifndef MJCF_PDG_APPS_HTML_PLAN_ROW_H_
#define MJCF_PDG_APPS_HTML_PLAN_ROW_H_

#include <vector>

#include "apps/html/page.h"
#include "plan/plan.h"

namespace mjcf_pdg::app {

struct PlannedPath {
  const Configuration &start, &goal;  // as given
  const Path& path;
  const std::vector<double>& times;  // of its configurations [s]; empty: not asked for
};

// The slider goes along the path, edge by edge, or, where none was found, from the start to the
// goal. Without command.
PageRow PathPageRow(const Scene& scene, const PlannedPath& planned);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_HTML_PLAN_ROW_H_
