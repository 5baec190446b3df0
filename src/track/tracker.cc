#include "mjcf_pdg/tracker.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>
#include <vector>

#include "base/tuning.h"
#include "solve/options.h"
#include "solve/rest.h"
#include "solve/solver_core.h"
#include "track/approach.h"
#include "track/elsewhere.h"
#include "track/follower.h"

namespace mjcf_pdg {
namespace {

namespace tune = tuning::track;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

void CheckTrackOptions(const TrackOptions& options) {
  if (options.queries < tune::kFewestQueries) {
    throw Error("a tick needs at least " + std::to_string(tune::kFewestQueries) + " queries");
  }
  if (!(options.switch_gain >= 0.0 && options.switch_gain < 1.0)) {
    throw Error("switch_gain must lie between 0 and 1");
  }
  if (!(options.max_step > 0.0)) throw Error("max_step must be positive");
  if (options.options.method != Method::kAuto) throw Error("a Tracker follows by method auto only");
}

}  // namespace

// `optimum` is the local optimum that is followed; `at` is where the follower stands. They differ
// only on the way from one optimum to another, or to a command, that max_step or certify_motion
// makes longer than a tick.
struct MJCF_PDG_LOCAL Tracker::Impl {
  Impl(const Scene& scene, const TrackOptions& o);

  Status Step(std::span<const double> q_command, Result& result);
  void SetObstacles(const mjData& data);
  void Reset(std::span<const double> q);
  // The command, with frozen joints as in `data`.
  std::span<const double> WithFrozenOf(const mjData& data, std::span<const double> q_command);

  bool Limited() const { return options.certify_motion || options.max_step < kInfinity; }
  // What a tick may move an answer that stands [√σ, m].
  double Noise() const { return tune::kNoise * work.problem().size; }
  std::int64_t LcpSteps() const {
    return core.LcpSteps() + follower.lcp_steps() + elsewhere.lcp_steps();
  }
  bool Free(const VectorXd& q);
  void First(Result& result);
  void Tick(BudgetMeter::Clock::time_point begin, Result& result);
  void Answer(Result& result);
  void Begin();
  bool Follow();
  void TrySwitch();
  bool Approached(bool command_free);
  bool MoveTowards(const VectorXd& target);
  bool SlideTowards(const VectorXd& target);
  const VectorXd* Rest() const { return options.options.rest > 0.0 ? &at_rest : nullptr; }
  void FallBack(Result& result);

  const TrackOptions options;
  SolverCore core;  // solves in the first tick, and where nothing that is followed is free
  Workspace& work;
  Follower follower;
  Elsewhere elsewhere;
  Approach approach;

  bool started = false, obstacles_moved = false, switched = false;
  bool on_command = false,
       on_way = false;  // the follower stands on the command; on its way to `optimum`
  int tick = 0;
  int blocked = 0;  // ticks for which no other optimum is sought, since the way to one was blocked
  Component start = Component::kNone;
  double moved = 0.0;  // how far the command has moved since the last tick [√σ, m]
  std::vector<double> q_in, asked, merged;
  VectorXd command, last_command, optimum, at, last_at, candidate, at_rest;
};

Tracker::Impl::Impl(const Scene& scene, const TrackOptions& o)
    : options(o),
      core(scene, options.options),
      work(core.work),
      follower(work),
      elsewhere(work),
      approach(work, options.max_step) {}

// By the verifier, one query.
bool Tracker::Impl::Free(const VectorXd& q) {
  asked.assign(q.data(), q.data() + q.size());
  work.budget.Charge(1);
  return core.verifier.IsFree(asked, q_in);
}

Status Tracker::Impl::Step(std::span<const double> q_command, Result& result) {
  const BudgetMeter::Clock::time_point begin = BudgetMeter::Clock::now();
  const std::int64_t queries = core.Queries(), lcp_steps = LcpSteps();
  q_in.assign(q_command.begin(), q_command.end());
  command = Eigen::Map<const VectorXd>(q_in.data(), static_cast<Eigen::Index>(q_in.size()));
  switched = false;
  if (started) {
    Tick(begin, result);
  } else {
    First(result);
  }
  last_command = command;
  result.switched = switched;
  result.stats.collision_queries = static_cast<int>(core.Queries() - queries);
  result.stats.lcp_sweeps = static_cast<int>(LcpSteps() - lcp_steps);
  result.stats.seconds = std::chrono::duration<double>(BudgetMeter::Clock::now() - begin).count();
  return result.status;
}

// As Solver does.
void Tracker::Impl::First(Result& result) {
  core.budget = {.queries = 0, .seconds = options.options.time_limit};
  core.Solve(q_in, result);
  if (result.status == Status::kUnsolved) return;
  Reset(result.q);
  obstacles_moved = false;
  on_command = result.status == Status::kAlreadyFree;
}

void Tracker::Impl::Tick(BudgetMeter::Clock::time_point begin, Result& result) {
  Reporter::Clear(result);
  work.budget.Begin(
      {.queries = options.queries - tune::kReserve, .seconds = options.options.time_limit}, begin,
      work.finder.queries());
  const bool command_free = Free(command);
  if (command_free && on_command && !Limited()) {
    at = optimum = command;
    Answer(result);
  } else {
    Begin();
    if (Approached(command_free)) {
      Answer(result);
    } else {
      FallBack(result);
    }
  }
  obstacles_moved = false;
}

void Tracker::Impl::Reset(std::span<const double> q) {
  at = optimum = Eigen::Map<const VectorXd>(q.data(), static_cast<Eigen::Index>(q.size()));
  last_command = at;
  obstacles_moved = true;  // nobody has asked whether q is free
  on_command = false;
  started = true;
  tick = blocked = 0;
  on_way = false;
  elsewhere.Reset();
}

std::span<const double> Tracker::Impl::WithFrozenOf(const mjData& data,
                                                    std::span<const double> q_command) {
  merged.assign(data.qpos, data.qpos + q_command.size());
  for (const JointEntry& joint : core.scene.tables().joints) {
    std::copy_n(q_command.begin() + joint.qadr, QposEntries(joint), merged.begin() + joint.qadr);
  }
  return merged;
}

// `at` is free, and the verifier's last question was about it.
void Tracker::Impl::Answer(Result& result) {
  on_command = at == command;
  asked.assign(at.data(), at.data() + at.size());
  if (on_command) {
    core.reporter.AlreadyFree(q_in, result);
  } else {
    core.reporter.SolvedBeside(q_in, asked, start, result);
  }
}

// The problem of this tick's command; what is frozen is where the command says.
void Tracker::Impl::Begin() {
  if (options.options.rest > 0.0) DistancesAtRest(core.verifier, core.scene.tables(), at_rest);
  work.Begin(command, core.mocap, Rest());
  moved = std::sqrt(work.norm.Sigma(last_command));
  for (VectorXd* q : {&optimum, &at}) {
    candidate = work.problem().q_in;
    SetMovable(core.scene.tables(), *q, candidate);
    obstacles_moved = obstacles_moved || candidate != *q;
    *q = candidate;
  }
  obstacles_moved = obstacles_moved || options.options.rest > 0.0;
}

// Moves `optimum` to where the command has moved it. Returns false if nothing there is free.
bool Tracker::Impl::Follow() {
  const bool own_free = !obstacles_moved || Free(optimum);
  const double own_sigma = own_free ? work.norm.Sigma(optimum) : kInfinity;
  const double reach = tune::kReach * moved + Noise();
  const LocalResult* found = &follower.Follow(optimum, own_free, reach);
  if (own_free && !(found->sigma < own_sigma)) return true;
  if (!found->free || !Free(found->q)) {
    candidate = found->q;
    found = &follower.Retreat(candidate);
    if (!found->free || !Free(found->q)) return own_free;
  }
  const bool jumps = follower.Apart(optimum, found->q) > tune::kJump * moved + Noise();
  const double kept = 1.0 - options.switch_gain;
  if (own_free && jumps && found->sigma > kept * kept * own_sigma) return true;
  switched = jumps;
  optimum = found->q;
  return true;
}

void Tracker::Impl::TrySwitch() {
  if (tick++ % tune::kSearchEvery != 0) return;
  const double sigma = work.norm.Sigma(optimum), kept = 1.0 - options.switch_gain;
  if (!elsewhere.Search(optimum, sigma, kept * kept * sigma)) return;
  candidate = elsewhere.q();
  Unwind(core.scene.tables(), work.problem().q_in, candidate);
  // Couplings may forbid whole turns of one joint alone.
  if (work.equality.Violation(candidate) > kEqualityTolerance) candidate = elsewhere.q();
  if (!Free(candidate)) return;
  switched = true;
  optimum = candidate;
  start = elsewhere.start();
}

// Moves the follower. Returns false if nothing free is known.
bool Tracker::Impl::Approached(bool command_free) {
  start = Component::kMotionCoherence;
  blocked = std::max(0, blocked - 1);
  if (command_free) {
    switched = blocked == 0 && follower.Apart(optimum, command) > tune::kJump * moved + Noise();
    optimum = command;
  } else {
    if (!Follow()) return false;
    if (!on_way && blocked == 0) TrySwitch();
  }
  if (!Limited()) {
    at = optimum;
    return true;
  }
  on_way = true;
  if (switched && !command_free)
    return Free(at);  // the search took the queries: off in the next tick
  if (MoveTowards(optimum) || (blocked == 0 && SlideTowards(optimum))) {
    on_way = at != optimum;
    return true;
  }
  // No way leads there: back to the optimum on this side.
  on_way = false;
  blocked = tune::kBlocked;
  work.Begin(command, core.mocap, Rest());
  candidate = follower.Follow(at, true, kInfinity).q;
  if (!Free(candidate)) return Free(at);
  optimum = candidate;
  return MoveTowards(optimum) || Free(at);
}

// Returns whether that leads anywhere.
bool Tracker::Impl::MoveTowards(const VectorXd& target) {
  const bool unproven = !options.certify_motion;
  double share = unproven ? approach.Cut(at, target) : approach.CutToProof(at, target);
  if (unproven && !Free(approach.q())) share = approach.CutToProof(at, target);
  if (share < tune::kLeastShare || !Free(approach.q())) return false;
  at = approach.q();
  return true;
}

// Where the straight way is blocked: along the obstacle, to what is nearest to the next point of
// the straight way. Returns whether that comes nearer to the target.
bool Tracker::Impl::SlideTowards(const VectorXd& target) {
  approach.Cut(at, target);
  work.Begin(approach.q(), core.mocap, Rest());
  const double before = follower.Apart(at, target);
  const VectorXd& beside = follower.Follow(at, true, kInfinity).q;
  last_at = at;
  if (MoveTowards(beside) && follower.Apart(at, target) < before) return true;
  at = last_at;
  return false;
}

// Nothing that is followed is free: a solve with what is left of the budget. Where max_step does
// not let the follower go there at once, it goes as far as it may.
void Tracker::Impl::FallBack(Result& result) {
  const std::int64_t left = work.budget.Left(work.finder.queries());
  core.budget = {.queries = static_cast<int>(std::max<std::int64_t>(1, left)),
                 .seconds = options.options.time_limit};
  core.Solve(q_in, result);
  on_command = false;
  if (result.status == Status::kUnsolved) return;
  optimum = ToEigen(result.q);
  switched = true;
  elsewhere.Reset();
  approach.Cut(at, optimum);
  at = approach.q();
  if (at == optimum) return;
  start = Component::kMotionCoherence;
  if (Free(at)) return Answer(result);
  result.q.assign(at.data(), at.data() + at.size());
  result.status = Status::kUnsolved;
  result.sigma = work.norm.Sigma(at);
  result.cause = Cause::kBudget;
  result.reason = "the way to a free configuration takes longer than a tick at this max_step";
}

void Tracker::Impl::SetObstacles(const mjData& data) {
  obstacles_moved = obstacles_moved || !core.HasObstacles(data);
  core.SetObstacles(data);
}

Tracker::Tracker(const Scene& scene, const TrackOptions& options) {
  CheckMujocoVersion();
  CheckTrackOptions(options);
  impl_ = std::make_unique<Impl>(scene, options);
}

Tracker::~Tracker() = default;
Tracker::Tracker(Tracker&&) noexcept = default;
Tracker& Tracker::operator=(Tracker&&) noexcept = default;

Status Tracker::Step(std::span<const double> q_command, Result& result) {
  impl_->core.CheckInput(q_command);
  return impl_->Step(q_command, result);
}

Status Tracker::Step(const mjData* data, std::span<const double> q_command, Result& result) {
  if (!data) throw Error("the data is null");
  impl_->core.CheckInput(q_command);
  impl_->core.CheckInput({data->qpos, q_command.size()});
  impl_->SetObstacles(*data);
  return impl_->Step(impl_->WithFrozenOf(*data, q_command), result);
}

void Tracker::Reset(std::span<const double> q) {
  impl_->core.CheckInput(q);
  impl_->Reset(q);
}

}  // namespace mjcf_pdg
