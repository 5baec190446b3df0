// Budgets of queries and of seconds: how far a solve may go beyond them, what it then returns, and
// how it says why. What they cost in time is measured by bench/budget_bench.
#include <gmock/gmock.h>

#include <cmath>

#include "mjcf_pdg/object_norm.h"
#include "mjcf_pdg/pdg.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

using Q = std::vector<double>;

class BudgetTest : public MujocoTest {
 protected:
  // Random robots, each at configurations that overlap and with one that is free.
  struct Case {
    Scene scene;
    Q q_free = {};
    std::vector<Q> overlapping = {};
  };
  std::vector<Case> RandomCases() {
    std::vector<Case> cases;
    while (cases.size() < 6) {
      Case made{.scene = Scene::FromString(RandomRobotXml(rng_, {.free_base = rng_.Chance(0.5)}))};
      Solver solver(made.scene);
      for (int k = 0; k < 40 && made.overlapping.size() < 8; ++k) {
        const Q q = ToVector(RandomConfiguration(made.scene, rng_));
        if (solver.IsFree(q)) continue;
        const Result result = solver.Solve(q);
        if (result.status != Status::kSolved) continue;
        made.overlapping.push_back(q);
        made.q_free = result.q;
      }
      if (made.overlapping.size() == 8) cases.push_back(std::move(made));
    }
    return cases;
  }

  Random rng_{2211};
};

// A box as deep in the ground as it is large, which three queries do not bring out and up.
const char kBuried[] = R"(<mujoco><worldbody><geom type="plane" size="0 0 1"/>
    <body pos="0 0 -.1"><freejoint/><geom type="box" size=".1 .1 .1"/></body>
    </worldbody></mujoco>)";

// After the budget come: the last step's query, the one that verifies the answer or finds that it
// is none, and, where there is none, those that tell how deep q_in and what is returned overlap.
TEST_F(BudgetTest, QueriesEndTheSearchOneStepAfterTheBudget) {
  int spent = 0;
  for (const Case& c : RandomCases()) {
    Solver solver(c.scene);
    for (const Q& q : c.overlapping) {
      const int all = solver.Solve(q).stats.collision_queries;
      for (const int budget : {1, 3, 10, 30}) {
        solver.SetBudget({.queries = budget});
        const Result result = solver.Solve(q);
        const int after = result.status == Status::kSolved ? 2 : 5;
        EXPECT_LE(result.stats.collision_queries, budget + after) << all;
        spent += all > budget + after;
        EXPECT_EQ(solver.Solve(q).q, result.q) << "the same budget leads to the same answer";
      }
      solver.SetBudget({});
      EXPECT_EQ(solver.Solve(q).stats.collision_queries, all) << "no budget: as before";
    }
  }
  EXPECT_GT(spent, 60) << "solves that would have taken more";
}

// The search on hulls, which comes first where several links of triangles overlap, has its share in
// the budget.
TEST_F(BudgetTest, QueriesOfTheHullStageCount) {
  const Scene scene = Scene::FromFile(std::string(MJCF_PDG_MODEL_DIR) + "/hand/hand_bottle.xml",
                                      {.exact_mesh = true});
  Solver solver(scene);
  int spent = 0;
  for (std::size_t key = 0; key < scene.KeyNames().size(); ++key) {
    for (const int budget : {20, 100}) {
      solver.SetBudget({.queries = budget});
      const Result result = solver.Solve(scene.KeyQpos(static_cast<int>(key)));
      EXPECT_LE(result.stats.collision_queries, budget + 6) << key;
      spent += result.stats.collision_queries >= budget;
    }
  }
  EXPECT_GT(spent, 10);
}

// The paper's method looks at its budget between configurations too: while it perturbs, projects
// and corrects. The translations of one selection, and the samples of a projection, are whole
// steps.
TEST_F(BudgetTest, QueriesEndThePapersMethodToo) {
  int spent = 0;
  for (const Case& c : RandomCases()) {
    for (const Q& q : c.overlapping) {
      Solver all(c.scene, {.method = Method::kPaper});
      const int unbounded = all.Solve(q).stats.collision_queries;
      for (const int budget : {1, 3, 10, 30}) {
        Solver solver(c.scene, {.method = Method::kPaper});
        solver.SetBudget({.queries = budget});
        const Result result = solver.Solve(q);
        EXPECT_LE(result.stats.collision_queries, budget + 6) << unbounded;
        spent += unbounded > budget + 6;
      }
    }
  }
  EXPECT_GT(spent, 60) << "solves that would have taken more";
}

TEST_F(BudgetTest, WhatIsCalledSolvedIsFreeAndTheRestSaysWhy) {
  int solved = 0, unsolved = 0;
  for (const Case& c : RandomCases()) {
    Solver solver(c.scene);
    for (const Q& q : c.overlapping) {
      for (const int budget : {1, 4, 12}) {
        solver.SetBudget({.queries = budget});
        const Result result = solver.Solve(q);
        if (result.status == Status::kSolved) {
          ++solved;
          EXPECT_TRUE(Verify(c.scene, result.q).free);
          EXPECT_EQ(result.cause, Cause::kNone);
        } else {
          ++unsolved;
          EXPECT_EQ(result.cause, Cause::kBudget) << result.reason;
          EXPECT_THAT(result.reason, HasSubstr("budget spent"));
        }
      }
    }
  }
  EXPECT_GT(solved, 10);
  EXPECT_GT(unsolved, 10);
}

TEST_F(BudgetTest, AFreeHintIsNeverThrownAway) {
  int solves = 0;
  for (const Case& c : RandomCases()) {
    Solver solver(c.scene);
    for (const Q& q : c.overlapping) {
      solver.SetHint(c.q_free);
      const double of_hint = ObjectNorm(c.scene, Metric::kSequential, q).Sigma(c.q_free);
      for (const Budget budget :
           {Budget{.queries = 1}, Budget{.queries = 4}, Budget{.queries = 20},
            Budget{.queries = 0, .seconds = 1e-9}, Budget{.queries = 0, .seconds = 3e-4}}) {
        solver.SetBudget(budget);
        const Result result = solver.Solve(q);
        ASSERT_EQ(result.status, Status::kSolved) << budget.queries << " " << budget.seconds;
        EXPECT_TRUE(Verify(c.scene, result.q).free);
        EXPECT_LE(result.sigma, of_hint * (1.0 + 1e-9)) << "no farther than the hint";
        ++solves;
      }
    }
  }
  EXPECT_EQ(solves, 6 * 8 * 5);
}

TEST_F(BudgetTest, AReasonNamesTheBudgetThatEndedTheSearch) {
  const Scene scene = Scene::FromString(kBuried);
  Options options;
  options.time_limit = 1e6;  // finite, and never reached
  Solver solver(scene, options);
  EXPECT_EQ(solver.Solve(scene.DefaultQpos()).status, Status::kSolved);
  solver.SetBudget({.queries = 1, .seconds = 1e6});
  const Result queries = solver.Solve(scene.DefaultQpos());
  ASSERT_EQ(queries.status, Status::kUnsolved);
  EXPECT_EQ(queries.cause, Cause::kBudget);
  EXPECT_THAT(queries.reason, HasSubstr("budget spent"));
  EXPECT_THAT(queries.reason, Not(HasSubstr("time limit")));
  solver.SetBudget({.queries = 0, .seconds = 1e-9});
  const Result seconds = solver.Solve(scene.DefaultQpos());
  ASSERT_EQ(seconds.status, Status::kUnsolved);
  EXPECT_EQ(seconds.cause, Cause::kBudget);
  EXPECT_THAT(seconds.reason, HasSubstr("time limit reached"));
}

TEST_F(BudgetTest, BudgetsThatMeanNothingAreRefused) {
  const Scene scene = Scene::FromString(kBuried);
  Solver solver(scene);
  EXPECT_THAT(ErrorOf([&] { solver.SetBudget({.queries = -1}); }), HasSubstr("queries"));
  EXPECT_THAT(ErrorOf([&] { solver.SetBudget({.queries = 0, .seconds = -1.0}); }),
              HasSubstr("seconds"));
  EXPECT_THAT(ErrorOf([&] { solver.SetBudget({.queries = 0, .seconds = std::nan("")}); }),
              HasSubstr("seconds"));
  EXPECT_EQ(solver.Solve(scene.DefaultQpos()).status, Status::kSolved) << "the old one holds";
}

}  // namespace
}  // namespace mjcf_pdg::test
