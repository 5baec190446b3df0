#include "optimize/local_optimization.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace mjcf_pdg {

namespace tune = tuning::descent;

LocalOptions LocalOptions::Polishing() {
  LocalOptions options;
  options.start = Component::kPolish;
  options.max_iterations = tune::kPolishSteps;
  options.convergence = tune::kPolishConvergence;
  options.trust_radius = tune::kPolishRadius;
  options.last_chances = tune::kPolishChances;
  return options;
}

LocalOptions LocalOptions::Retreating() {
  LocalOptions options = Polishing();
  options.retreats = true;
  return options;
}

LocalOptimization::LocalOptimization(Workspace& work)
    : problem_(work.problem()), work_(work), step_(work) {
  apart_.resize(problem_.tables.n);
  for (Iterate* it : {&descent_.best, &descent_.current, &descent_.trial}) {
    it->near.reserve(problem_.tables.pairs.size());
  }
}

void LocalOptimization::Look(const VectorXd& q, double margin, Iterate& out) {
  out.q = q;
  work_.finder.Pose(q);
  out.near = work_.finder.Find(margin + problem_.clearance, Depths::kSkipped);
  std::erase_if(out.near,
                [this](const NearPair& n) { return !problem_.tables.pairs[n.pair].moves; });
}

void LocalOptimization::Evaluate(double margin, Iterate& out) {
  out.sigma = work_.norm.Sigma(out.q);
  features_.Keep(problem_.tables, work_.finder.posed(), out.near);
  const std::size_t found = out.near.size();
  features_.AppendLearnt(problem_.tables, work_.finder.posed(), margin, out.near);
  out.learnt = out.near.size() - found;
  out.violation = 0.0;
  out.worst = -1.0;
  double of_pair = 0.0;  // of several features of a pair only the deepest counts
  for (std::size_t k = 0; k < out.near.size(); ++k) {
    if (std::isinf(out.near[k].distance)) MeasureOverlap(k, margin, out);
    const NearPair& near = out.near[k];
    const double needed = problem_.required[near.pair] - near.distance;
    const double excess = std::max(0.0, needed - aim_);
    const bool same = k > 0 && near.pair == out.near[k - 1].pair;
    of_pair = same && !PartedByOnePlane(near.kind) ? of_pair : 0.0;
    out.violation += std::max(0.0, excess - of_pair);
    of_pair = std::max(of_pair, excess);
    out.worst = std::max(out.worst, needed - accept_);
  }
  const double torn = work_.equality.Violation(out.q) - kEqualityTolerance;
  out.violation += std::max(0.0, torn);
  out.worst = std::max(out.worst, torn);
}

// Replaces out.near[k], an exact pair that overlaps by an unknown depth: by the planes that the
// pair had where it was apart and by the triangles that cross; or, if it never was apart, by
// measuring. Unless an overlap is allowed, the iterate is not free then, however small the depths
// found are.
void LocalOptimization::MeasureOverlap(std::size_t k, double margin, Iterate& out) {
  NearPair crossing = out.near[k];
  measured_.clear();
  features_.Append(problem_.tables, work_.finder.posed(), crossing.pair, measured_);
  const bool by_planes = !measured_.empty();
  if (!by_planes) {
    work_.finder.AppendFeatures(crossing.pair, margin, depths_, measured_);
  }
  const bool allowed = problem_.required[crossing.pair] < 0.0;
  if (!allowed || by_planes || measured_.empty()) {
    out.worst = std::max(out.worst, problem_.tolerances.user);
  }
  if (by_planes || measured_.empty()) {
    crossing.distance = crossing.n_W.dot(crossing.p2_W - crossing.p1_W);
    if (crossing.distance < 0.0) {
      measured_.push_back(crossing);
      if (by_planes) features_.Learn(problem_.tables, work_.finder.posed(), crossing);
    } else {
      out.violation += tune::kUnseenOverlap * problem_.size;
    }
  }
  if (measured_.empty()) measured_.push_back(crossing);
  const auto at = out.near.begin() + static_cast<std::ptrdiff_t>(k);
  out.near.insert(out.near.erase(at), measured_.begin(), measured_.end());
}

void LocalOptimization::Keep(const Iterate& it, LocalResult& result) const {
  if (Free(it) && (!result.free || it.sigma < result.sigma)) {
    result.free = true;
    result.sigma = it.sigma;
    result.q = it.q;
  }
}

// Linearizes at the current iterate and makes one step from there, to next_.
void LocalOptimization::Step(Descent& d) {
  const double margin = d.options.margin * problem_.size;
  if (!d.finder_at_current) work_.finder.Pose(d.current.q);
  step_.Linearize(d.current.q, d.current.near,
                  {.margin = margin, .aim = aim_, .safety_margin = safety_margin_});
  d.length =
      step_.Solve({.scale = scale_, .penalty = mu_, .damping = damping_, .trust_radius = d.radius});
  work_.norm.Retract(d.current.q, step_.dq(), next_);
  ClampToLimits(problem_.tables, next_);
  work_.equality.Project(next_);
}

// The trial: what is at next_.
void LocalOptimization::LookAtStep(Descent& d) {
  const double reach =
      std::clamp(tune::kMarginPerStep * step_.LargestLength(),
                 d.options.least_margin * problem_.size, tune::kLargestMargin * problem_.size);
  Look(next_, reach, d.trial);
  Evaluate(reach, d.trial);
  if (features_.learning()) AdaptSafetyMargin(d);
}

// Tells an observer of the iterate, and of the step that led there.
void LocalOptimization::Observe(const Iterate& it, bool stepped) {
  if (!work_.Watched()) return;
  work_.recorder->rows().clear();
  if (stepped) step_.AppendObserved(work_.recorder->rows());
  work_.recorder->Tell({it.q, it.sigma, it.violation, Free(it)});
}

void LocalOptimization::AdaptSafetyMargin(const Descent& d) {
  if (Free(d.trial)) {
    safety_margin_ *= tune::kSafetyMarginKept;
  } else {
    const double wanted =
        tune::kSafetyMarginPerOverlap * std::max(safety_margin_, d.trial.violation);
    safety_margin_ = std::min(wanted, tune::kSafetyMarginPerStep * d.length);
  }
}

// Takes back a step of exact meshes that ended in an overlap, since triangles that cross tell
// little about the way out: it will be made again from where the meshes are apart, shorter and with
// the planes that the overlap taught. Returns false when it would be too short.
bool LocalOptimization::TakeBackStep(Descent& d) {
  AdaptDamping(d.current, d.trial);
  const double share = d.taken_back++ == 0 ? tune::kFirstShortened : tune::kShortened;
  d.radius = share * std::min(d.radius, d.length);
  work_.finder.Pose(d.current.q);
  d.finder_at_current = true;
  std::vector<NearPair>& near = d.current.near;
  near.resize(near.size() - d.current.learnt);
  const std::size_t found = near.size();
  features_.AppendLearnt(problem_.tables, work_.finder.posed(), tune::kFirstMargin * problem_.size,
                         near);
  d.current.learnt = near.size() - found;
  return d.radius >= tune::kLeastRadius * problem_.size;
}

// ν is a few times the largest contact force. With μ instead, which is far above the forces, a
// micrometre of overlap would outweigh all that σ can gain.
void LocalOptimization::SetMeritPenalty() {
  const double wanted = tune::kPenaltyOverForce * step_.LargestForce();
  merit_penalty_ = std::min(mu_, std::max(merit_penalty_, wanted));
}

void LocalOptimization::AdaptDamping(const Iterate& current, const Iterate& trial) {
  const double promised = Merit(current) - Merit(Cost{step_.sigma(), step_.violation()});
  const double kept = Merit(current) - Merit(trial);
  if (kept > tune::kKept * promised) {
    damping_ = damping_ > tune::kLeastDamping ? 0.1 * damping_ : 0.0;
  } else if (kept < tune::kBroken * promised) {
    damping_ = 10.0 * std::max(damping_, tune::kRenewedDamping);
  }
}

// Whether q is so close to the known optimum, by the metric of the linearized norm, that the
// descent would end there.
bool LocalOptimization::NearKnown(const VectorXd& q, const LocalOptions& options) {
  if (!options.known || step_.sigma() < tune::kBeatsKnown * options.known_sigma) return false;
  Difference(problem_.tables, q, *options.known, apart_);
  return step_.SquaredLength(apart_) < tune::kNearKnown * tune::kNearKnown * options.known_sigma;
}

// Whether the step leads to the known optimum and promises no lower σ: what is there need not be
// looked at.
bool LocalOptimization::LeadsToKnown(Descent& d) {
  d.result.reached_known = step_.sigma() >= d.options.known_sigma && NearKnown(next_, d.options);
  return d.result.reached_known;
}

// Whether the descent is to be given up: it promises nothing better than what is known, is near the
// known optimum, or (exact meshes) has found no lower σ for some steps.
bool LocalOptimization::GivesUp(Descent& d) {
  const LocalOptions& options = d.options;
  // A descent that is far from its optimum gets nearer by a like share with each step.
  const double promised = step_.uncut_sigma();
  double falls = 1.0;
  if (options.looks_ahead) {
    falls = d.promised > 0.0 ? std::min(1.0, promised / d.promised) : 0.0;
  }
  d.promised = promised;
  const bool settling = Free(d.trial) || d.result.iterations >= tune::kGiveUpFrom;
  d.hopeless = settling && falls * promised > options.give_up_sigma ? d.hopeless + 1 : 0;
  d.result.hopeless = d.hopeless >= tune::kHopeless;
  if (d.result.hopeless) return true;
  d.result.reached_known = NearKnown(d.trial.q, options);
  if (d.result.reached_known) return true;
  const bool lower = !(d.result.sigma > (1.0 - options.convergence) * d.sigma_before);
  d.idle = features_.learning() && d.result.free && !lower ? d.idle + 1 : 0;
  return d.idle == options.last_chances;
}

// The trial becomes the current iterate, and the best one if it is better.
void LocalOptimization::Advance(Descent& d) {
  d.taken_back = 0;
  SetMeritPenalty();
  d.overlapping = Free(d.trial) ? 0 : d.overlapping + 1;
  if (step_.several_trees() && d.overlapping >= tune::kDrifts &&
      d.trial.worst < tune::kNearlyFree * problem_.size) {
    damping_ = 10.0 * std::max(damping_, tune::kFirstDamping);
  } else {
    AdaptDamping(d.current, d.trial);
  }
  if (d.without_progress == 0) d.first_length = d.length;
  ++d.without_progress;
  if (Merit(d.trial) < Merit(d.best)) {
    d.without_progress = 0;
    d.best = d.trial;
    if (d.length > tune::kFullStep * d.radius)
      d.radius = std::min(2.0 * d.radius, d.largest_radius);
  }
  std::swap(d.current, d.trial);
  d.finder_at_current = true;
}

// Whether the descent has settled: where it is free, or in an overlap that remains at the largest
// μ, because contacts conflict there. An overlap at a smaller μ raises it.
bool LocalOptimization::HasConverged(Descent& d) {
  const bool small =
      d.length < tune::kSmallStep * problem_.size + tune::kSmallShare * std::sqrt(d.current.sigma);
  if (Free(d.current)) {
    const double change = std::abs(d.sigma_before - d.current.sigma);
    d.settled = change <= d.options.convergence * d.current.sigma ? d.settled + 1 : 0;
    return small || d.settled >= tune::kSettled;
  }
  if (!small || d.without_progress == 0) return false;
  if (mu_ >= tune::kHighestPenalty * scale_) return true;
  mu_ *= 10.0;
  d.best = d.current;
  d.without_progress = 0;
  return false;
}

// At the last step, which has been taken.
bool LocalOptimization::IsEnough(const Descent& d) const {
  return Free(d.current) && d.length < tune::kFullStep * d.radius &&
         std::abs(d.current.sigma - step_.sigma()) < d.options.enough * d.current.sigma &&
         step_.DampingShare() < d.options.enough;
}

// Goes back to the best iterate with half the trust radius. Returns false when that is too small.
bool LocalOptimization::ReturnToBest(Descent& d) {
  d.radius = 0.5 * std::min(d.radius, features_.learning() ? d.first_length : d.length);
  d.current = d.best;
  d.finder_at_current = false;
  d.without_progress = 0;
  return d.radius >= tune::kLeastRadius * problem_.size;
}

void LocalOptimization::Begin(const VectorXd& q, const LocalOptions& options, Descent& d) {
  static_cast<Progress&>(d) = {};
  static_cast<LocalOutcome&>(d.result) = {};
  d.options = options;
  step_.Clear();
  features_.Clear(problem_.tables.pairs.size());
  if (!work_.remembers_distances) work_.finder.ForgetConvex();
  aim_ = options.retreats ? -problem_.tolerances.user : problem_.tolerances.aim;
  accept_ = options.retreats ? 0.0 : problem_.tolerances.accept;
  depths_ = d.options.depths;
  next_ = q;
  ClampToLimits(problem_.tables, next_);
  work_.equality.Project(next_);
  Look(next_, options.margin * problem_.size, d.current);
  Evaluate(options.margin * problem_.size, d.current);
  scale_ = std::max(problem_.size, tune::kSizePerDepth * d.current.worst) / tune::kDeskSize;
  BeginSteps(options, d);
  d.best = d.current;
}

void LocalOptimization::BeginSteps(const LocalOptions& options, Descent& d) {
  mu_ = tune::kFirstPenalty * scale_;
  merit_penalty_ = 0.0;
  damping_ = tune::kFirstDamping;
  safety_margin_ = 0.0;
  d.radius = d.largest_radius = std::min(options.trust_radius * scale_, options.largest_step);
}

const LocalResult& LocalOptimization::Run(const VectorXd& q, const LocalOptions& options) {
  Begin(q, options, descent_);
  if (work_.Watched()) work_.recorder->BeginDescent(options.start);
  Observe(descent_.current, false);
  return Go(descent_);
}

const LocalResult& LocalOptimization::Resume(const LocalOptions& options) {
  Descent& d = descent_;
  const int iterations = options.renewed ? 0 : d.result.iterations;
  if (options.renewed) {
    const double damping = damping_;
    static_cast<Progress&>(d) = {};
    d.best = d.current;
    BeginSteps(options, d);
    damping_ = std::min(damping_, damping);
  }
  d.options = options;
  d.options.max_iterations += iterations;
  static_cast<LocalOutcome&>(d.result) = {};
  d.result.iterations = iterations;
  d.current.sigma = work_.norm.Sigma(d.current.q);
  d.best.sigma = options.renewed ? d.current.sigma : work_.norm.Sigma(d.best.q);
  d.finder_at_current = false;
  return Go(d);
}

const LocalResult& LocalOptimization::Go(Descent& d) {
  d.result.ended = true;
  Keep(d.current, d.result);
  for (;;) {
    const int most = d.options.max_iterations + (Free(d.current) ? 0 : d.options.corrections);
    if (d.result.iterations >= most || work_.Spent()) {
      d.result.ended = false;
      break;
    }
    const BudgetMeter::Clock::time_point begin = work_.budget.Now();
    Step(d);
    d.result.length += d.length;
    if (LeadsToKnown(d)) break;
    ++d.result.iterations;
    LookAtStep(d);
    work_.budget.Stepped(begin);
    Observe(d.trial, true);
    d.sigma_before = d.result.sigma;
    Keep(d.trial, d.result);
    if (GivesUp(d)) break;
    if (features_.learning() && Free(d.current) && !Free(d.trial)) {
      if (!TakeBackStep(d)) break;
      continue;
    }
    Advance(d);
    if (HasConverged(d) || IsEnough(d)) break;
    const int patience = features_.learning() ? tune::kPatienceWithPlanes : tune::kPatience;
    if (d.without_progress > patience && !ReturnToBest(d)) break;
  }
  if (!d.result.free) {
    d.result.q = d.best.q;
    d.result.sigma = d.best.sigma;
    d.result.violation = d.best.violation;
  }
  return d.result;
}

bool Retreat(LocalOptimization& local, const Candidate& candidate, Outcome& outcome, VectorXd& q) {
  const LocalResult& retreated = local.Run(candidate.q, LocalOptions::Retreating());
  outcome.iterations += retreated.iterations;
  q = retreated.q;
  return retreated.free;
}

}  // namespace mjcf_pdg
