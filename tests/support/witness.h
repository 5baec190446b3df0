// Distances at a configuration, measured without the library: by MuJoCo on a copy of the user's
// model, and, for capsules against boxes, which MuJoCo misses, by the slow oracle.
#ifndef MJCF_PDG_TESTS_SUPPORT_WITNESS_H_
#define MJCF_PDG_TESTS_SUPPORT_WITNESS_H_

#include <algorithm>
#include <vector>

#include "tests/support/brute_distance.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {

class Witness {
 public:
  explicit Witness(const Scene& scene)
      : scene_(scene), model_(mj_copyModel(nullptr, scene.model())), data_(nullptr) {
    model_->opt.disableflags |= mjDSBL_MULTICCD;  // with several contacts, `dist` is off by cm
    model_->opt.ccd_tolerance = 1e-9;
    data_.reset(mj_makeData(model_.get()));
  }

  // The smallest of all contacts' distances and all kept pairs' signed distances [m], at most 1 m.
  double Least(const std::vector<double>& q) {
    Pose(q.data());
    mj_collision(model_.get(), data_.get());
    double least = LeastDistance(false);
    for (int c = 0; c < data_->ncon; ++c) least = std::min(least, data_->contact[c].dist);
    return least;
  }

  // The smallest signed distance of a kept pair that a joint can move [m], at most 1 m.
  double LeastMoving(const VectorXd& q) {
    Pose(q.data());
    return LeastDistance(true);
  }

 private:
  void Pose(const double* q) {
    mju_copy(data_->qpos, q, static_cast<int>(model_->nq));
    mj_kinematics(model_.get(), data_.get());
    mj_comPos(model_.get(), data_.get());
  }

  double LeastDistance(bool moving_only) {
    double least = 1.0;
    for (const KeptPair& pair : scene_.tables().pairs) {
      if (pair.kind == PairKind::kSdf || pair.kind == PairKind::kTerrain ||
          (moving_only && !pair.moves))
        continue;
      least = std::min(least, Distance(pair.geom1, pair.geom2));
    }
    return least;
  }

  double Distance(int g1, int g2) {
    const mjModel* m = model_.get();
    const double* p = data_->geom_xpos;
    const bool missed = m->geom_type[g1] == mjGEOM_CAPSULE && m->geom_type[g2] == mjGEOM_BOX;
    if (!missed) return mj_geomDistance(m, data_.get(), g1, g2, 1.0, nullptr);
    const double reach = m->geom_rbound[g1] + m->geom_rbound[g2];
    const double apart = mju_dist3(p + 3 * g1, p + 3 * g2) - reach;
    return apart > 0.01 ? apart : BruteDistance(m, data_.get(), g1, g2).distance;
  }

  const Scene& scene_;
  ModelPtr model_;
  DataPtr data_;
};

}  // namespace mjcf_pdg::test

#endif  // MJCF_PDG_TESTS_SUPPORT_WITNESS_H_
