// A planned path in a report: of `plan`.
#ifndef MJCF_PDG_APPS_HTML_PLAN_ROW_H_
#define MJCF_PDG_APPS_HTML_PLAN_ROW_H_

#include "apps/html/page.h"
#include "plan/plan.h"

namespace mjcf_pdg::app {

struct PlannedPath {
  const Configuration &start, &goal;  // as given
  const Path& path;
};

// The slider goes along the path, edge by edge, or, where none was found, from the start to the
// goal. Without command.
PageRow PathPageRow(const Scene& scene, const PlannedPath& planned);

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_HTML_PLAN_ROW_H_
