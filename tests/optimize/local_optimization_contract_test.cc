// What a local optimization returns, told by an observer of all its steps: the best of what it met,
// within its steps, its trust radius and its patience; and how it goes on where it stands.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "base/tuning.h"
#include "optimize/local_optimization.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

namespace tune = tuning::descent;

class LocalOptimizationContractTest : public MujocoTest {};

struct Met {
  VectorXd q;
  double sigma, violation;
  bool free;
  double largest_multiplier;
};

struct Watched {
  explicit Watched(const Scene& of, const Options& user_options = {})
      : scene(of), options(user_options), work(scene.tables(), options), local(work) {
    recorder.Set([this](const Iteration& it) {
      EXPECT_EQ(it.step, static_cast<int>(met.size()));
      Met one{Eigen::Map<const VectorXd>(it.q.data(), static_cast<int>(it.q.size())), it.sigma,
              it.violation, it.free, 0.0};
      for (const ObservedRow& row : it.rows) {
        if (row.geom[0] < 0) continue;
        one.largest_multiplier = std::max(one.largest_multiplier, row.multiplier);
      }
      met.push_back(one);
    });
    work.recorder = &recorder;
  }
  const LocalResult& Run(const VectorXd& q, const LocalOptions& how) {
    met.clear();
    return local.Run(q, how);
  }
  // Σ over the pairs of what they are too near by, and the largest, both beyond `allowed` [m].
  std::pair<double, double> Overlaps(const VectorXd& q, double allowed) {
    const Problem& problem = work.problem();
    ContactFinder finder(scene.tables(), problem.clearance);
    finder.Pose(q);
    double sum = 0.0, most = 0.0;
    for (const NearPair& near : finder.Find(problem.clearance + 0.01)) {
      if (!scene.tables().pairs[near.pair].moves) continue;
      const double excess = problem.required[near.pair] - near.distance - allowed;
      sum += std::max(0.0, excess);
      most = std::max(most, excess);
    }
    return {sum, most};
  }

  const Scene& scene;
  Options options;
  Workspace work;
  Recorder recorder;
  LocalOptimization local;
  std::vector<Met> met;
};

// The one with the least σ of those that are free; null if none is.
const Met* BestFree(const std::vector<Met>& met) {
  const Met* best = nullptr;
  for (const Met& one : met) {
    if (one.free && (!best || one.sigma < best->sigma)) best = &one;
  }
  return best;
}

TEST_F(LocalOptimizationContractTest, TheResultIsTheBestThatWasMetAndSaysSo) {
  Random rng(1);
  int free = 0, not_free = 0, settled = 0, stopped = 0;
  for (int k = 0; k < 60; ++k) {
    const Scene scene = Scene::FromString(
        RandomRobotXml(rng, {.bodies = 4 + k % 4, .free_base = k % 4 == 0, .obstacles = 6}));
    Options options;
    options.clearance = k % 3 == 1 ? 0.01 : 0.0;
    options.tolerance = k % 2 ? 1e-6 : 1e-5;
    Watched p(scene, options);
    p.work.Begin(RandomConfiguration(scene, rng));
    const Tolerances& tolerances = p.work.problem().tolerances;
    const bool retreats = k % 5 == 4;
    const double aim = retreats ? -tolerances.user : tolerances.aim;
    const double accept = retreats ? 0.0 : tolerances.accept;
    LocalOptions how;
    how.retreats = retreats;
    how.max_iterations = k % 4 == 3 ? 3 : 60;
    const VectorXd start = RandomConfiguration(scene, rng);
    const LocalResult& result = p.Run(start, how);
    ASSERT_EQ(p.met.size(), static_cast<std::size_t>(result.iterations) + 1);
    EXPECT_LE(result.iterations, how.max_iterations);
    for (const Met& one : p.met) {
      EXPECT_NEAR(one.sigma, p.work.norm.Sigma(one.q), 1e-12);
      EXPECT_LE(LimitExcess(scene.tables(), one.q), 1e-12);
      const double sum = p.Overlaps(one.q, aim).first;
      EXPECT_NEAR(one.violation, sum, 1e-6 + 0.05 * sum);
      const double beyond = p.Overlaps(one.q, accept).second;
      EXPECT_TRUE(one.free == (beyond <= 0.0) || std::abs(beyond) < 1e-6) << beyond;
    }
    const Met* best = BestFree(p.met);
    EXPECT_EQ(result.free, best != nullptr);
    if (best) {
      ++free;
      EXPECT_EQ(result.q, best->q);
      EXPECT_EQ(result.sigma, best->sigma);
      EXPECT_EQ(result.violation, 0.0);
    } else {
      ++not_free;
      const auto is_result = [&](const Met& one) { return one.q == result.q; };
      const auto it = std::find_if(p.met.begin(), p.met.end(), is_result);
      ASSERT_NE(it, p.met.end());
      EXPECT_EQ(result.sigma, it->sigma);
      EXPECT_EQ(result.violation, it->violation);
      EXPECT_FALSE(std::any_of(p.met.begin(), p.met.end(), [&](const Met& one) {
        return one.sigma < it->sigma && one.violation < it->violation;
      })) << "no merit prefers one that is worse in both";
    }
    stopped += !result.ended;
    EXPECT_TRUE(result.ended || result.iterations == how.max_iterations);
    if (result.ended && result.free && result.iterations >= 2 && p.met.back().free) {
      // It settled: twice in a row σ hardly changed, or the last step was small.
      const Met& last = p.met.back();
      double before = std::numeric_limits<double>::infinity();
      for (std::size_t i = 0; i + 1 < p.met.size(); ++i) {
        if (p.met[i].free) before = std::min(before, p.met[i].sigma);
      }
      VectorXd moved;
      Difference(scene.tables(), p.met[p.met.size() - 2].q, last.q, moved);
      const bool hardly = std::abs(before - last.sigma) <= how.convergence * last.sigma;
      VectorXd r;
      MatrixXd J;
      p.work.norm.Linearize(p.met[p.met.size() - 2].q, r, J);
      const double small =
          tune::kSmallStep * scene.tables().size + tune::kSmallShare * std::sqrt(last.sigma);
      EXPECT_TRUE(hardly || (J * moved).norm() < 1.5 * small) << before << " " << last.sigma;
      settled += hardly;
    }
  }
  EXPECT_GT(free, 25);
  EXPECT_GT(not_free, 3);
  EXPECT_GT(settled, 10);
  EXPECT_GT(stopped, 3);
}

// One slide: all lengths are the distance that it moves.
TEST_F(LocalOptimizationContractTest, StepsAreNoLongerThanTheTrustRadiusAndAddUp) {
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody><geom size=".1" pos="9 9 9"/>
      <geom type="plane" size="0 0 1" pos="0 0 -9"/>
      <body pos="0 .5 0"><joint type="slide" axis="0 0 1"/><geom size=".1"/></body></worldbody>
      </mujoco>)");
  Watched p(scene);
  p.work.Begin(VectorXd::Zero(1));
  for (const double radius : {0.05, 0.2}) {
    for (const double largest : {0.1, LocalOptions::kInfinity}) {
      LocalOptions how;
      how.trust_radius = radius;
      how.largest_step = largest;
      how.max_iterations = 6;
      const LocalResult& result = p.Run(VectorXd::Constant(1, 5.0), how);
      const double scale = scene.tables().size / tune::kDeskSize;
      const double most = std::min(radius * scale, largest);
      double sum = 0.0;
      for (std::size_t k = 1; k < p.met.size(); ++k) {
        const double step = std::abs(p.met[k].q[0] - p.met[k - 1].q[0]);
        EXPECT_NEAR(step, most, 1e-9) << "as far as it may, for the way is long";
        sum += step;
      }
      EXPECT_NEAR(result.length, sum, 1e-9);
      EXPECT_FALSE(result.ended);
      EXPECT_EQ(p.local.at(), p.met.back().q);
    }
  }
}

TEST_F(LocalOptimizationContractTest, ResumeGoesOnAsIfTheRunHadNotEnded) {
  Random rng(3);
  int went_on = 0;
  for (int k = 0; k < 20; ++k) {
    const Scene scene = Scene::FromString(RandomRobotXml(rng, {.bodies = 5, .obstacles = 6}));
    Watched whole(scene), parts(scene);
    const VectorXd q_in = RandomConfiguration(scene, rng), start = RandomConfiguration(scene, rng);
    whole.work.Begin(q_in), parts.work.Begin(q_in);
    LocalOptions how;
    how.max_iterations = 12;
    const LocalResult at_once = whole.Run(start, how);
    how.max_iterations = 4;
    LocalResult result = parts.Run(start, how);
    double length = result.length, sigma = result.free ? result.sigma : LocalOptions::kInfinity;
    for (int part = 0; part < 2 && !result.ended; ++part) {
      const VectorXd at = parts.local.at();
      const std::int64_t queries = parts.work.finder.queries();
      const std::size_t steps = parts.met.size();
      result = parts.local.Resume(how);
      EXPECT_EQ(parts.work.finder.queries() - queries,
                static_cast<std::int64_t>(parts.met.size() - steps))
          << "none for what is there";
      length += result.length;
      if (result.free) sigma = std::min(sigma, result.sigma);
      std::vector<Met> found(parts.met.begin() + static_cast<std::ptrdiff_t>(steps),
                             parts.met.end());
      for (const Met& one : parts.met) {
        if (one.q == at) found.push_back(one);
      }
      const Met* best = BestFree(found);
      EXPECT_EQ(result.free, best != nullptr);
      EXPECT_TRUE(!best || result.sigma == best->sigma);
    }
    if (parts.met.size() != whole.met.size()) continue;  // ended by what the parts do not know
    ++went_on;
    for (std::size_t i = 0; i < whole.met.size(); ++i) {
      EXPECT_LT((whole.met[i].q - parts.met[i].q).norm(), 1e-6) << i;
    }
    EXPECT_EQ(result.iterations, at_once.iterations);
    EXPECT_NEAR(length, at_once.length, 1e-6);
    EXPECT_TRUE(!at_once.free || std::abs(sigma - at_once.sigma) < 1e-6);
  }
  EXPECT_GT(went_on, 12);
}

TEST_F(LocalOptimizationContractTest, ResumedFromAnotherInputItMeasuresFromThere) {
  Random rng(4);
  const Scene scene = Scene::FromString(RandomRobotXml(rng, {.bodies = 5, .obstacles = 4}));
  Watched p(scene);
  for (const bool renewed : {false, true}) {
    const VectorXd q_in = RandomConfiguration(scene, rng);
    p.work.Begin(q_in);
    p.Run(q_in, {});
    VectorXd other;
    Integrate(scene.tables(), q_in, VectorXd::Constant(scene.dof(), 0.01), other);
    ClampToLimits(scene.tables(), other);
    p.work.Begin(other);
    LocalOptions how;
    how.renewed = renewed;
    how.max_iterations = 0;
    const VectorXd at = p.local.at();
    const std::int64_t queries = p.work.finder.queries();
    const LocalResult& result = p.local.Resume(how);
    EXPECT_EQ(p.work.finder.queries(), queries);
    EXPECT_EQ(p.local.at(), at);
    EXPECT_FALSE(result.ended);
    EXPECT_EQ(result.length, 0.0);
    EXPECT_TRUE(!result.free || result.q == at);
    EXPECT_NEAR(result.sigma, p.work.norm.Sigma(result.q), 1e-12);
  }
}

TEST_F(LocalOptimizationContractTest, ABudgetOfQueriesIsKept) {
  Random rng(5);
  for (int k = 0; k < 10; ++k) {
    const Scene scene = Scene::FromString(RandomRobotXml(rng, {.bodies = 5, .obstacles = 8}));
    Watched p(scene);
    p.work.Begin(RandomConfiguration(scene, rng));
    const VectorXd start = RandomConfiguration(scene, rng);
    const int free_steps = p.Run(start, {}).iterations;
    if (free_steps < 4) continue;
    p.work.budget.Begin({.queries = 3}, BudgetMeter::Clock::now(), p.work.finder.queries());
    const LocalResult& result = p.Run(start, {});
    EXPECT_EQ(result.iterations, 2) << "one query is the start's";
    EXPECT_FALSE(result.ended);
  }
}

}  // namespace
}  // namespace mjcf_pdg::test
