// Solver::SetObserver: what an observer is told of a solve.
#include <gmock/gmock.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "base/tuning.h"
#include "mjcf_pdg/pdg.h"
#include "model/scene_tables.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg {
namespace {

const std::string kArm = MJCF_PDG_MODEL_DIR "/puma/puma_car.xml";

constexpr int kArmThroughDoor = 6;  // a keyframe

struct Seen {
  std::string start;
  int descent, step;
  std::vector<double> q;
  double sigma, violation;
  bool free;
  std::vector<ObservedRow> rows;
};

Observer Into(std::vector<Seen>& seen) {
  return [&seen](const Iteration& it) {
    seen.push_back({it.start,
                    it.descent,
                    it.step,
                    {it.q.begin(), it.q.end()},
                    it.sigma,
                    it.violation,
                    it.free,
                    {it.rows.begin(), it.rows.end()}});
  };
}

// The keyframe `key` of the model.
std::vector<double> Keyframe(const Scene& scene, int key) {
  const mjModel& m = *scene.model();
  return {m.key_qpos + key * m.nq, m.key_qpos + (key + 1) * m.nq};
}

class ObserverTest : public ::testing::TestWithParam<Method> {};

TEST_P(ObserverTest, IsToldEveryIterationAndChangesNothing) {
  const Scene scene = Scene::FromFile(kArm);
  Options options;
  options.method = GetParam();
  const std::vector<double> q_in = Keyframe(scene, kArmThroughDoor);
  const Result unwatched = Solver(scene, options).Solve(q_in);
  ASSERT_EQ(unwatched.status, Status::kSolved);

  Solver solver(scene, options);
  std::vector<Seen> seen;
  solver.SetObserver(Into(seen));
  const Result watched = solver.Solve(q_in);
  EXPECT_EQ(watched.q, unwatched.q);
  EXPECT_EQ(watched.stats.collision_queries, unwatched.stats.collision_queries);

  ObjectNorm norm(scene, options.metric, q_in);
  int steps = 0, rows = 0;
  ASSERT_FALSE(seen.empty());
  for (std::size_t k = 0; k < seen.size(); ++k) {
    const Seen& it = seen[k];
    const bool begins = it.step == 0;
    EXPECT_EQ(it.descent, k == 0 ? 0 : seen[k - 1].descent + (begins ? 1 : 0));
    EXPECT_EQ(it.step, begins ? 0 : seen[k - 1].step + 1);
    EXPECT_NE(it.start, "none");
    EXPECT_NEAR(it.sigma, norm.Sigma(it.q), 1e-12 + 1e-9 * it.sigma);
    EXPECT_FALSE(begins && !it.rows.empty());
    steps += begins ? 0 : 1;
    for (const ObservedRow& row : it.rows) {
      ++rows;
      EXPECT_NE(row.joint >= 0, row.geom[0] >= 0);  // the one or the other
      EXPECT_GE(row.multiplier, 0.0);
    }
  }
  EXPECT_GE(steps, unwatched.stats.iterations);  // those of retreats and of starts count as well
  EXPECT_GT(rows, 0);
  EXPECT_EQ(seen.front().descent, 0);

  const std::size_t before = seen.size();
  solver.SetObserver({});
  solver.Solve(q_in);
  EXPECT_EQ(seen.size(), before);
}

INSTANTIATE_TEST_SUITE_P(Methods, ObserverTest, ::testing::Values(Method::kAuto, Method::kPaper),
                         [](const auto& method) {
                           return method.param == Method::kAuto ? "Auto" : "Paper";
                         });

TEST(Observer, SeesTheAnswerAmongTheFreeIterates) {
  const Scene scene = Scene::FromFile(kArm);
  Solver solver(scene);
  std::vector<Seen> seen;
  solver.SetObserver(Into(seen));
  const Result result = solver.Solve(Keyframe(scene, kArmThroughDoor));
  bool met = false;
  for (const Seen& it : seen) met = met || (it.free && it.q == result.q);
  EXPECT_TRUE(met);
}

// A ball between two plates that are nearer than it is wide, wherever it goes: while nothing free
// is known, starts are strewn about q_in, in a length that the scene gives, and ever farther.
TEST(Observer, SeesBlindStartsSpreadOut) {
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody>
      <geom type="box" size="50 50 1" pos="0 0 1.08"/><geom type="box" size="50 50 1" pos="0 0 -1.08"/>
      <body><joint name="x" type="slide" axis="1 0 0" range="-20 20"/>
      <joint name="y" type="slide" axis="0 1 0" range="-20 20"/>
      <geom size=".1"/></body></worldbody></mujoco>)");
  double early = 0.0, late = 0.0;  // sums of how far starts are, over what their turn's spread is
  int starts = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Options options;
    options.seed = seed;
    Solver solver(scene, options);
    std::vector<Seen> seen;
    solver.SetObserver(Into(seen));
    ASSERT_EQ(solver.Solve(std::vector<double>{0.0, 0.0}).status, Status::kUnsolved);
    std::vector<double> far;
    for (const Seen& it : seen) {
      if (it.start == "noise" && it.step == 0) far.push_back(std::hypot(it.q[0], it.q[1]));
    }
    starts = static_cast<int>(far.size());
    ASSERT_GE(starts, 4);
    for (int k = 0; k < starts; ++k) {
      (2 * k < starts ? early : late) += far[k] / tuning::starts::kNoise[k % 4];
    }
  }
  EXPECT_GT(early / (10.0 * starts), tuning::starts::kLeastNoise * scene.tables().size);
  EXPECT_GT(late, 1.5 * early);
}

// A free configuration needs no search.
TEST(Observer, IsToldNothingOfAFreeConfiguration) {
  const Scene scene = Scene::FromFile(kArm);
  Solver solver(scene);
  std::vector<Seen> seen;
  solver.SetObserver(Into(seen));
  const Result result = solver.Solve(Keyframe(scene, kArmThroughDoor));
  seen.clear();
  EXPECT_EQ(solver.Solve(result.q).status, Status::kAlreadyFree);
  EXPECT_TRUE(seen.empty());
}

}  // namespace
}  // namespace mjcf_pdg
