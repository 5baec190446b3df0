#include "paper/successive_perturbation.h"

#include "tests/support/paper_support.h"

namespace mjcf_pdg::test {
namespace {

class SuccessivePerturbationTest : public MujocoTest {};

struct Perturbed : PosedProblem {
  explicit Perturbed(const std::string& xml) : PosedProblem(xml), perturbation(work) {}

  PerturbationResult Run(const VectorXd& q_in, const PerturbationOptions& run_options = {}) {
    SetInput(q_in);
    return perturbation.Run(run_options);
  }
  SuccessivePerturbation perturbation;
};

std::string Bar(const std::string& joint, const std::string& inside = {}) {
  return "<body pos='.3 0 0'><joint " + joint +
         "/><geom type='capsule' size='.02' fromto='.03 0 0 .27 0 0'/>" + inside + "</body>";
}

// Base, three links in a row; the last one's reach is what collides.
std::string ChainXml(const std::string& obstacles, const std::string& range = "") {
  const std::string hinge = "axis='0 0 1' " + range;
  return InWorld(obstacles + Bar(hinge, Bar(hinge, Bar(hinge))));
}

TEST_F(SuccessivePerturbationTest, OnlyTheTerminalLinkMovesWhenThatIsEnough) {
  Perturbed p(ChainXml("<geom size='.05' pos='1.1 0 0'/>"));
  const PerturbationResult result = p.Run(VectorXd::Zero(3));
  ASSERT_TRUE(result.free);
  EXPECT_TRUE(p.Free(result.q));
  EXPECT_EQ(result.perturbed, 1);
  EXPECT_EQ(result.q[0], 0.0);
  EXPECT_EQ(result.q[1], 0.0);
  EXPECT_NE(result.q[2], 0.0);
}

TEST_F(SuccessivePerturbationTest, TheNearestTryThatSucceedsIsTaken) {
  Perturbed p(ChainXml("<geom size='.05' pos='1.1 .03 0'/>"));
  const PerturbationResult result = p.Run(VectorXd::Zero(3));
  ASSERT_TRUE(result.free);
  // Away from the obstacle, which lies to the positive side; not further than a few steps.
  EXPECT_LT(result.q[2], 0.0);
  EXPECT_GT(result.q[2], -0.5);
}

TEST_F(SuccessivePerturbationTest, ALinkThatFailsHandsOverToItsParent) {
  // The last link's anchor itself lies inside the obstacle: its own joint cannot help.
  Perturbed p(ChainXml("<geom size='.06' pos='.91 0 0'/>"));
  const PerturbationResult result = p.Run(VectorXd::Zero(3));
  ASSERT_TRUE(result.free);
  EXPECT_EQ(result.q[0], 0.0);
  EXPECT_NE(result.q[1], 0.0);
}

TEST_F(SuccessivePerturbationTest, AJointIsTriedOverItsWholeRange) {
  // Only turns of more than two thirds of a half turn bring the arm out of the block.
  Perturbed p(
      InWorld("<geom type='box' size='1 2 .1' pos='1.1 0 0'/>"
              "<body><joint axis='0 0 1'/>"
              "<geom type='capsule' size='.02' fromto='.15 0 0 .5 0 0'/></body>"));
  const PerturbationResult result = p.Run(VectorXd::Zero(1));
  ASSERT_TRUE(result.free);
  EXPECT_GT(std::abs(result.q[0]), 1.2);
}

TEST_F(SuccessivePerturbationTest, JointLimitsAreNeverLeft) {
  const std::string wall = "<geom type='box' size='.05 1 1' pos='1.12 0 0'/>";
  EXPECT_FALSE(Perturbed(ChainXml(wall, "range='-.01 .01'")).Run(VectorXd::Zero(3)).free);
  Perturbed wide(ChainXml(wall, "range='-1 1'"));
  const PerturbationResult result = wide.Run(VectorXd::Zero(3));
  ASSERT_TRUE(result.free);
  EXPECT_EQ(LimitExcess(wide.scene.tables(), result.q), 0.0);
  Perturbed ball(
      InWorld("<geom size='.05' pos='.3 0 0'/><body><joint type='ball' range='0 .4'/>"
              "<geom type='capsule' size='.02' fromto='.05 0 0 .5 0 0'/></body>"));
  const PerturbationResult turned = ball.Run(Eigen::Vector4d(1, 0, 0, 0));
  ASSERT_TRUE(turned.free);
  EXPECT_EQ(LimitExcess(ball.scene.tables(), turned.q), 0.0);
}

// Two fingers on a sliding palm.
std::string PalmXml(const std::string& obstacles, const std::string& range) {
  return InWorld(obstacles +
                 "<body><joint type='slide' axis='1 0 0'/>"
                 "<geom type='box' size='.1 .2 .02'/>"
                 "<body pos='.1 .15 0'><joint axis='0 0 1' " +
                 range +
                 "/>"
                 "<geom type='capsule' size='.02' fromto='.05 0 0 .3 0 0'/></body>"
                 "<body pos='.1 -.15 0'><joint axis='0 0 1' " +
                 range +
                 "/>"
                 "<geom type='capsule' size='.02' fromto='.05 0 0 .3 0 0'/></body></body>");
}

TEST_F(SuccessivePerturbationTest, ItStopsBelowALinkWithTwoChildren) {
  const std::string post = "<geom size='.04' pos='.35 .15 0'/>";
  EXPECT_TRUE(Perturbed(PalmXml(post, "")).Run(VectorXd::Zero(3)).free);
  // Moving the palm back would help, but it might disturb the other finger.
  const PerturbationResult stiff =
      Perturbed(PalmXml(post, "range='-.01 .01'")).Run(VectorXd::Zero(3));
  EXPECT_FALSE(stiff.free);
  EXPECT_EQ(stiff.perturbed, 0);
}

TEST_F(SuccessivePerturbationTest, AnInCollisionLinkWithTwoChildrenIsMovedFirst) {
  const std::string posts = "<geom size='.04' pos='-.13 0 0'/><geom size='.04' pos='.40 .15 0'/>";
  Perturbed p(PalmXml(posts, ""));
  const PerturbationResult result = p.Run(VectorXd::Zero(3));
  ASSERT_TRUE(result.free);
  EXPECT_TRUE(p.Free(result.q));
  EXPECT_GT(result.q[0], 0.0);
  EXPECT_NE(result.q[1], 0.0);
  EXPECT_EQ(result.q[2], 0.0);
}

TEST_F(SuccessivePerturbationTest, SelfCollisionCountsAsCollision) {
  Perturbed p(PalmXml("", ""));
  const VectorXd crossed = Vector3d(0.0, -0.9, 0.9);
  EXPECT_FALSE(p.perturbation.SelfCollisionFree(crossed));
  const PerturbationResult result = p.Run(crossed);
  ASSERT_TRUE(result.free);
  EXPECT_TRUE(p.perturbation.SelfCollisionFree(result.q));
  EXPECT_EQ(result.q[0], 0.0);
}

TEST_F(SuccessivePerturbationTest, QueriesAreBounded) {
  Perturbed p(InWorld("<geom type='box' size='9 9 9'/><body><freejoint/><geom size='.1'/></body>"));
  const PerturbationResult result = p.Run(ToEigen(p.scene.DefaultQpos()), {.max_queries = 50});
  EXPECT_FALSE(result.free);
  EXPECT_LE(result.queries, 51);
}

TEST_F(SuccessivePerturbationTest, OfRandomRobotsSuccessMeansFreeWithinLimits) {
  Random rng(7);
  int colliding = 0, solved = 0;
  for (int model = 0; model < 8; ++model) {
    RobotOptions robot;
    robot.free_base = model % 2 == 1;
    Perturbed p(RandomRobotXml(rng, robot));
    for (int i = 0; i < 12; ++i) {
      const VectorXd q_in = RandomConfiguration(p.scene, rng);
      p.SetInput(q_in);
      if (p.Free(q_in)) continue;
      ++colliding;
      const PerturbationResult result = p.perturbation.Run();
      EXPECT_LE(LimitExcess(p.scene.tables(), result.q), 1e-12);
      EXPECT_EQ(p.perturbation.Run().q, result.q);
      solved += result.free;
      EXPECT_EQ(result.free, p.Free(result.q)) << Join(q_in);
    }
  }
  RecordProperty("colliding", colliding);
  RecordProperty("solved", solved);
  EXPECT_GE(colliding, 30);
  EXPECT_GT(solved, colliding / 4);
}

}  // namespace
}  // namespace mjcf_pdg::test
