#include "optimize/local_optimization.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "tests/support/heap.h"
#include "tests/support/test_support.h"
#include "tests/support/witness.h"

namespace mjcf_pdg::test {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector2d;

class LocalOptimizationTest : public MujocoTest {};

constexpr double kTolerance = 1e-6;  // [m], the default

// One local optimization as a solve sets it up.
struct Local {
  explicit Local(const std::string& xml, const Options& user_options = {})
      : scene(Scene::FromString(xml)),
        options(user_options),
        work(scene.tables(), options),
        local(work) {}

  void Refer(const VectorXd& q_in) { work.Begin(q_in); }
  LocalResult Run(const VectorXd& q_in, const LocalOptions& how = {}) {
    Refer(q_in);
    return local.Run(work.problem().q_in, how);
  }

  Scene scene;
  Options options;
  Workspace work;
  LocalOptimization local;
};

// q_in moved by this share of the way to q.
VectorXd PartOfTheWay(const SceneTables& tables, const VectorXd& q_in, const VectorXd& q,
                      double share) {
  VectorXd dq, out;
  Difference(tables, q_in, q, dq);
  Integrate(tables, q_in, share * dq, out);
  return out;
}

std::string World(const std::string& inside) {
  return "<mujoco><worldbody>" + inside + "</worldbody></mujoco>";
}

VectorXd FreePose(const Vector3d& p, const Quaterniond& r = Quaterniond::Identity()) {
  VectorXd q(7);
  q << p, r.w(), r.x(), r.y(), r.z();
  return q;
}

// ---- Cases with a known answer ----

TEST_F(LocalOptimizationTest, ASphereLeavesAPlaneAlongTheNormal) {
  Random rng(1);
  for (int k = 0; k < 10; ++k) {
    const Vector3d n = rng.UnitVector(), inside = rng.InBox(0.5);
    Local p(World("<geom type='plane' size='0 0 1' zaxis='" + Join(n) +
                  "'/><body><freejoint/><geom size='.1'/></body>"));
    const double depth = rng.Uniform(0.001, 0.3);
    const Vector3d on_plane = inside - n.dot(inside) * n;
    const Vector3d start = on_plane + (0.1 - depth) * n;
    const LocalResult result = p.Run(FreePose(start, rng.UnitQuat()));
    ASSERT_TRUE(result.free);
    EXPECT_LT((result.q.head<3>() - (on_plane + 0.1 * n)).norm(), 2e-6);
    EXPECT_NEAR(std::sqrt(result.sigma), depth, 2 * kTolerance);
    EXPECT_LE(result.iterations, 5);
  }
}

TEST_F(LocalOptimizationTest, ASphereNearABoxCornerLeavesAlongTheDiagonal) {
  Local p(World(R"(<geom type="box" size=".2 .2 .2"/><body><freejoint/><geom size=".1"/></body>)"));
  const Vector3d corner = Vector3d::Constant(0.2), out = Vector3d(1, 2, 1.5).normalized();
  for (const double gap : {0.09, 0.05, 0.01}) {
    const LocalResult result = p.Run(FreePose(corner + gap * out));
    ASSERT_TRUE(result.free);
    EXPECT_LT((result.q.head<3>() - (corner + 0.1 * out)).norm(), 1e-5) << gap;
    EXPECT_NEAR(std::sqrt(result.sigma), 0.1 - gap, 2 * kTolerance);
  }
}

TEST_F(LocalOptimizationTest, ASphereInAnInnerCornerLeavesAllThreeWalls) {
  Local p(World(R"(<geom type="plane" size="0 0 1"/><geom type="plane" size="0 0 1" zaxis="1 0 0"/>
      <geom type="plane" size="0 0 1" zaxis="0 1 0"/><body><freejoint/><geom size=".1"/></body>)"));
  const Vector3d start(0.03, 0.07, -0.04);
  const LocalResult result = p.Run(FreePose(start));
  ASSERT_TRUE(result.free);
  EXPECT_LT((result.q.head<3>() - Vector3d::Constant(0.1)).norm(), 3e-6);
}

TEST_F(LocalOptimizationTest, OneHingeLeavesAWallByTheKnownAngle) {
  // A capsule of radius .02 from the hinge to .5 m, a wall .2 m below the hinge: the end touches at
  // sin θ = .18 / .5. Of (4/M) sin²(Δ/2) ωᵀIω, I and M are given.
  Local p(World(R"(<geom type="plane" size="0 0 1" pos="0 0 -.2"/>
      <body><joint axis="0 1 0"/><inertial mass="2" pos=".3 0 0" diaginertia=".01 .04 .04"/>
      <geom type="capsule" size=".02" fromto="0 0 0 .5 0 0"/></body>)"));
  const double touching = std::asin(0.18 / 0.5), inertia = 0.04 + 2 * 0.3 * 0.3;
  for (const double over : {0.001, 0.05, 0.3, 0.9}) {
    const LocalResult result = p.Run(VectorXd::Constant(1, touching + over));
    ASSERT_TRUE(result.free);
    EXPECT_NEAR(result.q[0], touching, 5e-6);
    const double sine = std::sin(0.5 * over);
    EXPECT_NEAR(result.sigma, 4.0 / 2 * sine * sine * inertia, 2e-6);
  }
}

TEST_F(LocalOptimizationTest, TwoSlidesShareTheWayByTheirMasses) {
  // Along x the whole chain moves (mass 4), along y only the outer body (mass 1), a wall at 45°.
  // Minimize 4 dx² + dy² with dx + dy = √2 depth: dx : dy = 1 : 4, σ = 2 depth² · (4/5) / 4.
  Local p(World(R"(<geom type="plane" size="0 0 1" zaxis="1 1 0"/>
      <body><joint type="slide" axis="1 0 0"/><inertial mass="3" pos="0 0 0" diaginertia="1 1 1"/>
      <body><joint type="slide" axis="0 1 0"/><inertial mass="1" pos="0 0 0" diaginertia="1 1 1"/>
      <geom size=".1"/></body></body>)"));
  for (const double depth : {0.01, 0.1}) {
    const VectorXd q_in = Vector2d::Constant((0.1 - depth) / std::sqrt(2.0));
    const LocalResult result = p.Run(q_in);
    ASSERT_TRUE(result.free);
    const double way = std::sqrt(2.0) * depth;
    EXPECT_NEAR(result.q[0] - q_in[0], 0.2 * way, 3e-6);
    EXPECT_NEAR(result.q[1] - q_in[1], 0.8 * way, 3e-6);
    EXPECT_NEAR(result.sigma, way * way * (4 * 0.04 + 0.64) / 4, 1e-6);
  }
}

TEST_F(LocalOptimizationTest, ALimitThatBlocksTheShortWayIsHeldAndTheOtherJointDoesIt) {
  Local p(World(R"(<geom type="plane" size="0 0 1" zaxis="1 1 0"/>
      <body><joint type="slide" axis="1 0 0"/><geom size=".02" pos="1 1 1"/>
      <body><joint type="slide" axis="0 1 0" range="-1 .01"/><geom size=".1"/></body></body>)"));
  const LocalResult result = p.Run(Vector2d(0.0, 0.0));
  ASSERT_TRUE(result.free);
  EXPECT_LE(LimitExcess(p.scene.tables(), result.q), 1e-9);
  EXPECT_NEAR(result.q[1], 0.01, 1e-6);
  EXPECT_NEAR(result.q[0], 0.1 * std::sqrt(2.0) - 0.01, 1e-5);
}

TEST_F(LocalOptimizationTest, ClearanceIsADistanceToKeep) {
  Options options;
  options.clearance = 0.05;
  Local p(World(R"(<geom type="plane" size="0 0 1"/><body><freejoint/><geom size=".1"/></body>)"),
          options);
  const LocalResult result = p.Run(FreePose(Vector3d(0, 0, 0.12)));
  ASSERT_TRUE(result.free);
  EXPECT_NEAR(result.q[2], 0.15, 2e-6);
}

TEST_F(LocalOptimizationTest, MorePairsThanRowsAreAllSeparated) {
  // 81 feet of different length in the floor; the body may tilt.
  Random rng(2);
  std::string feet;
  for (int i = 0; i < 81; ++i) {
    const Vector3d foot(0.05 * (i % 9), 0.05 * (i / 9), rng.Uniform(-0.01, 0.01));
    feet += "<geom size='.02' pos='" + Join(foot) + "'/>";
  }
  Local p(World("<geom type='plane' size='0 0 1'/><body><freejoint/>" + feet + "</body>"));
  ASSERT_EQ(p.scene.num_kept_pairs(), 81);
  const LocalResult result = p.Run(FreePose(Vector3d(0, 0, -0.05)));
  EXPECT_TRUE(result.free);
  EXPECT_GE(Witness(p.scene).LeastMoving(result.q), -1.1 * kTolerance);
}

// ---- How it ends ----

const std::string kBoxOnPlane = World(R"(<geom type="plane" size="0 0 1"/>
    <body><freejoint/><geom type="box" size=".1 .07 .05"/></body>)");

// Rounded light limbs of a heavy trunk turn far for next to no σ and roll over the floor as they
// do.
TEST_F(LocalOptimizationTest, LightRoundLimbsDoNotKeepTheDescentFromEnding) {
  std::string limbs;
  for (const char* at : {".2 .15 -.1", ".2 -.15 -.1", "-.2 .15 -.1", "-.2 -.15 -.1"}) {
    limbs += "<body pos='" + std::string(at) +
             "'><joint type='ball'/><geom type='ellipsoid' size='.04 .05 .15' pos='0 0 -.15' "
             "mass='1'/><body pos='0 0 -.32'><joint type='ball'/><geom type='ellipsoid' "
             "size='.12 .05 .03' pos='.06 0 -.02' mass='.1'/></body></body>";
  }
  Local local(
      World("<geom type='plane' size='5 5 .1'/><body pos='0 0 1'><freejoint/><geom "
            "type='ellipsoid' size='.25 .18 .1' mass='40'/>" +
            limbs + "</body>"));
  Random rng(5);
  std::vector<int> steps;
  int free = 0;
  for (int k = 0; k < 40; ++k) {
    VectorXd q = VectorXd::Zero(local.scene.nq());
    q[2] = 0.1 * rng.Uniform();
    for (int turn = 3; turn < q.size(); turn += 4) {
      const Quaterniond r = rng.UnitQuat();
      q.segment<4>(turn) << r.w(), r.x(), r.y(), r.z();
    }
    const LocalResult result = local.Run(q);
    free += result.free;
    steps.push_back(result.iterations);
  }
  std::sort(steps.begin(), steps.end());
  EXPECT_EQ(free, 40);
  EXPECT_LT(steps[20], 35);  // 26; with a radius that only shrinks and steps judged by μ, 43
  EXPECT_LT(steps[30], 50);
}

// Of a heap's many curved contacts some overlap by a little after each step that lowers σ.
TEST_F(LocalOptimizationTest, DescentsOfHeapsSoonPartTheirCurvedContacts) {
  Random rng(5);
  int steps = 0;
  constexpr int kHeaps = 6;
  for (int k = 0; k < kHeaps; ++k) {
    const Heap heap(40, rng);
    Local local(heap.xml);
    const LocalResult result = local.Run(ToEigen(heap.q));
    EXPECT_TRUE(result.free);
    steps += result.iterations;
  }
  EXPECT_LT(steps, 35 * kHeaps);
}

TEST_F(LocalOptimizationTest, AFreeStartThatIsTheReferenceStaysWhereItIs) {
  Local p(kBoxOnPlane);
  const VectorXd q = FreePose(Vector3d(0, 0, 0.06));
  const LocalResult result = p.Run(q);
  EXPECT_TRUE(result.free);
  EXPECT_LT(result.sigma, 1e-20);
  EXPECT_LT((result.q - q).norm(), 1e-12);
}

TEST_F(LocalOptimizationTest, AFreeStartFarAwayComesBackToTheContact) {
  Local p(kBoxOnPlane);
  p.Refer(FreePose(Vector3d(0, 0, 0.03)));
  LocalOptions options;
  options.convergence = 1e-6;
  const LocalResult result = p.local.Run(FreePose(Vector3d(0.3, -0.2, 0.5)), options);
  ASSERT_TRUE(result.free);
  EXPECT_NEAR(std::sqrt(result.sigma), 0.02, 1e-4);
}

TEST_F(LocalOptimizationTest, IterationsAreBoundedAndTheBestSoFarIsReturned) {
  Random rng(3);
  Local p(RandomRobotXml(rng));
  Witness oracle(p.scene);
  VectorXd q_in = RandomConfiguration(p.scene, rng);
  while (oracle.LeastMoving(q_in) > -0.03) q_in = RandomConfiguration(p.scene, rng);
  double least = 1e300;
  for (int most : {0, 1, 2, 5, 20}) {
    LocalOptions options;
    options.max_iterations = most;
    const LocalResult result = p.Run(q_in, options);
    EXPECT_LE(result.iterations, most);
    EXPECT_EQ(result.q.size(), q_in.size());
    EXPECT_TRUE(result.free || result.violation > 0.0);
    EXPECT_NEAR(result.sigma, p.work.norm.Sigma(result.q), 1e-12);
    EXPECT_LE(result.violation, least);
    least = std::min(least, result.violation);
  }
}

TEST_F(LocalOptimizationTest, ConflictingContactsEndNotFreeInBetween) {
  Local p(World(R"(<geom type="box" size=".1 1 1" pos="-.19 0 0"/>
      <geom type="box" size=".1 1 1" pos=".19 0 0"/>
      <body><joint type="slide" axis="1 0 0"/><geom size=".1"/></body>)"));
  const LocalResult result = p.Run(VectorXd::Constant(1, 0.008));
  EXPECT_FALSE(result.free);
  EXPECT_NEAR(result.violation, 0.02, 1e-5);  // 1 cm on either side, or 2 cm on one
  EXPECT_LT(result.iterations, 60);
}

TEST_F(LocalOptimizationTest, AKnownOptimumEndsTheRun) {
  Local p(kBoxOnPlane);
  const VectorXd q_in = FreePose(Vector3d(0, 0, 0.01), Quaterniond(0.9, 0.3, 0.1, 0.2));
  const LocalResult first = p.Run(q_in);
  ASSERT_TRUE(first.free);
  EXPECT_FALSE(first.reached_known);
  LocalOptions options;
  options.known = &first.q;
  options.known_sigma = first.sigma;
  const LocalResult second = p.Run(q_in, options);
  EXPECT_TRUE(second.reached_known);
  EXPECT_LE(second.iterations, first.iterations);
}

TEST_F(LocalOptimizationTest, AStepThatOnlyLeadsToTheKnownOptimumIsNotLookedAt) {
  Local p(kBoxOnPlane);
  const LocalResult first = p.Run(FreePose(Vector3d(0, 0, 0.01)));
  ASSERT_TRUE(first.free);
  LocalOptions options;
  options.known = &first.q;
  options.known_sigma = 0.99 * first.sigma;
  const std::int64_t before = p.work.finder.queries();
  const LocalResult second = p.local.Run(first.q, options);
  EXPECT_TRUE(second.reached_known);
  // The start and its first step are looked at, the second step is not: else it is 2 and 3.
  EXPECT_EQ(second.iterations, 1);
  EXPECT_EQ(p.work.finder.queries() - before, 2);
}

TEST_F(LocalOptimizationTest, AHopelessPredictionEndsTheRun) {
  Random rng(4);
  Local p(kBoxOnPlane);
  p.Refer(FreePose(Vector3d(0, 0, 0.01)));
  const VectorXd far = FreePose(Vector3d(2, 0, 0.5), rng.UnitQuat());
  LocalOptions options;
  options.convergence = 1e-6;
  const int patient = p.local.Run(far, options).iterations;
  options.give_up_sigma = 1e-9;
  EXPECT_LT(p.local.Run(far, options).iterations, patient);
}

// Steps from far lower σ by a like share each, which looking ahead takes into account: it leaves
// more descents alone that do get below the σ asked for, and still ends those soon that do not.
TEST_F(LocalOptimizationTest, LookingAheadSparesDescentsThatArrive) {
  Random rng(9);
  int arrive = 0, spared[2] = {}, steps[2] = {}, patient = 0;
  for (int model = 0; model < 12; ++model) {
    Local p(RandomRobotXml(rng, {.bodies = 4 + model % 4}));
    for (int k = 0; k < 25; ++k) {
      p.Refer(RandomConfiguration(p.scene, rng, 0.3));
      const VectorXd start = RandomConfiguration(p.scene, rng);
      const LocalResult whole = p.local.Run(start, {});
      if (!whole.free || whole.iterations < 4) continue;
      ++arrive;
      patient += whole.iterations;
      for (const bool looks_ahead : {false, true}) {
        LocalOptions options;
        options.looks_ahead = looks_ahead;
        options.give_up_sigma = 1.01 * whole.sigma;
        const LocalResult asked = p.local.Run(start, options);
        spared[looks_ahead] += asked.free && asked.sigma <= options.give_up_sigma;
        options.give_up_sigma = 0.5 * whole.sigma;
        steps[looks_ahead] += p.local.Run(start, options).iterations;
      }
    }
  }
  EXPECT_GT(arrive, 100);
  EXPECT_GT(spared[true], spared[false] + arrive / 10);
  EXPECT_LT(steps[true], patient / 2);
  EXPECT_LE(steps[false], steps[true]);
  std::printf("  of %d that arrive %d are spared, %d without; %d steps, %d, %d\n", arrive,
              spared[true], spared[false], patient, steps[true], steps[false]);
}

TEST_F(LocalOptimizationTest, EarlierRunsLeaveNoTrace) {
  Random rng(5);
  Local p(RandomRobotXml(rng));
  for (int k = 0; k < 15; ++k) {
    const VectorXd a = RandomConfiguration(p.scene, rng), b = RandomConfiguration(p.scene, rng);
    const LocalResult first = p.Run(a), second = p.Run(a), other = p.Run(b), third = p.Run(a);
    EXPECT_EQ(first.q, second.q);
    EXPECT_EQ(first.q, third.q);
    EXPECT_EQ(first.sigma, third.sigma);
    EXPECT_EQ(first.iterations, third.iterations);
    EXPECT_NE(first.q, other.q);
  }
}

// ---- By definition ----

TEST_F(LocalOptimizationTest, OfRandomRobotsFreeAnswersAreFreeAndAnyLessCollides) {
  Random rng(6);
  int runs = 0, free = 0, collide = 0;
  for (int model = 0; model < 16; ++model) {
    RobotOptions robot;
    robot.bodies = 3 + model % 6;
    robot.free_base = model % 2 == 1;
    Local p(RandomRobotXml(rng, robot));
    const SceneTables& tables = p.scene.tables();
    Witness oracle(p.scene);
    for (int i = 0; i < 20; ++i) {
      const VectorXd q_in = RandomConfiguration(p.scene, rng, 0.3);
      if (oracle.LeastMoving(q_in) > -0.005) continue;
      const LocalResult result = p.Run(q_in);
      ++runs;
      if (!result.free) continue;
      ++free;
      EXPECT_GE(oracle.LeastMoving(result.q), -1.5 * kTolerance) << Join(q_in);
      EXPECT_LE(LimitExcess(tables, result.q), 1e-9);
      EXPECT_NEAR(result.sigma, p.work.norm.Sigma(result.q), 1e-12);
      EXPECT_LE(result.iterations, LocalOptions{}.max_iterations);
      collide += oracle.LeastMoving(PartOfTheWay(tables, p.work.problem().q_in, result.q, 0.98)) <
                 -kTolerance;
    }
  }
  std::printf("  %d runs, %d free, %d collide again when shrunk\n", runs, free, collide);
  EXPECT_GT(runs, 100);
  EXPECT_GT(free, runs * 4 / 5);
  EXPECT_GE(collide, free * 97 / 100);
}

}  // namespace
}  // namespace mjcf_pdg::test
