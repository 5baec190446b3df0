#include "paper/contact_space_projection.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "tests/support/test_support.h"
#include "verify/verifier.h"

namespace mjcf_pdg::test {
namespace {

class ContactSpaceProjectionTest : public MujocoTest {};

struct Projector {
  explicit Projector(const std::string& xml)
      : scene(Scene::FromString(xml)),
        tables(scene.tables()),
        finder(tables),
        ccd(tables, finder),
        projection(tables, ccd),
        verifier(scene.verifier_model(), {}) {}

  // Smallest signed distance [m], at most 1 m, as the independent check says.
  double Margin(const VectorXd& q) { return verifier.Check(ToVector(q)).min_distance; }
  double Left(const VectorXd& q, const VectorXd& q_in) const {
    VectorXd dq;
    Difference(tables, q, q_in, dq);
    return dq.norm();
  }

  Scene scene;
  const SceneTables& tables;
  ContactFinder finder;
  Ccdg ccd;
  ContactSpaceProjection projection;
  Verifier verifier;
};

std::string World(const std::string& inside) {
  return "<mujoco><compiler boundmass='1e-3' boundinertia='1e-6'/><worldbody>" + inside +
         "</worldbody></mujoco>";
}

// Paper, Fig. 6: L0 carries L1 carries L2; L1 runs into the obstacle, L2 is clear of everything.
const std::string kThreeLinks = World(R"(
    <geom name="obstacle" size=".05" pos=".15 .1 0"/>
    <body name="L0"><joint axis="0 0 1"/><geom type="capsule" size=".01" fromto="0 0 .2 .1 0 .2"/>
      <body name="L1" pos=".1 0 0"><joint axis="0 0 1"/>
        <geom name="L1" type="capsule" size=".01" fromto="0 0 0 .1 0 0"/>
        <body name="L2" pos=".1 0 0"><joint axis="0 0 1"/>
          <geom type="capsule" size=".01" fromto="0 0 -.3 .1 0 -.3"/></body></body></body>)");

TEST_F(ContactSpaceProjectionTest, TheLinkInContactAndItsAncestorsStopAndItsDescendantArrives) {
  Projector p(kThreeLinks);
  const VectorXd q_f = VectorXd::Zero(3), q_in = Vector3d(0.6, 0.6, 1.0);
  const ProjectionResult& result = p.projection.GeneralizedCcd(q_f, q_in);
  EXPECT_TRUE(result.start_free);
  EXPECT_TRUE(result.certified);
  EXPECT_TRUE(result.complete);
  EXPECT_EQ(result.motions, 2);
  ASSERT_EQ(result.pairs.size(), 1u);
  EXPECT_EQ(p.scene.GeomName(p.tables.pairs[result.pairs[0]].geom2), "L1");
  EXPECT_LT(result.q[0], 0.6);
  EXPECT_NEAR(result.q[0], result.q[1], 1e-12);  // both stopped at the same τ
  EXPECT_NEAR(result.q[2], 1.0, 1e-12);
  EXPECT_GT(p.Margin(result.q), 0.0);
}

TEST_F(ContactSpaceProjectionTest, WithoutObstaclesBothStepsArrive) {
  Projector p(World(R"(<geom size=".1" pos="0 0 5"/><body><joint axis="0 0 1"/>
      <geom size=".1"/><body pos="1 0 0"><joint type="ball"/><geom size=".1"/></body></body>)"));
  Random rng(1);
  for (int i = 0; i < 20; ++i) {
    const VectorXd q_f = RandomConfiguration(p.scene, rng),
                   q_in = RandomConfiguration(p.scene, rng);
    EXPECT_LT(p.Left(p.projection.GeneralizedCcd(q_f, q_in).q, q_in), 1e-12);
    EXPECT_EQ(p.projection.GeneralizedCcd(q_f, q_in).motions, 1);
    EXPECT_LT(p.Left(p.projection.GreedyOptimization(q_f, q_in).q, q_in), 1e-12);
  }
}

// Paper, Fig. 7: after a first contact elsewhere in the chain, the base can still move alone.
TEST_F(ContactSpaceProjectionTest, GreedyOptimizationMovesTheBaseThatCcdgHadToStop) {
  Projector p(World(R"(<geom name="wall" type="box" size=".01 1 1" pos="1 0 0"/>
      <body name="base"><joint type="slide" axis="1 0 0"/><geom type="box" size=".1 .1 .1"/>
        <body pos="0 0 .5"><joint axis="0 1 0"/><geom type="capsule" size=".02" fromto="0 0 0 0 0 .3"/>
          <body pos="0 0 .3"><joint axis="0 1 0"/>
            <geom name="tip" type="capsule" size=".02" fromto="0 0 .05 0 0 .75"/></body></body></body>)"));
  // The tip folds back onto the base while the base drives into the wall.
  const VectorXd q_f = VectorXd::Zero(3), q_in = Vector3d(0.95, -0.2, -3.1);
  const ProjectionResult ccd = p.projection.GeneralizedCcd(q_f, q_in);
  EXPECT_LT(ccd.q[0], 0.88);
  ASSERT_EQ(ccd.pairs.size(), 1u);
  const ProjectionResult greedy = p.projection.GreedyOptimization(ccd.q, q_in);
  EXPECT_NEAR(greedy.q[0], 0.99 - 0.1, 5e-6);
  EXPECT_LE(greedy.motions, 3);
  EXPECT_TRUE(greedy.certified);
  EXPECT_GT(p.Margin(greedy.q), -1e-6);
  const ProjectionResult both = p.projection.Project(q_f, q_in);
  EXPECT_EQ(both.q, greedy.q);
  EXPECT_EQ(both.poses, ccd.poses + greedy.poses);
}

TEST_F(ContactSpaceProjectionTest, GreedyOptimizationGoesFromBaseToTerminal) {
  // Either joint alone would reach its goal, but not both: the base's comes first.
  Projector p(World(R"(<geom type="box" size=".01 1 1" pos="1 0 0"/>
      <body><joint type="slide" axis="1 0 0"/><geom size=".01" contype="0" conaffinity="0"/>
        <body><joint type="slide" axis="1 0 0"/><geom size=".1"/></body></body>)"));
  const ProjectionResult& result =
      p.projection.GreedyOptimization(Eigen::Vector2d(0, 0), Eigen::Vector2d(0.8, 0.5));
  EXPECT_NEAR(result.q[0], 0.8, 1e-12);
  EXPECT_NEAR(result.q[1], 0.99 - 0.1 - 0.8, 5e-6);
}

TEST_F(ContactSpaceProjectionTest, JointsAboveBothLinksStopToo) {
  // Two fingers of one hand close on each other while the hand turns.
  Projector p(World(R"(<body name="hand"><joint axis="0 0 1"/><geom size=".01" pos="0 0 1"/>
      <body pos="-.1 0 0"><joint axis="0 1 0"/><geom type="capsule" size=".02" fromto="0 0 0 0 0 .3"/></body>
      <body pos=".1 0 0"><joint axis="0 1 0"/><geom type="capsule" size=".02" fromto="0 0 0 0 0 .3"/></body>
      </body>)"));
  const ProjectionResult& result =
      p.projection.GeneralizedCcd(VectorXd::Zero(3), Vector3d(1.0, 0.5, -0.5));
  EXPECT_LT(result.q[0], 0.9);
  EXPECT_GT(p.Margin(result.q), 0.0);
}

TEST_F(ContactSpaceProjectionTest, AJointAtItsLimitStopsAlone) {
  Projector p(World(R"(<geom size=".1" pos="0 0 5"/><body><joint axis="0 0 1" range="-30 30"/>
      <geom size=".1"/><body pos="1 0 0"><joint axis="0 0 1"/><geom size=".1"/></body></body>)"));
  const ProjectionResult& result =
      p.projection.GeneralizedCcd(Eigen::Vector2d(0, 0), Eigen::Vector2d(1.0, 0.7));
  EXPECT_NEAR(result.q[0], M_PI / 6, 1e-12);
  EXPECT_NEAR(result.q[1], 0.7, 1e-12);
  EXPECT_TRUE(result.pairs.empty());
}

TEST_F(ContactSpaceProjectionTest, AStartThatOverlapsIsSaidAndReturned) {
  Projector p(World(R"(<geom size=".1"/><body pos=".15 0 0"><joint type="slide"/>
      <geom size=".1"/></body>)"));
  const VectorXd q_f = VectorXd::Zero(1);
  const ProjectionResult& result = p.projection.Project(q_f, VectorXd::Constant(1, 1.0));
  EXPECT_FALSE(result.start_free);
  EXPECT_EQ(result.q, q_f);
  EXPECT_EQ(result.pairs, std::vector<int>{0});
}

TEST_F(ContactSpaceProjectionTest, AnEmptyBudgetLeavesAFreeConfiguration) {
  Random rng(3);
  Projector p(kThreeLinks);
  ProjectionOptions options;
  options.ccd.max_poses = 3;
  const ProjectionResult& result =
      p.projection.Project(VectorXd::Zero(3), Vector3d(0.6, 0.6, 1.0), options);
  EXPECT_FALSE(result.complete);
  EXPECT_LE(result.poses, 3);
  EXPECT_GT(p.Margin(result.q), 0.0);
}

TEST_F(ContactSpaceProjectionTest, OfRandomRobotsEveryProjectionIsFreeCertifiedAndNearer) {
  Random rng(2);
  int runs = 0, in_contact = 0, open = 0;
  long poses = 0, most = 0, motions = 0;
  for (int model = 0; model < 12; ++model) {
    RobotOptions robot;
    robot.free_base = model % 2 == 1;
    Projector p(RandomRobotXml(rng, robot));
    for (int i = 0; i < 60; ++i) {
      const VectorXd q_f = RandomConfiguration(p.scene, rng);
      const VectorXd q_in = RandomConfiguration(p.scene, rng);
      if (p.Margin(q_f) < 0.0) continue;
      const ProjectionResult result = p.projection.Project(q_f, q_in);
      EXPECT_TRUE(result.start_free);
      EXPECT_TRUE(result.certified);
      EXPECT_TRUE(result.complete);
      EXPECT_GE(p.Margin(result.q), -1e-6) << Join(q_f) << "\n" << Join(q_in);
      EXPECT_LE(LimitExcess(p.tables, result.q), 1.1e-9);
      EXPECT_LE(p.Left(result.q, q_in), p.Left(q_f, q_in) + 1e-9);
      const VectorXd again = p.projection.Project(result.q, q_in).q;  // all contacts glide now
      EXPECT_GE(p.Margin(again), -1e-6);
      in_contact += !result.pairs.empty();
      open += p.Margin(result.q) > 0.0;
      ++runs;
      poses += result.poses;
      motions += result.motions;
      most = std::max<long>(most, result.poses);
    }
  }
  std::printf(
      "  %d projections, %d in contact, %d with an open gap; %.1f motions, %.1f poses each "
      "(most %ld)\n",
      runs, in_contact, open, double(motions) / runs, double(poses) / runs, most);
  EXPECT_GT(runs, 100);
  EXPECT_GT(in_contact, runs / 2);
  EXPECT_GT(open, runs * 9 / 10);
  EXPECT_LT(poses, 150L * runs);
}

// A bar above a wall, turned by 90 degrees against q_in, which lies in the wall.
TEST_F(ContactSpaceProjectionTest, ARigidModelIsRotatedFirstAndThenTranslated) {
  Projector p(World(R"(
      <geom name="wall" type="box" size="1 1 .1"/>
      <body><freejoint/><geom type="box" size=".3 .02 .02" mass="1" pos=".1 0 0"/></body>)"));
  VectorXd q_f(7), q_in(7);
  q_f << 0, 0, 1, std::sqrt(0.5), 0, 0, std::sqrt(0.5);
  q_in << 0, 0, 0.05, 1, 0, 0, 0;
  const ProjectionResult& result = p.projection.Project(q_f, q_in);
  EXPECT_TRUE(result.certified);
  EXPECT_EQ(result.jumps, 1);
  EXPECT_EQ(result.q.segment<4>(3), q_in.segment<4>(3));
  EXPECT_NEAR(result.q[2], 0.12, 1e-5);
  EXPECT_NEAR(p.Margin(result.q), 0.0, 1e-5);
}

// Turned about the middle of the two balls, which lies 0.5 m from the body's own mass, the dumbbell
// comes straight down.
TEST_F(ContactSpaceProjectionTest, WeldedBodiesTurnAboutTheirCommonCentreOfMass) {
  Projector p(World(R"(
      <geom name="wall" type="box" size="3 3 .1"/>
      <body><freejoint/><geom size=".05" mass="1"/>
        <body pos="1 0 0"><geom size=".05" mass="1"/></body></body>)"));
  VectorXd q_f(7), q_in(7);
  q_f << 0, 0, 1, 1, 0, 0, 0;
  q_in << 1, 0, 0.05, 0, 0, 0, 1;
  const ProjectionResult& result = p.projection.Project(q_f, q_in);
  EXPECT_EQ(result.jumps, 1);
  EXPECT_NEAR(result.q[0], 1.0, 1e-9);
  EXPECT_NEAR(result.q[2], 0.15, 1e-5);
}

TEST_F(ContactSpaceProjectionTest, ARotationThatCollidesIsLeftToFullCcd) {
  Projector p(World(R"(
      <geom name="wall" type="box" size="1 1 .1"/>
      <body><freejoint/><geom type="box" size=".3 .02 .02" mass="1"/></body>)"));
  VectorXd q_f(7), q_in(7);
  q_f << 0, 0, 0.2, 1, 0, 0, 0;
  q_in << 0, 0, 0.2, std::sqrt(0.5), 0, std::sqrt(0.5), 0;  // upright: through the wall
  const ProjectionResult& result = p.projection.Project(q_f, q_in);
  EXPECT_EQ(result.jumps, 0);
  EXPECT_FALSE(result.pairs.empty());
  EXPECT_NEAR(p.Margin(result.q), 0.0, 1e-5);
  EXPECT_LT(p.Left(result.q, q_in), p.Left(q_f, q_in));
}

}  // namespace
}  // namespace mjcf_pdg::test
