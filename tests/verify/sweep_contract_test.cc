// What sweep.h promises, where its order and its pairs are many.
#include <algorithm>
#include <limits>
#include <set>
#include <vector>

#include "tests/support/allocation_counter.h"
#include "tests/support/mesh_shapes.h"
#include "tests/support/test_support.h"
#include "verify/posed_pair.h"
#include "verify/sweep.h"

namespace mjcf_pdg::test {
namespace {

class SweepContractTest : public MujocoTest {};

std::set<int> Expected(const VerifierModel& model, const mjData& d, double reach) {
  std::set<int> near;
  for (int k = 0; k < static_cast<int>(model.pairs.size()); ++k) {
    if (model.pairs[k].sdf) continue;
    const verify::PosedPair posed{model, d, model.pairs[k]};
    if (posed.HasPlane() || posed.SphereBound() <= reach) near.insert(k);
  }
  return near;
}

// Free bodies, some of two geoms, of which not all collide with each other, around a plane that
// is not the first geom.
Scene Many(int bodies, Random& rng) {
  std::string xml = "<mujoco><worldbody>";
  for (int k = 0; k < bodies; ++k) {
    const std::string bits = "' contype='" + std::to_string(1 + k % 3) + "' conaffinity='" +
                             std::to_string(1 + k % 2) + "' pos='" + Join(rng.InBox(0.3)) + "'/>";
    xml += "<body><freejoint/><geom size='" + std::to_string(rng.Uniform(.01, .2)) + bits;
    if (k % 4 == 0) xml += "<geom type='capsule' size='.05 .2" + bits;
    xml += "</body>";
    if (k == bodies / 2) xml += "<body><geom type='plane' size='0 0 1'/></body>";
  }
  return Scene::FromString(xml + "</worldbody></mujoco>");
}

TEST_F(SweepContractTest, FewOrManyGeomsSpreadAlongAnyAxisAreAllFound) {
  Random rng(1);
  for (const int bodies : {5, 30, 120}) {
    const Scene scene = Many(bodies, rng);
    const VerifierModel& model = *scene.verifier_model();
    verify::Sweep sweep(model);
    const DataPtr d(mj_makeData(scene.model()));
    int apart = 0, near = 0;
    for (int trial = 0; trial < 9; ++trial) {
      Eigen::Vector3d spread = Eigen::Vector3d::Constant(0.3);
      spread[trial % 3] = 3.0;
      for (int k = 0; k < scene.nq(); k += 7) {
        const Eigen::Vector3d p = spread.cwiseProduct(rng.InBox(1.0));
        mju_copy(d->qpos + k, p.data(), 3);
      }
      mj_kinematics(scene.model(), d.get());
      for (const double reach : {0.0, 0.1, 2.0}) {
        const std::vector<int>& found = sweep.Near(*d, reach);
        const std::set<int> once(found.begin(), found.end());
        EXPECT_EQ(once.size(), found.size()) << "a pair is named twice";
        EXPECT_EQ(once, Expected(model, *d, reach));
        near += static_cast<int>(once.size());
        apart += static_cast<int>(model.pairs.size() - once.size());
      }
    }
    EXPECT_GT(near, 0);
    EXPECT_GT(apart, 0);
  }
}

TEST_F(SweepContractTest, PairsWithAnSdfAreNotNamed) {
  const Scene scene = Scene::FromString("<mujoco><asset>" + MeshXml("m", BoxMesh({.1, .2, .3})) +
                                        R"(</asset><worldbody><geom type="sdf" mesh="m"/>
    <body><freejoint/><geom size=".1"/><geom type="box" size=".1 .1 .1" pos=".1 0 0"/></body>
    <body><freejoint/><geom size=".1"/></body></worldbody></mujoco>)");
  const VerifierModel& model = *scene.verifier_model();
  ASSERT_TRUE(model.has_sdf_pairs);
  verify::Sweep sweep(model);
  const DataPtr d(mj_makeData(scene.model()));
  mj_kinematics(scene.model(), d.get());
  const std::vector<int>& found = sweep.Near(*d, 10.0);
  EXPECT_EQ(found.size(), 2u);
  for (const int k : found) EXPECT_FALSE(model.pairs[k].sdf);
}

TEST_F(SweepContractTest, WhatHasNoPlaceIsNearEverything) {
  Random rng(2);
  const Scene scene = Many(30, rng);
  const VerifierModel& model = *scene.verifier_model();
  verify::Sweep sweep(model);
  const DataPtr d(mj_makeData(scene.model()));
  mj_kinematics(scene.model(), d.get());
  const int lost = 17;
  for (int k = 0; k < 3; ++k) {
    d->geom_xpos[3 * lost + k] = std::numeric_limits<double>::quiet_NaN();
  }
  const std::vector<int>& found = sweep.Near(*d, 0.0);
  const std::set<int> near(found.begin(), found.end());
  int of_lost = 0;
  for (int k = 0; k < static_cast<int>(model.pairs.size()); ++k) {
    if (model.pairs[k].geom1 != lost && model.pairs[k].geom2 != lost) continue;
    ++of_lost;
    EXPECT_EQ(near.count(k), 1u);
  }
  EXPECT_GT(of_lost, 10);
}

TEST_F(SweepContractTest, NearAllocatesNothing) {
  if (!AllocationCounter::Works()) GTEST_SKIP() << "no allocation is seen here";
  Random rng(3);
  for (const int bodies : {30, 120}) {
    const Scene scene = Many(bodies, rng);
    verify::Sweep sweep(*scene.verifier_model());
    const DataPtr d(mj_makeData(scene.model()));
    mj_kinematics(scene.model(), d.get());
    const AllocationCounter counter;
    for (const double reach : {0.0, 100.0}) sweep.Near(*d, reach);
    EXPECT_EQ(counter.count(), 0);
  }
}

}  // namespace
}  // namespace mjcf_pdg::test
