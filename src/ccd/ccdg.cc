#include "ccd/ccdg.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mjcf_pdg {
namespace {

constexpr double kForever = 2.0;  // beyond any t
// Motion bounds are tried on the rest of the line, then on pieces of about the step they gave.
constexpr int kHorizons = 3;
constexpr double kHorizonPerStep = 4.0;
constexpr double kSmallestShrink = 1.0 / 16.0;
constexpr double kLeastSlack = 1.0 / 64.0;  // of the gap; far above the error of a distance
constexpr double kToleranceUsed = 0.99;     // the rest is for the error of a distance
constexpr double kSureNormal = 1e-7;        // the normal of a shallower overlap is noise [m]
constexpr double kNegligible = 1e-12;       // a motion too small to matter [m]
constexpr double kLimitSlack = 1e-9;        // by which a limit counts as held [rad or m]

// MuJoCo's depths of these can be too shallow.
bool Curved(int type) { return type == mjGEOM_ELLIPSOID || type == mjGEOM_CYLINDER; }

double HingeReach(const JointEntry& joint, double q, double dq) {
  const double bound = dq > 0.0 ? joint.hi : joint.lo;
  const double beyond = dq > 0.0 ? q + dq - bound : bound - q - dq;
  if (dq == 0.0 || beyond <= kLimitSlack) return 1.0;
  return std::clamp((bound - q) / dq, 0.0, 1.0);
}

// The scalar part of q0 exp(s dq) is R cos(s φ/2 + ψ), φ = ‖dq‖; the limit holds while it is at
// least cos(hi/2).
double BallReach(const JointEntry& joint, const double* quat, const Vector3d& dq) {
  const double phi = dq.norm(), hi = joint.hi + 0.5 * kLimitSlack;
  if (phi == 0.0 || hi >= M_PI) return 1.0;
  const Eigen::Vector4d q = Eigen::Map<const Eigen::Vector4d>(quat).normalized();
  const double sign = q[0] < 0.0 ? -1.0 : 1.0;
  const double w = sign * q[0], along = sign * q.tail<3>().dot(dq) / phi;
  const double R = std::hypot(w, along), psi = std::atan2(along, w), least = std::cos(hi / 2);
  const bool outside = w < least;
  if (R < least || (outside && psi >= 0.0)) return 0.0;
  return std::clamp(2.0 * (std::acos(std::min(1.0, least / R)) - psi) / phi, 0.0, 1.0);
}

}  // namespace

double LimitReach(const SceneTables& tables, const VectorXd& q0, const VectorXd& dq, int& joint) {
  double reach = 1.0;
  joint = -1;
  for (int j = 0; j < static_cast<int>(tables.joints.size()); ++j) {
    const JointEntry& entry = tables.joints[j];
    if (!entry.limited) continue;
    const double own = entry.type == mjJNT_BALL
                           ? BallReach(entry, q0.data() + entry.qadr, dq.segment<3>(entry.col))
                           : HingeReach(entry, q0[entry.qadr], dq[entry.col]);
    if (own >= reach) continue;
    reach = own;
    joint = j;
  }
  return reach;
}

Ccdg::Ccdg(const SceneTables& tables, ContactFinder& finder)
    : tables_(tables),
      finder_(finder),
      motion_(tables),
      separation_(tables),
      states_(tables.pairs.size()),
      bodies_safe_(tables.body_pairs.size()),
      bodies_required_(tables.body_pairs.size()) {
  moving_.reserve(tables.body_pairs.size());
  result_.pairs.reserve(tables.pairs.size());
}

const CcdResult& Ccdg::Move(const VectorXd& q0, const VectorXd& dq, const CcdOptions& options,
                            const VectorXd* required) {
  Start(q0, dq, options, required);
  double next = moving_.empty() ? end_ : 0.0;
  while (next < end_ || first_) {
    if (moving_.empty()) break;
    if (result_.poses >= options_.max_poses) return Finish(CcdOutcome::kBudget, free_t_);
    PoseAt(next);
    next = Sweep();
    if (colliding_) return Finish(CcdOutcome::kStartInCollision, 0.0);
    first_ = false;
    if (retry_) {
      result_.pairs.clear();
      continue;
    }
    if (!rejected_) free_t_ = t_;
    if (!result_.pairs.empty()) return Finish(CcdOutcome::kContact, free_t_);
  }
  return Finish(result_.joint >= 0 ? CcdOutcome::kLimit : CcdOutcome::kFree, end_);
}

void Ccdg::Start(const VectorXd& q0, const VectorXd& dq, const CcdOptions& options,
                 const VectorXd* required) {
  finder_.ForgetConvex();
  options_ = options;
  required_ = required;
  q0_ = q0;
  dq_ = dq;
  free_t_ = 0.0;
  first_ = true;
  colliding_ = false;
  critical_ = -1;
  result_.certified = true;
  result_.pairs.clear();
  result_.poses = result_.distance_queries = result_.contact_queries = 0;
  end_ = LimitReach(tables_, q0, dq, result_.joint);
  motion_.SetPath(dq);
  moving_.clear();
  for (int k = 0; k < static_cast<int>(tables_.body_pairs.size()); ++k) {
    if (!motion_.Moves(k)) continue;
    moving_.push_back(k);
    bodies_safe_[k] = 0.0;
    bodies_required_[k] = -std::numeric_limits<double>::infinity();
    for (int pair = tables_.body_pairs[k].begin; pair < tables_.body_pairs[k].end; ++pair) {
      bodies_required_[k] = std::max(bodies_required_[k], Required(pair));
      states_[pair] = PairState();
      states_[pair].floor = states_[pair].advance = 0.5 * options_.gap;
    }
  }
}

void Ccdg::PoseAt(double t) {
  t_ = t;
  step_ = t * dq_;
  Integrate(tables_, q0_, step_, result_.q);
  finder_.Pose(result_.q);
  motion_.SetPose(finder_.posed());
  contacts_ = nullptr;
  rejected_ = retry_ = false;
  ++result_.poses;
}

// Renews the proofs that run out first, until the earliest of them all is from this pose; returns
// where it ends. Whoever ended the last step is asked first: it leaves the others little to prove.
double Ccdg::Sweep() {
  double next = end_;
  const int asked_first = critical_;
  if (asked_first >= 0) RefreshBodies(asked_first, next);
  for (const int body_pair : moving_) {
    if (body_pair == asked_first) continue;
    if (first_ || bodies_safe_[body_pair] < next) RefreshBodies(body_pair, next);
  }
  return next;
}

void Ccdg::RefreshBodies(int body_pair, double& next) {
  double distance = 0.0;
  const double closing = motion_.BodiesClosing(finder_.posed(), body_pair, end_ - t_, distance);
  const double margin = distance - bodies_required_[body_pair];
  double safe = t_ + (margin - 0.5 * options_.gap) / closing;
  if (margin <= options_.gap || safe < next) {
    safe = kForever;
    const BodyPair& bodies = tables_.body_pairs[body_pair];
    for (int pair = bodies.begin; pair < bodies.end; ++pair) {
      if (first_ || states_[pair].safe < std::min(next, safe)) {
        RefreshPair(body_pair, pair, std::min(next, safe));
      }
      safe = std::min(safe, states_[pair].safe);
    }
  }
  bodies_safe_[body_pair] = safe;
  if (safe >= next) return;
  next = safe;
  critical_ = body_pair;
}

void Ccdg::RefreshPair(int body_pair, int pair, double next) {
  PairState& state = states_[pair];
  const double horizon = end_ - t_;
  double closing = motion_.Geoms(finder_.posed(), body_pair, pair, horizon).closing;
  const double bound = finder_.DistanceBound(pair) - Required(pair);
  state.safe = t_ + (bound - state.floor) / closing;
  if (bound > options_.gap && state.safe >= next) return;
  if (!tables_.pairs[pair].has_distance) return RefreshContactOnly(pair, closing);

  const Margin margin = MarginOf(pair, std::max(options_.gap, state.floor + closing * horizon));
  state.safe = kForever;
  if (!margin.exact) return;
  if (first_ && !Admit(pair, margin.value)) return;
  const double step = ProvenStep(body_pair, pair, margin, closing);
  state.safe = t_ + step;
  if (step >= horizon) {
    state.safe = kForever;
  } else if (step * closing < state.advance) {
    state.safe = t_;
    if (!colliding_) result_.pairs.push_back(pair);
  }
  if (!first_ && margin.value < -options_.tolerance) {  // queries and proofs contradict each other
    rejected_ = true;
    result_.certified = false;
    if (state.safe > t_) result_.pairs.push_back(pair);
  }
}

// At the start: overlapping (then false), gliding, or far enough.
bool Ccdg::Admit(int pair, double margin) {
  PairState& state = states_[pair];
  if (margin < -options_.tolerance) {
    if (!colliding_) result_.pairs.clear();
    colliding_ = true;
    result_.pairs.push_back(pair);
    return false;
  }
  if (margin <= options_.gap) {
    // Half of what is left, so that a gap stays open however often its pair is pushed.
    const double slack = std::max(0.5 * margin, kLeastSlack * options_.gap);
    state.floor = std::max(-kToleranceUsed * options_.tolerance, margin - slack);
    state.advance = 0.5 * slack;
  }
  return true;
}

Ccdg::Margin Ccdg::MarginOf(int pair, double enough) {
  const KeptPair& kept = tables_.pairs[pair];
  NearPair near;
  Margin margin;
  margin.value = enough;
  ++result_.distance_queries;
  if (!finder_.Distance(pair, enough + Required(pair), near)) return margin;
  const PosedModel& posed = finder_.posed();
  const mjModel& m = *posed.model();
  margin.exact = true;
  margin.value = near.distance - Required(pair);
  margin.n_W = near.n_W;
  if (m.geom_type[kept.geom1] == mjGEOM_PLANE) {
    margin.n_W = AsMatrix(posed.data()->geom_xmat + 9 * kept.geom1).col(2);
  }
  const bool curved = Curved(m.geom_type[kept.geom1]) || Curved(m.geom_type[kept.geom2]);
  if (curved && !kept.exact && near.distance < -kSureNormal) {
    const double proven = separation_.Distance(posed, kept.geom1, kept.geom2, margin.n_W);
    margin.value = std::min(margin.value, proven - Required(pair));
  }
  return margin;
}

// How far the pair is proven to stay above its floor; `closing` becomes the λ of the last horizon.
double Ccdg::ProvenStep(int body_pair, int pair, const Margin& margin, double& closing) {
  const KeptPair& kept = tables_.pairs[pair];
  const double floor = states_[pair].floor;
  double horizon = end_ - t_, step = 0.0;
  for (int i = 0; i < kHorizons; ++i) {
    const RelativeMotion motion = motion_.Geoms(finder_.posed(), body_pair, pair, horizon);
    closing = motion.closing;
    if (i == 0 && closing * horizon <= kNegligible) return horizon;
    double proven = std::clamp((margin.value - floor) / closing, 0.0, horizon);
    if (proven < horizon) {
      proven = std::max(proven, separation_.SafeStep(finder_.posed(), kept, margin.n_W, motion,
                                                     floor + Required(pair), horizon));
    }
    step = std::max(step, proven);
    const double shorter = std::max(kHorizonPerStep * step, kSmallestShrink * horizon);
    if (proven >= horizon || shorter > 0.5 * horizon) break;
    horizon = shorter;
  }
  return step;
}

// SDF and height fields: contacts every sample_step; where one appears, halved back to the gap.
void Ccdg::RefreshContactOnly(int pair, double closing) {
  PairState& state = states_[pair];
  const double margin = ContactOnlyMargin(pair);
  result_.certified = false;
  if (first_ && !Admit(pair, margin)) return;
  if (!first_ && margin < state.floor) {
    rejected_ = true;
    state.bad = t_;
    state.safe = 0.5 * (free_t_ + t_);
    if ((t_ - free_t_) * closing > options_.gap) {
      retry_ = true;
    } else {
      result_.pairs.push_back(pair);
    }
    return;
  }
  state.safe = t_ + options_.sample_step / closing;
  if (state.bad > 1.0 || state.safe < state.bad) return;
  state.safe = 0.5 * (t_ + state.bad);
  if ((state.bad - t_) * closing <= options_.gap) result_.pairs.push_back(pair);
}

double Ccdg::ContactOnlyMargin(int pair) {
  if (!contacts_) {
    contacts_ = &finder_.Find(options_.gap);
    ++result_.contact_queries;
  }
  double least = std::numeric_limits<double>::infinity();
  for (const NearPair& near : *contacts_) {
    if (near.pair == pair) least = std::min(least, near.distance - Required(pair));
  }
  return least;
}

const CcdResult& Ccdg::Finish(CcdOutcome outcome, double t) {
  result_.outcome = outcome;
  result_.t = t;
  if (outcome != CcdOutcome::kLimit) result_.joint = -1;
  if (t == 0.0) {
    result_.q = q0_;
  } else {
    step_ = t * dq_;
    Integrate(tables_, q0_, step_, result_.q);
  }
  return result_;
}

}  // namespace mjcf_pdg
