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

}  // namespace
}  // namespace mjcf_pdg::test
