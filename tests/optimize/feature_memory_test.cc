#include "optimize/feature_memory.h"

#include "tests/support/mesh_shapes.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

// A ring around the z axis, 40 mm inside and 60 mm outside, that may go anywhere, and a post of 20
// mm radius.
Scene RingOnPost() {
  const MeshShape ring = Revolution({{0.04, -0.01}, {0.06, -0.01}, {0.06, 0.01}, {0.04, 0.01}}, 32);
  const std::string xml =
      "<mujoco><asset>" + MeshXml("ring", ring) +
      "</asset><worldbody><geom type='cylinder' size='.02 .1'/><body><freejoint/>"
      "<geom type='mesh' mesh='ring'/></body></worldbody></mujoco>";
  return Scene::FromString(xml, Exact());
}

class FeatureMemoryTest : public MujocoTest {
 protected:
  FeatureMemoryTest() { memory_.Clear(tables_.pairs.size()); }

  void PoseAt(double x) {
    VectorXd q(7);
    q << x, 0, 0, 1, 0, 0, 0;
    finder_.Pose(q);
  }
  const PosedModel& posed() const { return finder_.posed(); }

  const Scene scene_ = RingOnPost();
  const SceneTables& tables_ = scene_.tables();
  ContactFinder finder_{tables_};
  FeatureMemory memory_;
};

TEST_F(FeatureMemoryTest, PlanesOfAFreePoseMeasureTheOverlapOfASmallStep) {
  EXPECT_FALSE(memory_.learning());
  PoseAt(0.019);
  memory_.Keep(tables_, posed(), finder_.Find(0.005));
  ASSERT_TRUE(memory_.learning());
  PoseAt(0.022);  // 2 mm into the post
  std::vector<NearPair> planes;
  memory_.Append(tables_, posed(), 0, planes);
  ASSERT_FALSE(planes.empty());
  double deepest = 0.0;
  for (const NearPair& near : planes) {
    deepest = std::min(deepest, near.distance);
    EXPECT_NEAR(near.n_W.norm(), 1.0, 1e-9);
    EXPECT_NEAR(near.n_W.dot(near.p2_W - near.p1_W), near.distance, 1e-12);
  }
  EXPECT_NEAR(deepest, -0.002, 3e-4);  // the hole is a polygon
}

TEST_F(FeatureMemoryTest, WhatWasLearntIsHeededWhereTheMeshesAreApartUntilItIsProvenWrong) {
  PoseAt(0.0);
  memory_.Keep(tables_, posed(), finder_.Find(0.03));
  NearPair crossing;
  crossing.n_W = Vector3d::UnitX();
  crossing.p1_W = Vector3d(0.02, 0, 0);
  crossing.p2_W = Vector3d(0.021, 0, 0);
  memory_.Learn(tables_, posed(), crossing);
  std::vector<NearPair> out;
  memory_.AppendLearnt(tables_, posed(), 0.005, out);
  ASSERT_EQ(out.size(), 1u);
  EXPECT_NEAR(out[0].distance, 0.001, 1e-12);
  out.clear();
  PoseAt(-0.01);  // apart, and yet the plane sees an overlap: forgotten
  memory_.AppendLearnt(tables_, posed(), 0.005, out);
  EXPECT_TRUE(out.empty());
  PoseAt(0.0);
  memory_.AppendLearnt(tables_, posed(), 0.005, out);
  EXPECT_TRUE(out.empty());
}

TEST_F(FeatureMemoryTest, SkippedDepthsStillTellThatThereIsAnOverlap) {
  int overlapping = 0;
  for (double x = 0.0; x < 0.1; x += 0.004) {
    PoseAt(x);
    const std::vector<NearPair> measured = finder_.Find(0.001);
    const std::vector<NearPair> skipped = finder_.Find(0.001, Depths::kSkipped);
    const bool overlaps = !measured.empty() && measured.front().distance < 0.0;
    overlapping += overlaps;
    ASSERT_EQ(overlaps, !skipped.empty() && std::isinf(skipped.front().distance)) << x;
  }
  EXPECT_GT(overlapping, 8);
}

}  // namespace
}  // namespace mjcf_pdg::test
