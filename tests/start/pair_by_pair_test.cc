// Overlapping meshes parted pair by pair: fingers through the wall of a cup.
#include "start/pair_by_pair.h"

#include <gtest/gtest.h>

#include "mjcf_pdg/pdg.h"
#include "tests/support/mesh_shapes.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

// A tube about z, and a finger on a slide along x whose tip is in the tube's wall.
class PairByPairTest : public ::testing::Test {
 protected:
  static constexpr double kRadius = 0.05, kWall = 0.004, kTip = 0.01;

  // `slides`: of the finger, MJCF.
  static Scene TubeAndFinger(const std::string& slides) {
    const MeshShape tube = Cup(kRadius, 0.1, kWall, 48), tip = BoxMesh({kTip, kTip, kTip});
    return Scene::FromString("<mujoco><asset>" + MeshXml("tube", tube) + MeshXml("tip", tip) +
                                 "</asset><worldbody><geom type='mesh' mesh='tube'/>"
                                 "<body pos='0 0 0.06'>" +
                                 slides +
                                 "<geom type='mesh' mesh='tip'/></body></worldbody></mujoco>",
                             Exact());
  }

  static std::optional<VectorXd> Start(const Scene& scene, const std::vector<double>& q) {
    Options options;
    Workspace work(scene.tables(), options);
    work.Begin(ToEigen(q));
    return PairByPair(work).Start(work.problem().q_in);
  }
};

TEST_F(PairByPairTest, TheShorterWayOutOfAThinWallIsTaken) {
  const Scene scene = TubeAndFinger("<joint type='slide' axis='1 0 0'/>");
  const double inner = kRadius - kWall - kTip, outer = kRadius + kTip;  // but for the curvature
  int inside = 0, outside = 0;
  for (double x = 0.037; x < 0.0595; x += 0.0015) {
    const std::optional<VectorXd> q = Start(scene, {x});
    ASSERT_TRUE(q) << x;
    EXPECT_TRUE(Verify(scene, {(*q)[0]}).free) << x;
    const double in = x - inner, out = outer - x;
    if (std::abs(in - out) < 0.004) continue;
    ++(in < out ? inside : outside);
    EXPECT_EQ((*q)[0] < x, in < out) << x;
    EXPECT_LT(std::abs((*q)[0] - x), 2.5 * std::min(in, out) + 1e-3)
        << "the first way that is free";
  }
  EXPECT_GT(inside, 3);
  EXPECT_GT(outside, 3);
}

TEST_F(PairByPairTest, NothingOverlapsOrNothingCanMoveApart) {
  EXPECT_FALSE(Start(TubeAndFinger("<joint type='slide' axis='1 0 0'/>"), {0.0}));
  // Along z within its limits the tip stays in the wall.
  const std::string stuck =
      "<joint type='slide' axis='0 0 1' limited='true' range='-0.001 0.001'/>";
  const Scene scene = Scene::FromString(
      "<mujoco><asset>" + MeshXml("tube", Cup(kRadius, 0.1, kWall, 48)) +
          MeshXml("tip", BoxMesh({kTip, kTip, kTip})) +
          "</asset><worldbody><geom type='mesh' mesh='tube'/><body pos='0.048 0 0.06'>" + stuck +
          "<geom type='mesh' mesh='tip'/></body></worldbody></mujoco>",
      Exact());
  EXPECT_FALSE(Start(scene, {0.0}));
}

}  // namespace
}  // namespace mjcf_pdg::test
