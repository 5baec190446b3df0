// What contacts.h promises beside distances: bounds, order, counts of work, and what is remembered.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "collide/contacts.h"
#include "tests/support/brute_distance.h"
#include "tests/support/mesh_shapes.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

class ContactFinderContractTest : public MujocoTest {};

Scene Robot(std::uint64_t seed) {
  Random rng(seed);
  RobotOptions options;
  options.free_base = true;
  return Scene::FromString(RandomRobotXml(rng, options));
}

TEST_F(ContactFinderContractTest, BoundsOfDistancesAreThoseOfBoundingSpheres) {
  Random rng(1);
  int planes = 0, spheres = 0;
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Scene scene = Robot(seed);
    const mjModel& m = *scene.model();
    ContactFinder finder(scene.tables());
    for (int trial = 0; trial < 5; ++trial) {
      finder.Pose(RandomConfiguration(scene, rng));
      const mjData& d = *finder.posed().data();
      for (int pair = 0; pair < scene.num_kept_pairs(); ++pair) {
        const int g1 = scene.tables().pairs[pair].geom1, g2 = scene.tables().pairs[pair].geom2;
        const double bound = finder.DistanceBound(pair);
        EXPECT_LE(bound, BruteDistance(&m, &d, g1, g2).distance + 1e-9);
        const Vector3d between = AsVector(d.geom_xpos + 3 * g2) - AsVector(d.geom_xpos + 3 * g1);
        const double radii = m.geom_rbound[g1] + m.geom_rbound[g2];
        if (m.geom_type[g1] == mjGEOM_PLANE) {
          ++planes;
          const Vector3d up = AsMatrix(d.geom_xmat + 9 * g1).col(2);
          EXPECT_NEAR(bound, up.dot(between) - radii, 1e-12);
        } else {
          ++spheres;
          EXPECT_NEAR(bound, between.norm() - radii, 1e-12);
        }
      }
    }
  }
  EXPECT_GT(planes, 20);
  EXPECT_GT(spheres, 200);
}

TEST_F(ContactFinderContractTest, NearPairsComeInOrderOnceEachAndAreWhatDistanceSays) {
  Random rng(2);
  int near_pairs = 0, far_pairs = 0;
  for (const std::uint64_t seed : {4, 5}) {
    const Scene scene = Robot(seed);
    ContactFinder finder(scene.tables()), other(scene.tables());
    for (int trial = 0; trial < 20; ++trial) {
      const VectorXd q = RandomConfiguration(scene, rng);
      const double margin = rng.Uniform(-0.02, 0.3);
      finder.Pose(q);
      other.Pose(q);
      const std::vector<NearPair>& found = finder.Find(margin);
      auto next = found.begin();
      for (int pair = 0; pair < scene.num_kept_pairs(); ++pair) {
        NearPair near;
        near.pair = -7;
        near.distance = 42.0;
        if (!other.Distance(pair, margin, near)) {
          ++far_pairs;
          EXPECT_EQ(near.pair, -7) << "it is left alone";
          EXPECT_EQ(near.distance, 42.0);
          continue;
        }
        ++near_pairs;
        ASSERT_TRUE(next != found.end());
        EXPECT_EQ(next->pair, pair);
        EXPECT_EQ(near.pair, pair);
        EXPECT_LT(next->distance, margin);
        EXPECT_NEAR(next->distance, near.distance, 1e-6);
        EXPECT_NEAR(next->n_W.norm(), 1.0, 1e-12);
        EXPECT_NEAR(next->n_W.dot(next->p2_W - next->p1_W), next->distance, 1e-6);
        EXPECT_EQ(next->kind, scene.tables().pairs[pair].kind);
        ++next;
      }
      EXPECT_TRUE(next == found.end());
    }
  }
  EXPECT_GT(near_pairs, 200);
  EXPECT_GT(far_pairs, 200);
}

// After Forget a finder answers, bit for bit, as one that was asked nothing before.
TEST_F(ContactFinderContractTest, ForgettingMakesAnswersThoseOfANewFinder) {
  Random rng(3);
  const Scene convex = Robot(6);
  const Scene exact =
      MeshScene(Torus(0.3, 0.1, 12, 8), "type='mesh' mesh='moving'", Torus(0.2, 0.05, 10, 6));
  int compared = 0;
  for (const Scene* scene : {&convex, &exact}) {
    ContactFinder used(scene->tables());
    for (int trial = 0; trial < 10; ++trial) {
      used.Pose(RandomConfiguration(*scene, rng, 0.2));
      used.Find(0.5);
      const VectorXd q = RandomConfiguration(*scene, rng, 0.2);
      used.Forget();
      used.Pose(q);
      ContactFinder fresh(scene->tables());
      fresh.Pose(q);
      const std::vector<NearPair> now = used.Find(0.5), expected = fresh.Find(0.5);
      ASSERT_EQ(now.size(), expected.size());
      for (std::size_t k = 0; k < now.size(); ++k) {
        ++compared;
        EXPECT_EQ(now[k].distance, expected[k].distance);
        EXPECT_EQ(now[k].n_W, expected[k].n_W);
        EXPECT_EQ(now[k].p1_W, expected[k].p1_W);
      }
    }
  }
  EXPECT_GT(compared, 100);
}

TEST_F(ContactFinderContractTest, WorkIsCounted) {
  const Scene spheres = Scene::FromString(R"(<mujoco><worldbody>
    <geom type="sphere" size=".1"/><geom type="sphere" size=".1" pos="50 0 0"/>
    <body pos=".5 0 0"><freejoint/><geom type="sphere" size=".1"/></body></worldbody></mujoco>)");
  ContactFinder finder(spheres.tables());
  finder.Pose(ToEigen(FreePose({0.5, 0, 0})));
  EXPECT_EQ(finder.distances(), 0);
  finder.Find(0.4);  // of the near pair only
  EXPECT_EQ(finder.distances(), 1);
  NearPair near;
  EXPECT_TRUE(finder.Distance(0, 1.0, near));
  EXPECT_EQ(finder.distances(), 2);
  EXPECT_EQ(finder.queries(), 1);
  EXPECT_EQ(finder.box_tests(), 0);

  const Scene exact =
      MeshScene(Torus(0.3, 0.1, 12, 8), "type='mesh' mesh='moving'", Torus(0.2, 0.05, 10, 6));
  ContactFinder of_meshes(exact.tables());
  of_meshes.Pose(ToEigen(FreePose({0.0, 0.0, 0.4})));
  std::vector<NearPair> out(1);
  out[0].pair = -7;
  of_meshes.AppendFeatures(0, 1.0, Depths::kMeasured, out);
  EXPECT_EQ(out[0].pair, -7) << "it appends";
  ASSERT_GT(out.size(), 1u);
  EXPECT_EQ(out[1].kind, PairKind::kExact);
  const std::int64_t first = of_meshes.box_tests();
  EXPECT_GT(first, 0);
  of_meshes.AppendFeatures(0, 1.0, Depths::kMeasured, out);
  EXPECT_GT(of_meshes.box_tests(), first);
  EXPECT_EQ(of_meshes.queries(), 0);
}

}  // namespace
}  // namespace mjcf_pdg::test
