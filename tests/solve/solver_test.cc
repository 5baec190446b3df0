#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <thread>

#include "mjcf_pdg/pdg.h"
#include "model/kinematics.h"
#include "tests/support/test_support.h"
#include "tests/support/witness.h"

namespace mjcf_pdg::test {
namespace {

using ::testing::AnyOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;

class SolverTest : public MujocoTest {};

using Q = std::vector<double>;

Q PartOfTheWay(const Scene& scene, const Q& q_in, const Q& q, double share) {
  VectorXd dq, out;
  const VectorXd from = Normalized(scene.tables(), ToEigen(q_in));
  Difference(scene.tables(), from, ToEigen(q), dq);
  Integrate(scene.tables(), from, share * dq, out);
  return ToVector(out);
}

// Everything a solved result must keep to, by other means than the solver's.
void ExpectSolved(const Scene& scene, const Q& q_in, const Result& result) {
  ASSERT_EQ(result.status, Status::kSolved) << result.reason << "\n" << Join(ToEigen(q_in));
  EXPECT_GE(Witness(scene).Least(result.q), -1.1e-6) << Join(ToEigen(q_in));
  EXPECT_LE(LimitExcess(scene.tables(), ToEigen(result.q)), 1e-9);
  EXPECT_TRUE(Verify(scene, result.q).free);
  EXPECT_NEAR(ObjectNorm(scene, Metric::kSequential, q_in).Sigma(result.q), result.sigma,
              1e-12 + 1e-9 * result.sigma);
  EXPECT_LE(result.sigma_lower_bound, result.sigma);
  EXPECT_TRUE(result.reason.empty()) << result.reason;
}

// Random configurations that overlap by a centimetre or more.
std::vector<Q> CollidingRows(const Scene& scene, Random& rng, int n) {
  std::vector<Q> rows;
  Witness witness(scene);
  while (static_cast<int>(rows.size()) < n) {
    rows.push_back(ToVector(RandomConfiguration(scene, rng, 0.2)));
    if (witness.Least(rows.back()) > -0.01) rows.pop_back();
  }
  return rows;
}

std::string World(const std::string& inside) {
  return "<mujoco><worldbody>" + inside + "</worldbody></mujoco>";
}

const std::string kSphereOnPlane = World(R"(<geom name="floor" type="plane" size="0 0 1"/>
    <body name="ball"><freejoint/><geom name="ball" size=".1"/></body>)");

// A bead on a rail along x between two walls `gap` apart: it fits if gap >= .2.
std::string BeadBetweenWalls(double gap) {
  const double x = 0.5 * gap + 0.05;
  return World("<geom name='left' type='box' size='.05 1 1' pos='" + std::to_string(-x) +
               " 0 0'/><geom name='right' type='box' size='.05 1 1' pos='" + std::to_string(x) +
               R"( 0 0'/><body name="bead"><joint name="rail" type="slide" axis="1 0 0"
               range="-.1 .1"/><geom name="bead" size=".1"/></body>)");
}

// ---- Answers ----

TEST_F(SolverTest, AFreeConfigurationComesBackBitForBit) {
  const Scene scene = Scene::FromString(kSphereOnPlane);
  Options options;
  options.report_contacts = true;
  Solver solver(scene, options);
  for (const Q& q_in : {Q{0, 0, 0.1, 1, 0, 0, 0}, Q{-0.0, 1e-17, 0.3, 0.1, 0.2, -0.7, 3}}) {
    const Result result = solver.Solve(q_in);
    EXPECT_EQ(result.status, Status::kAlreadyFree);
    EXPECT_EQ(result.q, q_in);
    EXPECT_TRUE(std::signbit(result.q[0]) == std::signbit(q_in[0]));
    EXPECT_EQ(result.sigma, 0.0);
    EXPECT_EQ(result.sigma_lower_bound, 0.0);
    EXPECT_EQ(result.contacts_in.size(), q_in[2] == 0.1 ? 1u : 0u);
    EXPECT_EQ(result.stats.collision_queries, 1) << "the verifier's";
  }
}

TEST_F(SolverTest, AKnownDepthIsReportedInAllItsParts) {
  const Scene scene = Scene::FromString(kSphereOnPlane);
  const Q q_in = {0.3, -0.2, 0.06, 1, 0, 0, 0};
  Options options;
  options.report_contacts = true;
  const Result result = Solver(scene, options).Solve(q_in);
  ExpectSolved(scene, q_in, result);
  EXPECT_NEAR(std::sqrt(result.sigma), 0.04, 2e-6);
  EXPECT_NEAR(result.depth_in, -0.04, 1e-9);
  EXPECT_NEAR(result.min_distance, 0.0, 1e-6);
  EXPECT_GT(result.sigma_lower_bound, 0.2 * result.sigma);
  EXPECT_TRUE(result.certified);
  EXPECT_EQ(result.start, "direct");
  ASSERT_EQ(result.contacts_in.size(), 1u);
  ASSERT_EQ(result.contacts.size(), 1u);
  EXPECT_EQ(scene.GeomName(result.contacts_in[0].geom[0]), "floor");
  EXPECT_NEAR(result.contacts_in[0].normal_W[2], 1.0, 1e-9);
  EXPECT_NEAR(result.contacts_in[0].distance, -0.04, 1e-9);
  EXPECT_GT(result.stats.iterations, 0);
  EXPECT_GT(result.stats.collision_queries, result.stats.iterations);
  EXPECT_EQ(result.stats.starts, 3);  // that agree
}

TEST_F(SolverTest, OfRandomRobotsEveryAnswerIsFreeAndALittleLessCollides) {
  Random rng(1);
  int runs = 0, solved = 0, moved = 0, collide = 0;
  for (int model = 0; model < 12; ++model) {
    RobotOptions robot;
    robot.bodies = 3 + model % 6;
    robot.free_base = model % 2 == 1;
    const Scene scene = Scene::FromString(RandomRobotXml(rng, robot));
    Solver solver(scene);
    Witness witness(scene);
    for (int k = 0; k < 12; ++k) {
      const Q q_in = ToVector(RandomConfiguration(scene, rng, 0.3));
      const Result result = solver.Solve(q_in);
      if (result.status == Status::kAlreadyFree) continue;
      ++runs;
      EXPECT_LT(witness.Least(q_in), 0.0);
      if (result.status == Status::kUnsolved) {
        EXPECT_LT(witness.Least(result.q), 0.0) << Join(ToEigen(q_in));
        continue;
      }
      ++solved;
      ExpectSolved(scene, q_in, result);
      if (result.sigma < 1e-6) continue;
      ++moved;
      collide += witness.Least(PartOfTheWay(scene, q_in, result.q, 0.98)) < -1e-6;
    }
  }
  std::printf("  %d runs, %d solved, %d of %d collide again when shrunk\n", runs, solved, collide,
              moved);
  EXPECT_GT(runs, 60);
  EXPECT_GE(solved, runs * 95 / 100);
  EXPECT_GE(collide, moved * 97 / 100);
}

TEST_F(SolverTest, LimitsExceededAtTheStartAreMovedInside) {
  const Scene chain = Scene::FromString(BallChainXml(true));  // 60° each
  Q q_in = chain.DefaultQpos();
  const double half = 0.5 * 100 * M_PI / 180;
  q_in[4] = std::cos(half);
  q_in[6] = std::sin(half);
  const Result ball = Solver(chain).Solve(q_in);
  ExpectSolved(chain, q_in, ball);
  EXPECT_GT(ball.sigma, 1e-3);
  EXPECT_GT(2 * std::acos(std::abs(ball.q[4])), 0.9);  // no further than needed

  const Scene bead = Scene::FromString(BeadBetweenWalls(2.0));
  const Result slide = Solver(bead).Solve({0.25});
  ExpectSolved(bead, {0.25}, slide);
  EXPECT_NEAR(slide.q[0], 0.1, 1e-9);
}

TEST_F(SolverTest, RoundingBeyondALimitIsStillFree) {
  const Scene bead = Scene::FromString(BeadBetweenWalls(2.0));
  EXPECT_EQ(Solver(bead).Solve({0.1 + 0.9e-6}).status, Status::kAlreadyFree);
  EXPECT_EQ(Solver(bead).Solve({0.1 + 1.1e-6}).status, Status::kSolved);
}

TEST_F(SolverTest, EveryEffortSolvesAndMaxIsNoWorseThanFast) {
  Random rng(2);
  RobotOptions robot;
  robot.free_base = true;
  const Scene scene = Scene::FromString(RandomRobotXml(rng, robot));
  for (const Q& q_in : CollidingRows(scene, rng, 8)) {
    double sigma[3];
    for (const Effort effort : {Effort::kFast, Effort::kDefault, Effort::kMax}) {
      Options options;
      options.effort = effort;
      const Result result = Solver(scene, options).Solve(q_in);
      EXPECT_NE(result.status, Status::kUnsolved) << result.reason;
      sigma[static_cast<int>(effort)] = result.sigma;
    }
    EXPECT_LE(sigma[1], 1.02 * sigma[0] + 1e-9);
    EXPECT_LE(sigma[2], 1.02 * sigma[0] + 1e-9);
  }
}

TEST_F(SolverTest, AFreeHintIsAStartAndABadOneDoesNoHarm) {
  const Scene scene = Scene::FromString(kSphereOnPlane);
  const Q q_in = {0, 0, -0.3, 1, 0, 0, 0};
  const Q hints[] = {{0.1, 0, 0.4, 1, 0, 0, 0}, {0, 0, -9, 1, 0, 0, 0}, {0, 0, 5, 0, 1, 1, 0}};
  for (const Q& hint : hints) {
    const Result result = Solver(scene).Solve(q_in, hint);
    ExpectSolved(scene, q_in, result);
    EXPECT_NEAR(std::sqrt(result.sigma), 0.4, 1e-4);
    EXPECT_GE(result.stats.starts, 2);
  }
  const Scene bead = Scene::FromString(BeadBetweenWalls(2.0));  // a free hint beyond a limit
  ExpectSolved(bead, {0.3}, Solver(bead).Solve({0.3}, Q{0.2}));
}

// ---- Honesty ----

TEST_F(SolverTest, WhatCannotBeFreedIsUnsolvedLeastPenetratingAndSaysWhy) {
  const Scene scene = Scene::FromString(BeadBetweenWalls(0.18));
  Options options;
  options.report_contacts = true;
  const Result result = Solver(scene, options).Solve({0.06});
  EXPECT_EQ(result.status, Status::kUnsolved);
  EXPECT_EQ(result.cause, Cause::kNotFound);
  EXPECT_THAT(result.reason, HasSubstr("bead"));
  EXPECT_THAT(result.reason, AnyOf(HasSubstr("left"), HasSubstr("right")));
  ASSERT_EQ(result.q.size(), 1u);
  EXPECT_LE(std::abs(result.q[0]), 0.011);  // between the two contacts: 2 cm in all
  EXPECT_NEAR(result.min_distance, Witness(scene).Least(result.q), 1e-6);
  EXPECT_FALSE(result.contacts.empty());
  EXPECT_THAT(result.reason, Not(HasSubstr("exclude"))) << "each wall alone could be left";
}

// An arm that grows out of a static base, which MuJoCo's parent filter does not excuse, in a post
// that it can be turned out of.
TEST_F(SolverTest, LinksThatOverlapEverywhereAreNamedWithTheExcludeThatHelps) {
  const std::string arm = R"(<geom type="capsule" size=".05" fromto=".3 0 -.2 .3 0 .2"/>
      <body name="base"><geom type="box" size=".1 .1 .1"/><body name="arm"><joint axis="0 0 1"/>
      <geom type="capsule" size=".02" fromto="0 0 0 .4 0 0"/></body></body>)";
  const std::string exclude = "<exclude body1='base' body2='arm'/>";
  const Result result = Solver(Scene::FromString(World(arm))).Solve({0.05});
  EXPECT_EQ(result.status, Status::kUnsolved);
  EXPECT_THAT(result.reason, EndsWith("in each of 100 random configurations, too: " + exclude));
  const std::string helped =
      "<mujoco><worldbody>" + arm + "</worldbody><contact>" + exclude + "</contact></mujoco>";
  EXPECT_EQ(Solver(Scene::FromString(helped)).Solve({0.05}).status, Status::kSolved);

  std::string unnamed = arm;
  unnamed.erase(unnamed.find(" name=\"arm\""), 11);
  EXPECT_THAT(Solver(Scene::FromString(World(unnamed))).Solve({0.05}).reason,
              EndsWith("too: bodies 'base' and #2"));
}

TEST_F(SolverTest, OverlapsThatNoJointCanSeparateAreNamed) {
  const Scene scene = Scene::FromString(World(R"(<geom name="floor" type="plane" size="0 0 1"/>
      <body name="post" pos="0 0 -.05"><joint name="turn" axis="0 0 1"/>
      <geom name="post" size=".1"/><body name="arm" pos="0 0 .5"><joint axis="0 1 0"/>
      <geom name="arm" type="capsule" size=".02" fromto="0 0 0 .3 0 0"/></body></body>)"));
  SceneOptions only_arm;
  only_arm.movable = {"arm"};
  const Scene frozen = Scene::FromString(World(R"(<geom name="floor" type="plane" size="0 0 1"/>
      <body name="post" pos="0 0 -.05"><joint axis="1 0 0"/><geom name="post" size=".1"/></body>
      <body name="arm" pos="1 0 .2"><joint axis="0 1 0" range="-90 115"/>
      <geom type="capsule" size=".02" fromto="0 0 0 .3 0 0"/></body>)"),
                                         only_arm);
  const Result result = Solver(frozen).Solve({0.2, 0.0});
  EXPECT_EQ(result.status, Status::kUnsolved);
  EXPECT_THAT(result.reason, HasSubstr("post"));
  EXPECT_THAT(result.reason, HasSubstr("floor"));
  EXPECT_EQ(result.q, (Q{0.2, 0.0}));
  EXPECT_EQ(result.stats.starts, 0) << "nothing to search for";
  EXPECT_EQ(result.start, "none");
  EXPECT_THAT(result.reason, Not(HasSubstr("exclude"))) << "the post's joint was not tried";
  EXPECT_NEAR(Solver(frozen).Solve({0.2, -2.0}).q[1], -M_PI_2, 1e-12) << "limits hold anyway";
  const Result dipped = Solver(frozen).Solve({0.2, 1.8});  // the arm hangs in the floor, too
  EXPECT_EQ(dipped.status, Status::kUnsolved);
  EXPECT_EQ(dipped.q[0], 0.2);
  EXPECT_NEAR(dipped.min_distance, result.min_distance, 1e-6) << "but the arm came out of it";
  const Result turned = Solver(scene).Solve({0.0, 0.0});  // it may turn, which does not help
  EXPECT_EQ(turned.status, Status::kUnsolved);
  EXPECT_THAT(turned.reason, HasSubstr("post"));
}

TEST_F(SolverTest, WhatNothingMovesMayOverlapByTheTolerance) {
  SceneOptions only_ball;
  only_ball.movable = {"ball"};
  for (const double overlap : {0.95e-6, 1.5e-6}) {
    const double z = 0.2 - overlap;
    const Scene scene = Scene::FromString(
        World("<geom type='box' size='.1 .1 .1' pos='2 0 0'/>"
              "<body><freejoint/><geom type='box' size='.1 .1 .1'/></body>"
              "<body name='ball' pos='2 0 .13'><freejoint/><geom size='.05'/></body>"
              "<body><freejoint/><geom type='box' size='.1 .1 .1'/></body>"),
        only_ball);
    Q q_in = scene.DefaultQpos();
    q_in[14 + 2] = z;
    const Result result = Solver(scene).Solve(q_in);
    const bool accepted = overlap < Options().tolerance;
    EXPECT_EQ(result.status, accepted ? Status::kSolved : Status::kUnsolved) << result.reason;
    EXPECT_NEAR(result.q[7 + 2], 0.15, 2e-6);
  }
}

TEST_F(SolverTest, ATinyTimeLimitEndsTheSolveWithoutAFalseClaim) {
  Random rng(3);
  const Scene scene = Scene::FromString(RandomRobotXml(rng));
  Options hurried;
  hurried.time_limit = 1e-9;
  int unsolved = 0;
  for (int k = 0; k < 40; ++k) {
    const Q q_in = ToVector(RandomConfiguration(scene, rng));
    const Result result = Solver(scene, hurried).Solve(q_in);
    EXPECT_EQ(result.q.size(), q_in.size());
    EXPECT_LE(result.stats.starts, 1);
    // q_in, one step of the first start and the check of the answer, however hard the problem.
    EXPECT_LE(result.stats.collision_queries, 7);
    if (result.status == Status::kSolved) ExpectSolved(scene, q_in, result);
    if (result.status != Status::kUnsolved) continue;
    ++unsolved;
    EXPECT_THAT(result.reason, HasSubstr("time limit"));
    EXPECT_LT(Witness(scene).Least(result.q), 0.0);
  }
  EXPECT_GT(unsolved, 5);
}

TEST_F(SolverTest, ATimeLimitThatNoClockCountsIsNone) {
  const Scene scene = Scene::FromString(kSphereOnPlane);
  for (const double limit : {1.0, 1e10, 1e300}) {
    Options options;
    options.time_limit = limit;
    EXPECT_EQ(Solver(scene, options).Solve({0, 0, 0.05, 1, 0, 0, 0}).status, Status::kSolved);
  }
}

TEST_F(SolverTest, BadInputThrowsAndTheSolverGoesOn) {
  const Scene scene = Scene::FromString(kSphereOnPlane);
  Solver solver(scene);
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = 1.0 / 0.0;
  const Q good = {0, 0, 0, 1, 0, 0, 0};
  const Q bad_ones[] = {{},
                        {0, 0, 0, 1, 0, 0},
                        {0, 0, 0, 1, 0, 0, 0, 0},
                        {nan, 0, 0, 1, 0, 0, 0},
                        {0, 0, -inf, 1, 0, 0, 0},
                        {0, 0, 0, 0, 0, 0, 0},
                        {0, 0, 0, nan, 0, 0, 1}};
  for (const Q& bad : bad_ones) {
    EXPECT_THROW(solver.Solve(bad), Error);
    EXPECT_THROW(solver.Solve(good, bad), Error);
  }
  EXPECT_EQ(solver.Solve(good).status, Status::kSolved);
  auto refused = [&scene](auto change) {
    Options options;
    change(options);
    EXPECT_THROW(Solver(scene, options), Error);
  };
  refused([](Options& o) { o.tolerance = 0.0; });
  refused([nan](Options& o) { o.tolerance = nan; });
  refused([](Options& o) { o.clearance = -0.1; });
  refused([nan](Options& o) { o.clearance = nan; });
  refused([inf](Options& o) { o.rest = inf; });
  refused([](Options& o) { o.time_limit = 0.0; });
  refused([nan](Options& o) { o.time_limit = nan; });
  refused([](Options& o) { o.mocap_pos = {0, 0, 0}; });  // the model has no mocap body
  Solver with_obstacle(
      Scene::FromString(World("<body mocap='true'><geom size='.1'/></body>"
                              "<body pos='1 0 0'><joint/><geom size='.1'/></body>")));
  EXPECT_THROW(with_obstacle.SetMocap({0, 0}, {}), Error);
  EXPECT_THROW(with_obstacle.SetMocap({0, 0, nan}, {}), Error);
  EXPECT_THROW(with_obstacle.SetMocap({}, {1, 0, 0, inf}), Error);
  EXPECT_THROW(with_obstacle.SetMocap({}, {0, 0, 0, 0}), Error);
}

// ---- The same again ----

TEST_F(SolverTest, ResultsDependOnNeitherEarlierRowsNorThreads) {
  Random rng(4);
  const Scene scene = Scene::FromString(RandomRobotXml(rng));
  const std::vector<Q> rows = CollidingRows(scene, rng, 8);
  std::vector<Q> alone, in_turn(rows.size()), threaded(rows.size());
  Solver solver(scene);
  for (const Q& row : rows) alone.push_back(Solver(scene).Solve(row).q);
  for (std::size_t k = rows.size(); k-- > 0;) in_turn[k] = solver.Solve(rows[k]).q;
  std::vector<std::thread> threads;
  for (std::size_t first : {0, 1}) {
    threads.emplace_back([&, first] {
      Solver own(scene);
      for (std::size_t k = first; k < rows.size(); k += 2) threaded[k] = own.Solve(rows[k]).q;
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(in_turn, alone);
  EXPECT_EQ(threaded, alone);
}

TEST_F(SolverTest, TheUsersModelIsNeverWrittenTo) {
  Random rng(5);
  RobotOptions robot;
  robot.free_base = true;
  const ModelPtr model = LoadModel(RandomRobotXml(rng, robot));
  model->opt.disableflags |= mjDSBL_CONTACT;  // and what it disables is none of our business
  const std::vector<char> before = ModelBytes(model.get());
  const Scene scene = Scene::FromModel(model.get());
  Solver solver(scene);
  int solved = 0;
  for (int k = 0; k < 20; ++k) {
    const Q q_in = ToVector(RandomConfiguration(scene, rng, 0.2));
    solved += solver.Solve(q_in).status == Status::kSolved;
  }
  EXPECT_GT(solved, 5);
  EXPECT_EQ(ModelBytes(model.get()), before);
}

}  // namespace
}  // namespace mjcf_pdg::test
