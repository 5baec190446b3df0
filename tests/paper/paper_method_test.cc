#include "paper/paper_method.h"

#include <cstdio>

#include "mjcf_pdg/pdg.h"
#include "tests/support/paper_support.h"

namespace mjcf_pdg::test {
namespace {

class PaperMethodTest : public MujocoTest {};

struct Paper : PosedProblem {
  explicit Paper(const std::string& xml, const Options& user_options = {})
      : PosedProblem(xml, user_options), method(work) {}
  PaperMethod method;
};

// Paper, Fig. 12 and 13.
TEST_F(PaperMethodTest, TwoLinksOverTheGroundReachTheAnalyticOptimum) {
  for (int k = 0; k < 10; ++k) {
    const double d = 1.0 + 0.1 * k, optimum = TwoLinksOptimum(d);
    Paper p(TwoLinksXml(d));
    const PaperResult result = p.method.Run();
    ASSERT_TRUE(result.free);
    EXPECT_TRUE(result.certified);
    EXPECT_EQ(result.start, Component::kSuccessivePerturbation);
    EXPECT_NEAR(result.sigma, p.work.norm.Sigma(result.q), 1e-15);
    EXPECT_LT(result.sigma, (k == 0 ? 1.2 : 1.01) * optimum) << "d = " << d;
    EXPECT_GT(result.sigma, 0.9999 * optimum) << "d = " << d;  // the tolerance allows a little
    // Theorem 1: the answer lies on the contact space.
    EXPECT_LT(p.Margin(result.q), 1e-5);
  }
}

// Limits, freeness, monotony and determinism, whatever the scene.
struct Tally {
  int colliding = 0, solved = 0, touching = 0;
};

void CheckRobot(Paper& p, Paper& fresh, Random& rng, Tally& tally) {
  for (int i = 0; i < 8; ++i) {
    const VectorXd q_in = RandomConfiguration(p.scene, rng);
    p.SetInput(q_in);
    if (p.Free(p.work.problem().q_in)) continue;
    ++tally.colliding;
    const PaperResult result = p.method.Run();
    fresh.SetInput(q_in);
    const PaperResult again = fresh.method.Run();
    EXPECT_EQ(again.q, result.q);
    EXPECT_EQ(again.sigmas, result.sigmas);
    if (!result.free) continue;
    ++tally.solved;
    // MuJoCo's distances jitter: what is left of that the solver mends, after its verifier.
    EXPECT_GE(p.Margin(result.q), -1.1 * p.options.tolerance) << Join(q_in);
    EXPECT_LE(LimitExcess(p.scene.tables(), result.q), 1.1e-9);
    ASSERT_FALSE(result.sigmas.empty());
    for (std::size_t k = 1; k < result.sigmas.size(); ++k) {
      EXPECT_LT(result.sigmas[k], result.sigmas[k - 1]);
    }
    EXPECT_EQ(result.sigma, result.sigmas.back());
    EXPECT_NE(result.status, IterationStatus::kStartNotFree);
    EXPECT_NE(result.status, IterationStatus::kBudget);
    tally.touching += p.Margin(result.q) < 1e-4;
  }
}

TEST_F(PaperMethodTest, OfRandomRobotsAnswersAreFreeWithinLimitsAndTheirSigmaNeverRises) {
  Random rng(11);
  Tally tally;
  for (int model = 0; model < 8; ++model) {
    RobotOptions robot;
    robot.free_base = model % 2 == 1;
    const std::string xml = RandomRobotXml(rng, robot);
    Paper p(xml), fresh(xml);
    CheckRobot(p, fresh, rng, tally);
  }
  std::printf("%d colliding, %d solved, %d touching\n", tally.colliding, tally.solved,
              tally.touching);
  EXPECT_GE(tally.colliding, 20);
  EXPECT_GE(tally.solved, tally.colliding * 8 / 10);
  EXPECT_GE(tally.touching, tally.solved * 9 / 10);  // Theorem 1
}

TEST_F(PaperMethodTest, CorrectionsLowerSigmaFarMoreOftenThanTheyRaiseIt) {
  Random rng(12);
  int lower = 0, higher = 0;
  for (int model = 0; model < 8; ++model) {
    RobotOptions robot;
    robot.free_base = model % 2 == 1;
    const std::string xml = RandomRobotXml(rng, robot);
    Options options;
    options.method = Method::kPaper;
    Paper p(xml, options);
    options.without = {"corrections"};
    Paper uncorrected(xml, options);
    for (int i = 0; i < 8; ++i) {
      const VectorXd q_in = RandomConfiguration(p.scene, rng);
      p.SetInput(q_in);
      uncorrected.SetInput(q_in);
      if (p.Free(p.work.problem().q_in)) continue;
      const double with = p.method.Run().sigma;
      const double without = uncorrected.method.Run().sigma;
      lower += with < 0.999 * without;
      higher += without < 0.999 * with;
    }
  }
  std::printf("lower %d times, higher %d times\n", lower, higher);
  EXPECT_GE(lower, 5);
  EXPECT_GE(lower, 3 * higher);
}

TEST_F(PaperMethodTest, AJointLimitThatEndsTheWayIsKept) {
  // The nearest way out, up, is closed by the hinge's limit.
  Paper p(
      InWorld("<geom type='box' size='.1 1 .1' pos='.6 0 -.02'/>"
              "<body><joint axis='0 -1 0' range='-1.5 .05'/>"
              "<geom type='capsule' size='.02' fromto='.1 0 0 .7 0 0'/></body>"));
  const PaperResult result = p.method.Run();
  ASSERT_TRUE(result.free);
  EXPECT_LT(result.q[0], 0.0);
  EXPECT_GE(result.q[0], -1.5);
}

// Paper, Fig. 8: a thin obstacle stands between q_f and the place where q_in's obstacle begins.
const std::string kBlocked = InWorld(
    "<geom type='box' size='.01 1 1' pos='1 0 0'/><geom size='.2'/>"
    "<body><joint type='slide' axis='1 0 0'/><geom size='.1'/></body>");

TEST_F(PaperMethodTest, ALimitThatIsExceededIsMendedWithoutAnyPairOfGeoms) {
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody><body>
      <joint type="slide" range="0 1"/><geom size=".1"/></body></worldbody></mujoco>)");
  Options options;
  options.method = Method::kPaper;
  const Result result = Solver(scene, options).Solve(std::vector<double>{-0.5});
  EXPECT_EQ(result.status, Status::kSolved);
  EXPECT_NEAR(result.sigma, 0.25, 1e-5);
}

TEST_F(PaperMethodTest, ReverseProjectionGetsBehindAnObstacleOnTheWay) {
  PosedProblem p(kBlocked);
  Ccdg ccd(p.scene.tables(), p.work.finder);
  ContactSpaceProjection projection(p.scene.tables(), ccd);
  const VectorXd q_f = VectorXd::Constant(1, 2.0), q_in = VectorXd::Zero(1);
  ProjectionOptions options;
  EXPECT_NEAR(projection.Project(q_f, q_in, options).q[0], 1.11, 1e-5);
  options.reverse_samples = 16;
  const ProjectionResult& result = projection.Project(q_f, q_in, options);
  EXPECT_NEAR(result.q[0], 0.3, 1e-5);
  EXPECT_GE(result.jumps, 1);
  EXPECT_TRUE(result.certified);
}

TEST_F(PaperMethodTest, ReverseProjectionOfAFreeGoalArrivesAtOnce) {
  PosedProblem p(kBlocked);
  Ccdg ccd(p.scene.tables(), p.work.finder);
  ContactSpaceProjection projection(p.scene.tables(), ccd);
  ProjectionOptions options;
  options.reverse_samples = 8;
  const VectorXd q_f = VectorXd::Constant(1, 2.0), goal = VectorXd::Constant(1, 0.5);
  EXPECT_EQ(projection.Project(q_f, goal, options).q[0], 0.5);
}

// A bar on a ball joint, turned from one side of a post to the other, about z.
void CheckBall(const std::string& range, bool arrives) {
  PosedProblem p(
      InWorld("<geom size='.02' pos='0 .3 0'/><geom size='.06' pos='.3 0 0'/>"
              "<body><joint type='ball' " +
              range +
              "/>"
              "<geom type='capsule' size='.01' fromto='.1 0 0 .5 0 0'/></body>"));
  Ccdg ccd(p.scene.tables(), p.work.finder);
  ContactSpaceProjection projection(p.scene.tables(), ccd);
  auto turned = [](double angle) {
    return VectorXd(Eigen::Vector4d(std::cos(angle / 2), 0, 0, std::sin(angle / 2)));
  };
  ProjectionOptions options;
  const double contact = 2.0 * std::asin(std::sqrt((1.0 - std::cos(std::asin(0.07 / 0.3))) / 2));
  const VectorXd ccdg = projection.Project(turned(2.5), turned(0.0), options).q;
  EXPECT_GT(BallAngle(ccdg.data()), M_PI / 2);  // the post stops it
  options.reverse_samples = 16;
  const VectorXd q = projection.Project(turned(2.5), turned(0.0), options).q;
  EXPECT_TRUE(p.Free(q));
  EXPECT_NEAR(BallAngle(q.data()), contact, 1e-4);
  // From outside of the limit's reach and back: the axis turns by more than the limit on the way.
  const VectorXd far = projection.Project(turned(-2.5), turned(2.5), options).q;
  EXPECT_TRUE(p.Free(far));
  EXPECT_LE(LimitExcess(p.scene.tables(), far), 1.1e-9);
  EXPECT_EQ(std::abs(far.dot(turned(2.5))) > 1 - 1e-9, arrives);
}

TEST_F(PaperMethodTest, ReverseProjectionTurnsBallsWithAndWithoutLimits) {
  CheckBall("", true);
  CheckBall("range='0 2.6'", true);
}

TEST_F(PaperMethodTest, TheSolverRunsItWhenAsked) {
  Options options;
  options.method = Method::kPaper;
  const Scene scene = Scene::FromString(TwoLinksXml(1.4));
  const Result result = Solver(scene, options).Solve({0.0, 0.0});
  EXPECT_EQ(result.status, Status::kSolved);
  EXPECT_EQ(result.start, "successive_perturbation");
  EXPECT_NEAR(result.sigma, TwoLinksOptimum(1.4), 1e-3);
  EXPECT_TRUE(Verify(scene, result.q, options).free);
}

TEST_F(PaperMethodTest, OnATrajectoryLaterFramesStartFromEarlierAnswers) {
  Options options;
  options.method = Method::kPaper;
  const Scene scene = Scene::FromString(TwoLinksXml(1.4));
  for (const bool trajectory : {false, true}) {
    options.trajectory = trajectory;
    Solver solver(scene, options);
    EXPECT_EQ(solver.Solve({0.0, 0.0}).start, "successive_perturbation");
    const Result second = solver.Solve({0.02, 0.01});
    EXPECT_EQ(second.status, Status::kSolved);
    EXPECT_EQ(second.start, trajectory ? "motion_coherence" : "successive_perturbation");
  }
}

TEST_F(PaperMethodTest, WhatNoSelectionSolvesIsReportedUnsolved) {
  Options options;
  options.method = Method::kPaper;
  const Scene scene = Scene::FromString(InWorld(
      "<geom type='box' size='3 3 3'/><body><joint axis='0 0 1'/><geom size='.1'/></body>"));
  EXPECT_EQ(Solver(scene, options).Solve({0.0}).status, Status::kUnsolved);
}

}  // namespace
}  // namespace mjcf_pdg::test
