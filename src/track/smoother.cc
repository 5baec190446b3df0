#include "track/smoother.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "norm/change.h"
#include "problem/effort.h"
#include "solve/rest.h"

namespace mjcf_pdg {

namespace tune = tuning::smoothing;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The best ω for the unconstrained E: by Young's formula, of ρ, the spectral radius of Jacobi's
// iteration on a long chain.
double Relaxation(double weight) {
  const double rho = 2.0 * weight / (1.0 + 2.0 * weight);
  return 2.0 / (1.0 + std::sqrt(1.0 - rho * rho));
}

// The frames' numbers in the order of a sweep.
std::size_t Turn(std::size_t k, std::size_t count, bool backward) {
  return backward ? count - 1 - k : k;
}

}  // namespace

void CheckSmooth(double weight, const Options& options) {
  constexpr double kLargest = 1e6;
  if (!(weight >= 0.0 && weight <= kLargest)) throw Error("smooth must lie between 0 and 1e6");
  if (weight == 0.0) return;
  if (options.method != Method::kAuto) throw Error("smooth needs method auto");
  if (options.time_limit < kInfinity) {
    throw Error("smooth seeks all frames together, and the time limit is of one");
  }
}

Smoother::Smoother(const Scene& scene, const Options& options, double weight,
                   const std::vector<Frame>& frames)
    : weight_(weight),
      relaxation_(Relaxation(weight)),
      frames_(frames),
      scene_(scene),
      options_(options),
      core_(scene, options_),
      follower_(core_.work, {.steps = tune::kSteps}),
      earlier_(scene.tables(), options.metric),
      answers_(frames.size()),
      gains_(frames.size(), kInfinity),
      iterations_(frames.size(), 0),
      queries_(frames.size(), 0),
      seconds_(frames.size(), 0.0) {}

bool Smoother::Run(const std::function<bool()>& go_on, std::vector<Result>& results) {
  // Those that do not look elsewhere stay on their side of an obstacle as long as they can.
  std::vector<std::vector<Result>> ways;
  for (const bool searches : {true, false}) {
    for (const bool backward : {false, true}) {
      FrameSolver solver(scene_, options_, searches);
      if (!searches && !solver.follows()) continue;
      if (!Follow(solver, backward, go_on, ways.emplace_back())) return false;
    }
  }
  Choose(ways);
  energy_ = Energy();
  for (int pair = 0; pair < tune::kPairs; ++pair) {
    const double before = energy_;
    if (!Sweep(false, go_on) || !Sweep(true, go_on)) return false;
    if (!(energy_ < (1.0 - tune::kConvergence) * before)) break;
  }
  results = std::move(ways.front());
  for (std::size_t k = 0; k < frames_.size(); ++k) {
    if (!go_on()) return false;
    if (answers_[k].free) Report(k, results[k]);
  }
  return true;
}

bool Smoother::Follow(FrameSolver& solver, bool backward, const std::function<bool()>& go_on,
                      std::vector<Result>& results) {
  results.resize(frames_.size());
  for (std::size_t k = 0; k < frames_.size(); ++k) {
    if (!go_on()) return false;
    const std::size_t at = Turn(k, frames_.size(), backward);
    solver.Solve(frames_[at], results[at]);
    queries_[at] += results[at].stats.collision_queries;
    iterations_[at] += results[at].stats.iterations;
    seconds_[at] += results[at].stats.seconds;
  }
  return true;
}

// Of the answers of each frame, one for each way to follow, those whose sequence has the least E.
// Beside one that is not free, a free one is taken.
void Smoother::Choose(const std::vector<std::vector<Result>>& ways) {
  const std::size_t count = frames_.size(), choices = ways.size();
  std::vector<std::vector<Answer>> answers(count, std::vector<Answer>(choices));
  std::vector<std::vector<std::size_t>> before(count, std::vector<std::size_t>(choices, 0));
  std::vector<double> least(choices, 0.0),
      up_to(choices);  // E up to a frame that ends in an answer
  for (std::size_t k = 0; k < count; ++k) {
    bool some_free = false;
    for (std::size_t way = 0; way < choices; ++way) {
      const Result& result = ways[way][k];
      answers[k][way] = {ToEigen(result.q), result.status != Status::kUnsolved, result.sigma};
      some_free = some_free || answers[k][way].free;
    }
    const std::vector<double> earlier = least;
    for (std::size_t way = 0; way < choices; ++way) {
      least[way] = some_free && !answers[k][way].free ? kInfinity : answers[k][way].sigma;
      if (k == 0) continue;
      for (std::size_t other = 0; other < choices; ++other) {
        up_to[other] = earlier[other] + ChangeFrom(k - 1, answers[k - 1][other], answers[k][way]);
      }
      const auto best = std::min_element(up_to.begin(), up_to.end());
      before[k][way] = static_cast<std::size_t>(best - up_to.begin());
      least[way] += *best;
    }
  }
  const auto best = std::min_element(least.begin(), least.end());
  std::size_t way = static_cast<std::size_t>(best - least.begin());
  for (std::size_t k = count; k-- > 0; way = before[k][way]) answers_[k] = answers[k][way];
}

// W times the change from frame k to the next; 0 if either is not free.
double Smoother::ChangeFrom(std::size_t k, const Answer& from, const Answer& to) {
  if (!from.free || !to.free) return 0.0;
  earlier_.SetReference(ToEigen(frames_[k].q), frames_[k].mocap);
  earlier_.Linearize(earlier_.q_in(), r_, J_);
  Change(scene_.tables(), from.q, to.q, X_, nullptr);
  return weight_ * (J_ * X_).squaredNorm();
}

double Smoother::Energy() {
  double sum = 0.0;
  for (std::size_t k = 0; k < frames_.size(); ++k) {
    if (answers_[k].free) sum += answers_[k].sigma;
    if (k + 1 < frames_.size()) sum += ChangeFrom(k, answers_[k], answers_[k + 1]);
  }
  return sum;
}

bool Smoother::Sweep(bool backward, const std::function<bool()>& go_on) {
  const std::size_t count = frames_.size();
  const double still = tune::kStill * energy_ / static_cast<double>(count);
  for (std::size_t k = 0; k < count; ++k) {
    if (!go_on()) return false;
    const std::size_t at = Turn(k, count, backward);
    const std::size_t first = at > 0 ? at - 1 : 0, last = std::min(at + 1, count - 1);
    const double gained = std::max({gains_[first], gains_[at], gains_[last]});
    if (!answers_[at].free || !(gained > still)) continue;
    gains_[at] = Improve(at);
    energy_ -= gains_[at];
  }
  return true;
}

// The problem of frame k alone.
void Smoother::Begin(std::size_t k) {
  const Frame& frame = frames_[k];
  q_in_ = &frame.q;
  if (!(frame.mocap == core_.mocap)) core_.SetMocap(frame.mocap.pos, frame.mocap.quat);
  const bool rests = options_.rest > 0.0;
  if (rests) {
    core_.verifier.IsFree(frame.q, frame.q);
    DistancesAtRest(core_.verifier, scene_.tables(), at_rest_);
  }
  core_.work.Begin(ToEigen(frame.q), core_.mocap, rests ? &at_rest_ : nullptr);
}

// Lets a neighbour of frame k pull; `earlier` is the earlier of the two.
void Smoother::Pull(std::size_t k, std::size_t neighbour, std::size_t earlier) {
  if (!answers_[neighbour].free) return;
  if (earlier != k) {
    earlier_.SetReference(ToEigen(frames_[earlier].q), frames_[earlier].mocap);
    earlier_.Linearize(earlier_.q_in(), r_, J_);
  }
  core_.work.norm.AddPull(answers_[neighbour].q, std::sqrt(weight_) * J_);
}

// Descends on frame k's part of E and goes on in the same direction by ω, if that is free, too.
// Returns by how much E is lower.
double Smoother::Improve(std::size_t k) {
  const BudgetMeter::Clock::time_point begin = BudgetMeter::Clock::now();
  const std::int64_t queries = core_.Queries();
  Begin(k);
  NormEvaluator& norm = core_.work.norm;
  core_.work.budget.Begin({}, begin, core_.work.finder.queries());
  norm.Linearize(core_.work.problem().q_in, r_, J_);
  if (k + 1 < frames_.size()) Pull(k, k + 1, k);
  if (k > 0) Pull(k, k - 1, k - 1);
  Answer& answer = answers_[k];
  const double before = norm.Sigma(answer.q);
  const LocalResult* descended = &follower_.Follow({answer.q, true, ++visits_, kInfinity});
  iterations_[k] += descended->iterations;
  found_ = answer.q;
  if (descended->free && descended->sigma < before) {
    Difference(scene_.tables(), answer.q, descended->q, dq_);
    Integrate(scene_.tables(), answer.q, relaxation_ * dq_, trial_);
    ClampToLimits(scene_.tables(), trial_);
    core_.work.equality.Project(trial_);
    if (!Lower(trial_, before) && !Lower(descended->q, before)) {
      trial_ = descended->q;
      descended = &follower_.Retreat(trial_);
      if (descended->free) Lower(descended->q, before);
    }
  }
  const double gain = before - norm.Sigma(found_);
  answer.q = found_;
  queries_[k] += static_cast<int>(core_.Queries() - queries);
  seconds_[k] += std::chrono::duration<double>(BudgetMeter::Clock::now() - begin).count();
  return gain;
}

// Takes q as found_ if frame k's part of E is less there than `than` and the verifier calls it
// free.
bool Smoother::Lower(const VectorXd& q, double than) {
  if (!(core_.work.norm.Sigma(q) < than)) return false;
  asked_.assign(q.data(), q.data() + q.size());
  if (!core_.verifier.IsFree(asked_, *q_in_)) return false;
  found_ = q;
  return true;
}

void Smoother::Report(std::size_t k, Result& result) {
  const Frame& frame = frames_[k];
  Reporter::Clear(result);
  Begin(k);
  asked_.assign(answers_[k].q.data(), answers_[k].q.data() + answers_[k].q.size());
  core_.reporter.Input(frame.q, result);
  if (asked_ != frame.q) {
    core_.reporter.Solved(frame.q, {asked_, Component::kMotionCoherence}, result);
    const std::vector<NearPair>& overlaps = core_.work.OverlapsAtInput();
    core_.reporter.Overlaps(overlaps, result);
    if (options_.report_lower_bound) {
      const int cells = PlanFor(options_.effort).bound_cells;
      result.sigma_lower_bound = core_.bound.Sigma(core_.work, overlaps, cells);
    }
  }
  result.stats.iterations = iterations_[k];
  result.stats.collision_queries = queries_[k];
  result.stats.seconds = seconds_[k];
}

}  // namespace mjcf_pdg
