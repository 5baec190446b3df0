// SolveTrajectory: frames are followed at the cost of a tick, and smoothed clips are the minimum of
// what they are said to minimize.
#include "mjcf_pdg/trajectory.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "mjcf_pdg/pdg.h"
#include "mjcf_pdg/tracker.h"
#include "model/kinematics.h"
#include "norm/change.h"
#include "norm/norm_evaluator.h"
#include "tests/support/mesh_shapes.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

using ::testing::HasSubstr;
using Q = std::vector<double>;

// A ball that moves up and down over a floor.
constexpr char kOverFloor[] = R"(<mujoco><worldbody><geom type="plane" size="1 1 .1"/>
  <body><joint type="slide" axis="0 0 1"/><geom size=".1"/></body></worldbody></mujoco>)";

// A ball in the plane and a box of which its command passes a corner.
constexpr char kBox[] = R"(<mujoco><worldbody><geom type="box" size=".5 .5 .5"/>
  <body><joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/><geom size=".1"/></body>
  </worldbody></mujoco>)";

class TrajectoryTest : public MujocoTest {
 protected:
  static std::vector<Result> Solve(const Scene& scene, const TrajectoryOptions& options,
                                   const Q& frames) {
    std::vector<Result> results;
    SolveTrajectory(scene, options, frames, [&](std::size_t k, const Result& result) {
      EXPECT_EQ(k, results.size());
      results.push_back(result);
      return true;
    });
    return results;
  }
  static Q Frame(const Scene& scene, const Q& frames, std::size_t k) {
    const auto nq = static_cast<std::ptrdiff_t>(scene.nq());
    const auto at = frames.begin() + static_cast<std::ptrdiff_t>(k) * nq;
    return {at, at + nq};
  }

  // Σσ + W Σ change of answers.
  static double Energy(const Scene& scene, double weight, const Q& frames,
                       const std::vector<Result>& results) {
    NormEvaluator norm(scene.tables(), Metric::kSequential);
    double sum = 0.0;
    VectorXd r, X;
    MatrixXd J;
    for (std::size_t k = 0; k < results.size(); ++k) {
      norm.SetReference(ToEigen(Frame(scene, frames, k)));
      sum += norm.Sigma(ToEigen(results[k].q));
      if (k + 1 == results.size()) continue;
      norm.Linearize(norm.q_in(), r, J);
      Change(scene.tables(), ToEigen(results[k].q), ToEigen(results[k + 1].q), X, nullptr);
      sum += weight * (J * X).squaredNorm();
    }
    return sum;
  }

  // A closed curve through two random configurations.
  static Q Clip(const Scene& scene, Random& rng, int count) {
    const VectorXd a = RandomConfiguration(scene, rng), b = RandomConfiguration(scene, rng);
    VectorXd dq, q;
    Difference(scene.tables(), a, b, dq);
    Q frames;
    for (int k = 0; k < count; ++k) {
      Integrate(scene.tables(), a, (0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * k / count)) * dq,
                q);
      frames.insert(frames.end(), q.data(), q.data() + q.size());
    }
    return frames;
  }
};

double Quantile(std::vector<int> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

TEST_F(TrajectoryTest, AFrameCostsAFewQueriesAndStaysNearTheBest) {
  Random rng(2704);
  std::vector<int> queries;
  double sigma = 0.0, sigma_alone = 0.0;
  for (int robot = 0; robot < 6; ++robot) {
    RobotOptions shape;
    shape.free_base = robot % 2 == 1;
    const Scene scene = Scene::FromString(RandomRobotXml(rng, shape));
    const Q frames = Clip(scene, rng, 150);
    const std::vector<Result> results = Solve(scene, {}, frames);
    Solver alone(scene);
    for (std::size_t k = 0; k < results.size(); ++k) {
      if (results[k].status == Status::kUnsolved) continue;
      ASSERT_TRUE(Verify(scene, results[k].q).free) << robot << " " << k;
      if (results[k].status != Status::kSolved) continue;
      EXPECT_LE(results[k].sigma_lower_bound, results[k].sigma * (1.0 + 1e-9));
      EXPECT_LT(results[k].depth_in, 0.0);
      if (k > 0) queries.push_back(results[k].stats.collision_queries);
      if (k % 10 != 0) continue;
      sigma += results[k].sigma;
      sigma_alone += alone.Solve(Frame(scene, frames, k)).sigma;
    }
  }
  ASSERT_GT(queries.size(), 300u);
  EXPECT_LE(Quantile(queries, 0.5), 8);
  EXPECT_LE(Quantile(queries, 0.99), 50);
  EXPECT_LE(sigma, 1.25 * sigma_alone);
}

TEST_F(TrajectoryTest, FreeFramesComeBackAsTheyAre) {
  const Scene scene = Scene::FromString(kOverFloor);
  const Q frames = {0.3, 0.2, 0.15, 0.1};
  for (const Result& result : Solve(scene, {}, frames)) {
    EXPECT_EQ(result.status, Status::kAlreadyFree);
    EXPECT_EQ(result.sigma, 0.0);
  }
}

// E is a quadratic over a half-space for each frame here: the oracle descends on one frame after
// the other until nothing moves.
TEST_F(TrajectoryTest, ASmoothedClipIsTheMinimum) {
  const Scene scene = Scene::FromString(kOverFloor);
  Q frames;
  for (int k = 0; k < 60; ++k) frames.push_back(0.15 + 0.2 * std::sin(0.35 * k) + (k == 30) * 0.3);
  for (const double weight : {0.3, 5.0, 100.0}) {
    Q best = frames;
    for (double& z : best) z = std::max(z, 0.1);
    for (double moved = 1.0; moved > 1e-12;) {
      moved = 0.0;
      for (std::size_t k = 0; k < best.size(); ++k) {
        double sum = frames[k], weights = 1.0;
        if (k > 0) sum += weight * best[k - 1], weights += weight;
        if (k + 1 < best.size()) sum += weight * best[k + 1], weights += weight;
        const double z = std::max(0.1, sum / weights);
        moved = std::max(moved, std::abs(z - best[k]));
        best[k] = z;
      }
    }
    const std::vector<Result> results = Solve(scene, {.smooth = weight}, frames);
    ASSERT_EQ(results.size(), best.size());
    std::vector<Result> oracle(best.size());
    for (std::size_t k = 0; k < best.size(); ++k) {
      ASSERT_NE(results[k].status, Status::kUnsolved) << results[k].reason;
      EXPECT_TRUE(Verify(scene, results[k].q).free) << k;
      EXPECT_NEAR(results[k].q[0], best[k], 5e-3) << weight << " " << k;
      EXPECT_NEAR(results[k].sigma, std::pow(results[k].q[0] - frames[k], 2), 1e-12);
      oracle[k].q = {best[k]};
    }
    const double least = Energy(scene, weight, frames, oracle);
    EXPECT_NEAR(Energy(scene, weight, frames, results), least, 2e-3 * least) << weight;
  }
}

// Followed alone, the ball stays on the left side as long as it can and then hops; a frame that
// knows what comes goes round the corner in time.
TEST_F(TrajectoryTest, AFrameKnowsWhatComes) {
  const Scene scene = Scene::FromString(kBox);
  Q frames;
  for (int k = 0; k < 80; ++k) {
    frames.push_back(-0.9 + 0.0225 * k);
    frames.push_back(0.35);
  }
  const auto fastest = [&](const std::vector<Result>& results) {
    double most = 0.0;
    for (std::size_t k = 1; k < results.size(); ++k) {
      most = std::max(most, std::hypot(results[k].q[0] - results[k - 1].q[0],
                                       results[k].q[1] - results[k - 1].q[1]));
    }
    return most;
  };
  const std::vector<Result> followed = Solve(scene, {}, frames);
  const std::vector<Result> smooth = Solve(scene, {.smooth = 3.0}, frames);
  for (const Result& result : smooth) EXPECT_TRUE(Verify(scene, result.q).free);
  EXPECT_LT(fastest(smooth), 0.6 * fastest(followed));
  EXPECT_LT(Energy(scene, 3.0, frames, smooth), Energy(scene, 3.0, frames, followed));
}

// Whatever the robot: free, never worse than following, a local minimum (no frame of some that are
// moved at random is free and better), and the same every time.
TEST_F(TrajectoryTest, SmoothedClipsOfRandomRobotsAreFreeAndBetter) {
  Random rng(2705);
  int smoothed = 0, better = 0, tried = 0;
  for (int robot = 0; robot < 4; ++robot) {
    RobotOptions shape;
    shape.bodies = 5;
    shape.free_base = robot % 2 == 1;
    const Scene scene = Scene::FromString(RandomRobotXml(rng, shape));
    const Q frames = Clip(scene, rng, 60);
    const double weight = robot < 2 ? 0.5 : 8.0;
    const std::vector<Result> followed = Solve(scene, {}, frames);
    const auto solved = [](const Result& r) { return r.status != Status::kUnsolved; };
    if (!std::all_of(followed.begin(), followed.end(), solved)) continue;
    std::vector<Result> smooth = Solve(scene, {.smooth = weight}, frames);
    const double energy = Energy(scene, weight, frames, smooth);
    EXPECT_LT(energy, Energy(scene, weight, frames, followed));
    const std::vector<Result> again = Solve(scene, {.smooth = weight}, frames);
    for (std::size_t k = 0; k < smooth.size(); ++k) {
      ASSERT_TRUE(solved(smooth[k])) << smooth[k].reason;
      EXPECT_TRUE(Verify(scene, smooth[k].q).free) << robot << " " << k;
      EXPECT_EQ(smooth[k].q, again[k].q);
      ++smoothed;
    }
    for (int trial = 0; trial < 200; ++trial) {
      Result& one = smooth[static_cast<std::size_t>(rng.Index(static_cast<int>(smooth.size())))];
      const Q kept = one.q;
      VectorXd moved;
      Integrate(scene.tables(), ToEigen(kept), 1e-3 * rng.Normals(scene.tables().n), moved);
      ClampToLimits(scene.tables(), moved);
      one.q = ToVector(moved);
      if (Verify(scene, one.q).free) {
        ++tried;
        better += Energy(scene, weight, frames, smooth) < (1.0 - 1e-4) * energy;
      }
      one.q = kept;
    }
  }
  EXPECT_GT(smoothed, 100);
  EXPECT_GT(tried, 50);
  EXPECT_EQ(better, 0);
}

// A ball on a rail through a box that has no way out in the middle of the clip.
TEST_F(TrajectoryTest, FramesThatCannotBeFreeStayUnsolvedBesideOthers) {
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody><geom type="box" size=".5 .5 .5"/>
    <body><joint name="rail" type="slide" axis="1 0 0"/><inertial pos="0 0 0" mass="1"
    diaginertia=".1 .1 .1"/><body name="ball"><joint type="slide"
    axis="0 0 1" range="-.2 .2" limited="true"/><geom size=".1"/></body></body>
    </worldbody></mujoco>)",
                                        {.movable = {"ball"}});
  Q frames;
  for (int k = 0; k < 30; ++k) frames.insert(frames.end(), {-1.45 + 0.1 * k, 0.01 * k - 0.1});
  for (const double smooth : {0.0, 2.0}) {
    const std::vector<Result> results = Solve(scene, {.smooth = smooth}, frames);
    ASSERT_EQ(results.size(), 30u);
    int unsolved = 0;
    for (std::size_t k = 0; k < results.size(); ++k) {
      const bool inside = std::abs(-1.45 + 0.1 * static_cast<double>(k)) < 0.6;
      EXPECT_EQ(results[k].status == Status::kUnsolved, inside) << k;
      EXPECT_EQ(Verify(scene, results[k].q).free, !inside) << k;
      unsolved += inside;
    }
    EXPECT_GT(unsolved, 5);
  }
}

// A mesh that may slide by a millimetre, and one that goes through it. A tick has no time to
// measure how deep, frames have.
TEST_F(TrajectoryTest, DepthsOfUnsolvedFramesAreMeasuredWhereATicksAreRough) {
  Random rng(8);
  int unsolved = 0, deeper = 0;
  for (int i = 0; i < 40; ++i) {
    TwoGeoms geoms{.first = RandomShape(mjGEOM_MESH, rng), .second = RandomShape(mjGEOM_MESH, rng)};
    geoms.joint2 = "<joint type='slide' range='-.001 .001' limited='true'/>";
    const Scene scene = Scene::FromString(TwoGeomXml(geoms), {.movable = {"b2"}});
    Q frames = FreePose({5.0, 0.0, 0.0}, rng.UnitQuat());
    frames.push_back(0.0);
    for (int k = 0; k < 10; ++k) {
      const Q pose = FreePose(rng.InBox(0.1), rng.UnitQuat());
      frames.insert(frames.end(), pose.begin(), pose.end());
      frames.push_back(0.0);
    }
    const std::vector<Result> results = Solve(scene, {}, frames);
    Tracker tracker(scene);
    for (std::size_t k = 0; k < results.size(); ++k) {
      const Result& frame = results[k];
      Result tick;
      tracker.Step(std::span(frames).subspan(8 * k, 8), tick);
      if (frame.status == Status::kUnsolved) {
        EXPECT_NEAR(frame.min_distance, Verify(scene, frame.q).min_distance, 1e-9);
        ++unsolved;
      }
      if (tick.status != Status::kUnsolved) continue;
      const double depth = Verify(scene, tick.q).min_distance;
      EXPECT_LE(tick.min_distance, depth + 1e-9);
      deeper += tick.min_distance < depth - 1e-6;
    }
  }
  EXPECT_GT(unsolved, 100);
  EXPECT_GT(deeper, 0);
}

TEST_F(TrajectoryTest, GoOnEndsItBetweenFrames) {
  const Scene scene = Scene::FromString(kOverFloor);
  const Q frames(20, 0.05);
  for (const double smooth : {0.0, 2.0}) {
    int asked = 0;
    TrajectoryOptions options{.smooth = smooth, .go_on = [&] { return ++asked <= 7; }};
    EXPECT_EQ(Solve(scene, options, frames).size(), smooth > 0.0 ? 0u : 7u);
  }
}

TEST_F(TrajectoryTest, BadInputIsRefused) {
  const Scene scene = Scene::FromString(kOverFloor);
  const auto refused = [&](const TrajectoryOptions& options, const Q& frames) {
    return ErrorOf([&] { Solve(scene, options, frames); });
  };
  const double nan = std::nan("");
  for (const double smooth : {-1.0, nan, 1e7, std::numeric_limits<double>::infinity()}) {
    EXPECT_THAT(refused({.smooth = smooth}, {0.3}), HasSubstr("smooth must lie")) << smooth;
  }
  TrajectoryOptions paper{.smooth = 1.0};
  paper.options.method = Method::kPaper;
  EXPECT_THAT(refused(paper, {0.3}), HasSubstr("method auto"));
  TrajectoryOptions late{.smooth = 1.0};
  late.options.time_limit = 1.0;
  EXPECT_THAT(refused(late, {0.3}), HasSubstr("time limit"));
  EXPECT_THAT(refused({}, {0.3, nan}), HasSubstr("row 1"));
  EXPECT_EQ(Solve(scene, {.smooth = 1.0}, {}).size(), 0u);
}

}  // namespace
}  // namespace mjcf_pdg::test
