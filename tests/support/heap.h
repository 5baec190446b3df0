// Heaps: free bodies of mixed shapes, thrown together above a floor.
#ifndef MJCF_PDG_TESTS_SUPPORT_HEAP_H_
#define MJCF_PDG_TESTS_SUPPORT_HEAP_H_

#include <cmath>
#include <string>
#include <vector>

#include "tests/support/test_support.h"

namespace mjcf_pdg::test {

struct Heap {
  Heap(int bodies, Random& rng) {
    const char* const types[] = {"sphere", "capsule", "ellipsoid", "cylinder", "box"};
    const double half = 0.058 * std::cbrt(bodies);  // the bodies fill about half of a cube
    for (int k = 0; k < bodies; ++k) {
      const Eigen::Vector3d size = Eigen::Vector3d::Constant(0.055) + rng.InBox(0.025);
      xml += std::string("<body><freejoint/><geom type='") + types[k % 5] + "' size='" +
             Join(size) + "'/></body>";
      const Eigen::Vector3d p_W = rng.InBox(half) + Eigen::Vector3d(0, 0, half + 0.05);
      const Eigen::Quaterniond turn = rng.UnitQuat();
      q.insert(q.end(), {p_W.x(), p_W.y(), p_W.z(), turn.w(), turn.x(), turn.y(), turn.z()});
    }
    xml = "<mujoco><worldbody><geom type='plane' size='5 5 1'/>" + xml + "</worldbody></mujoco>";
  }

  std::string xml;
  std::vector<double> q;
};

}  // namespace mjcf_pdg::test

#endif  // MJCF_PDG_TESTS_SUPPORT_HEAP_H_
