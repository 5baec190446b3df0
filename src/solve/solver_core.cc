#include "solve/solver_core.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <chrono>
#include <string>

#include "base/tuning.h"
#include "equality/held.h"
#include "solve/options.h"
#include "solve/rest.h"

namespace mjcf_pdg {
namespace {

Eigen::Map<const VectorXd> AsEigen(std::span<const double> q) {
  return {q.data(), static_cast<Eigen::Index>(q.size())};
}

// The motions of method paper are straight, and so leave what equality constraints allow.
void CheckMethodHolds(const Options& options, const std::string& equality) {
  if (options.method != Method::kPaper) return;
  throw Error("method paper cannot hold equality constraint " + equality +
              ": use method auto, or ignore equality constraints");
}

const Options& Checked(const Scene& scene, const Options& options) {
  CheckOptions(options, *scene.model());
  const std::vector<std::string> equalities = scene.HeldEqualities();
  if (!equalities.empty()) CheckMethodHolds(options, equalities.front());
  if (scene.HoldsTendonLimits() && options.method == Method::kPaper) {
    throw Error("method paper cannot hold tendon limits: use method auto");
  }
  return options;
}

// Frames of a trajectory begin with earlier answers of the whole scene, and method paper is the
// paper's.
bool SolvesIslands(const Scene& scene, const Options& options) {
  return options.method == Method::kAuto && !options.trajectory &&
         MovableTrees(scene.tables()).count() > tuning::islands::kFew;
}

}  // namespace

SolverCore::SolverCore(const Scene& s, const Options& o)
    : scene(s),
      options(Checked(scene, o)),
      work(scene.tables(), options),
      verifier(scene.verifier_model(), options, options.report_distances_to),
      reporter(work, verifier),
      budget{.queries = 0, .seconds = options.time_limit},
      bystanders_(scene.tables()) {
  if (SolvesIslands(scene, options)) {
    islands_ = std::make_unique<IslandSearch>(work, verifier);
  } else {
    whole_ = std::make_unique<Stages>(work, verifier);
  }
  work.recorder = &recorder;
  SetMocap(options.mocap_pos, options.mocap_quat);
}

void SolverCore::Forget() {
  if (whole_) whole_->strategy->Forget();
}

std::int64_t SolverCore::Queries() const {
  return work.finder.queries() + (whole_ ? whole_->strategy->other_queries() : 0) +
         (islands_ ? islands_->queries() : 0) + verifier.queries();
}

std::int64_t SolverCore::LcpSteps() const {
  return (whole_ ? whole_->strategy->lcp_steps() : 0) + (islands_ ? islands_->lcp_steps() : 0);
}

Status SolverCore::Solve(std::span<const double> q, Result& result) {
  const BudgetMeter::Clock::time_point begin = BudgetMeter::Clock::now();
  const std::int64_t queries_before = Queries(), lcp_before = LcpSteps();
  q_in_.assign(q.begin(), q.end());
  recorder.BeginSolve();
  work.budget.Begin(budget, begin, work.finder.queries());
  Reporter::Clear(result);
  if (!reporter.Input(q_in_, result)) {
    if (options.rest > 0.0) DistancesAtRest(verifier, scene.tables(), at_rest_);
    const VectorXd* const rest = options.rest > 0.0 ? &at_rest_ : nullptr;
    work.BeginWithoutNorm(AsEigen(q_in_), mocap, rest);
    if (!islands_) work.ReferNorm();
    if (Search(result)) {
      reporter.Solved(q_in_, {.q = q_, .start = start_, .sigma = sigma_}, result);
    } else {
      reporter.Unsolved(q_in_, outcome_, frozen_, result);
    }
  }
  if (options.trajectory) Remember(result);
  result.stats.collision_queries = static_cast<int>(Queries() - queries_before);
  result.stats.lcp_sweeps = static_cast<int>(LcpSteps() - lcp_before);
  result.stats.seconds = std::chrono::duration<double>(BudgetMeter::Clock::now() - begin).count();
  return result.status;
}

// q_in_ penetrates: bound, search, accept. True if q_ is a free configuration.
bool SolverCore::Search(Result& result) {
  outcome_ = nullptr;
  const std::int64_t distances_before = work.finder.distances();
  const std::vector<NearPair>& overlaps = work.OverlapsAtInput();
  reporter.Overlaps(overlaps, result);
  const int distances = static_cast<int>(work.finder.distances() - distances_before);
  const auto moves = [this](const NearPair& near) { return scene.tables().pairs[near.pair].moves; };
  frozen_ = !std::all_of(overlaps.begin(), overlaps.end(), moves);
  if (frozen_ && std::none_of(overlaps.begin(), overlaps.end(), moves)) return false;
  const bool accepted =
      islands_ ? SearchIslands(overlaps, result) : SearchWhole(overlaps, distances, result);
  result.stats.iterations = outcome_->iterations;
  result.stats.starts = outcome_->starts;
  return accepted;
}

bool SolverCore::SearchWhole(const std::vector<NearPair>& overlaps, int distances, Result& result) {
  const VectorXd* const given = Hint();
  outcome_ = &whole_->Search(overlaps, distances, given);
  result.sigma_lower_bound = whole_->sigma_lower_bound();
  whole_->acceptance.Begin(q_in_);
  if (frozen_ || !whole_->acceptance.Accept(*outcome_, given)) return false;
  q_ = whole_->acceptance.q();
  sigma_.reset();
  start_ = whole_->acceptance.start();
  LeaveBystanders(overlaps);
  return true;
}

// A start that moved everything may have left others where they need not be: σ is a sum over trees.
void SolverCore::LeaveBystanders(const std::vector<NearPair>& overlaps) {
  if (options.method == Method::kPaper || options.trajectory || work.Spent()) return;
  left_ = q_;
  if (!bystanders_.PutBack(work.problem(), overlaps, q_in_, left_)) return;
  if (verifier.IsFree(left_, q_in_)) {
    q_ = left_;
  } else {
    verifier.IsFree(q_, q_in_);  // whose last words the report tells
  }
}

bool SolverCore::SearchIslands(const std::vector<NearPair>& overlaps, Result& result) {
  const bool free = islands_->Run({.q_in = q_in_,
                                   .overlaps = overlaps,
                                   .at_rest = options.rest > 0.0 ? &at_rest_ : nullptr,
                                   .hint = Hint()});
  outcome_ = &islands_->outcome();
  result.sigma_lower_bound = islands_->sigma_lower_bound();
  q_ = islands_->q();
  sigma_ = islands_->sigma();
  start_ = islands_->start();
  return free && !frozen_;
}

// The user's hint, inside limits; null if there is none.
const VectorXd* SolverCore::Hint() {
  if (hint.size() == 0 || !work.problem().Uses(Component::kUserPose)) return nullptr;
  q_hint_ = work.problem().q_in;
  SetMovable(scene.tables(), hint, q_hint_);
  ClampToLimits(scene.tables(), q_hint_);
  return &q_hint_;
}

void SolverCore::Remember(const Result& result) {
  Strategy& strategy = *whole_->strategy;
  strategy.Remember(AsEigen(result.q), result.status != Status::kUnsolved);
  if (result.status != Status::kAlreadyFree && options.method == Method::kPaper) {
    strategy.Remember(work.problem().q_in, false);
  }
}

void SolverCore::SetMocap(std::span<const double> pos, std::span<const double> quat) {
  mocap.pos.assign(pos.begin(), pos.end());
  mocap.quat.assign(quat.begin(), quat.end());
  verifier.SetMocap(pos, quat);
}

void SolverCore::SetActive(std::span<const mjtBool> active) {
  for (std::size_t e = 0; e < active.size(); ++e) {
    if (active[e] && scene.tables().held_equalities[e]) {
      CheckMethodHolds(options, DescribeEquality(*scene.model(), static_cast<int>(e)));
    }
  }
  work.equality.SetActive(active);
  verifier.SetActive(active);
}

void SolverCore::SetObstacles(const mjData& data) {
  const mjModel& m = *scene.model();
  const std::size_t nmocap = static_cast<std::size_t>(m.nmocap);
  SetActive({data.eq_active, static_cast<std::size_t>(m.neq)});
  SetMocap({data.mocap_pos, 3 * nmocap}, {data.mocap_quat, 4 * nmocap});
}

bool SolverCore::HasObstacles(const mjData& data) const {
  const mjModel& m = *scene.model();
  const auto same = [](const mjtNum* now, std::size_t count, const std::vector<double>& set) {
    return std::equal(now, now + count, set.begin(), set.end());
  };
  const std::size_t nmocap = static_cast<std::size_t>(m.nmocap);
  const std::span<const mjtBool> active = work.equality.active();
  for (std::size_t e = 0; e < active.size(); ++e) {
    const bool counts = data.eq_active[e] && scene.tables().held_equalities[e];
    if (counts != static_cast<bool>(active[e])) return false;
  }
  return same(data.mocap_pos, 3 * nmocap, mocap.pos) &&
         same(data.mocap_quat, 4 * nmocap, mocap.quat);
}

void SolverCore::CheckInput(std::span<const double> q) const {
  scene.CheckUnchanged();
  scene.CheckConfiguration(q);
}

}  // namespace mjcf_pdg
