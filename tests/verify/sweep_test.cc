#include "verify/sweep.h"

#include <gtest/gtest.h>

#include <set>

#include "mjcf_pdg/scene.h"
#include "tests/support/test_support.h"
#include "verify/posed_pair.h"

namespace mjcf_pdg::test {
namespace {

class SweepTest : public MujocoTest {};

TEST_F(SweepTest, NamesExactlyThePairsWhoseSpheresAreNear) {
  Random rng(7);
  std::string xml = R"(<mujoco><worldbody><geom type="plane" size="0 0 1"/>)";
  for (int k = 0; k < 40; ++k) {
    const double size = rng.Uniform(.01, .2);
    xml += "<body><freejoint/><geom type='" + std::string(k % 2 ? "box" : "sphere") + "' size='" +
           Join(Eigen::Vector3d(size, rng.Uniform(.01, .2), .1)) + "' contype='" +
           std::to_string(k % 3) + "'/></body>";
  }
  const Scene scene = Scene::FromString(xml + "</worldbody></mujoco>");
  const VerifierModel& model = *scene.verifier_model();
  verify::Sweep sweep(model);
  const DataPtr d(mj_makeData(scene.model()));
  int near_pairs = 0;
  for (int trial = 0; trial < 30; ++trial) {
    mju_copy(d->qpos, RandomConfiguration(scene, rng).data(), scene.nq());
    mj_kinematics(scene.model(), d.get());
    for (const double reach : {0.0, 0.05, 1.0}) {
      const std::vector<int>& found = sweep.Near(*d, reach);
      const std::set<int> near(found.begin(), found.end());
      ASSERT_EQ(near.size(), found.size()) << "a pair is named twice";
      for (int k = 0; k < static_cast<int>(model.pairs.size()); ++k) {
        const verify::PosedPair posed{model, *d, model.pairs[k]};
        EXPECT_EQ(near.count(k), posed.HasPlane() || posed.SphereBound() <= reach) << k;
      }
      near_pairs += static_cast<int>(near.size()) - 40;
    }
  }
  EXPECT_GT(near_pairs, 1000);
}

}  // namespace
}  // namespace mjcf_pdg::test
