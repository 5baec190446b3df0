// Overlaps of ellipsoids and cylinders, for which MuJoCo's depths can be millimetres too shallow.
#ifndef MJCF_PDG_TESTS_SUPPORT_SHALLOW_DEPTHS_H_
#define MJCF_PDG_TESTS_SUPPORT_SHALLOW_DEPTHS_H_

#include <algorithm>
#include <string>
#include <vector>

#include "tests/support/brute_distance.h"
#include "tests/support/mesh_shapes.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {

struct CurvedPair {
  const char *first, *second;  // XML attributes of geoms

  // A scene with the first geom fixed and the second on a free joint. `allowed` is the overlap that
  // the model allows by a negative margin [m].
  Scene Make(double allowed = 0.0) const {
    const double margin = -allowed;
    return Scene::FromString(std::string("<mujoco><worldbody><geom ") + first +
                             "/><body><freejoint/><geom " + second + " margin='" +
                             Join(&margin, 1) + "'/></body></worldbody></mujoco>");
  }
};

struct Overlap {
  std::vector<double> q;
  double told = 0.0, truth = 0.0;  // signed distances of MuJoCo and of the slow oracle [m]

  double hidden() const { return told - truth; }  // how much MuJoCo's depth is too shallow [m]
};

// Tries `poses` random poses of a CurvedPair's scene, with positions within ± `spread` [m]. Returns
// those that overlap by more than a millimetre and whose depth MuJoCo may make too shallow, and one
// in a hundred of the others.
inline std::vector<Overlap> RandomOverlaps(const Scene& scene, int poses, double spread) {
  constexpr double kShallow = 1e-5;  // least error of a depth that is suspected too shallow [m]
  constexpr int kOthers = 100;       // of other overlaps, one pose in this many is returned
  const ModelPtr m(mj_copyModel(nullptr, scene.model()));
  m->opt.ccd_tolerance = 1e-9;  // as the library sets it, like the iterations
  m->opt.ccd_iterations = 50;
  const DataPtr d(mj_makeData(m.get()));
  Random rng(6);
  std::vector<Overlap> overlaps;
  for (int i = 0; i < poses; ++i) {
    Overlap overlap;
    const Eigen::Vector3d p = rng.InBox(spread);
    overlap.q = FreePose(p, rng.UnitQuat());
    mju_copy(d->qpos, overlap.q.data(), 7);
    mj_kinematics(m.get(), d.get());
    Eigen::Matrix<double, 3, 2> witness;
    overlap.told = mj_geomDistance(m.get(), d.get(), 0, 1, 1.0, witness.data());
    if (overlap.told > -1e-3) continue;
    // The gap along any direction is at most the true signed distance. If the gap along MuJoCo's
    // own normal equals MuJoCo's distance, that is the true one or too deep.
    const Eigen::Vector3d n = (witness.col(0) - witness.col(1)).normalized();
    const double along = -Support(m.get(), d.get(), 0, n) - Support(m.get(), d.get(), 1, -n);
    const bool shallow = along < overlap.told - kShallow;
    if (!shallow && i % kOthers != 0) continue;
    overlap.truth = std::max(BruteDistance(m.get(), d.get(), 0, 1).distance, along);
    overlaps.push_back(overlap);
  }
  return overlaps;
}

}  // namespace mjcf_pdg::test

#endif  // MJCF_PDG_TESTS_SUPPORT_SHALLOW_DEPTHS_H_
