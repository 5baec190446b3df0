#include "ccd/ccdg.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/tuning.h"
#include "ccd/limit_reach.h"

namespace mjcf_pdg {

namespace tune = tuning::bisection;

namespace {

constexpr double kForever = 2.0;  // beyond any t

constexpr double kLeastSlack = 1.0 / 64.0;  // of the gap; far above the error of a distance
constexpr double kToleranceUsed = 0.99;     // the rest is for the error of a distance
constexpr double kSlideSlack = 1e-3;        // of a tolerance: by which a slide's limit is held
// SDF pairs are looked at each time they can have moved by this share of the
// smaller geom's bounding radius: 1 mm for a ball of 10 cm.
constexpr double kSampleStep = 0.01;

// How far from its pose a proof of length `reach.length` is expected to meet one from a later pose:
// twice as far, but not beyond where the margin would run out at its present rate.
double ExpectedMeeting(const Reach& reach, double slack) {
  double far = 2.0 * reach.length;
  if (reach.rate * far < -slack) far = -slack / reach.rate;
  far *= tune::kMeetShare;
  return far > tune::kWorthAsking * reach.length ? far : reach.length;
}

// That there is room for from the start. Halving [0, 1] leaves nothing after that many.
constexpr int kIntervals = 64;

double SmallerRadius(const mjModel& m, const KeptPair& kept) {
  const double r1 = m.geom_rbound[kept.geom1], r2 = m.geom_rbound[kept.geom2];
  return r1 > 0.0 && r2 > 0.0 ? std::min(r1, r2) : std::max(r1, r2);
}

}  // namespace

Ccdg::Ccdg(const SceneTables& tables, ContactFinder& finder)
    : tables_(tables),
      finder_(finder),
      proof_(tables, finder),
      pairs_(tables.pairs.size()),
      bodies_(tables.body_pairs.size()) {
  asked_.reserve(tables.body_pairs.size());
  result_.pairs.reserve(tables.pairs.size());
  result_.q.resize(tables.model->nq);
  intervals_.reserve(kIntervals);
  ahead_.reserve(tables.pairs.size() + kIntervals);
}

const CcdResult& Ccdg::Move(const CcdMotion& motion, const CcdOptions& options) {
  Start(motion, options);
  while (!intervals_.empty()) {
    if (Stopped()) return Finish(result_.outcome, front_);
    Interval& now = intervals_.back();
    if (front_ >= now.t1) {
      Pop();
      continue;
    }
    if (Spent()) return Finish(CcdOutcome::kBudget, front_);
    now.t0 = options_.halve ? std::min(now.t0, front_) : front_;
    const double next = NextPose(now);
    if (next > now.t0 && next < now.t1) {
      Split(next);
    } else {
      now.end_asked |= next == now.t1;
      Ask(next);
    }
  }
  return Finish(result_.joint >= 0 ? CcdOutcome::kLimit : CcdOutcome::kFree, end_);
}

void Ccdg::Start(const CcdMotion& motion, const CcdOptions& options) {
  finder_.ForgetConvex();
  options_ = options;
  critical_ = -1;
  result_.outcome = CcdOutcome::kFree;
  result_.certified = true;
  result_.pairs.clear();
  result_.poses = result_.distance_queries = result_.contact_queries = 0;
  end_ = LimitReach(tables_, motion.q0, motion.dq, kSlideSlack * options.tolerance, result_.joint);
  proof_.SetMotion(motion, options.tolerance);
  intervals_.clear();
  ahead_.clear();
  asked_.clear();
  for (int k = 0; k < static_cast<int>(tables_.body_pairs.size()); ++k) {
    if (!options.still_pairs && !proof_.Moves(k)) continue;
    asked_.push_back(k);
    bodies_[k] = {0.0, 0.0, -std::numeric_limits<double>::infinity()};
    for (int pair = tables_.body_pairs[k].begin; pair < tables_.body_pairs[k].end; ++pair) {
      bodies_[k].required = std::max(bodies_[k].required, proof_.Required(pair));
      pairs_[pair] = PairState();
      pairs_[pair].floor = pairs_[pair].advance = 0.5 * options_.Gap();
    }
  }
  if (asked_.empty()) return;
  intervals_.push_back({0.0, end_});
  Ask(0.0);
}

bool Ccdg::Spent() const {
  return result_.poses >= options_.max_poses ||
         (options_.budget && options_.budget->Spent(finder_.queries()));
}

// The end of the interval or its start, if that is to be asked next; else where to split it.
double Ccdg::NextPose(const Interval& interval) const {
  if (options_.halve) {
    return interval.end_asked ? 0.5 * (interval.t0 + interval.t1) : interval.t1;
  }
  if (meet_ < interval.t1) return meet_;
  return interval.end_asked ? interval.t0 : interval.t1;
}

void Ccdg::Split(double at) {
  const Interval whole = intervals_.back();
  const double least = tune::kNearestSplit * (whole.t1 - whole.t0);
  at = std::clamp(at, whole.t0 + least, whole.t1 - least);
  intervals_.back().t0 = at;
  intervals_.push_back({whole.t0, at, false});
}

void Ccdg::Pop() {
  while (!ahead_.empty() && ahead_.back().at <= intervals_.back().t1) ahead_.pop_back();
  intervals_.pop_back();
}

// Poses the model at t and renews the proofs that run out first, until the earliest of them all is
// from this pose. Whoever has the front is asked first: it leaves the others little to prove.
void Ccdg::Ask(double t) {
  t_ = t;
  proof_.PoseAt(t);
  contacts_ = nullptr;
  ++result_.poses;
  double next = end_;
  const int first = critical_;
  if (first >= 0) AskBodies(first, next);
  for (const int body_pair : asked_) {
    if (body_pair == first) continue;
    if (t_ == 0.0 || bodies_[body_pair].until < next) AskBodies(body_pair, next);
  }
  front_ = meet_ = kForever;
  for (const int body_pair : asked_) {
    meet_ = std::min(meet_, bodies_[body_pair].meet);
    if (bodies_[body_pair].until >= front_) continue;
    front_ = bodies_[body_pair].until;
    critical_ = body_pair;
  }
}

// Bounding spheres first, then pair by pair. Lowers `next` to where the proofs from this pose end.
void Ccdg::AskBodies(int body_pair, double& next) {
  BodiesState& state = bodies_[body_pair];
  const BodyPair& bodies = tables_.body_pairs[body_pair];
  const double back = std::max(0.0, t_ - state.until);
  const double reach = proof_.BodiesReach(body_pair, state.required + 0.5 * options_.Gap(),
                                          std::max(end_ - t_, back));
  const bool proven = reach > back && t_ + reach >= next;
  state.until = state.meet = kForever;
  for (int pair = bodies.begin; pair < bodies.end; ++pair) {
    const double until = pairs_[pair].until;
    if (proven) {
      Extend(pair, reach, tune::kMeetShare * 2.0 * reach);
    } else if (t_ == 0.0 || until < next) {
      AskPair(body_pair, pair, next);
    }
    if (pairs_[pair].until >= t_) next = std::min(next, pairs_[pair].until);
    state.until = std::min(state.until, pairs_[pair].until);
    state.meet = std::min(state.meet, pairs_[pair].meet);
  }
}

// Bounding volumes first, then the distance, from which proofs go both ways.
void Ccdg::AskPair(int body_pair, int pair, double next) {
  PairState& state = pairs_[pair];
  const double back = std::max(0.0, t_ - state.until), rest = end_ - t_;
  const Reach bounds = proof_.BoundsReach(body_pair, pair, state.floor, std::max(rest, back));
  if (bounds.length > back && t_ + bounds.length >= next) {
    return Extend(pair, bounds.length, tune::kMeetShare * 2.0 * bounds.length);
  }
  if (tables_.pairs[pair].kind == PairKind::kSdf) return Sample(pair, bounds.lambda);

  ++result_.distance_queries;
  const Margin margin = proof_.Measure(pair, state.floor + bounds.lambda * std::max(rest, back));
  if (!margin.measured) return Extend(pair, kForever, kForever);
  if (t_ == 0.0 && !Admit(pair, margin.value)) return;
  if (back == 0.0 && margin.value < -options_.tolerance) return Contradict(pair);
  Reach earlier;
  if (back > 0.0) {
    earlier = proof_.Prove(body_pair, pair, margin, state.floor, Direction::kEarlier, back);
  }
  const Reach later = proof_.Prove(body_pair, pair, margin, state.floor, Direction::kLater, rest);
  if (earlier.length < back) {
    state.meet = state.until;
    ahead_.push_back({pair, t_, t_ - earlier.length, t_ + later.length});
  } else if (later.length >= rest) {
    Extend(pair, kForever, kForever);
  } else if (later.length * later.lambda < state.advance) {
    Stop(pair, t_);
  } else {
    Extend(pair, later.length, ExpectedMeeting(later, margin.value - state.floor));
  }
}

// The pair is proven from before this pose on to t_ + `length`; what was proven ahead may go on.
void Ccdg::Extend(int pair, double length, double meeting) {
  PairState& state = pairs_[pair];
  state.seen = t_;
  state.until = std::max(state.until, t_ + length);
  for (auto proof = ahead_.rbegin(); proof != ahead_.rend(); ++proof) {
    if (proof->pair == pair && proof->from <= state.until) {
      state.until = std::max(state.until, proof->until);
    }
  }
  state.meet = std::max(state.until, t_ + meeting);
}

// At the start: overlapping (then false), gliding, or far enough.
bool Ccdg::Admit(int pair, double margin) {
  PairState& state = pairs_[pair];
  if (margin < -options_.tolerance) {
    if (result_.outcome != CcdOutcome::kStartInCollision) result_.pairs.clear();
    result_.outcome = CcdOutcome::kStartInCollision;
    result_.pairs.push_back(pair);
    return false;
  }
  if (margin <= options_.Gap()) {
    // Half of what is left, so that a gap stays open however often its pair is pushed.
    const double slack = std::max(0.5 * margin, kLeastSlack * options_.Gap());
    state.floor = std::max(-kToleranceUsed * options_.tolerance, margin - slack);
    state.advance = 0.5 * slack;
  }
  return true;
}

// The motion cannot go beyond t with this pair.
void Ccdg::Stop(int pair, double t) {
  pairs_[pair].until = pairs_[pair].meet = t;
  if (result_.outcome != CcdOutcome::kStartInCollision) result_.pairs.push_back(pair);
}

// A pair that stops, but not before the others are proven, stops nothing yet.
bool Ccdg::Stopped() {
  std::erase_if(result_.pairs, [this](int pair) { return pairs_[pair].until > front_; });
  if (result_.pairs.empty()) return false;
  if (result_.outcome == CcdOutcome::kFree) result_.outcome = CcdOutcome::kContact;
  return true;
}

// A query finds an overlap where a proof says there is none: one of them errs.
void Ccdg::Contradict(int pair) {
  result_.certified = false;
  Stop(pair, pairs_[pair].seen);
}

// SDFs: looked at every kSampleStep; where one is below its floor, the interval
// since it was last seen above is halved down to the gap.
void Ccdg::Sample(int pair, double lambda) {
  PairState& state = pairs_[pair];
  const bool before_bad = state.bad > state.seen;
  if (t_ > state.until && !before_bad) return;
  const double margin = SampledMargin(pair);
  result_.certified = false;
  if (t_ == 0.0 && !Admit(pair, margin)) return;
  if (margin < state.floor) {
    state.bad = t_;
  } else {
    state.seen = t_;
    const double radius = SmallerRadius(*tables_.model, tables_.pairs[pair]);
    state.until = state.meet = t_ + kSampleStep * radius / lambda;
  }
  if (state.bad <= state.seen || (margin >= state.floor && state.until < state.bad)) return;
  state.until = state.seen;
  state.meet = 0.5 * (state.seen + state.bad);
  if ((state.bad - state.seen) * lambda <= options_.Gap()) Stop(pair, state.seen);
}

double Ccdg::SampledMargin(int pair) {
  if (!contacts_) {
    contacts_ = &finder_.Find(options_.Gap());
    ++result_.contact_queries;
  }
  double least = std::numeric_limits<double>::infinity();
  for (const NearPair& near : *contacts_) {
    if (near.pair == pair) least = std::min(least, near.distance - proof_.Required(pair));
  }
  return least;
}

const CcdResult& Ccdg::Finish(CcdOutcome outcome, double t) {
  result_.outcome = outcome;
  result_.t = t;
  if (outcome != CcdOutcome::kLimit) result_.joint = -1;
  proof_.At(t, result_.q);
  return result_;
}

}  // namespace mjcf_pdg
