// The repair follows the command: free in every tick, bracketed, among obstacles that move, too.
#include <gmock/gmock.h>

#include <cmath>

#include "apps/view/repair_session.h"
#include "apps/view/search_record.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

using app::Configuration;
using app::RepairSession;
using app::Search;
using app::SearchRecord;

// A ball in the plane beside a box, and an obstacle that is moved by mocap.
constexpr char kScene[] = R"(<mujoco><worldbody>
  <geom name="box" type="box" size=".5 .5 .5"/>
  <body name="post" mocap="true" pos="0 5 0"><geom name="post" size=".1"/></body>
  <body name="ball"><joint name="x" type="slide" axis="1 0 0"/>
    <joint name="y" type="slide" axis="0 1 0"/><geom name="ball" size=".1"/></body>
  </worldbody></mujoco>)";

Configuration Row(const std::vector<double>& q) {
  Configuration row;
  row.label = "row";
  row.q = q;
  return row;
}

class ViewSessionTest : public MujocoTest {
 protected:
  const Scene scene_ = Scene::FromString(kScene);
};

TEST_F(ViewSessionTest, EveryTickIsFreeAndBracketed) {
  RepairSession session(scene_, {}, Row({-1.0, 0.1}));
  EXPECT_EQ(session.result(), nullptr);
  int colliding = 0;
  for (int tick = 0; tick < 100; ++tick) {
    session.SetCommand(std::vector{-1.0 + 0.01 * tick, 0.1});
    session.Tick();
    const Result& result = *session.result();
    EXPECT_TRUE(Verify(scene_, result.q).free);
    // The way out to the left takes the whole mass along by `left`, the one over the top by 0.5.
    // The second one is taken some ticks after it has become the shorter one.
    const double left = -1.0 + 0.01 * tick + 0.6;
    if (left <= 1e-9) {
      EXPECT_EQ(result.status, Status::kAlreadyFree);
      continue;
    }
    ++colliding;
    EXPECT_EQ(result.status, Status::kSolved);
    EXPECT_GE(std::sqrt(result.sigma), std::min(left, 0.5) - 1e-5);
    EXPECT_LE(std::sqrt(result.sigma), left + 1e-5);
    EXPECT_GT(result.sigma_lower_bound, 0.0);
    EXPECT_LE(result.sigma_lower_bound, result.sigma * (1 + 1e-9) + 1e-10);
    EXPECT_EQ(result.contacts_in.size(), 1u);
  }
  EXPECT_EQ(colliding, 59);
  EXPECT_GT(session.MedianSeconds(), 0.0);
  EXPECT_GE(session.LongestSeconds(), session.MedianSeconds());
}

// While nothing moves what was proven stays so, whatever single ticks prove.
TEST_F(ViewSessionTest, TheBoundNeverFallsWhileNothingMoves) {
  const Scene puma = Scene::FromFile(MJCF_PDG_MODEL_DIR "/puma/puma_car.xml");
  const mjModel& m = *puma.model();
  int proven = 0;
  for (int key = 0; key < m.nkey; ++key) {
    const mjtNum* const q = m.key_qpos + m.nq * key;
    RepairSession session(puma, {}, Row({q, q + m.nq}));
    double most = 0.0;
    for (int tick = 0; tick < 20; ++tick) {
      session.Tick();
      const double bound = session.result()->sigma_lower_bound;
      EXPECT_GE(bound, most) << "key " << key << " tick " << tick;
      most = bound;
    }
    proven += most > 0.0;
  }
  EXPECT_GT(proven, 10);
}

TEST_F(ViewSessionTest, AJumpForgetsAndAMotionFollows) {
  RepairSession session(scene_, {}, Row({-0.55, 0.0}));
  session.Tick();
  EXPECT_LT(session.result()->q[0], -0.59);
  // Just beyond the middle: what is followed stays on its side, what is solved anew does not.
  for (const double x : {-0.4, -0.2, 0.0, 0.01}) {
    session.SetCommand(std::vector{x, 0.0});
    session.Tick();
  }
  EXPECT_LT(session.result()->q[0], 0.1);
  session.Jump(Row({0.45, 0.0}));
  EXPECT_EQ(session.result(), nullptr);
  session.Tick();
  EXPECT_GT(session.result()->q[0], 0.59);
}

TEST_F(ViewSessionTest, ObstaclesAreWhereTheyWereDragged) {
  RepairSession session(scene_, {}, Row({-1.0, 0.0}));
  session.Tick();
  EXPECT_EQ(session.result()->status, Status::kAlreadyFree);
  DataPtr data(mj_makeData(scene_.model()));
  data->qpos[0] = -1.0;
  data->mocap_pos[0] = -1.0;
  data->mocap_pos[1] = 0.05;
  session.SetCommand(*data);
  EXPECT_EQ(session.ticks_at_rest(), 0);
  session.Tick();
  const Result& result = *session.result();
  EXPECT_EQ(result.status, Status::kSolved);
  Options options;
  options.mocap_pos = session.row().mocap_pos;
  options.mocap_quat = session.row().mocap_quat;
  EXPECT_TRUE(Verify(scene_, result.q, options).free);
  EXPECT_FALSE(Verify(scene_, session.command(), options).free);
}

TEST_F(ViewSessionTest, ASearchIsRecordedToItsAnswer) {
  Search search(scene_, {});
  EXPECT_FALSE(search.running());
  search.Begin(Row({-0.3, 0.05}));
  search.Begin(Row({5.0, 5.0}));  // does nothing: one is running
  const SearchRecord record = search.Take();
  EXPECT_FALSE(search.running());
  EXPECT_EQ(record.row.q, (std::vector{-0.3, 0.05}));
  ASSERT_GE(record.steps.size(), 3u);
  EXPECT_EQ(record.steps.front().start, "direct");
  EXPECT_EQ(record.steps.front().q, record.row.q);
  EXPECT_FALSE(record.steps.front().free);
  EXPECT_EQ(record.steps.back().start, "answer");
  EXPECT_EQ(record.steps.back().q, record.result.q);
  EXPECT_NEAR(std::sqrt(record.steps.back().sigma), 0.3, 1e-5);
  // The same as without being watched.
  Solver solver(scene_);
  EXPECT_EQ(solver.Solve(std::vector{-0.3, 0.05}).q, record.result.q);
}

TEST_F(ViewSessionTest, ASearchThatFailsSaysSo) {
  Search search(scene_, {});
  search.Begin(Row({0.0}));
  EXPECT_THROW(search.Take(), Error);
  EXPECT_FALSE(search.running());
}

}  // namespace
}  // namespace mjcf_pdg::test
