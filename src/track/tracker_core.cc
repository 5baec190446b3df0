#include "track/tracker_core.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "problem/effort.h"
#include "solve/rest.h"

namespace mjcf_pdg {

namespace tune = tuning::track;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Queries of a solve beyond its budget: one of the command, one that ends it, and three of what is
// not free (Budget in types.h); and one of where max_step lets the follower go instead.
constexpr int kBeyondSolve = 6;

}  // namespace

TrackerCore::TrackerCore(const Scene& scene, const TrackOptions& o, const Pace& p)
    : options(o),
      pace(p),
      core(scene, options.options),
      work(core.work),
      follower(work, pace.follow),
      elsewhere(work),
      approach(work, options.max_step) {
  work.remembers_distances = true;
  if (!Limited()) return;
  own_side = std::make_unique<Follower>(work, pace.follow);
  detour = std::make_unique<Detour>(work, options.max_step, options.certify_motion);
}

// By the verifier, one query. What the budget does not allow to ask is not called free.
bool TrackerCore::Free(const VectorXd& q) { return Left() > 0 && Ask(q); }

// By Check where that is to be reported of the answer.
bool TrackerCore::Ask(const VectorXd& q) {
  asked.assign(q.data(), q.data() + q.size());
  work.budget.Charge(1);
  if (!core.reporter.Reports()) return core.verifier.IsFree(asked, q_in);
  return core.verifier.Check(asked, q_in, verify::Depths::kMeasured, verify::Words::kSkipped).free;
}

Status TrackerCore::Step(std::span<const double> q_command, Result& result) {
  const BudgetMeter::Clock::time_point begin = BudgetMeter::Clock::now();
  const std::int64_t queries = core.Queries(), lcp_steps = LcpSteps();
  q_in.assign(q_command.begin(), q_command.end());
  command = Eigen::Map<const VectorXd>(q_in.data(), static_cast<Eigen::Index>(q_in.size()));
  switched = advanced = lags = false;
  iterations = 0;
  if (started) {
    Tick(begin, result);
  } else {
    First(result);
  }
  last_command = command;
  const bool was_away = away;
  away = at != optimum;
  result.switched = switched;
  result.under_way = lags || (advanced && (away || was_away));
  result.stats.iterations += iterations;
  result.stats.collision_queries = static_cast<int>(core.Queries() - queries);
  result.stats.lcp_sweeps = static_cast<int>(LcpSteps() - lcp_steps);
  result.stats.seconds = std::chrono::duration<double>(BudgetMeter::Clock::now() - begin).count();
  return result.status;
}

// A solve depends on nothing that was asked before.
void TrackerCore::Solve(Result& result) {
  work.remembers_distances = false;
  core.Solve(q_in, result);
  work.ReferNorm();
  work.remembers_distances = true;
}

// As Solver does.
void TrackerCore::First(Result& result) {
  core.budget = {.queries = 0, .seconds = options.options.time_limit};
  Solve(result);
  if (result.status == Status::kUnsolved) return;
  Reset(result.q);
  moves = Obstacles();
  obstacles_moved = false;
  on_command = result.status == Status::kAlreadyFree;
}

void TrackerCore::Tick(BudgetMeter::Clock::time_point begin, Result& result) {
  Reporter::Clear(result);
  // Of these no search may take any: the answer is asked about for the report, or has a bound.
  const int words =
      (work.equality.any() || core.reporter.Reports() ? 1 : 0) + (pace.bounds ? 1 : 0);
  work.budget.Begin(
      {.queries = options.queries - words - tune::kReserve, .seconds = options.options.time_limit},
      begin, work.finder.queries());
  work.budget.Charge(1);
  asked.clear();
  const bool command_free = core.reporter.Input(q_in, result);
  if (command_free && on_command && !Limited()) {
    at = optimum = command;
  } else {
    Begin();
    if (!lost && Approached(command_free)) {
      Answer(result);
    } else {
      FallBack(result);
    }
  }
  moves = Obstacles();
  // Where nothing free was found, what is followed is not known to be free in the next tick either.
  obstacles_moved = result.status == Status::kUnsolved;
}

void TrackerCore::Reset(std::span<const double> q) {
  at = optimum = Eigen::Map<const VectorXd>(q.data(), static_cast<Eigen::Index>(q.size()));
  last_command = at;
  obstacles_moved = true;  // nobody has asked whether q is free
  on_command = lost = fleeing = away = false;
  unslid = 0;
  started = true;
  blocked = 0;
  search_due = last_sigma = 0.0;
  if (detour) detour->Reset();
  going = false;
  elsewhere.Reset();
}

std::span<const double> TrackerCore::WithFrozenOf(const mjData& data,
                                                  std::span<const double> q_command) {
  merged.assign(data.qpos, data.qpos + q_command.size());
  for (const JointEntry& joint : core.scene.tables().joints) {
    std::copy_n(q_command.begin() + joint.qadr, QposEntries(joint), merged.begin() + joint.qadr);
  }
  return merged;
}

// `at` is free. If it is the command, the result is complete.
void TrackerCore::Answer(Result& result) {
  on_command = at == command;
  if (on_command) return;
  const bool last = std::equal(asked.begin(), asked.end(), at.begin(), at.end());
  if (work.equality.any() && !last) Ask(at);  // whose constraints are reported
  asked.assign(at.data(), at.data() + at.size());
  core.reporter.Solved(q_in, {asked, start, last && core.reporter.Reports()}, result);
  if (pace.bounds) Bound(result);
}

// One query.
void TrackerCore::Bound(Result& result) {
  const std::vector<NearPair>& overlaps = work.OverlapsAtInput();
  core.reporter.Overlaps(overlaps, result);
  const int cells = PlanFor(core.options.effort).bound_cells;
  result.sigma_lower_bound = core.bound.Sigma(work, overlaps, cells);
}

// The problem of this tick's command; what is frozen is where the command says.
void TrackerCore::Begin() {
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
bool TrackerCore::Follow() {
  const bool known = !obstacles_moved || (Limited() && at == optimum);  // see Evaded
  const bool own_free = known || Free(optimum);
  if (work.Spent()) return own_free;
  const double own_sigma = own_free ? work.norm.Sigma(optimum) : kInfinity;
  const double reach = tune::kReach * moved + Noise();
  const LocalResult* found = &follower.Follow({optimum, own_free, Obstacles(), reach});
  iterations = found->iterations;
  if (own_free && !(found->sigma < own_sigma)) return true;
  if (!found->free || !Free(found->q)) {
    candidate = found->q;
    if (!work.Spent()) {
      found = &follower.Retreat(candidate);
      iterations += found->iterations;
    }
    if (!found->free || !Free(found->q)) {
      if (!own_free) optimum = found->q;  // from where the next tick goes on
      return own_free;
    }
  }
  const double limit = tune::kJump * moved + Noise();
  const bool jumps = follower.Farther(optimum, found->q, limit);
  const double kept = 1.0 - options.switch_gain;
  if (own_free && jumps && found->sigma > kept * kept * own_sigma) return true;
  switched = jumps;
  optimum = found->q;
  return true;
}

// Queries of this tick for another optimum than that of `sigma`; one at most where following took
// more than a step, for a deadline sees the bursts.
int TrackerCore::SearchQueries(double sigma) {
  constexpr int kMost = 2;
  if (!pace.searches) return 0;
  const bool falls = sigma < (1.0 - tune::kFalls) * last_sigma;
  const double due = falls ? tune::kSearchFalling : tune::kSearchRising;
  last_sigma = sigma;
  search_due = std::min<double>(search_due + due, kMost);
  const int queries = std::min(static_cast<int>(search_due), iterations > 1 ? 1 : kMost);
  search_due -= queries;
  return queries;
}

void TrackerCore::TrySwitch() {
  const double sigma = work.norm.Sigma(optimum), kept = 1.0 - options.switch_gain;
  if (!elsewhere.Search({.own = optimum,
                         .own_sigma = sigma,
                         .sigma = kept * kept * sigma,
                         .queries = SearchQueries(sigma),
                         .obstacles = Obstacles()})) {
    return;
  }
  work.Unwound(elsewhere.q(), candidate);
  if (!Free(candidate)) return;
  switched = true;
  optimum = candidate;
  start = elsewhere.start();
}

// Obstacles may have run into the follower where it stands: then it goes to what is free beside
// that, if max_step lets it.
bool TrackerCore::Evaded() {
  if (!obstacles_moved || Free(at)) return true;
  const LocalResult* beside = &follower.Follow({at, false, Obstacles(), kInfinity});
  candidate = beside->q;
  if (!beside->free || !Free(candidate)) {
    beside = &follower.Retreat(candidate);
    if (!beside->free) return false;
    candidate = beside->q;
    if (!Free(candidate)) return false;
  }
  if (approach.Cut(at, candidate) < 1.0) {
    optimum = candidate;
    fleeing = true;
    return false;
  }
  if (at == optimum) optimum = candidate;
  at = candidate;
  return true;
}

// Moves the follower. Returns false if nothing free is known.
bool TrackerCore::Approached(bool command_free) {
  start = Component::kMotionCoherence;
  blocked = std::max(0, blocked - 1);
  stood = at;
  if (Limited() && !Evaded()) return false;
  evaded = at;
  const bool settled = at == optimum;
  if (command_free) {
    switched = blocked == 0 && follower.Farther(optimum, command, tune::kJump * moved + Noise());
    optimum = command;
  } else if (Follow()) {
    if (settled && blocked == 0) TrySwitch();
  } else {
    if (!Limited()) return false;
    optimum = at;  // what it was on its way to is lost
  }
  if (!Limited()) {
    at = optimum;
    return true;
  }
  if (settled) side_reach = tune::kReach * moved + Noise();
  GoOn();
  if (evaded != stood && approach.Cut(stood, at) < 1.0) at = evaded;  // too far for one tick
  return true;
}

// Nothing that is followed is free: a solve with what is left of the budget, if that is enough for
// one; in the next tick it comes first. Where max_step does not let the follower go there at once,
// it goes as far as it may.
void TrackerCore::FallBack(Result& result) {
  on_command = false;
  if (fleeing) return Flee(result);
  const std::int64_t left = Left() - kBeyondSolve;
  if (left < 1) {
    lost = !lost && options.queries > kBeyondSolve + 3;  // the command and two words
    return Stand(Limited() ? at : optimum, result);
  }
  lost = false;
  const double left_s = std::max(options.options.time_limit - work.budget.Elapsed(),
                                 std::numeric_limits<double>::min());  // 0 would be no limit
  core.budget = {.queries = static_cast<int>(left), .seconds = left_s};
  core.reporter.depths_of_unsolved = pace.depths;
  Solve(result);
  if (result.status == Status::kUnsolved) return;
  optimum = ToEigen(result.q);
  switched = true;
  elsewhere.Reset();
  if (approach.Cut(at, optimum) < 1.0) return Flee(result);
  at = optimum;
}

// From where nothing is free towards `optimum`, where it is, as far as max_step allows.
void TrackerCore::Flee(Result& result) {
  fleeing = false;
  approach.Cut(at, optimum);
  at = approach.q();
  advanced = true;
  start = Component::kMotionCoherence;
  if (Free(at)) return Answer(result);
  Stand(at, result);
}

// An answer that is not free; how deep, if a query is left for that.
void TrackerCore::Stand(const VectorXd& q, Result& result) {
  result.q.assign(q.data(), q.data() + q.size());
  result.status = Status::kUnsolved;
  result.sigma = work.norm.Sigma(q);
  if (Left() > 0) {
    result.min_distance =
        core.verifier.Check(result.q, q_in, pace.depths, verify::Words::kSkipped).min_distance;
  }
  result.cause = Cause::kBudget;
  result.reason = "no free configuration found that a tick reaches within its queries and max_step";
}

void TrackerCore::SetMocap(const MocapPoses& poses) {
  if (poses == core.mocap) return;
  obstacles_moved = true;
  core.SetMocap(poses.pos, poses.quat);
}

void TrackerCore::SetObstacles(const mjData& data) {
  obstacles_moved = obstacles_moved || !core.HasObstacles(data);
  core.SetObstacles(data);
}

}  // namespace mjcf_pdg
