// Which starts a search varies: their order, kinds and spreads, each made again beside it by the
// selections of start/ and the same random numbers, and compared to where its descent begins.
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "base/tuning.h"
#include "search/varied_starts.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

namespace tune = tuning::starts;

class VariedStartsTest : public MujocoTest {};

constexpr std::uint64_t kSeed = 7;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Options Seeded(const std::vector<std::string>& without) {
  Options options;
  options.seed = kSeed;
  options.without = without;
  return options;
}

// A search whose descents are told, and beside it a workspace in which each start is made again.
class Watched {
 public:
  Watched(const std::string& xml, const EffortPlan& effort, bool rays,
          const std::vector<std::string>& without = {})
      : scene(Scene::FromString(xml)),
        options(Seeded(without)),
        work(scene.tables(), options),
        trials(work),
        varied(work, trials),
        twin(scene.tables(), options),
        again(twin),
        random(kSeed),
        plan(effort),
        on_rays(rays) {
    work.Begin(ToEigen(scene.DefaultQpos()));
    twin.Begin(work.problem().q_in);
    recorder.Set([this](const Iteration& it) {
      if (it.step == 0 && on_start) on_start(it);
    });
    work.recorder = &recorder;
    center = work.problem().q_in;
    ClampToLimits(scene.tables(), center);
    overlaps = work.OverlapsAtInput();
    trials.Begin(plan, {.overlaps = overlaps}, 0.1, false);
    varied.Begin(plan, center, on_rays);
  }

  bool Direct() {
    trials.Try(center, Component::kDirect, LocalOptions{});
    return trials.HasFree();
  }
  double size() const { return scene.tables().size; }

  // What noise is measured by: √ of it is about how far answers are.
  double Sigma() {
    if (trials.HasFree()) return trials.BestSigma();
    if (!trials.outcome().has_overlap) return size() * size();
    return std::max(trials.outcome().least_overlap.sigma, std::pow(tune::kLeastNoise * size(), 2));
  }

  // Start `k` of the varied ones; none if a ray leads to nothing free.
  std::optional<VectorXd> Varied(int k, bool noise, bool hops, std::string& name) {
    constexpr Hop kKinds[] = {Hop::kFromBest, Hop::kFromInput, Hop::kMirrored};
    VectorXd q;
    if (hops && trials.HasFree() && (!noise || k % 3 == 1)) {
      again.ContactHop(trials.Best(), trials.BestSigma(), kKinds[(noise ? k / 3 : k) % 3], random,
                       q);
      name = "hop";
      ++hopped;
    } else {
      const double widened = trials.HasFree() ? 1.0 : 1.0 + tune::kWiderWhenBlind * k;
      again.Gaussian(center, Sigma(), widened * tune::kNoise[k % std::size(tune::kNoise)], random,
                     q);
      name = "noise";
    }
    return OnRay(q);
  }
  std::optional<VectorXd> OnRay(const VectorXd& q) {
    if (!on_rays) return q;
    VectorXd far;
    again.Beyond(center, q, tune::kRayEnd, far);
    const auto found = again.FirstFree(center, {&far, 1}, 5.0 * trials.BestSigma());
    if (found.empty()) return std::nullopt;
    EXPECT_TRUE(twin.Free(found[0].q));
    return found[0].q;
  }

  // From here on expects starts of TryUntilDone.
  void ExpectVaried(bool noise = true, bool hops = true) {
    next = 0;
    starts = 0;
    on_start = [this, noise, hops](const Iteration& it) {
      std::optional<VectorXd> q;
      std::string name;
      while (!q && next < 1000) q = Varied(next++, noise, hops, name);
      ASSERT_TRUE(q);
      EXPECT_EQ(it.start, name) << "start " << next - 1;
      Compare(it, *q);
    };
  }
  void Compare(const Iteration& it, const VectorXd& q) {
    ++starts;
    const VectorXd at = Eigen::Map<const VectorXd>(it.q.data(), q.size());
    EXPECT_LT((at - q).norm(), 1e-12) << it.start << " " << starts;
  }

  Scene scene;
  Options options;
  Workspace work;
  Recorder recorder;
  Trials trials;
  VariedStarts varied;
  Workspace twin;
  StartSelection again;
  mjcf_pdg::Random random;
  EffortPlan plan;
  bool on_rays;
  VectorXd center;
  std::vector<NearPair> overlaps;
  std::function<void(const Iteration&)> on_start;
  int next = 0, starts = 0, hopped = 0;
};

EffortPlan ByQueries(int queries) {
  return {.agree_over_bound = 1000.0,
          .agree = 1000,
          .queries = queries,
          .evaluations = kInfinity,
          .blind = 9};
}

// Two fingers on a carriage that overlap each other and a wall, and a free ball in a corner.
const char* const kFingers = R"(<mujoco><worldbody><geom size=".1" pos="5 5 5"/>
    <geom type="plane" size="0 0 1"/><geom type="box" size=".05 .3 .3" pos=".62 0 .3"/>
    <body pos=".4 .1 .25"><joint type="slide" axis="1 0 0" range="-.4 .4"/>
      <joint axis="0 0 1" range="-120 120"/><geom type="capsule" size=".03" fromto="0 0 0 .1 0 0"/>
      <body pos=".1 .05 0"><joint axis="0 0 1" range="-60 60"/>
        <geom type="capsule" size=".02" fromto=".03 0 0 .15 -.04 0"/></body>
      <body pos=".1 -.05 0"><joint axis="0 0 1" range="-60 60"/>
        <geom type="capsule" size=".02" fromto=".03 0 0 .15 .04 0"/></body></body>
    <body pos=".55 -.2 .05"><freejoint/><geom size=".08"/></body></worldbody></mujoco>)";

TEST_F(VariedStartsTest, NoiseAndHopsComeInTurnWithTheSpreadsOfTheBestAnswer) {
  Watched p(kFingers, ByQueries(1000), false);  // shared by its two trees
  ASSERT_TRUE(p.Direct());
  VectorXd mirrored;
  p.again.Mirrored(p.trials.Best(), mirrored);
  p.on_start = [&](const Iteration& it) {
    EXPECT_STREQ(it.start, "mirror");
    p.Compare(it, mirrored);
  };
  p.varied.TryMirror();
  EXPECT_EQ(p.starts, 1);
  const std::int64_t before = p.work.finder.queries();
  p.trials.RenewQueries();
  p.ExpectVaried();
  p.varied.TryUntilDone();
  EXPECT_GT(p.starts, 12);
  EXPECT_EQ(p.starts, p.next);
  EXPECT_EQ(p.hopped, (p.starts + 1) / 3);
  EXPECT_TRUE(p.trials.Done());
  EXPECT_GE(p.work.finder.queries() - before, 500);
}

TEST_F(VariedStartsTest, WhatIsLeftOutIsReplacedByTheOther) {
  for (const bool noise : {true, false}) {
    Watched p(kFingers, ByQueries(300), false, {noise ? "hop" : "noise"});
    p.ExpectVaried(noise, !noise);
    if (!noise) {
      p.varied.TryUntilDone();
      EXPECT_EQ(p.starts, 0) << "there is nothing to hop from";
    }
    p.on_start = nullptr;
    ASSERT_TRUE(p.Direct());
    p.ExpectVaried(noise, !noise);
    p.varied.TryUntilDone();
    EXPECT_GT(p.starts, 5);
    EXPECT_EQ(p.hopped, noise ? 0 : p.starts);
  }
}

TEST_F(VariedStartsTest, OnRaysEachStartIsTheFirstFreeOne) {
  Watched p(kFingers, ByQueries(1500), true);
  ASSERT_TRUE(p.Direct());
  p.ExpectVaried();
  p.varied.TryUntilDone();
  EXPECT_GT(p.starts, 3);
  EXPECT_GT(p.hopped, 1);
}

// A ball that is too thick for its gap: nothing is free on the line that it can move along.
const char* const kPinched = R"(<mujoco><worldbody><geom size=".1" pos="5 5 5"/>
    <geom type="box" size="3 1 .1" pos="0 0 .18"/><geom type="box" size="3 1 .1" pos="0 0 -.18"/>
    <body pos=".1 0 0"><joint type="slide" axis="1 0 0" range="-2 2.5" ref=".3"/>
      <joint type="slide" axis="0 0 1" range="-.1 .1"/><geom size=".1"/></body>
    </worldbody></mujoco>)";

TEST_F(VariedStartsTest, WhileNothingIsFreeNoiseWidensAndEnds) {
  for (const bool first : {true, false}) {
    Watched p(kPinched, ByQueries(100000), false);
    EXPECT_FALSE(first && p.Direct());
    p.ExpectVaried();
    p.varied.TryUntilDone();
    EXPECT_EQ(p.starts, p.plan.blind);
    EXPECT_EQ(p.hopped, 0);
    EXPECT_FALSE(p.trials.HasFree());
    // Then anywhere, by the random numbers that follow.
    p.starts = 0;
    p.on_start = [&p](const Iteration& it) {
      VectorXd q;
      p.again.Uniform(p.center, p.random, q);
      EXPECT_STREQ(it.start, "anywhere");
      p.Compare(it, q);
    };
    p.varied.TryAnywhere();
    EXPECT_EQ(p.starts, p.plan.blind);
  }
}

TEST_F(VariedStartsTest, NothingIsTriedWhenTheBudgetIsSpent) {
  Watched p(kFingers, ByQueries(300), false);
  ASSERT_TRUE(p.Direct());
  p.work.budget.Begin({.queries = 40}, BudgetMeter::Clock::now(), p.work.finder.queries());
  p.ExpectVaried();
  p.varied.TryUntilDone();
  EXPECT_GT(p.starts, 0);
  EXPECT_FALSE(p.trials.Done());
  EXPECT_EQ(p.work.budget.Left(p.work.finder.queries()), 0);
  const int starts = p.starts;
  p.varied.TryUntilDone();
  p.varied.TryMirror();
  p.varied.TryAnywhere();
  p.varied.TryTranslations(p.overlaps);
  EXPECT_EQ(p.starts, starts);
}

// A box in a box whose top alone is open to it: translations are tried until one is free.
TEST_F(VariedStartsTest, TranslationsAreTriedUntilOneLeadsToSomethingFree) {
  Watched p(R"(<mujoco><worldbody><geom size=".1" pos="5 5 5"/>
      <geom type="box" size=".4 .4 .4"/><geom type="box" size=".1 .5 .5" pos="1.2 0 0"/>
      <body pos=".2 .05 0"><joint type="slide" axis="1 0 0"/>
        <joint type="slide" axis="0 1 0" range="-.1 .1"/><geom type="box" size=".2 .2 .1"/></body>
      </worldbody></mujoco>)",
            ByQueries(1000), false);
  int descents = 0;
  p.on_start = [&](const Iteration& it) {
    EXPECT_STREQ(it.start, "constrained_translation");
    EXPECT_FALSE(p.trials.HasFree());
    ++descents;
  };
  p.varied.TryTranslations(p.overlaps);
  EXPECT_TRUE(p.trials.HasFree());
  EXPECT_GT(descents, 0);
  EXPECT_EQ(p.trials.outcome().free[0].start, Component::kConstrainedTranslation);
}

}  // namespace
}  // namespace mjcf_pdg::test
