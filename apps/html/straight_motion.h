// Configurations on the straight motion between two, for the slider of a report.
#ifndef MJCF_PDG_APPS_HTML_STRAIGHT_MOTION_H_
#define MJCF_PDG_APPS_HTML_STRAIGHT_MOTION_H_

#include <vector>

#include "mjcf_pdg/scene.h"
#include "model/kinematics.h"

namespace mjcf_pdg::app {

// q(t) = from ⊕ t·(to ⊖ from), as MotionChecker checks it; nq entries.
inline std::vector<double> OnTheWay(const Scene& scene, const std::vector<double>& from,
                                    const std::vector<double>& to, double t) {
  const SceneTables& tables = scene.tables();
  VectorXd dq, q;
  Difference(tables, ToEigen(from), ToEigen(to), dq);
  Integrate(tables, ToEigen(from), t * dq, q);
  return {q.data(), q.data() + q.size()};
}

}  // namespace mjcf_pdg::app

#endif  // MJCF_PDG_APPS_HTML_STRAIGHT_MOTION_H_
