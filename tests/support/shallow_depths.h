// Overlaps of ellipsoids and cylinders: MuJoCo's depths of them can be millimetres too shallow.
#ifndef MJCF_PDG_TESTS_SUPPORT_SHALLOW_DEPTHS_H_
#define MJCF_PDG_TESTS_SUPPORT_SHALLOW_DEPTHS_H_

#include <algorithm>
#include <string>
#include <vector>

#include "tests/support/test_support.h"
#include "tests/support/verify_scenes.h"

namespace mjcf_pdg::test {

struct CurvedPair {
  const char *first, *second;  // XML attributes of geoms

  // The first fixed, the second on a free joint; `allowed` is the overlap that the model allows
  // [m].
  Scene Make(double allowed = 0.0) const {
    const double margin = -allowed;
    return Scene::FromString(std::string("<mujoco><worldbody><geom ") + first +
                             "/><body><freejoint/><geom " + second + " margin='" +
                             Join(&margin, 1) + "'/></body></worldbody></mujoco>");
  }
};

struct Overlap {
  std::vector<double> q;
  double told = 0.0, truth = 0.0;  // signed distances: MuJoCo's and the slow oracle's [m]

  double hidden() const { return told - truth; }
};

// Of a CurvedPair's poses at random, within `spread` of each other [m], those that overlap by more
// than a millimetre: where MuJoCo's depth is too shallow, and some others.
inline std::vector<Overlap> RandomOverlaps(const Scene& scene, int poses, double spread) {
  constexpr double kShallow = 1e-5;  // [m]
  constexpr int kOthers = 100;       // one in so many poses
  const ModelPtr m(mj_copyModel(nullptr, scene.model()));
  m->opt.ccd_tolerance = 1e-9;  // ours, as are the iterations
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
    // No direction parts them by less than the truth: that of a true depth proves it.
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
