// Tracker: answers are free, follow their optimum, move no faster than they may, and stand on the
// side of an obstacle from which they came if the motion is to be proven.
#include "mjcf_pdg/tracker.h"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <thread>

#include "mjcf_pdg/pdg.h"
#include "model/kinematics.h"
#include "tests/support/allocation_counter.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

using ::testing::HasSubstr;
using Q = std::vector<double>;

// A ball in the plane, beside a box of one by one metre.
constexpr char kBox[] = R"(<mujoco><worldbody>
  <geom name="box" type="box" size=".5 .5 .5"/>
  <body name="ball"><joint name="x" type="slide" axis="1 0 0"/>
    <joint name="y" type="slide" axis="0 1 0"/><geom name="ball" size=".1"/></body>
  </worldbody></mujoco>)";

// The same ball and a sheet of a millimetre at x = 0.
constexpr char kSheet[] = R"(<mujoco><worldbody>
  <geom name="sheet" type="box" size=".0005 1 1"/>
  <body name="ball"><joint name="x" type="slide" axis="1 0 0"/>
    <joint name="y" type="slide" axis="0 1 0"/><geom name="ball" size=".1"/></body>
  </worldbody></mujoco>)";

// An arm of three links in the plane, and an obstacle on rails.
constexpr char kArm[] = R"(<mujoco><compiler angle="radian"/><worldbody>
  <body name="obstacle" mocap="true" pos="1.2 0 0"><geom type="sphere" size=".15"/></body>
  <body><joint axis="0 0 1" range="-2 2" limited="true"/>
    <geom type="capsule" fromto="0 0 0 .4 0 0" size=".04"/>
    <body pos=".4 0 0"><joint axis="0 0 1" range="-2 2" limited="true"/>
      <geom type="capsule" fromto="0 0 0 .4 0 0" size=".04"/>
      <body pos=".4 0 0"><joint axis="0 0 1" range="-2 2" limited="true"/>
        <geom type="capsule" fromto="0 0 0 .3 0 0" size=".04"/></body></body></body>
  </worldbody></mujoco>)";

double LargestStep(const Q& a, const Q& b) {
  double largest = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) largest = std::max(largest, std::abs(a[k] - b[k]));
  return largest;
}

class TrackerTest : public MujocoTest {};

TEST_F(TrackerTest, FreeCommandsComeBackAsTheyAre) {
  const Scene scene = Scene::FromString(kBox);
  Tracker tracker(scene);
  Result result;
  for (int k = 0; k < 20; ++k) {
    const Q command = {-2.0 + 0.01 * k, 0.3};
    EXPECT_EQ(tracker.Step(command, result), Status::kAlreadyFree);
    EXPECT_EQ(result.q, command);
    EXPECT_EQ(result.sigma, 0.0);
    EXPECT_FALSE(result.switched);
    if (k > 0) {
      EXPECT_EQ(result.stats.collision_queries, 1) << "what IsFree costs";
    }
  }
}

// The command goes straight through the box, below its middle. The answer slides along the near
// side, until another side is nearer by the gain.
TEST_F(TrackerTest, AnswersStayOnTheirSideUntilAnotherIsNearer) {
  const Scene scene = Scene::FromString(kBox);
  TrackOptions options;
  options.switch_gain = 0.1;
  Tracker tracker(scene, options);
  Result result;
  int switches = 0, followed = 0;
  for (int k = 0; k <= 2000; ++k) {
    const Q command = {-1.0 + 0.001 * k, -0.2};
    const Status status = tracker.Step(command, result);
    ASSERT_NE(status, Status::kUnsolved) << k << ": " << result.reason;
    ASSERT_TRUE(Verify(scene, result.q).free) << k;
    EXPECT_LE(result.stats.collision_queries, k == 0 ? 1000 : options.queries) << k;
    switches += result.switched;
    const double into = 0.6 - std::abs(command[0]);  // from the left and right sides
    if (into <= 1e-3) {
      EXPECT_EQ(result.q, command);
      continue;
    }
    // The nearest of all sides is 0.4 away or nearer; before and after that it is left and right.
    const double nearest = std::min(into, 0.4);
    EXPECT_LE(std::sqrt(result.sigma), nearest / (1.0 - 0.1) + 0.01) << k << ": found in 10 ticks";
    ++followed;
  }
  EXPECT_GT(followed, 1000);
  EXPECT_EQ(switches, 2) << "to the lower side and off it again";
}

// A ball on an arm stands at a side of a gap in a wall while its command goes on round in the wall.
// When that is half a turn ahead, the other side of the gap is as near: σ has a maximum there, from
// which the arm turns for nothing to first order, by the radian that a step may turn and that the
// gap is wide.
TEST_F(TrackerTest, AnArmThatIsPassedByHalfATurnDoesNotJumpUntold) {
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody>
    <geom name="wall" type="box" pos="-.6136 0 0" size="1 2 1"/>
    <body><joint axis="0 0 1"/><geom name="ball" pos=".5 0 0" size=".05"/></body>
    </worldbody></mujoco>)");
  TrackOptions options;
  options.switch_gain = 0.999;  // to nothing nearer
  Tracker tracker(scene, options);
  Result result;
  double last = 0.0, largest = 0.0;
  int in_wall = 0;
  constexpr double kStep = 0.02;
  for (int k = 0; k < 310; ++k) {
    const Q command = {kStep * k};
    ASSERT_NE(tracker.Step(command, result), Status::kUnsolved) << k << ": " << result.reason;
    in_wall += result.status == Status::kSolved;
    const double turn = std::abs(std::remainder(result.q[0] - last, 2 * std::numbers::pi));
    if (!result.switched) largest = std::max(largest, turn);
    last = result.q[0];
  }
  EXPECT_GT(in_wall, 250);
  EXPECT_LE(largest, 10 * kStep);
}

TEST_F(TrackerTest, NoJointMovesFartherThanMaxStep) {
  const Scene scene = Scene::FromString(kBox);
  TrackOptions options;
  options.max_step = 0.003;
  Tracker tracker(scene, options);
  Result result;
  Q last;
  int limited = 0;
  for (int k = 0; k <= 3000; ++k) {
    const Q command = {std::min(-1.0 + 0.001 * k, 1.0), -0.2};
    ASSERT_NE(tracker.Step(command, result), Status::kUnsolved) << k << ": " << result.reason;
    ASSERT_TRUE(Verify(scene, result.q).free) << k;
    if (k > 0) {
      ASSERT_LE(LargestStep(result.q, last), options.max_step * (1 + 1e-9)) << k;
      limited += LargestStep(result.q, last) > 0.9 * options.max_step;
    }
    last = result.q;
  }
  EXPECT_GT(limited, 50) << "the way round the corners takes longer than a tick";
  EXPECT_NEAR(result.q[0], 1.0, 1e-9) << "it has arrived";
  EXPECT_NEAR(result.q[1], -0.2, 1e-9);
}

// A command that jumps to the other side of a sheet is free, but the way to it is not.
TEST_F(TrackerTest, AProvenMotionDoesNotPassASheet) {
  const Scene scene = Scene::FromString(kSheet);
  for (const bool certify : {true, false}) {
    TrackOptions options;
    options.certify_motion = certify;
    Tracker tracker(scene, options);
    Result result;
    Q last = {-0.5, 0.0};
    for (int k = 0; k < 400; ++k) {
      const Q command = {(k / 100) % 2 == 0 ? -0.5 : 0.5, 0.001 * k};
      ASSERT_NE(tracker.Step(command, result), Status::kUnsolved) << k << ": " << result.reason;
      ASSERT_TRUE(Verify(scene, result.q).free) << k;
      if (certify) {
        EXPECT_LT(result.q[0], -0.1) << k;
        // Proven again from outside, up to the band in which a motion ends before it touches.
        const Motion motion = CheckMotion(scene, last, result.q);
        EXPECT_LT((1.0 - motion.t) * LargestStep(last, result.q), 1e-5) << k;
      } else {
        EXPECT_EQ(result.q, command);
      }
      last = result.q;
    }
  }
}

// The command stands still; an obstacle on rails pushes the arm aside and lets it return.
// A proof takes as long as the motion needs, which no count of queries bounds.
TEST_F(TrackerTest, AProofOfTheMotionEndsWithTheTicksTime) {
  const Scene scene = Scene::FromString(kBox);
  const Q first = {-1.0, 0.61}, command = {1.0, 0.61};  // 1 cm above the box
  TrackOptions options;
  options.certify_motion = true;
  Result result;
  for (const double seconds : {10.0, 1e-12}) {
    options.options.time_limit = seconds;
    Tracker tracker(scene, options);
    ASSERT_EQ(tracker.Step(first, result), Status::kAlreadyFree);
    ASSERT_NE(tracker.Step(command, result), Status::kUnsolved) << result.reason;
    EXPECT_EQ(result.q == command, seconds == 10.0) << "cut where the first pose's proof ends";
    EXPECT_TRUE(Verify(scene, result.q).free);
  }
}

TEST_F(TrackerTest, ObstaclesPushTheAnswerAhead) {
  const Scene scene = Scene::FromString(kArm);
  const std::unique_ptr<mjData, void (*)(mjData*)> d(mj_makeData(scene.model()), mj_deleteData);
  Tracker tracker(scene);
  Result result;
  const Q command = {0.1, 0.2, 0.3};
  int pushed = 0;
  for (int k = 0; k < 5000; ++k) {
    const double t = k / 5000.0;
    d->mocap_pos[0] = 0.8;
    d->mocap_pos[1] = -0.8 + 1.6 * t;
    const Status status = tracker.Step(d.get(), command, result);
    ASSERT_NE(status, Status::kUnsolved) << k << ": " << result.reason;
    Options here;
    here.mocap_pos.assign(d->mocap_pos, d->mocap_pos + 3);
    here.mocap_quat.assign(d->mocap_quat, d->mocap_quat + 4);
    ASSERT_TRUE(Verify(scene, result.q, here).free) << k;
    pushed += status == Status::kSolved;
  }
  EXPECT_GT(pushed, 500);
  EXPECT_EQ(result.q, command) << "it has returned";
}

// Robots at random, their joints on sinusoids through each other and an obstacle.
TEST_F(TrackerTest, RandomRobotsAreFreeInEveryTickWithoutJumps) {
  Random rng(2701);
  int overlapping = 0, jumps = 0, ticks = 0;
  for (int robot = 0; robot < 8; ++robot) {
    const Scene scene = Scene::FromString(RandomRobotXml(rng, {.free_base = false}));
    const Q first = ToVector(RandomConfiguration(scene, rng));
    const Q other = ToVector(RandomConfiguration(scene, rng));
    Tracker tracker(scene);
    Result result;
    Q last, last_command;
    for (int k = 0; k < 600; ++k) {
      const double share = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * k / 600);
      VectorXd dq, q;
      Difference(scene.tables(), ToEigen(first), ToEigen(other), dq);
      Integrate(scene.tables(), ToEigen(first), share * dq, q);
      const Q command = ToVector(q);
      const Status status = tracker.Step(command, result);
      if (k == 0 && status == Status::kUnsolved) break;
      ASSERT_NE(status, Status::kUnsolved) << robot << " " << k << ": " << result.reason;
      ASSERT_TRUE(Verify(scene, result.q).free) << robot << " " << k;
      ASSERT_LE(result.stats.collision_queries, k == 0 ? 10000 : 12) << robot << " " << k;
      overlapping += status == Status::kSolved;
      ++ticks;
      if (k > 0 && !result.switched) {
        const double moved = ObjectNorm(scene, Metric::kSequential, last_command).Sigma(command);
        const double answer = ObjectNorm(scene, Metric::kSequential, last).Sigma(result.q);
        const bool jump = std::sqrt(answer) > 10.0 * std::sqrt(moved) + 1e-5;
        jumps += jump;
        EXPECT_FALSE(jump) << robot << " " << k << ": " << std::sqrt(moved) << " m, answer "
                           << std::sqrt(answer) << " m";
      }
      last = result.q;
      last_command = command;
    }
  }
  EXPECT_GT(ticks, 3000);
  EXPECT_GT(overlapping, 1000);
  EXPECT_EQ(jumps, 0);
}

TEST_F(TrackerTest, ItTakesNothingFromTheHeapOnceWarm) {
  if (!AllocationCounter::Works()) GTEST_SKIP() << "no hook into this C library's malloc";
  const Scene scene = Scene::FromString(kArm);
  for (const double max_step : {std::numeric_limits<double>::infinity(), 0.002}) {
    TrackOptions options;
    options.max_step = max_step;
    options.options.report_lower_bound = false;
    options.options.mocap_pos = {0.6, 0.3, 0.0};
    options.options.mocap_quat = {1.0, 0.0, 0.0, 0.0};
    Tracker tracker(scene, options);
    Result result;
    Q command = {0.0, 0.0, 0.0};
    int overlapping = 0;
    std::int64_t allocations = 0;
    for (int k = 0; k < 2000; ++k) {
      command[1] = 1.9 * std::sin(0.005 * k);
      command[2] = 1.9 * std::sin(0.0061 * k);
      command[0] = std::sin(0.0023 * k);
      const AllocationCounter counter;
      overlapping += tracker.Step(command, result) == Status::kSolved;
      if (k > 1000) allocations += counter.count();
    }
    EXPECT_EQ(allocations, 0) << max_step;
    EXPECT_GT(overlapping, 100);
  }
}

// Where the command stops, the answer is beside it in the same tick, also after a while at rest.
TEST_F(TrackerTest, ATickGoesAllTheWayAlongAnObstacle) {
  const Scene scene = Scene::FromString(kBox);
  Tracker tracker(scene);
  Result result;
  for (int k = 0; k < 5; ++k) tracker.Step(Q{-0.4, 0.0}, result);
  for (const double y : {0.05, 0.1, 0.02}) {
    for (int k = 0; k < 3; ++k) {
      tracker.Step(Q{-0.4, y}, result);
      EXPECT_NEAR(result.q[0], -0.6, 1e-5);
      EXPECT_NEAR(result.q[1], y, 1e-3) << k;
    }
  }
}

// A ball that is pushed into a box by d must move by d, less the tolerance, wherever it goes.
TEST_F(TrackerTest, TheLowerBoundIsThatOfASolve) {
  const Scene scene = Scene::FromString(kBox);
  TrackOptions options;
  options.lower_bound = true;
  Tracker tracker(scene, options), usual(scene);
  Solver solver(scene);
  Result result, plain;
  for (int k = 0; k < 40; ++k) {
    const double depth = 0.01 * (k - 5);
    const Q command = {-0.6 + depth, 0.2};
    tracker.Step(command, result);
    usual.Step(command, plain);
    EXPECT_EQ(result.q, plain.q) << "the answer is the same";
    if (depth < 1e-9) {
      EXPECT_EQ(result.sigma_lower_bound, 0.0);
      continue;
    }
    EXPECT_NEAR(std::sqrt(result.sigma_lower_bound), depth, 1e-5);
    EXPECT_EQ(result.sigma_lower_bound, solver.Solve(command).sigma_lower_bound);
    EXPECT_EQ(plain.sigma_lower_bound, 0.0);
  }
}

// The answers of some ticks among an obstacle that moves, one after the other.
std::vector<Q> AnswersInScene(const Scene& scene, const TrackOptions& options) {
  const DataPtr d(mj_makeData(scene.model()));
  Tracker tracker(scene, options);
  Result result;
  std::vector<Q> answers;
  for (int k = 0; k < 400; ++k) {
    d->mocap_pos[0] = 0.8;
    d->mocap_pos[1] = 0.4 * std::sin(0.02 * k);
    const double way = 0.006 * k;
    tracker.Step(d.get(), Q{1.5 * std::sin(way), 1.9 * std::sin(1.7 * way), way}, result);
    answers.push_back(result.q);
  }
  return answers;
}

TEST_F(TrackerTest, ThreadsMayTrackInOneScene) {
  const Scene scene = Scene::FromString(kArm);
  std::vector<TrackOptions> options(3);
  options[1].max_step = 0.01;
  options[2].certify_motion = true;
  std::vector<std::vector<Q>> alone, together(2 * options.size());
  for (const TrackOptions& o : options) alone.push_back(AnswersInScene(scene, o));
  std::vector<std::thread> threads;
  for (std::size_t k = 0; k < together.size(); ++k) {
    threads.emplace_back(
        [&, k] { together[k] = AnswersInScene(scene, options[k % options.size()]); });
  }
  for (std::thread& thread : threads) thread.join();
  for (std::size_t k = 0; k < together.size(); ++k) {
    EXPECT_EQ(together[k], alone[k % options.size()]) << k << ": the same ticks, the same answers";
  }
  EXPECT_NE(alone[0], alone[1]) << "max_step decided nothing";
}

TEST_F(TrackerTest, ResetSaysWhereTheFollowerStands) {
  const Scene scene = Scene::FromString(kBox);
  TrackOptions options;
  options.switch_gain = 0.9;
  Tracker tracker(scene, options);
  tracker.Reset(Q{0.0, 0.8});
  Result result;
  ASSERT_EQ(tracker.Step(Q{-0.45, 0.3}, result), Status::kSolved);
  EXPECT_GT(result.q[1], 0.59) << "from above, though the left side is nearer";
}

TEST_F(TrackerTest, BadInputIsRefused) {
  const Scene scene = Scene::FromString(kBox);
  Tracker tracker(scene);
  Result result;
  EXPECT_THAT(ErrorOf([&] { tracker.Step(Q{0.0}, result); }), HasSubstr("2"));
  EXPECT_THAT(ErrorOf([&] { tracker.Step(Q{0.0, std::nan("")}, result); }), HasSubstr("number"));
  EXPECT_THAT(ErrorOf([&] { tracker.Step(nullptr, Q{0.0, 0.0}, result); }), HasSubstr("null"));
  const auto refuses = [&](const std::function<void(TrackOptions&)>& set, const char* words) {
    TrackOptions options;
    set(options);
    EXPECT_THAT(ErrorOf([&] { Tracker(scene, options); }), HasSubstr(words));
  };
  refuses([](TrackOptions& o) { o.queries = 2; }, "queries");
  refuses([](TrackOptions& o) { o.switch_gain = 1.0; }, "switch_gain");
  refuses([](TrackOptions& o) { o.max_step = 0.0; }, "max_step");
  refuses([](TrackOptions& o) { o.options.method = Method::kPaper; }, "method auto");
  refuses([](TrackOptions& o) { o.options.tolerance = -1.0; }, "tolerance");
}

}  // namespace
}  // namespace mjcf_pdg::test
