#include "solve/solver_core.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <chrono>
#include <string>

#include "equality/held.h"
#include "paper/paper_method.h"
#include "problem/effort.h"
#include "search/auto_method.h"
#include "solve/options.h"
#include "solve/rest.h"

namespace mjcf_pdg {
namespace {

Eigen::Map<const VectorXd> AsEigen(std::span<const double> q) {
  return {q.data(), static_cast<Eigen::Index>(q.size())};
}

std::unique_ptr<Strategy> MakeStrategy(Workspace& work) {
  if (work.problem().options.method == Method::kPaper) return std::make_unique<PaperMethod>(work);
  return std::make_unique<AutoMethod>(work);
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
  return options;
}

}  // namespace

SolverCore::SolverCore(const Scene& s, const Options& o)
    : scene(s),
      options(Checked(scene, o)),
      work(scene.tables(), options),
      strategy(MakeStrategy(work)),
      verifier(scene.verifier_model(), options, options.report_distances_to),
      acceptance(work, *strategy, verifier),
      reporter(work, verifier),
      budget{.queries = 0, .seconds = options.time_limit} {
  SetMocap(options.mocap_pos, options.mocap_quat);
}

Status SolverCore::Solve(std::span<const double> q, Result& result) {
  const BudgetMeter::Clock::time_point begin = BudgetMeter::Clock::now();
  const std::int64_t queries_before = Queries(), lcp_before = strategy->lcp_steps();
  q_in_.assign(q.begin(), q.end());
  work.budget.Begin(budget, begin, work.finder.queries());
  Reporter::Clear(result);
  if (!reporter.Input(q_in_, result)) {
    if (options.rest > 0.0) DistancesAtRest(verifier, scene.tables(), at_rest_);
    work.Begin(AsEigen(q_in_), mocap, options.rest > 0.0 ? &at_rest_ : nullptr);
    if (Search(result)) {
      reporter.Solved(q_in_, {acceptance.q(), acceptance.start()}, result);
    } else {
      reporter.Unsolved(q_in_, outcome_, frozen_, result);
    }
  }
  if (options.trajectory) Remember(result);
  result.stats.collision_queries = static_cast<int>(Queries() - queries_before);
  result.stats.lcp_sweeps = static_cast<int>(strategy->lcp_steps() - lcp_before);
  result.stats.seconds = std::chrono::duration<double>(BudgetMeter::Clock::now() - begin).count();
  return result.status;
}

// q_in_ penetrates: bound, search, accept. True if acceptance has a free configuration.
bool SolverCore::Search(Result& result) {
  outcome_ = nullptr;
  const std::int64_t distances_before = work.finder.distances();
  StrategyInput input{.overlaps = work.OverlapsAtInput()};
  reporter.Overlaps(input.overlaps, result);
  input.distances_at_input = static_cast<int>(work.finder.distances() - distances_before);
  if (options.report_lower_bound || strategy->UsesLowerBound()) {
    input.sigma_lower_bound =
        bound.Sigma(work, input.overlaps, PlanFor(options.effort).bound_cells);
  }
  result.sigma_lower_bound = input.sigma_lower_bound;
  if (hint.size() > 0 && work.problem().Uses(Component::kUserPose)) {
    q_hint_ = work.problem().q_in;
    SetMovable(scene.tables(), hint, q_hint_);
    ClampToLimits(scene.tables(), q_hint_);
    input.hint = &q_hint_;
  }
  const auto moves = [this](const NearPair& near) { return scene.tables().pairs[near.pair].moves; };
  frozen_ = !std::all_of(input.overlaps.begin(), input.overlaps.end(), moves);
  if (frozen_ && std::none_of(input.overlaps.begin(), input.overlaps.end(), moves)) return false;
  outcome_ = &strategy->Run(input);
  acceptance.Begin(q_in_);
  const bool accepted = !frozen_ && acceptance.Accept(*outcome_, input.hint);
  result.stats.iterations = outcome_->iterations;
  result.stats.starts = outcome_->starts;
  return accepted;
}

void SolverCore::Remember(const Result& result) {
  strategy->Remember(AsEigen(result.q), result.status != Status::kUnsolved);
  if (result.status != Status::kAlreadyFree && options.method == Method::kPaper) {
    strategy->Remember(work.problem().q_in, false);
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
