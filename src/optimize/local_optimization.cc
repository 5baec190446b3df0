#include "optimize/local_optimization.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/grow.h"

namespace mjcf_pdg {
namespace {

constexpr int kMaxContactRows = 48;
// μ [m], for scenes up to desk size; larger ones scale it. Joint limits give way to nothing.
constexpr double kFirstPenalty = 10.0, kHighestPenalty = 1e4, kLimitPenalty = 1e6;
constexpr double kDeskSize = 0.1;          // typical radius there [m]
constexpr double kSizePerDepth = 0.1;      // deep overlaps make a scene larger
constexpr double kPenaltyOverForce = 3.0;  // by which steps are judged, over the largest force
constexpr double kNearKnown = 0.15;        // √σ to a known optimum, in units of its own √σ
constexpr double kBeatsKnown = 0.95;       // a prediction below that may lead elsewhere
constexpr int kGiveUpFrom = 4;  // a start that still overlaps after so many steps is judged too
constexpr int kHopeless = 2, kSettled = 2;               // such steps in a row end it
constexpr double kSmallStep = 1e-6, kSmallShare = 1e-4;  // a small step: [size] and of √σ
constexpr int kPatience = 7;            // steps without progress before the trust radius shrinks
constexpr int kPatienceWithPlanes = 1;  // ... where each step teaches where triangles cross
// Levenberg-Marquardt: a tenth after steps that keep most of what they promise, tenfold after
// others.
constexpr double kFirstDamping = 0.1, kLeastDamping = 1e-5, kRenewedDamping = 1e-4;
constexpr double kKept = 0.75, kBroken = 0.25;  // share of the promised decrease
constexpr double kLeastRadius = 1e-6;           // [size]
constexpr double kFullStep = 0.9;               // of the trust radius: it may be doubled
constexpr double kLargestTurn = 1.0;  // of a joint in a step; no linearization holds beyond [rad]
// Margins within which pairs get rows, in units of the scene's size; later 1.5 times the step.
constexpr double kFirstMargin = 0.12, kLeastMargin = 0.01, kLargestMargin = 0.5;
constexpr double kUnseenOverlap = 1e-3;  // counted for an overlap of unknown depth [size]
// Exact meshes keep a safety margin from what bounds a step, for curved surfaces meet earlier than
// their planes: twice the overlap that a step ends in, at most a share of its length; kept in part
// after others.
constexpr double kSafetyMarginPerOverlap = 2.0, kSafetyMarginPerStep = 0.03,
                 kSafetyMarginKept = 0.25;
// A step that ends in an overlap is made again: by this share of its length the first time, when
// what it taught may suffice, then by the smaller one.
constexpr double kFirstRetreat = 0.7, kRetreat = 0.15;
// Joint limits farther than this get no row: [rad], of slides [size].
constexpr double kLimitReach = 0.5, kSlideReach = 5.0;

}  // namespace

LocalOptions LocalOptions::Polishing() {
  LocalOptions options;
  options.max_iterations = 15;
  options.convergence = 1e-6;
  options.trust_radius = 0.05;
  options.last_chances = 3;
  return options;
}

LocalOptions LocalOptions::Retreating() {
  LocalOptions options = Polishing();
  options.retreats = true;
  return options;
}

// Rooms for the most rows there can be, so that no later run needs more.
LocalOptimization::LocalOptimization(Workspace& work) : problem_(work.problem()), work_(work) {
  const SceneTables& tables = problem_.tables;
  const std::size_t pairs = tables.pairs.size();
  const int n = tables.n, limits = 2 * static_cast<int>(tables.joints.size());
  const int rows = kMaxContactRows * (1 + WitnessMemory::kPerPair) + limits;
  rows_.Reserve(rows, n);
  lcp_.Reserve(n, rows);
  GrowTo(n, rows, G_);
  for (VectorXd* per_row : {&lambda_, &b_, &bounds_, &slack_}) GrowTo(rows, *per_row);
  nearest_.reserve(pairs);
  apart_.resize(n);
  for (Iterate* it : {&descent_.best, &descent_.current, &descent_.trial}) it->near.reserve(pairs);
}

void LocalOptimization::Look(const VectorXd& q, double margin, Iterate& out) {
  out.q = q;
  work_.finder.Pose(q);
  out.near = work_.finder.Find(margin + problem_.options.clearance, Depths::kSkipped);
  std::erase_if(out.near,
                [this](const NearPair& n) { return !problem_.tables.pairs[n.pair].moves; });
}

void LocalOptimization::Evaluate(double margin, Iterate& out) {
  out.sigma = work_.norm.Sigma(out.q);
  features_.Keep(problem_.tables, work_.finder.posed(), out.near);
  out.found = out.near.size();
  features_.AppendLearnt(problem_.tables, work_.finder.posed(), margin, out.near);
  out.violation = 0.0;
  out.worst = -1.0;
  double of_pair = 0.0;  // of the features of a pair the worst counts
  for (std::size_t k = 0; k < out.near.size(); ++k) {
    if (std::isinf(out.near[k].distance)) MeasureOverlap(k, margin, out);
    const NearPair& near = out.near[k];
    const double needed = problem_.required[near.pair] - near.distance;
    const double excess = std::max(0.0, needed - aim_);
    const bool same = k > 0 && near.pair == out.near[k - 1].pair;
    of_pair = same && near.local ? of_pair : 0.0;
    out.violation += std::max(0.0, excess - of_pair);
    of_pair = std::max(of_pair, excess);
    out.worst = std::max(out.worst, needed - accept_);
  }
}

// An exact pair overlaps at out.near[k]: by the planes of where it was apart and by the triangles
// that cross, or else measured. Not free, however little these see of it.
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
      out.violation += kUnseenOverlap * problem_.size;
    }
  }
  if (measured_.empty()) measured_.push_back(crossing);
  const auto at = out.near.begin() + static_cast<std::ptrdiff_t>(k);
  out.near.insert(out.near.erase(at), measured_.begin(), measured_.end());
}

// Rows at the posed configuration, the nearest if there are too many; joint limits after them.
void LocalOptimization::Linearize(const Iterate& at, double margin) {
  const SceneTables& tables = problem_.tables;
  const PosedModel& posed = work_.finder.posed();
  const double merge = 1e-3 * problem_.size;
  nearest_.clear();
  for (const NearPair& near : at.near) nearest_.push_back(&near);
  auto slack = [this](const NearPair& near) {
    return near.distance - problem_.required[near.pair];
  };
  if (nearest_.size() > kMaxContactRows) {
    std::nth_element(nearest_.begin(), nearest_.begin() + kMaxContactRows, nearest_.end(),
                     [&](const NearPair* a, const NearPair* b) { return slack(*a) < slack(*b); });
    nearest_.resize(kMaxContactRows);
  }
  rows_.Clear(tables.n);
  for (const NearPair* near : nearest_) {
    double offset = aim_ - problem_.required[near->pair];
    if (near->local) offset -= safety_margin_;
    const int row = rows_.Append(near->distance + offset);
    ContactRow(tables, posed, near->pair, near->p1_W, near->p2_W, near->n_W, rows_.C.row(row));
    if (!remembers_ || near->local) continue;  // all features of such a pair are here
    auto append_remembered = [&](const Vector3d& p1_W, const Vector3d& p2_W) {
      const double distance = near->n_W.dot(p2_W - p1_W);
      if (distance > margin + problem_.options.clearance) return;
      const int extra = rows_.Append(distance + offset);
      ContactRow(tables, posed, near->pair, p1_W, p2_W, near->n_W, rows_.C.row(extra));
    };
    memory_.ForEach(tables, posed, *near, merge, append_remembered);
    memory_.Add(tables, posed, *near, merge);
  }
  contact_rows_ = rows_.m;
  AppendLimitRows(tables, at.q, {kLimitReach, kSlideReach * problem_.size, problem_.size}, rows_);
  work_.norm.Linearize(at.q, r_, J_);
}

double LocalOptimization::SolveStep(double trust_radius) {
  // H = JᵀJ = L Lᵀ; z = Lᵀ dq; y = L⁻¹ Jᵀ r; G = L⁻¹ Cᵀ.
  work_.norm.InnerProduct(J_, H_);
  if (damps_) AddDamping();
  whitening_.Factor(H_, work_.norm.blocks());
  y_.noalias() = J_.transpose() * r_;
  whitening_.SolveLower(y_);
  SolveLcp();
  dq_ = z_;
  whitening_.SolveUpper(dq_);
  moved_.noalias() = J_ * dq_;
  promised_sigma_ = (r_ + moved_).squaredNorm();
  const double length = moved_.norm();
  const double scale = std::min({1.0, trust_radius / length, kLargestTurn / LargestTurn()});
  dq_ *= scale;
  moved_ *= scale;
  PredictStep();
  return scale * length;
}

// λ_ and the whitened step z_ = G λ - y.
void LocalOptimization::SolveLcp() {
  const int n = problem_.tables.n, m = rows_.m;
  GrowTo(n, m, G_);
  for (VectorXd* per_row : {&lambda_, &b_, &bounds_}) GrowTo(m, *per_row);
  auto G = G_.leftCols(m);
  auto lambda = lambda_.head(m), b = b_.head(m), bounds = bounds_.head(m);
  G = rows_.C.topRows(m).transpose();
  whitening_.SolveLower(G);
  b = -rows_.gap.head(m);
  b.noalias() += G.transpose() * y_;
  bounds.setConstant(mu_);
  bounds.tail(m - contact_rows_).setConstant(kLimitPenalty * scale_);
  LcpOptions options;
  options.max_steps = 10 * (n + m);
  options.tolerance = 0.01 * problem_.tolerances.user;
  lcp_steps_ += lcp_.Solve(G, b, bounds, options, lambda).steps;
  z_ = -y_;
  z_.noalias() += G * lambda;
}

// What the linearization says of where dq_ leads.
void LocalOptimization::PredictStep() {
  predicted_.sigma = (r_ + moved_).squaredNorm();
  GrowTo(contact_rows_, slack_);
  auto slack = slack_.head(contact_rows_);
  slack = rows_.gap.head(contact_rows_);
  slack.noalias() += rows_.C.topRows(contact_rows_) * dq_;
  predicted_.violation = -slack.cwiseMin(0.0).sum();
}

double LocalOptimization::LargestTurn() const {
  double largest = 0.0;
  for (const JointEntry& joint : problem_.tables.joints) {
    for (int k = 0; k < joint.ndof; ++k) {
      if (!joint.Slides(k)) largest = std::max(largest, std::abs(dq_[joint.col + k]));
    }
  }
  return largest;
}

// The norm hardly sees light links: without damping, small gains turn them far and the
// linearization is lost. Rotations count as translations of the scene's size.
void LocalOptimization::AddDamping() {
  const double rotation = damping_ * problem_.size * problem_.size;
  for (const JointEntry& joint : problem_.tables.joints) {
    for (int k = 0; k < joint.ndof; ++k) {
      H_(joint.col + k, joint.col + k) += joint.Slides(k) ? damping_ : rotation;
    }
  }
}

void LocalOptimization::Keep(const Iterate& it, LocalResult& result) const {
  if (Free(it) && (!result.free || it.sigma < result.sigma)) {
    result.free = true;
    result.sigma = it.sigma;
    result.q = it.q;
  }
}

// One linearization at the current iterate, one step, judged: the trial.
void LocalOptimization::Step(Descent& d) {
  const double margin = kFirstMargin * problem_.size;
  if (!d.finder_at_current) work_.finder.Pose(d.current.q);
  Linearize(d.current, margin);
  d.length = SolveStep(d.radius);
  work_.norm.Retract(d.current.q, dq_, next_);
  ClampToLimits(problem_.tables, next_);
  const double reach =
      std::clamp(1.5 * d.length, kLeastMargin * problem_.size, kLargestMargin * problem_.size);
  Look(next_, reach, d.trial);
  Evaluate(reach, d.trial);
  if (features_.learning()) AdaptSafetyMargin(d);
}

void LocalOptimization::AdaptSafetyMargin(const Descent& d) {
  if (Free(d.trial)) {
    safety_margin_ *= kSafetyMarginKept;
  } else {
    const double wanted = kSafetyMarginPerOverlap * std::max(safety_margin_, d.trial.violation);
    safety_margin_ = std::min(wanted, kSafetyMarginPerStep * d.length);
  }
}

// A step of exact meshes that ends in an overlap is not taken, for triangles that cross tell
// little. It is made again from where they are apart, shorter, knowing what the overlap taught.
// False when it is too short.
bool LocalOptimization::Retreat(Descent& d) {
  AdaptDamping(d.current, d.trial);
  const double share = d.retreats++ == 0 ? kFirstRetreat : kRetreat;
  d.radius = share * std::min(d.radius, d.length);
  work_.finder.Pose(d.current.q);
  d.finder_at_current = true;
  d.current.near.resize(d.current.found);
  features_.AppendLearnt(problem_.tables, work_.finder.posed(), kFirstMargin * problem_.size,
                         d.current.near);
  return d.radius >= kLeastRadius * problem_.size;
}

// Steps are judged by a penalty weight a few times the largest force: by μ, which is far above, a
// micrometre of overlap would outweigh all that σ can gain.
void LocalOptimization::SetMeritPenalty() {
  if (contact_rows_ == 0) return;
  const double largest = lambda_.head(contact_rows_).maxCoeff();
  merit_penalty_ = std::min(mu_, std::max(merit_penalty_, kPenaltyOverForce * largest));
}

void LocalOptimization::AdaptDamping(const Iterate& current, const Iterate& trial) {
  const double promised = Merit(current) - Merit(predicted_);
  const double kept = Merit(current) - Merit(trial);
  if (kept > kKept * promised) {
    damping_ = damping_ > kLeastDamping ? 0.1 * damping_ : 0.0;
  } else if (kept < kBroken * promised) {
    damping_ = 10.0 * std::max(damping_, kRenewedDamping);
  }
}

// By the norm's local metric: close enough to the known optimum to end there.
bool LocalOptimization::NearKnown(const VectorXd& q, const LocalOptions& options) {
  if (!options.known || predicted_.sigma < kBeatsKnown * options.known_sigma) return false;
  Difference(problem_.tables, q, *options.known, apart_);
  to_known_.noalias() = J_ * apart_;
  return to_known_.squaredNorm() < kNearKnown * kNearKnown * options.known_sigma;
}

// The trial promises nothing better than is known, or nears the known optimum, or idles.
bool LocalOptimization::GivesUp(Descent& d) {
  const LocalOptions& options = d.options;
  const bool all_seen = depths_ == Depths::kSearched;
  const bool settling = Free(d.trial) || all_seen || d.result.iterations >= kGiveUpFrom;
  d.hopeless = settling && promised_sigma_ > options.give_up_sigma ? d.hopeless + 1 : 0;
  d.result.hopeless = d.hopeless >= kHopeless;
  if (d.result.hopeless) return true;
  d.result.reached_known = NearKnown(d.trial.q, options);
  if (d.result.reached_known) return true;
  const bool lower = !(d.result.sigma > (1.0 - options.convergence) * d.sigma_before);
  d.idle = features_.learning() && d.result.free && !lower ? d.idle + 1 : 0;
  return d.idle == options.last_chances;
}

// The trial becomes the current iterate, and the best one if it is better.
void LocalOptimization::Advance(Descent& d) {
  d.retreats = 0;
  SetMeritPenalty();
  AdaptDamping(d.current, d.trial);
  if (d.without_progress == 0) d.first_length = d.length;
  ++d.without_progress;
  if (Merit(d.trial) < Merit(d.best)) {
    d.without_progress = 0;
    d.best = d.trial;
    if (d.length > kFullStep * d.radius) d.radius = std::min(2.0 * d.radius, d.largest_radius);
  }
  std::swap(d.current, d.trial);
  d.finder_at_current = true;
}

// Settled where it is free, or in an overlap whose penalty weight can rise no more: contacts
// conflict there.
bool LocalOptimization::HasConverged(Descent& d) {
  const bool small =
      d.length < kSmallStep * problem_.size + kSmallShare * std::sqrt(d.current.sigma);
  if (Free(d.current)) {
    const double change = std::abs(d.sigma_before - d.current.sigma);
    d.settled = change <= d.options.convergence * d.current.sigma ? d.settled + 1 : 0;
    return small || d.settled >= kSettled;
  }
  if (!small || d.without_progress == 0) return false;
  if (mu_ >= kHighestPenalty * scale_) return true;
  mu_ *= 10.0;
  d.best = d.current;
  d.without_progress = 0;
  return false;
}

// From the best iterate again, within half the radius; false when there is none left.
bool LocalOptimization::ReturnToBest(Descent& d) {
  d.radius = 0.5 * std::min(d.radius, features_.learning() ? d.first_length : d.length);
  d.current = d.best;
  d.finder_at_current = false;
  d.without_progress = 0;
  return d.radius >= kLeastRadius * problem_.size;
}

void LocalOptimization::Begin(const VectorXd& q, const LocalOptions& options, Descent& d) {
  static_cast<Progress&>(d) = {};
  static_cast<LocalOutcome&>(d.result) = {};
  d.options = options;
  to_known_.resize(work_.norm.rows());
  memory_.Clear(problem_.tables.pairs.size());
  features_.Clear(problem_.tables.pairs.size());
  work_.finder.ForgetConvex();
  remembers_ = problem_.Uses(Component::kWitnessMemory);
  damps_ = problem_.Uses(Component::kDamping);
  aim_ = options.retreats ? -problem_.tolerances.user : problem_.tolerances.aim;
  accept_ = options.retreats ? 0.0 : problem_.tolerances.accept;
  merit_penalty_ = 0.0;
  damping_ = kFirstDamping;
  safety_margin_ = 0.0;
  depths_ = d.options.depths;
  next_ = q;
  ClampToLimits(problem_.tables, next_);
  Look(next_, kFirstMargin * problem_.size, d.current);
  Evaluate(kFirstMargin * problem_.size, d.current);
  scale_ = std::max(problem_.size, kSizePerDepth * d.current.worst) / kDeskSize;
  mu_ = kFirstPenalty * scale_;
  d.radius = d.largest_radius = std::min(d.options.trust_radius * scale_, d.options.largest_step);
  d.best = d.current;
}

const LocalResult& LocalOptimization::Run(const VectorXd& q, const LocalOptions& options) {
  Descent& d = descent_;
  Begin(q, options, d);
  Keep(d.current, d.result);
  while (d.result.iterations < options.max_iterations && !work_.Spent()) {
    ++d.result.iterations;
    const BudgetMeter::Clock::time_point begin = work_.budget.Now();
    Step(d);
    work_.budget.Stepped(begin);
    d.sigma_before = d.result.sigma;
    Keep(d.trial, d.result);
    if (GivesUp(d)) break;
    if (features_.learning() && Free(d.current) && !Free(d.trial)) {
      if (!Retreat(d)) break;
      continue;
    }
    Advance(d);
    if (HasConverged(d)) break;
    const int patience = features_.learning() ? kPatienceWithPlanes : kPatience;
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
