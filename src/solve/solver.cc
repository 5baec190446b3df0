// A solve from q_in to its result: check, bound, search, accept, report.
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "bound/lower_bound.h"
#include "equality/held.h"
#include "mjcf_pdg/pdg.h"
#include "paper/paper_method.h"
#include "problem/effort.h"
#include "problem/strategy.h"
#include "problem/workspace.h"
#include "search/auto_method.h"
#include "solve/acceptance.h"
#include "solve/options.h"
#include "solve/report.h"
#include "solve/rest.h"
#include "verify/verifier.h"

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

// Puts the hint of SetHint back, however a solve with one of its own ends.
struct RestoreHint {
  ~RestoreHint() { hint.swap(kept); }
  VectorXd& hint;
  VectorXd& kept;
};

}  // namespace

struct MJCF_PDG_LOCAL Solver::Impl {
  Impl(const Scene& s, const Options& o);

  Status Solve(std::span<const double> q, Result& result);
  bool Search(Result& result);
  void Remember(const Result& result);
  void SetMocap(std::span<const double> pos, std::span<const double> quat);
  void SetActive(std::span<const mjtBool> active);
  void CheckInput(std::span<const double> q) const;
  std::int64_t Queries() const {
    return work.finder.queries() + strategy->other_queries() + verifier.queries();
  }

  const Scene scene;
  const Options options;
  Workspace work;
  LowerBound bound;
  std::unique_ptr<Strategy> strategy;
  Verifier verifier;
  Acceptance acceptance;
  Reporter reporter;
  Budget budget;
  MocapPoses mocap;
  VectorXd hint;  // nq; empty: none

  // The present solve.
  std::vector<double> q_in;    // as the user gave it
  VectorXd at_rest;            // per kept pair, see DistancesAtRest
  VectorXd q_hint;             // the hint with what is frozen as in q_in
  Outcome* outcome = nullptr;  // null: nothing was searched
  bool frozen = false;         // pairs overlap that no movable joint can part
};

Solver::Impl::Impl(const Scene& s, const Options& o)
    : scene(s),
      options(o),
      work(scene.tables(), options),
      strategy(MakeStrategy(work)),
      verifier(scene.verifier_model(), options, options.report_distances_to),
      acceptance(work, *strategy, verifier),
      reporter(work, verifier),
      budget{.queries = 0, .seconds = options.time_limit} {
  SetMocap(options.mocap_pos, options.mocap_quat);
}

Status Solver::Impl::Solve(std::span<const double> q, Result& result) {
  const BudgetMeter::Clock::time_point begin = BudgetMeter::Clock::now();
  const std::int64_t queries_before = Queries(), lcp_before = strategy->lcp_steps();
  q_in.assign(q.begin(), q.end());
  work.budget.Begin(budget, begin, work.finder.queries());
  Reporter::Clear(result);
  if (!reporter.Input(q_in, result)) {
    if (options.rest > 0.0) DistancesAtRest(verifier, scene.tables(), at_rest);
    work.Begin(AsEigen(q_in), mocap, options.rest > 0.0 ? &at_rest : nullptr);
    if (Search(result)) {
      reporter.Solved(q_in, acceptance.q(), acceptance.start(), result);
    } else {
      reporter.Unsolved(q_in, outcome, frozen, result);
    }
  }
  if (options.trajectory) Remember(result);
  result.stats.collision_queries = static_cast<int>(Queries() - queries_before);
  result.stats.lcp_sweeps = static_cast<int>(strategy->lcp_steps() - lcp_before);
  result.stats.seconds = std::chrono::duration<double>(BudgetMeter::Clock::now() - begin).count();
  return result.status;
}

// q_in penetrates: bound, search, accept. True if acceptance has a free configuration.
bool Solver::Impl::Search(Result& result) {
  outcome = nullptr;
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
    q_hint = work.problem().q_in;
    SetMovable(scene.tables(), hint, q_hint);
    ClampToLimits(scene.tables(), q_hint);
    input.hint = &q_hint;
  }
  const auto moves = [this](const NearPair& near) { return scene.tables().pairs[near.pair].moves; };
  frozen = !std::all_of(input.overlaps.begin(), input.overlaps.end(), moves);
  if (frozen && std::none_of(input.overlaps.begin(), input.overlaps.end(), moves)) return false;
  outcome = &strategy->Run(input);
  acceptance.Begin(q_in);
  const bool accepted = !frozen && acceptance.Accept(*outcome, input.hint);
  result.stats.iterations = outcome->iterations;
  result.stats.starts = outcome->starts;
  return accepted;
}

void Solver::Impl::Remember(const Result& result) {
  strategy->Remember(AsEigen(result.q), result.status != Status::kUnsolved);
  if (result.status != Status::kAlreadyFree && options.method == Method::kPaper) {
    strategy->Remember(work.problem().q_in, false);
  }
}

void Solver::Impl::SetMocap(std::span<const double> pos, std::span<const double> quat) {
  mocap.pos.assign(pos.begin(), pos.end());
  mocap.quat.assign(quat.begin(), quat.end());
  verifier.SetMocap(pos, quat);
}

void Solver::Impl::SetActive(std::span<const mjtBool> active) {
  for (std::size_t e = 0; e < active.size(); ++e) {
    if (active[e] && scene.tables().held_equalities[e]) {
      CheckMethodHolds(options, DescribeEquality(*scene.model(), static_cast<int>(e)));
    }
  }
  work.equality.SetActive(active);
  verifier.SetActive(active);
}

void Solver::Impl::CheckInput(std::span<const double> q) const {
  scene.CheckUnchanged();
  scene.CheckConfiguration(q);
}

Solver::Solver(const Scene& scene, const Options& options) {
  CheckMujocoVersion();
  CheckOptions(options, *scene.model());
  const std::vector<std::string> equalities = scene.HeldEqualities();
  if (!equalities.empty()) CheckMethodHolds(options, equalities.front());
  impl_ = std::make_unique<Impl>(scene, options);
}

Solver::~Solver() = default;
Solver::Solver(Solver&&) noexcept = default;
Solver& Solver::operator=(Solver&&) noexcept = default;

Status Solver::Solve(std::span<const double> q_in, Result& result) {
  impl_->CheckInput(q_in);
  return impl_->Solve(q_in, result);
}

Result Solver::Solve(std::span<const double> q_in) {
  Result result;
  Solve(q_in, result);
  return result;
}

Result Solver::Solve(const std::vector<double>& q_in,
                     const std::optional<std::vector<double>>& free_hint) {
  if (!free_hint) return Solve(std::span<const double>(q_in));
  impl_->scene.CheckConfiguration(*free_hint);
  VectorXd kept = AsEigen(*free_hint);
  kept.swap(impl_->hint);
  const RestoreHint restore{impl_->hint, kept};
  return Solve(std::span<const double>(q_in));
}

Status Solver::Solve(const mjData* data, Result& result) {
  if (!data) throw Error("the data is null");
  const mjModel& m = *impl_->scene.model();
  impl_->scene.CheckUnchanged();
  impl_->SetActive({data->eq_active, static_cast<std::size_t>(m.neq)});
  const std::size_t nmocap = static_cast<std::size_t>(m.nmocap);
  impl_->SetMocap({data->mocap_pos, 3 * nmocap}, {data->mocap_quat, 4 * nmocap});
  return Solve(std::span<const double>(data->qpos, static_cast<std::size_t>(m.nq)), result);
}

bool Solver::IsFree(std::span<const double> q) {
  impl_->CheckInput(q);
  return impl_->verifier.IsFree(q);
}

void Solver::SetHint(std::span<const double> q_free) {
  if (!q_free.empty()) impl_->scene.CheckConfiguration(q_free);
  impl_->hint = AsEigen(q_free);
}

void Solver::SetBudget(const Budget& budget) {
  CheckBudget(budget);
  impl_->budget = budget;
}

void Solver::SetMocap(const std::vector<double>& pos, const std::vector<double>& quat) {
  CheckMocap(pos, quat, *impl_->scene.model());
  impl_->SetMocap(pos, quat);
}

void Solver::Reset() { impl_->strategy->Forget(); }

}  // namespace mjcf_pdg
