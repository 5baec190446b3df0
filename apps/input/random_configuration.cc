#include "apps/input/random_configuration.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>

#include "model/scene_tables.h"

namespace mjcf_pdg::app {
namespace {

double Between(double low, double high, Random& random) {
  return low + (high - low) * random.Uniform();
}

// Uniform over all rotations, or, with a limit, over those of at most `largest` [rad] about a
// random axis.
void TurnAtRandom(double largest, double* quat, Random& random) {
  for (int k = 0; k < 4; ++k) quat[k] = random.Normal();
  mju_normalize4(quat);
  const double angle = 2.0 * std::acos(std::min(1.0, std::abs(quat[0])));
  if (angle <= largest) return;
  double axis[3] = {quat[1], quat[2], quat[3]};
  mju_normalize3(axis);
  mju_axisAngle2Quat(quat, axis, largest * random.Uniform());
}

void DrawJoint(const mjModel& m, int joint, double* q, Random& random) {
  const double* range = m.jnt_range + 2 * joint;
  const bool limited = m.jnt_limited[joint] && std::isfinite(range[1] - range[0]);
  switch (m.jnt_type[joint]) {
    case mjJNT_FREE:
      for (int k = 0; k < 3; ++k) q[k] += Between(-m.stat.extent, m.stat.extent, random);
      TurnAtRandom(mjPI, q + 3, random);
      return;
    case mjJNT_BALL:
      TurnAtRandom(limited ? range[1] : mjPI, q, random);
      return;
    case mjJNT_SLIDE:
      *q = limited ? Between(range[0], range[1], random)
                   : *q + Between(-m.stat.extent, m.stat.extent, random);
      return;
    default:
      *q = limited ? Between(range[0], range[1], random) : Between(-mjPI, mjPI, random);
  }
}

}  // namespace

std::vector<double> RandomConfiguration(const Scene& scene, Random& random) {
  std::vector<double> q = scene.DefaultQpos();
  const mjModel& m = *scene.model();
  for (const JointEntry& joint : scene.tables().joints) {
    DrawJoint(m, joint.id, q.data() + joint.qadr, random);
  }
  return q;
}

}  // namespace mjcf_pdg::app
