// When a search ends and what its trials keep, by slow models of what the headers say.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "base/tuning.h"
#include "search/stopping_rule.h"
#include "search/trials.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

class StoppingRuleTest : public MujocoTest {};

constexpr double kInfinity = std::numeric_limits<double>::infinity();

const char* const kBalls = R"(<mujoco><worldbody><geom size=".1" pos="5 5 5"/>
    <geom type="plane" size="0 0 1"/><body pos="1 0 .1"><freejoint/><geom size=".12"/></body>
    <body pos="1 .2 .1"><joint type="slide" axis="0 1 0"/><geom type="ellipsoid" size=".1 .1 .1"/>
    </body></worldbody></mujoco>)";

// What is asked of a rule, and the workspace whose counts it reads.
struct Asked {
  explicit Asked(const EffortPlan& effort)
      : work(scene.tables(), options), rule(work), plan(effort) {
    work.Begin(ToEigen(scene.DefaultQpos()));
    Query(3);  // what was before the search does not count
  }
  void Begin(double bound, double depth, bool meshes, int distances = 10) {
    rule.Begin(plan,
               {.overlaps = overlaps,
                .distances_at_input = distances,
                .sigma_lower_bound = bound,
                .tighten = tighten},
               depth, meshes);
  }
  void Query(int count) {
    work.finder.Pose(work.problem().q_in);
    for (int k = 0; k < count; ++k) work.finder.Find(0.01);
  }

  Scene scene = Scene::FromString(kBalls);
  Options options;
  Workspace work;
  StoppingRule rule;
  EffortPlan plan;
  std::vector<NearPair> overlaps;
  std::function<double(double)> tighten;
};

LocalResult Ended(bool free, double sigma, bool known = false) {
  LocalResult result;
  result.free = free;
  result.sigma = sigma;
  result.reached_known = known;
  return result;
}

LocalResult GivenUp() {
  LocalResult result;
  result.hopeless = true;
  return result;
}

EffortPlan NeverByCounts() {
  return {.agree_over_bound = 2.0, .agree = 6, .queries = 1 << 30, .evaluations = kInfinity};
}

TEST_F(StoppingRuleTest, AProvenAnswerEndsTheSearchAndOnlyThat) {
  Asked p(NeverByCounts());
  p.Begin(2.0, 0.1, false);
  EXPECT_TRUE(p.rule.Done(2.0, 0));
  EXPECT_TRUE(p.rule.Done(2.0199, 0));
  EXPECT_FALSE(p.rule.Done(2.0201, 0));
  p.Begin(0.0, 0.1, false);
  EXPECT_FALSE(p.rule.Done(1e-12, 0));
  EXPECT_TRUE(p.rule.Done(0.0, 0));
}

// Starts that agree are counted by a list of all of them.
TEST_F(StoppingRuleTest, ASearchEndsWhenEnoughIndependentStartsAgree) {
  Random rng(1);
  constexpr Component kStarts[] = {Component::kDirect, Component::kNoise, Component::kHop,
                                   Component::kConstrainedTranslation, Component::kMirror};
  int ended = 0, ended_early = 0, waited = 0;
  for (int search = 0; search < 400; ++search) {
    Asked p(NeverByCounts());
    const double bound = rng.Chance(0.5) ? 0.0 : rng.Uniform(0.1, 0.4);
    p.Begin(bound, 0.1, false);
    double best = kInfinity;
    int agree = 0;
    for (int k = 0; k < 15; ++k) {
      const Component start = kStarts[rng.Index(5)];
      const double levels[] = {1.0, 1.005, 1.02, 0.995, 2.0, 0.95};
      const LocalResult result =
          Ended(rng.Chance(0.8), (best < kInfinity ? best : 1.5) * levels[rng.Index(6)],
                best < kInfinity && rng.Chance(0.1));
      p.rule.Count(result, start, best);
      const bool hop = start == Component::kHop;
      if (result.free && result.sigma < best / 1.01) {
        agree = hop ? 0 : 1;
      } else if (result.reached_known || (result.free && result.sigma <= 1.01 * best)) {
        agree += !hop && start != Component::kConstrainedTranslation;
      }
      if (result.free) best = std::min(best, result.sigma);
      if (best == kInfinity || best <= 1.01 * bound) continue;
      int enough = 6;
      if (bound > 0.0)
        enough = std::min(6, static_cast<int>(std::ceil(2.0 * std::sqrt(best / bound))));
      ASSERT_EQ(p.rule.Done(best, 0), agree >= enough) << agree << " of " << enough;
      ended += agree >= enough;
      ended_early += agree >= enough && agree < 6;
      waited += agree < enough && agree >= 2;
    }
    p.Begin(bound, 0.1, false);
    EXPECT_FALSE(p.rule.Done(1e9, 0)) << "a new search begins without agreement";
  }
  EXPECT_GT(ended, 100);
  EXPECT_GT(ended_early, 50);
  EXPECT_GT(waited, 50);
}

// Six starts that were given up count as one that agrees. Those before the best answer do not, and
// neither do hops and translations.
TEST_F(StoppingRuleTest, StartsThatAreGivenUpCountASixth) {
  Asked p(NeverByCounts());
  for (const int agree : {1, 2, 5}) {
    p.Begin(0.0, 0.1, false);
    p.rule.Count(Ended(true, 2.0), Component::kDirect, kInfinity);
    for (int k = 0; k < 30; ++k) p.rule.Count(GivenUp(), Component::kNoise, 2.0);
    p.rule.Count(Ended(true, 1.0), Component::kNoise, 2.0);
    for (int k = 1; k < agree; ++k) p.rule.Count(Ended(true, 1.0), Component::kNoise, 1.0);
    for (int k = 0; k < 99; ++k) {
      p.rule.Count(GivenUp(), Component::kHop, 1.0);
      p.rule.Count(GivenUp(), Component::kConstrainedTranslation, 1.0);
    }
    int given_up = 0;
    for (; !p.rule.Done(1.0, 0) && given_up < 99; ++given_up) {
      p.rule.Count(GivenUp(), Component::kNoise, 1.0);
    }
    EXPECT_EQ(given_up, 6 * (6 - agree));
  }
}

// How many starts must agree on `best` where the bound is 1.
int Needed(Asked& p, double best) {
  p.Begin(1.0, 0.1, false);
  int agree = 0;
  for (double before = kInfinity; !p.rule.Done(best, 0); before = best, ++agree) {
    p.rule.Count(Ended(true, best), Component::kNoise, before);
  }
  return agree;
}

TEST_F(StoppingRuleTest, TheFartherAnAnswerIsAboveItsBoundTheMoreStartsMustAgree) {
  Asked p(PlanFor(Effort::kDefault));
  EXPECT_EQ(Needed(p, 1.009), 0);
  EXPECT_EQ(Needed(p, std::pow(1.499, 2)), 3);
  EXPECT_EQ(Needed(p, std::pow(1.501, 2)), 4);
  EXPECT_EQ(Needed(p, std::pow(2.499, 2)), 5);
  EXPECT_EQ(Needed(p, std::pow(3.499, 2)), 7);
  EXPECT_EQ(Needed(p, 1e6), 7);
  p.plan = PlanFor(Effort::kMax);
  EXPECT_EQ(Needed(p, std::pow(1.249, 2)), 5);
  EXPECT_EQ(Needed(p, 1e6), 12);
  p.plan = PlanFor(Effort::kFast);
  p.plan.queries = 1 << 30;
  EXPECT_EQ(Needed(p, 1e6), 1);
}

// Not before two starts agree on an answer, and once for each answer that they agree on.
TEST_F(StoppingRuleTest, ATighterBoundIsAskedForWhenStartsAgree) {
  Asked p(NeverByCounts());
  std::vector<double> asked;
  p.tighten = [&](double sigma) {
    asked.push_back(sigma);
    return sigma == 1.0 ? 0.6 : sigma;
  };
  p.Begin(0.01, 0.1, false);
  p.rule.Count(Ended(true, 2.0), Component::kNoise, kInfinity);
  EXPECT_FALSE(p.rule.Done(2.0, 0));
  p.rule.Count(Ended(true, 1.0), Component::kNoise, 2.0);
  EXPECT_FALSE(p.rule.Done(1.0, 0));
  EXPECT_TRUE(asked.empty());
  p.rule.Count(Ended(true, 1.0), Component::kNoise, 1.0);
  EXPECT_FALSE(p.rule.Done(1.0, 0)) << "twice the root of 1 / 0.6 is more than 2";
  EXPECT_FALSE(p.rule.Done(1.0, 0));
  EXPECT_EQ(asked, std::vector<double>({1.0}));
  p.rule.Count(Ended(true, 1.0), Component::kNoise, 1.0);
  EXPECT_TRUE(p.rule.Done(1.0, 0)) << "the bound is 0.6 now";
  p.rule.Count(Ended(true, 0.8), Component::kNoise, 1.0);
  EXPECT_FALSE(p.rule.Done(0.8, 0));
  p.rule.Count(Ended(true, 0.8), Component::kNoise, 0.8);
  EXPECT_TRUE(p.rule.Done(0.8, 0)) << "twice the root of 0.8 / 0.8 is 2";
  EXPECT_EQ(asked, std::vector<double>({1.0, 0.8}));
}

// The scene's two trees share the queries.
TEST_F(StoppingRuleTest, QueriesCountFromTheBeginOfTheSearchOrItsRenewal) {
  Asked p({.agree_over_bound = 99.0, .agree = 99, .queries = 20, .evaluations = kInfinity});
  p.Begin(0.0, 0.1, false);
  for (int round = 0; round < 2; ++round) {
    p.Query(9);
    EXPECT_FALSE(p.rule.Done(1.0, 0));
    p.Query(1);
    EXPECT_TRUE(p.rule.Done(1.0, 0));
    p.rule.RenewQueries();
    EXPECT_FALSE(p.rule.Done(1.0, 0));
  }
}

TEST_F(StoppingRuleTest, TheEstimatedTimeCountsQueriesDistancesAndLcpStepsFromTheFirstFree) {
  namespace tune = tuning::stopping;
  for (const int distances : {0, 2, 7, 20}) {
    Asked p({.agree_over_bound = 99.0, .agree = 99, .queries = 1 << 30, .evaluations = 20.0});
    p.Begin(0.0, 0.1, false, distances);
    p.Query(30);
    p.rule.FirstFree(500);
    const std::int64_t before = p.work.finder.distances();
    p.Query(11);
    const auto measured = static_cast<double>(p.work.finder.distances() - before);
    ASSERT_GE(measured, 11);
    const double per = std::max(4, distances), n = p.scene.dof();
    // The fewest LCP steps that fill the rest of the time.
    const double rest = 20.0 - tune::kPerQuery * 11 - tune::kPerDistance * measured / per;
    const auto steps =
        static_cast<std::int64_t>(std::ceil(rest * per / (n * tune::kPerStepAndDof)));
    ASSERT_GT(steps, 10);
    EXPECT_FALSE(p.rule.Done(1.0, 500 + steps - 1)) << distances;
    EXPECT_TRUE(p.rule.Done(1.0, 500 + steps + 1)) << distances;
  }
}

TEST_F(StoppingRuleTest, OverlappingMeshesHaveMoreQueriesWhileTheAnswerIsVeryFar) {
  namespace tune = tuning::exact_meshes;
  Asked p({.agree_over_bound = 99.0, .agree = 99, .queries = 10, .evaluations = 0.0});
  p.Begin(0.0, 0.2, true);
  const double far = std::pow(1.01 * tune::kVeryFar * 0.2, 2);
  p.Query(static_cast<int>(tune::kQueries * 10) - 1);
  EXPECT_FALSE(p.rule.Done(1.0, 0));
  p.Query(1);
  EXPECT_TRUE(p.rule.Done(1.0, 0));
  EXPECT_FALSE(p.rule.Done(far, 0));
  p.Query(static_cast<int>((tune::kQueriesVeryFar - tune::kQueries) * 10) - 1);
  EXPECT_FALSE(p.rule.Done(far, 0));
  p.Query(1);
  EXPECT_TRUE(p.rule.Done(far, 0));
  for (const double depths : {1.0, 2.5}) {
    EXPECT_TRUE(p.rule.Exceeds(depths, std::pow(1.001 * depths * 0.2, 2)));
    EXPECT_FALSE(p.rule.Exceeds(depths, std::pow(0.999 * depths * 0.2, 2)));
    EXPECT_TRUE(p.rule.Exceeds(depths, kInfinity));
  }
}

// ---- Trials ----

// Each start descends again beside the trials, by the options that these promise.
TEST_F(StoppingRuleTest, TrialsKeepWhatTheirDescentsFind) {
  Random rng(2);
  int free = 0, overlapping = 0, hopeless = 0, known = 0;
  for (int scene_number = 0; scene_number < 6; ++scene_number) {
    const Scene scene = Scene::FromString(RandomRobotXml(rng, {.bodies = 5, .obstacles = 8}));
    Options options;
    if (scene_number % 3 == 2) options.without = {"early_exit"};
    Workspace work(scene.tables(), options), twin(scene.tables(), options);
    Trials trials(work);
    LocalOptimization local(twin);
    const VectorXd q_in = RandomConfiguration(scene, rng);
    work.Begin(q_in), twin.Begin(q_in);
    const std::vector<NearPair> overlaps;
    trials.Begin({}, {.overlaps = overlaps}, 0.1, false);
    std::vector<LocalResult> all;
    int iterations = 0;
    for (int k = 0; k < 10; ++k) {
      LocalOptions how = Coarse();
      how.max_iterations = 4 + 6 * (k % 3);
      LocalResult const* best = nullptr;
      for (const LocalResult& result : all) {
        if (result.free && (!best || result.sigma < best->sigma)) best = &result;
      }
      EXPECT_EQ(trials.HasFree(), best != nullptr);
      EXPECT_EQ(trials.BestSigma(), best ? best->sigma : kInfinity);
      const VectorXd q = RandomConfiguration(scene, rng);
      LocalOptions bounded = how;
      if (best && scene_number % 3 != 2) {
        bounded.give_up_sigma = tuning::starts::kGiveUp * best->sigma;
        bounded.known = &best->q;
        bounded.known_sigma = best->sigma;
      }
      const LocalResult result = local.Run(q, bounded);
      EXPECT_EQ(trials.Try(q, Component::kNoise, how), !result.hopeless);
      all.push_back(result);
      iterations += result.iterations;
      hopeless += result.hopeless;
      known += result.reached_known;
    }
    const Outcome& outcome = trials.outcome();
    EXPECT_EQ(outcome.starts, 10);
    EXPECT_EQ(outcome.iterations, iterations);
    std::vector<double> sigmas;
    double least_violation = kInfinity, least_sigma = kInfinity;
    for (const LocalResult& result : all) {
      if (result.free) sigmas.push_back(result.sigma);
      if (result.free) continue;
      least_violation = std::min(least_violation, result.violation);
      if (!result.hopeless) least_sigma = std::min(least_sigma, result.sigma);
      ++overlapping;
    }
    std::sort(sigmas.begin(), sigmas.end());
    ASSERT_EQ(outcome.free.size(), sigmas.size());
    for (std::size_t k = 0; k < sigmas.size(); ++k) {
      EXPECT_EQ(outcome.free[k].sigma, sigmas[k]);
      EXPECT_EQ(twin.norm.Sigma(outcome.free[k].q), sigmas[k]);
    }
    free += static_cast<int>(sigmas.size());
    EXPECT_EQ(outcome.has_overlap, least_violation < kInfinity);
    EXPECT_EQ(outcome.nearest_overlap.sigma, least_sigma);
    for (const LocalResult& result : all) {
      if (result.free || result.violation != least_violation) continue;
      EXPECT_EQ(outcome.least_violation, result.violation);
      EXPECT_EQ(outcome.least_overlap.q, result.q);
      EXPECT_EQ(outcome.least_overlap.sigma, result.sigma);
      break;
    }
    if (!trials.HasFree()) continue;
    Candidate candidate = outcome.free[outcome.free.size() - 1];
    const LocalResult polished = local.Run(candidate.q, LocalOptions::Polishing());
    const double before = candidate.sigma;
    const bool nearer = polished.free && polished.sigma < before;
    EXPECT_EQ(trials.Polish(candidate), nearer);
    EXPECT_EQ(candidate.sigma, nearer ? polished.sigma : before);
    EXPECT_EQ(outcome.iterations, iterations + polished.iterations);
    EXPECT_EQ(twin.norm.Sigma(candidate.q), candidate.sigma);
  }
  EXPECT_GT(free, 10);
  EXPECT_GT(overlapping, 3);
  EXPECT_GT(hopeless + known, 5);
}

TEST_F(StoppingRuleTest, WithoutBudgetATrialIsMadeOnlyIfThereIsNone) {
  for (const bool needed : {true, false}) {
    Asked p({});
    Trials trials(p.work);
    trials.Begin({}, {.overlaps = p.overlaps}, 0.1, false);
    if (!needed) trials.NeedNoStart();
    p.work.budget.Begin({.queries = 1}, BudgetMeter::Clock::now(), p.work.finder.queries());
    p.Query(1);
    ASSERT_TRUE(trials.Spent());
    EXPECT_EQ(trials.Try(p.work.problem().q_in, Component::kDirect, {}), needed);
    EXPECT_EQ(trials.outcome().starts, needed ? 1 : 0);
    EXPECT_FALSE(trials.Try(p.work.problem().q_in, Component::kNoise, {}));
    EXPECT_EQ(trials.outcome().starts, needed ? 1 : 0);
    trials.Begin({}, {.overlaps = p.overlaps}, 0.1, false);
    EXPECT_TRUE(trials.Try(p.work.problem().q_in, Component::kNoise, {})) << "a search of its own";
  }
}

// From q_in, which is easy, every start ends at the same answer.
TEST_F(StoppingRuleTest, TrialsEndWhenStartsAgreeOrTheTimeSinceTheFirstFreeIsSpent) {
  for (const double evaluations : {kInfinity, 20.0}) {
    Asked p({.agree_over_bound = 99.0,
             .agree = evaluations < kInfinity ? 99 : 3,
             .queries = 1 << 30,
             .evaluations = evaluations});
    p.Query(200);
    Trials trials(p.work);
    trials.Begin(p.plan, {.overlaps = p.overlaps, .distances_at_input = 10}, 0.1, false);
    int starts = 0;
    for (; !trials.Done() && starts < 50; ++starts) {
      trials.Try(p.work.problem().q_in, Component::kNoise, {});
      EXPECT_TRUE(trials.HasFree());
    }
    EXPECT_EQ(starts == 3, evaluations == kInfinity) << starts;
    EXPECT_GT(starts, 2);
    EXPECT_LT(starts, 50);
  }
}

TEST_F(StoppingRuleTest, CandidatesAreTheNearestInOrderOldOnesFirst) {
  Random rng(3);
  Candidates candidates;
  candidates.Reserve(1);
  std::vector<std::pair<double, int>> all;
  for (int k = 0; k < 60; ++k) {
    const double sigma = rng.Index(12);
    candidates.Insert(VectorXd::Constant(1, k), sigma, Component::kHop);
    all.push_back({sigma, k});
    std::sort(all.begin(), all.end());
    ASSERT_EQ(candidates.size(), std::min(all.size(), Candidates::kSlots));
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      EXPECT_EQ(candidates[i].sigma, all[i].first);
      EXPECT_EQ(candidates[i].q[0], all[i].second);
    }
    if (all.size() > Candidates::kSlots) all.resize(Candidates::kSlots);
  }
}

}  // namespace
}  // namespace mjcf_pdg::test
