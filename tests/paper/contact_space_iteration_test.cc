#include "paper/contact_space_iteration.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

using Eigen::Vector2d;

class ContactSpaceIterationTest : public MujocoTest {};

struct Iterator {
  explicit Iterator(const std::string& xml)
      : scene(Scene::FromString(xml)), work(scene.tables(), options), iteration(work) {}

  IterationResult Run(const VectorXd& q_f, const VectorXd& q_in, const IterationOptions& how = {}) {
    work.Begin(q_in);
    return iteration.Run(q_f, how);
  }
  // Smallest distance of a pair that can move, by MuJoCo's own function, at most 1 m.
  double Nearest(const VectorXd& q) const {
    const mjModel* m = scene.model();
    const DataPtr d(mj_makeData(m));
    mju_copy(d->qpos, q.data(), m->nq);
    mj_kinematics(m, d.get());
    double least = 1.0;
    for (const KeptPair& pair : scene.tables().pairs) {
      if (!pair.moves) continue;
      least = std::min(least, mj_geomDistance(m, d.get(), pair.geom1, pair.geom2, 1.0, nullptr));
    }
    return least;
  }

  Scene scene;
  Options options;
  Workspace work;
  ContactSpaceIteration iteration;
};

std::string World(const std::string& inside) {
  return "<mujoco><worldbody>" + inside + "</worldbody></mujoco>";
}

// ---- Two links over the ground: Fig. 12 and 13, Eq. 32 ----

// Two thin links of length 1 and mass 1 hang from a height; their tips have this radius.
constexpr double kTip = 1e-3;
std::string TwoLinks(double height) {
  const std::string link = R"(<joint axis="0 1 0"/><inertial mass="1" pos="0 0 -.5"
      diaginertia=".083333333333333333 .083333333333333333 1e-6"/><geom type="sphere" size=")" +
                           std::to_string(kTip) + R"(" pos="0 0 -1"/>)";
  const double ground = -height - kTip;
  return World("<geom type='plane' size='0 0 1' pos='0 0 " + Join(&ground, 1) + "'/><body>" + link +
               "<body pos='0 0 -1'>" + link + "</body></body>");
}

double Eq32(double theta1, double theta2) {
  const double s1 = std::sin(0.5 * theta1), s2 = std::sin(0.5 * theta2);
  return 0.5 * (4 * s1 * s1 * 8.0 / 3.0 + 4 * s2 * s2 / 3.0);
}

// Fine search along cos θ1 + cos(θ1 + θ2) = d, both links above the ground.
double AnalyticOptimum(double d) {
  double best = 1e300;
  constexpr int kSteps = 200000;
  for (int k = 0; k <= kSteps; ++k) {
    const double theta1 = 0.5 * M_PI * k / kSteps, c2 = d - std::cos(theta1);
    if (std::abs(c2) > 1.0 || std::cos(theta1) > d) continue;
    for (const double sign : {1.0, -1.0}) {
      best = std::min(best, Eq32(theta1, sign * std::acos(c2) - theta1));
    }
  }
  return best;
}

TEST_F(ContactSpaceIterationTest, TheNormOfTwoLinksIsTheOneOfThePaper) {
  Iterator p(TwoLinks(1.5));
  p.work.norm.SetReference(Vector2d(0, 0));
  for (const Vector2d& q : {Vector2d(0.3, -0.7), Vector2d(1.0, 0.4), Vector2d(-0.5, 2.0)}) {
    EXPECT_NEAR(p.work.norm.Sigma(q), Eq32(q[0], q[1]), 1e-9);
  }
}

TEST_F(ContactSpaceIterationTest, TwoLinksOverTheGroundComeNearTheAnalyticOptimum) {
  for (const double d : {1.1, 1.2, 1.4, 1.6, 1.8, 1.9}) {
    Iterator p(TwoLinks(d));
    const IterationResult result = p.Run(Vector2d(1.2, -0.1), Vector2d(0, 0));
    ASSERT_TRUE(result.start_free);
    const double optimum = AnalyticOptimum(d);
    EXPECT_GE(result.sigma, optimum - 1e-5) << d;
    EXPECT_LE(result.sigma, 1.01 * optimum) << d;
    EXPECT_GE(p.Nearest(result.q), -p.work.problem().tolerances.user);
    EXPECT_LE(p.Nearest(result.q), 2e-5) << "on the contact space (Theorem 1)";
    std::printf("  d = %.1f l: %.6f, optimum %.6f, %zu accepted\n", d, result.sigma, optimum,
                result.sigmas.size());
  }
}

// ---- Cases with a known answer ----

TEST_F(ContactSpaceIterationTest, AFreeSphereComesStraightBackToThePlane) {
  Iterator p(World(R"(<geom type="plane" size="0 0 1"/>
      <body><freejoint/><geom size=".1"/></body>)"));
  VectorXd q_in(7), q_f(7);
  q_in << 0.2, 0.1, -0.05, 1, 0, 0, 0;
  q_f << 0.5, -0.3, 0.4, 1, 0, 0, 0;
  const IterationResult result = p.Run(q_f, q_in);
  ASSERT_TRUE(result.start_free);
  EXPECT_TRUE(result.certified);
  EXPECT_LT((result.q.head<3>() - Vector3d(0.2, 0.1, 0.1)).norm(), 1e-4);
  EXPECT_NEAR(std::sqrt(result.sigma), 0.15, 1e-4);
}

TEST_F(ContactSpaceIterationTest, OneHingeStopsAtTheAngleOfContact) {
  Iterator p(World(R"(<geom type="plane" size="0 0 1" pos="0 0 -.2"/>
      <body><joint axis="0 1 0"/><geom type="capsule" size=".02" fromto="0 0 0 .5 0 0"/></body>)"));
  const double touching = std::asin(0.18 / 0.5);
  const IterationResult result = p.Run(VectorXd::Constant(1, -0.5), VectorXd::Constant(1, 0.8));
  ASSERT_TRUE(result.start_free);
  EXPECT_NEAR(result.q[0], touching, 1e-4);
}

TEST_F(ContactSpaceIterationTest, AFreeGoalIsReachedAtOnce) {
  Iterator p(World(R"(<geom type="plane" size="0 0 1"/><body><joint type="slide"/>
      <geom size=".1"/></body>)"));
  const IterationResult result = p.Run(VectorXd::Constant(1, 0.9), VectorXd::Constant(1, 0.3));
  ASSERT_TRUE(result.start_free);
  EXPECT_NEAR(result.q[0], 0.3, 1e-12);
  EXPECT_LT(result.sigma, 1e-20);
  EXPECT_EQ(result.status, IterationStatus::kConverged);
}

TEST_F(ContactSpaceIterationTest, LimitsAreKept) {
  Iterator p(World(R"(<geom type="plane" size="0 0 1" zaxis="1 1 0"/>
      <body><joint type="slide" axis="1 0 0"/><geom size=".02" pos="1 1 1"/>
      <body><joint type="slide" axis="0 1 0" range="-1 .01"/><geom size=".1"/></body></body>)"));
  const IterationResult result = p.Run(Vector2d(0.8, 0.0), Vector2d(0, 0));
  ASSERT_TRUE(result.start_free);
  EXPECT_LE(result.q[1], 0.01 + 1e-9);
  EXPECT_NEAR(result.q[1], 0.01, 1e-4);
  EXPECT_NEAR(result.q[0], 0.1 * std::sqrt(2.0) - 0.01, 1e-3);
}

TEST_F(ContactSpaceIterationTest, AStartThatIsNotFreeIsSaidAndReturned) {
  Iterator p(World(R"(<geom type="plane" size="0 0 1"/><body><joint type="slide"/>
      <geom size=".1"/></body>)"));
  const VectorXd q_f = VectorXd::Constant(1, 0.05);
  const IterationResult result = p.Run(q_f, VectorXd::Constant(1, -0.1));
  EXPECT_FALSE(result.start_free);
  EXPECT_EQ(result.q, q_f);
  EXPECT_EQ(result.status, IterationStatus::kStartNotFree);
  EXPECT_TRUE(result.sigmas.empty());
  EXPECT_TRUE(std::isinf(result.sigma));
}

TEST_F(ContactSpaceIterationTest, NoIterationsLeaveTheProjection) {
  Iterator p(TwoLinks(1.5));
  IterationOptions none;
  none.max_iterations = 0;
  const IterationResult projected = p.Run(Vector2d(1.2, -0.1), Vector2d(0, 0), none);
  EXPECT_EQ(projected.sigmas.size(), 1u);
  EXPECT_EQ(projected.status, IterationStatus::kIterationLimit);
  EXPECT_EQ(projected.sweeps, 0);
  const IterationResult iterated = p.Run(Vector2d(1.2, -0.1), Vector2d(0, 0));
  EXPECT_EQ(iterated.sigmas.front(), projected.sigma);
  EXPECT_LT(iterated.sigma, 0.9 * projected.sigma);
}

TEST_F(ContactSpaceIterationTest, AnExpiredDeadlineIsSaid) {
  Iterator p(TwoLinks(1.5));
  p.work.budget.Begin({.queries = 0, .seconds = 1e-9}, {}, 0);
  const IterationResult result = p.Run(Vector2d(1.2, -0.1), Vector2d(0, 0));
  EXPECT_EQ(result.status, IterationStatus::kBudget);
  EXPECT_EQ(result.sigmas.size(), 1u);
}

// ---- What never happens ----

// What the status says about the accepted σ.
void CheckStatus(const IterationResult& result, const IterationOptions& options) {
  const std::size_t accepted = result.sigmas.size() - 1;  // after the projection
  const std::size_t iterations = result.iterations;
  switch (result.status) {
    case IterationStatus::kConverged:
      if (accepted < iterations) break;  // the last one changed nothing
      EXPECT_GE(result.sigma, (1 - options.convergence) * result.sigmas[accepted - 1]);
      break;
    case IterationStatus::kWouldRise:
    case IterationStatus::kRefusedByCcd:
      EXPECT_EQ(accepted + 1, iterations) << "the last one was refused";
      break;
    case IterationStatus::kIterationLimit:
      EXPECT_EQ(result.iterations, options.max_iterations);
      EXPECT_EQ(accepted, iterations);
      break;
    default:
      ADD_FAILURE() << "free, and no time limit";
  }
}

TEST_F(ContactSpaceIterationTest, OfRandomRobotsSigmaNeverRisesAndEveryResultIsFree) {
  Random rng(1);
  int runs = 0, improved = 0, touching = 0;
  std::map<IterationStatus, int> statuses;
  for (int model = 0; model < 12; ++model) {
    RobotOptions robot;
    robot.free_base = model % 2 == 1;
    robot.bodies = 3 + model % 5;
    Iterator p(RandomRobotXml(rng, robot));
    for (int k = 0; k < 60; ++k) {
      const VectorXd q_f = RandomConfiguration(p.scene, rng);
      const VectorXd q_in = RandomConfiguration(p.scene, rng);
      if (p.Nearest(q_f) < 0.0 || p.Nearest(q_in) > -0.01) continue;
      const IterationResult result = p.Run(q_f, q_in);
      if (!result.start_free) continue;  // a capsule in a box, which MuJoCo's distance misses
      ++runs;
      for (std::size_t i = 1; i < result.sigmas.size(); ++i) {
        EXPECT_LT(result.sigmas[i], result.sigmas[i - 1]) << Join(q_f) << "\n" << Join(q_in);
      }
      EXPECT_LE(result.sigmas.size(), 31u);
      CheckStatus(result, {});
      ++statuses[result.status];
      EXPECT_EQ(result.sigma, result.sigmas.back());
      EXPECT_EQ(result.sigma, p.work.norm.Sigma(result.q));
      EXPECT_LE(LimitExcess(p.scene.tables(), result.q), 1.1e-9);
      EXPECT_GE(p.Nearest(result.q), -1.5e-6) << Join(q_f) << "\n" << Join(q_in);
      touching += p.Nearest(result.q) < 1e-4;
      improved += result.sigma < 0.99 * result.sigmas.front();
    }
  }
  std::printf(
      "  %d runs, %d better than the projection, %d in contact; converged %d, would rise %d, "
      "refused %d, limit %d\n",
      runs, improved, touching, statuses[IterationStatus::kConverged],
      statuses[IterationStatus::kWouldRise], statuses[IterationStatus::kRefusedByCcd],
      statuses[IterationStatus::kIterationLimit]);
  EXPECT_GT(statuses[IterationStatus::kConverged], 10);
  EXPECT_GT(statuses[IterationStatus::kWouldRise], 10);
  EXPECT_GT(runs, 60);
  EXPECT_GT(improved, runs / 3);
  EXPECT_GT(touching, runs * 9 / 10);  // Theorem 1; capsule-box contacts are not seen here
}

TEST_F(ContactSpaceIterationTest, EarlierRunsLeaveNoTrace) {
  Iterator p(TwoLinks(1.4));
  const Vector2d a(1.2, -0.1), b(-1.3, 0.2), q_in(0, 0);
  const IterationResult first = p.Run(a, q_in), other = p.Run(b, Vector2d(0.1, 0.1)),
                        third = p.Run(a, q_in);
  EXPECT_EQ(first.q, third.q);
  EXPECT_EQ(first.sigmas, third.sigmas);
  EXPECT_EQ(first.sweeps, third.sweeps);
  EXPECT_NE(first.q, other.q);
}

}  // namespace
}  // namespace mjcf_pdg::test
