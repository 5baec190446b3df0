#include "apps/output/joint_moved.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>

namespace mjcf_pdg::app {

std::map<std::string, int> JointsOfTerms(const Scene& scene, Metric metric) {
  std::map<std::string, int> ids;
  if (metric != Metric::kSequential) return ids;
  for (int j = 0; j < scene.model()->njnt; ++j) ids[scene.JointName(j)] = j;
  return ids;
}

double JointMoved(const Scene& scene, int id, const std::vector<double>& q_in,
                  const std::vector<double>& q) {
  const mjModel& m = *scene.model();
  const int at = m.jnt_qposadr[id];
  const int type = m.jnt_type[id];
  if (type == mjJNT_HINGE || type == mjJNT_SLIDE) return q[at] - q_in[at];
  if (type == mjJNT_FREE)
    return std::hypot(q[at] - q_in[at], q[at + 1] - q_in[at + 1], q[at + 2] - q_in[at + 2]);
  double dot = 0.0;
  for (int k = 0; k < 4; ++k) dot += q[at + k] * q_in[at + k];
  return 2.0 * std::acos(std::min(1.0, std::abs(dot)));
}

}  // namespace mjcf_pdg::app
