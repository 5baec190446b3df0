// A control loop's promise: once warm, a solve takes nothing from the heap.
#include <gmock/gmock.h>

#include "mjcf_pdg/pdg.h"
#include "tests/support/allocation_counter.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

class SolverAllocationTest : public MujocoTest {};

TEST_F(SolverAllocationTest, WarmSolvesAndQuestionsTakeNothingFromTheHeap) {
  ASSERT_TRUE(AllocationCounter::Works());
  int all_solved = 0;
  for (const char* path :
       {"/puma/puma_car.xml", "/hand/hand_bottle.xml", "/figure/figure_bench.xml"}) {
    const Scene scene = Scene::FromFile(std::string(MJCF_PDG_MODEL_DIR) + path);
    Random rng(3);
    std::vector<std::vector<double>> rows;
    for (int k = 0; k < 20; ++k) rows.push_back(ToVector(RandomConfiguration(scene, rng, 0.3)));
    for (const Effort effort : {Effort::kFast, Effort::kDefault}) {
      Options options;
      options.effort = effort;
      Solver solver(scene, options);
      Result result;
      for (const std::vector<double>& q : rows) solver.Solve(q, result);
      int free = 0, solved = 0;
      std::int64_t taken = 0;
      for (const std::vector<double>& q : rows) {
        const AllocationCounter counter;
        const bool is_free = solver.IsFree(q);
        solver.Solve(q, result);
        taken += result.status == Status::kUnsolved ? 0 : counter.count();
        free += is_free;
        solved += result.status == Status::kSolved;
      }
      EXPECT_EQ(taken, 0) << path;
      EXPECT_EQ(free + solved, 20) << path;
      all_solved += solved;
    }
  }
  EXPECT_GT(all_solved, 30);
}

// Islands are kept: here two, one of them pushing a third body, and with a hint.
TEST_F(SolverAllocationTest, WarmIslandsTakeNothingFromTheHeap) {
  ASSERT_TRUE(AllocationCounter::Works());
  std::string xml = R"(<mujoco><worldbody><geom type="plane" size="0 0 1"/>)";
  for (int k = 0; k < 7; ++k) {
    xml += R"(<body><freejoint/><geom type="box" size=".05 .05 .05"/></body>)";
  }
  const Scene scene = Scene::FromString(xml + "</worldbody></mujoco>");
  std::vector<double> q, hint;
  for (const double x : {0.0, 0.09, 0.191, 1.0, 1.08, 2.0, 3.0}) {
    q.insert(q.end(), {x, 0, .05, 1, 0, 0, 0});
    hint.insert(hint.end(), {1.5 * x, 0, .05, 1, 0, 0, 0});
  }
  Solver solver(scene);
  solver.SetHint(hint);
  Result result;
  ASSERT_EQ(solver.Solve(q, result), Status::kSolved);
  ASSERT_EQ(solver.Solve(q, result), Status::kSolved);
  const AllocationCounter counter;
  solver.Solve(q, result);
  EXPECT_EQ(counter.count(), 0);
}

}  // namespace
}  // namespace mjcf_pdg::test
