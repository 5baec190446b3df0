// A few hundred of the cases that the target `fuzz` runs by the thousand.
#include <gtest/gtest.h>

#include <map>
#include <string>

#include "mjcf_pdg/pdg.h"
#include "tests/fuzz/cases.h"
#include "tests/fuzz/judge.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

// Runs the cases of `count` seeds and returns how many were of each kind.
std::map<std::string, int> RunCases(CaseOutcome (*run)(std::uint64_t), int count) {
  const QuietMujoco quiet;
  std::map<std::string, int> kinds;
  for (int seed = 1; seed <= count; ++seed) {
    const CaseOutcome outcome = run(static_cast<std::uint64_t>(seed));
    EXPECT_EQ(outcome.wrong, "") << "seed " << seed;
    ++kinds[outcome.kind];
  }
  return kinds;
}

TEST(FuzzTest, VerdictsOnRandomModelsAreFiniteAndNotFalselyFree) {
  std::map<std::string, int> kinds = RunCases(VerdictCase, 300);
  EXPECT_GT(kinds["free"], 30);
  EXPECT_GT(kinds["not free"], 100);
  EXPECT_EQ(kinds["refused"], 0);  // all are models that may be, of 1e-4 to 1e4 m
}

TEST(FuzzTest, SolvesOfRandomModelsAreFiniteAndNotFalselyFree) {
  std::map<std::string, int> kinds = RunCases(SolvingCase, 80);
  EXPECT_GT(kinds["solved"], 25);
  EXPECT_GT(kinds["already free"], 5);
}

#ifdef MJCF_PDG_HAVE_PLAN
TEST(FuzzTest, PathsOfRandomModelsAreFree) {
  std::map<std::string, int> kinds = RunCases(PlanningCase, 40);
  EXPECT_GT(kinds["found"], 10);
}

// A connect that can be met in two ways: the trees grew on the spot.
TEST(FuzzTest, TreesOnTwoSidesOfAConstraintDoNotGrowWithoutEnd) {
  const QuietMujoco quiet;
  EXPECT_EQ(PlanningCase(5139).wrong, "");
  EXPECT_EQ(PlanningCase(4904).wrong, "");
}
#endif

TEST(FuzzTest, DamagedFilesAreReadAsNumbersOrRefused) {
  std::map<std::string, int> kinds = RunCases(BytesCase, 400);
  EXPECT_GT(kinds["refused"], 100);
  EXPECT_GT(kinds["model"], 20);
  EXPECT_GT(kinds["rows"], 30);
  EXPECT_GT(kinds["mesh"], 2);
}

// The judge must be able to say no, and to be told a plane that it would not find.
TEST(FuzzTest, TheJudgeSeesOverlapsLimitsAndConstraints) {
  const ModelPtr m = LoadModel(R"(<mujoco><worldbody><geom type="box" size=".1 .1 .1"/>
    <body pos="0 0 .2"><joint name="a" type="slide" axis="0 0 1" range="-1 1"/>
      <geom type="cylinder" size=".05 .1"/></body>
    <body pos="1 0 0"><joint name="b" type="slide" axis="0 0 1"/><geom size=".1"/></body></worldbody>
    <equality><joint joint1="b" joint2="a" polycoef="0 2 0 0 0"/></equality></mujoco>)");
  Judge judge(*m);
  const auto none = [](int, int) -> Eigen::Vector3d { return Eigen::Vector3d::Zero(); };
  EXPECT_EQ(judge.Refute({0.0, 0.0}, 1e-6, none), "");
  EXPECT_EQ(judge.Refute({0.5, 1.0}, 1e-6, none), "");
  EXPECT_NE(judge.Refute({-2e-6, -4e-6}, 1e-6, none), "");  // the box and the cylinder
  EXPECT_NE(judge.Refute({1.1, 2.2}, 1e-6, none), "");      // beyond its range
  EXPECT_NE(judge.Refute({0.5, 1.00001}, 1e-6, none), "");  // the coupling
}

}  // namespace
}  // namespace mjcf_pdg::test
