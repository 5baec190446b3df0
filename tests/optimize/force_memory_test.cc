#include "optimize/force_memory.h"

#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

constexpr int kPairs = 5, kJoints = 3;

ContactRows Rows(const std::vector<RowSource>& sources) {
  ContactRows rows;
  rows.Clear(1);
  for (const RowSource& source : sources) rows.Append(0.0, source);
  return rows;
}

RowSource Pair(int pair) { return {.pair = pair}; }
RowSource Joint(int joint) { return {.joint = joint}; }

VectorXd Recalled(const ForceMemory& memory, const std::vector<RowSource>& sources) {
  VectorXd lambda = VectorXd::Constant(static_cast<Eigen::Index>(sources.size()), -7.0);
  memory.Recall(Rows(sources), lambda);
  return lambda;
}

TEST(ForceMemoryTest, ForcesAreRecalledByWhatTheRowsAreAboutAndTheirPlaces) {
  ForceMemory memory;
  memory.Reserve(8, kPairs, kJoints);
  EXPECT_EQ(Recalled(memory, {Pair(0), Joint(0)}), VectorXd::Zero(2));
  VectorXd lambda(6);
  lambda << 1, 2, 3, 4, 5, 6;
  memory.Keep(Rows({Pair(3), Pair(3), Pair(1), Joint(0), Joint(2), {}}), lambda);
  VectorXd expected(9);
  expected << 3, 0, 1, 2, 0, 0, 4, 5, 0;
  EXPECT_EQ(
      Recalled(memory,
               {Pair(1), Pair(1), Pair(3), Pair(3), Pair(3), Pair(4), Joint(0), Joint(2), {}}),
      expected);
  // The last rows are kept, no others.
  memory.Keep(Rows({Pair(4)}), VectorXd::Constant(1, 9.0));
  EXPECT_EQ(Recalled(memory, {Pair(3), Pair(4)}), Eigen::Vector2d(0, 9));
  memory.Keep(Rows({}), VectorXd());
  EXPECT_EQ(Recalled(memory, {Pair(3), Pair(4)}), Eigen::Vector2d(0, 0));
}

}  // namespace
}  // namespace mjcf_pdg::test
