#include "verify/verify.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solve/options.h"
#include "verify/verify_capsule_box.h"
#include "verify/verify_support.h"

namespace mjcf_pdg {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kFar = 1.0;              // beyond the clearance: min_distance is cut off there [m]
constexpr double kLimitTolerance = 1e-6;  // joint limits [rad or m]
constexpr double kTouching = 1e-9;        // [m]
constexpr double kSureNormal = 1e-7;      // the normal of a shallower overlap is noise [m]
constexpr double kRestRounding = 1e-9;    // a contact of exactly `rest` still rests [m]
constexpr double kDistanceTolerance = 1e-9;  // of the convex solver: 1e-6 jitters by 5e-7 m

bool ContactOnly(int type) { return type == mjGEOM_SDF || type == mjGEOM_HFIELD; }
bool Curved(int type) { return type == mjGEOM_ELLIPSOID || type == mjGEOM_CYLINDER; }

std::uint64_t PairKey(int geom1, int geom2) {
  const auto [low, high] = std::minmax(geom1, geom2);
  return (static_cast<std::uint64_t>(low) << 32) | static_cast<std::uint32_t>(high);
}

}  // namespace

Verifier::Verifier(const SceneTables& tables, const Options& options)
    : tables_(tables),
      tolerance_(options.tolerance),
      clearance_(options.clearance),
      rest_(options.rest),
      model_(tables.verify_model),
      posed_(&model_),
      exact_(tables, options.rest + kRestRounding) {
  NeutraliseMargins();
  distance_model_ = model_;
  distance_model_.opt.ccd_tolerance = std::min(model_.opt.ccd_tolerance, kDistanceTolerance);
  IndexPairs();
  readings_.resize(tables.pairs.size());
  order_.reserve(tables.pairs.size());
  required_.resize(tables.pairs.size());
  UpdateRest({});
}

// MuJoCo detects contacts nearer than margin + gap: a negative sum hides overlaps, a positive one
// misplaces contacts. Ours are zero, and what a negative sum allows is in KeptPair::allowed. Only
// geoms without signed distances get a margin, where a clearance must be seen by their contacts.
void Verifier::NeutraliseMargins() {
  geom_margin_.assign(model_.ngeom, 0.0);
  body_margin_.assign(model_.nbody, 0.0);
  pair_margin_.assign(model_.npair, 0.0);
  no_gap_.assign(std::max(model_.ngeom, model_.npair), 0.0);
  if (clearance_ > 0.0) {
    for (int g = 0; g < model_.ngeom; ++g) {
      if (!ContactOnly(model_.geom_type[g])) continue;
      geom_margin_[g] = clearance_;
      body_margin_[model_.geom_bodyid[g]] = clearance_;
    }
    for (int k = 0; k < model_.npair; ++k) {
      if (ContactOnly(model_.geom_type[model_.pair_geom1[k]]) ||
          ContactOnly(model_.geom_type[model_.pair_geom2[k]])) {
        pair_margin_[k] = clearance_;
      }
    }
  }
  model_.geom_margin = geom_margin_.data();
  model_.geom_gap = no_gap_.data();
  model_.body_margin = body_margin_.data();
  model_.pair_margin = pair_margin_.data();
  model_.pair_gap = no_gap_.data();
}

void Verifier::IndexPairs() {
  pair_index_.reserve(tables_.pairs.size());
  for (int i = 0; i < static_cast<int>(tables_.pairs.size()); ++i) {
    pair_index_.emplace_back(PairKey(tables_.pairs[i].geom1, tables_.pairs[i].geom2), i);
  }
  std::sort(pair_index_.begin(), pair_index_.end());
}

int Verifier::PairIndex(int geom1, int geom2) const {
  const std::uint64_t key = PairKey(geom1, geom2);
  const auto it = std::lower_bound(pair_index_.begin(), pair_index_.end(), std::pair(key, -1));
  return it != pair_index_.end() && it->first == key ? it->second : -1;
}

void Verifier::SetMocap(const MocapPoses& poses) {
  posed_.SetMocap(poses);
  UpdateRest({});
}

double Verifier::Usual(const KeptPair& pair) const {
  return (pair.moves ? clearance_ : 0.0) - pair.allowed;
}

double Verifier::DepthAtRest(int pair) const {
  return required_[pair] < Usual(tables_.pairs[pair]) ? required_[pair] : 0.0;
}

// What each pair must keep. Empty q_in: nothing rests. Where the two readings of a depth differ,
// the deeper one tells whether the contact rests at all, and the shallower one how deep it may
// stay.
void Verifier::UpdateRest(const std::vector<double>& q_in) {
  for (std::size_t i = 0; i < required_.size(); ++i) {
    required_[i] = Usual(tables_.pairs[i]);
  }
  rest_q_in_ = q_in;
  if (q_in.empty()) return;
  Measure(q_in, Depths::kMeasured);
  for (std::size_t i = 0; i < required_.size(); ++i) {
    const Reading& reading = readings_[i];
    double deepest = reading.signed_distance, shallowest = reading.as_told;
    if (!tables_.pairs[i].has_distance) {
      deepest = reading.contact < 0 ? kInfinity : posed_.data()->contact[reading.contact].dist;
      shallowest = deepest;
    }
    if (deepest < 0.0 && deepest >= -rest_ - kRestRounding) {
      required_[i] = std::min(required_[i], shallowest);
    }
  }
}

void Verifier::Measure(const std::vector<double>& q, Depths depths) {
  ++queries_;
  posed_.Pose(Eigen::Map<const VectorXd>(q.data(), static_cast<Eigen::Index>(q.size())));
  for (Reading& reading : readings_) {
    reading.signed_distance = reading.as_told = kInfinity;
    reading.contact = -1;
  }
  verdict_.min_distance = clearance_ + kFar;
  AskCollision();
  AskDistances(depths);
}

// Witness 1. MuJoCo reports a full arena by a warning alone, and drops contacts.
void Verifier::AskCollision() {
  mjData& d = *posed_.data();
  d.warning[mjWARN_CONTACTFULL].number = 0;
  mj_collision(&model_, &d);
  arena_full_ = d.warning[mjWARN_CONTACTFULL].number > 0;
  contacts_of_unkept_pairs_.clear();
  for (int c = 0; c < d.ncon; ++c) {
    const int pair = PairIndex(d.contact[c].geom[0], d.contact[c].geom[1]);
    if (pair < 0) {
      contacts_of_unkept_pairs_.push_back(c);
      continue;
    }
    if (tables_.pairs[pair].exact) continue;
    int& deepest = readings_[pair].contact;
    if (deepest < 0 || !(d.contact[c].dist >= d.contact[deepest].dist)) deepest = c;
    if (!tables_.pairs[pair].has_distance) {
      verdict_.min_distance = std::min(verdict_.min_distance, d.contact[c].dist);
    }
  }
}

// Witness 2. Pairs in the order of their bounds: once a bound exceeds all that matters, we are
// done.
void Verifier::AskDistances(Depths depths) {
  const double matters = tolerance_ + clearance_;
  order_.clear();
  for (int i = 0; i < static_cast<int>(tables_.pairs.size()); ++i) {
    if (!tables_.pairs[i].has_distance) continue;
    const double bound = SphereBound(tables_.pairs[i]);
    if (bound <= std::max(clearance_ + kFar, matters)) order_.emplace_back(bound, i);
  }
  std::sort(order_.begin(), order_.end());
  for (const auto& [bound, i] : order_) {
    const double cutoff = std::max(verdict_.min_distance, matters);
    if (bound > cutoff) break;
    const KeptPair& pair = tables_.pairs[i];
    if (BoxBound(pair) > cutoff) continue;
    Reading& reading = readings_[i];
    const double distance = SignedDistance(i, cutoff, depths, reading.fromto);
    if (distance >= cutoff) continue;
    reading.as_told = std::isnan(distance) ? -kInfinity : distance;
    reading.signed_distance = std::min(reading.as_told, AlongNormal(pair, reading));
    verdict_.min_distance = std::min(verdict_.min_distance, reading.signed_distance);
  }
}

// From bounding spheres; never above the pair's distance. -inf when nothing is known.
double Verifier::SphereBound(const KeptPair& pair) const {
  const mjData& d = *posed_.data();
  const int a = pair.geom1, b = pair.geom2;
  const Vector3d between = AsVector(d.geom_xpos + 3 * b) - AsVector(d.geom_xpos + 3 * a);
  double bound = -kInfinity;
  if (model_.geom_type[a] == mjGEOM_PLANE) {
    bound = AsMatrix(d.geom_xmat + 9 * a).col(2).dot(between) - model_.geom_rbound[b];
  } else if (model_.geom_rbound[a] > 0.0 && model_.geom_rbound[b] > 0.0) {
    bound = between.norm() - model_.geom_rbound[a] - model_.geom_rbound[b];
  }
  return std::isnan(bound) ? -kInfinity : bound;
}

// From the geoms' oriented boxes: how far apart they are along each box's own axes.
double Verifier::BoxBound(const KeptPair& pair) const {
  if (model_.geom_type[pair.geom1] == mjGEOM_PLANE) return -kInfinity;
  const mjData& d = *posed_.data();
  Matrix3d R[2];
  Vector3d center[2], half[2];
  for (int k = 0; k < 2; ++k) {
    const int g = k == 0 ? pair.geom1 : pair.geom2;
    R[k] = AsMatrix(d.geom_xmat + 9 * g);
    center[k] = AsVector(d.geom_xpos + 3 * g) + R[k] * AsVector(model_.geom_aabb + 6 * g);
    half[k] = AsVector(model_.geom_aabb + 6 * g + 3);
  }
  double bound = -kInfinity;
  for (const Matrix3d& axes : R) {
    for (int i = 0; i < 3; ++i) {
      const Vector3d n = axes.col(i);
      const double reach = (R[0].transpose() * n).cwiseAbs().dot(half[0]) +
                           (R[1].transpose() * n).cwiseAbs().dot(half[1]);
      bound = std::max(bound, std::abs(n.dot(center[1] - center[0])) - reach);
    }
  }
  return bound;
}

double Verifier::SignedDistance(int index, double cutoff, Depths depths, double fromto[6]) {
  const KeptPair& pair = tables_.pairs[index];
  if (pair.exact) {
    const double permitted = tolerance_ + pair.allowed;
    if (required_[index] > 0.0) depths = Depths::kMeasured;
    return exact_.Distance(posed_, pair, cutoff, permitted, depths, fromto);
  }
  if (model_.geom_type[pair.geom1] == mjGEOM_CAPSULE &&
      model_.geom_type[pair.geom2] == mjGEOM_BOX) {
    return CapsuleBoxDistance(model_, *posed_.data(), pair.geom1, pair.geom2, fromto);
  }
  const double distance =
      mj_geomDistance(&distance_model_, posed_.data(), pair.geom1, pair.geom2, cutoff, fromto);
  if (std::abs(distance) > kTouching) return distance;
  return std::min(distance, DistanceFromNudgedPose(pair, cutoff, fromto));
}

// Zero, or nearly, is what MuJoCo says of things that touch, and of solids whose middles coincide.
double Verifier::DistanceFromNudgedPose(const KeptPair& pair, double cutoff, double fromto[6]) {
  constexpr double kNudge = 1e-6, kDeep = 2e-6;  // [m]
  Eigen::Map<Vector3d> center(posed_.data()->geom_xpos + 3 * pair.geom2);
  const Vector3d kept = center;
  center += kNudge * Vector3d(0.36, 0.48, 0.8);
  const double distance =
      mj_geomDistance(&distance_model_, posed_.data(), pair.geom1, pair.geom2, cutoff, fromto);
  center = kept;
  return distance < -kDeep ? distance : 0.0;
}

// MuJoCo's depths of ellipsoids and cylinders can be too shallow, by 2 mm of 16. The overlap along
// any direction is at least the true one: along the normal of a true reading they are the same, so
// that a reading shallower than that is wrong. Infinite where there is nothing to check: what is
// not permitted anyway may be as deep as it is told.
double Verifier::AlongNormal(const KeptPair& pair, const Reading& reading) const {
  const int type1 = model_.geom_type[pair.geom1], type2 = model_.geom_type[pair.geom2];
  if (pair.exact || type1 == mjGEOM_PLANE || !(Curved(type1) || Curved(type2))) return kInfinity;
  const double permitted = tolerance_ + pair.allowed + rest_ + kRestRounding;
  if (reading.as_told < -permitted || reading.as_told >= -kSureNormal) return kInfinity;
  const Vector3d n_W = (AsVector(reading.fromto) - AsVector(reading.fromto + 3)).normalized();
  return DistanceAlong(model_, *posed_.data(), pair.geom1, pair.geom2, n_W,
                       reading.as_told - kTouching);
}

// Either witness is enough. One exception: where some overlap is permitted and the signed distance
// confirms one within it, a contact's dist is not believed, for it may be centimetres off.
void Verifier::JudgePair(int index) {
  const KeptPair& pair = tables_.pairs[index];
  const Reading& reading = readings_[index];
  const mjData& d = *posed_.data();
  const mjContact* contact = reading.contact < 0 ? nullptr : &d.contact[reading.contact];
  const double required = required_[index];
  const double by_contact = contact ? contact->dist : kInfinity;
  const double by_distance = reading.signed_distance;
  // Contacts of pairs with a signed distance are asked about overlap only.
  const double required_contact = pair.has_distance ? std::min(required, 0.0) : required;
  const bool permitted = pair.has_distance && required < 0.0 && by_distance < 0.0;
  const bool contact_violates =
      contact && !permitted && !(by_contact >= required_contact - tolerance_);
  const bool distance_violates = !(by_distance >= required - tolerance_);
  const bool use_contact = !pair.has_distance || (contact_violates && !distance_violates);
  const double distance = use_contact ? by_contact : by_distance;
  Finding finding;
  finding.violates = contact_violates || distance_violates;
  if (!finding.violates && !(distance < tolerance_)) return;
  finding.contact.geom = {pair.geom1, pair.geom2};
  finding.required = required;
  finding.frozen = !pair.moves;
  const bool touching = std::abs(distance) < kNoDirection;
  if (contact && (use_contact || touching)) {
    FillFromContact(*contact, finding.contact);
    finding.contact.distance = distance;
  } else {
    FillFromWitnesses(d, distance, reading.fromto, finding.contact);
  }
  findings_.push_back(finding);
}

// Contacts of pairs that are not in our table: MuJoCo's word alone.
void Verifier::JudgeContactsOfUnkeptPairs() {
  const mjData& d = *posed_.data();
  for (const int c : contacts_of_unkept_pairs_) {
    if (d.contact[c].dist >= tolerance_) continue;
    Finding finding;
    finding.contact.geom = {d.contact[c].geom[0], d.contact[c].geom[1]};
    FillFromContact(d.contact[c], finding.contact);
    finding.violates = !(d.contact[c].dist >= -tolerance_);
    auto same = [&](const Finding& f) { return f.contact.geom == finding.contact.geom; };
    const auto known = std::find_if(findings_.begin(), findings_.end(), same);
    if (known == findings_.end()) {
      findings_.push_back(finding);
    } else if (finding.contact.distance < known->contact.distance) {
      *known = finding;
    }
  }
}

// All joints of the model, frozen ones too. A ball's whole angle counts, twist included.
void Verifier::CheckLimits(const std::vector<double>& q) {
  limit_reasons_.clear();
  verdict_.limit_excess = 0.0;
  for (int j = 0; j < model_.njnt; ++j) {
    const int type = model_.jnt_type[j];
    if (!model_.jnt_limited[j] || type == mjJNT_FREE) continue;
    const double* value = q.data() + model_.jnt_qposadr[j];
    const double low = model_.jnt_range[2 * j], high = model_.jnt_range[2 * j + 1];
    double excess = 0.0;
    if (type == mjJNT_BALL) {
      const double sine = std::hypot(value[1], value[2], value[3]);
      excess = 2.0 * std::atan2(sine, std::abs(value[0])) - high;
    } else {
      excess = std::max(low - *value, *value - high);
    }
    verdict_.limit_excess = std::max(verdict_.limit_excess, excess);
    if (excess <= kLimitTolerance) continue;
    limit_reasons_.push_back(DescribeExcess(model_, j, excess));
  }
}

const Verdict& Verifier::Check(const std::vector<double>& q, const std::vector<double>* q_in,
                               Depths depths) {
  const bool rests = rest_ > 0.0 && q_in != nullptr;
  if (rests ? rest_q_in_ != *q_in : !rest_q_in_.empty()) {
    UpdateRest(rests ? *q_in : std::vector<double>());
  }
  verdict_.contacts.clear();
  verdict_.reason.clear();
  findings_.clear();
  verdict_.free = false;
  verdict_.certified = !tables_.has_contact_only_pairs;
  if (!std::all_of(q.begin(), q.end(), [](double v) { return std::isfinite(v); })) {
    verdict_.reason = "the configuration is not a number";
    return verdict_;
  }
  Measure(q, depths);
  for (std::size_t i = 0; i < readings_.size(); ++i) JudgePair(static_cast<int>(i));
  JudgeContactsOfUnkeptPairs();
  CheckLimits(q);
  WriteVerdict(model_, arena_full_, findings_, limit_reasons_, verdict_);
  return verdict_;
}

Verdict Verify(const Scene& scene, const std::vector<double>& q, const Options& options,
               const std::vector<double>* q_in) {
  scene.CheckConfiguration(q);
  if (q_in) scene.CheckConfiguration(*q_in);
  CheckOptions(options, *scene.model());
  Verifier verifier(scene.tables(), options);
  verifier.SetMocap({options.mocap_pos, options.mocap_quat});
  return verifier.Check(q, q_in);
}

}  // namespace mjcf_pdg
