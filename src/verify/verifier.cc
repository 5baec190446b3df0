#include "verify/verifier.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "verify/constraints.h"
#include "verify/convex/direction_search.h"
#include "verify/terrain_pair.h"

namespace mjcf_pdg {
namespace {

using verify::Certificate;
using verify::CheckedPair;
using verify::ConvexPair;
using verify::Depths;
using verify::Finding;
using verify::PosedPair;
using verify::Proof;
using verify::Reading;
using verify::Vector3d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// A contact whose depth exceeds Options::rest by rounding alone still rests. The slack is the first
// share of `rest` plus the second share of the pair's size.
constexpr double kRestRounding = 1e-6, kSizeRounding = 1e-12;
// A plane from an earlier call, or from measuring, is accepted only if its gap exceeds the needed
// distance by this share of the pair's size. Otherwise the pair is decided anew, always in the same
// way, so that no verdict depends on earlier calls.
constexpr double kClear = 1e-9;

// Accuracy of MuJoCo's contacts (mjOption::ccd_tolerance): this share of the tolerance, but not
// less than this share of the model's size, below which digits are rounding.
constexpr double kFinerThanTolerance = 0.1, kFinestContacts = 1e-9;

// The model's size: the largest bounding radius of its geoms [m].
double SizeOf(const mjModel& m) {
  return m.ngeom > 0 ? *std::max_element(m.geom_rbound, m.geom_rbound + m.ngeom) : 0.0;
}

bool AllFinite(std::span<const double> q) {
  return std::all_of(q.begin(), q.end(), [](double v) { return std::isfinite(v); });
}

std::pair<int, int> Sorted(int geom1, int geom2) { return std::minmax(geom1, geom2); }

}  // namespace

Verifier::Verifier(std::shared_ptr<const VerifierModel> model, const Options& options, double range)
    : shared_(std::move(model)),
      tolerance_(options.tolerance),
      clearance_(options.clearance),
      reach_(std::max(clearance_, shared_->keeps_margins ? shared_->largest_margin : 0.0)),
      rest_(options.rest),
      range_(range),
      model_(shared_->unblinded),
      data_(mj_makeData(&model_)),
      exact_(*shared_, rest_ * (1.0 + kRestRounding)),
      sweep_(*shared_) {
  if (!data_) throw Error("MuJoCo could not allocate its data for this model");
  NeutraliseMargins();
  model_.opt.ccd_tolerance =
      std::max(kFinerThanTolerance * tolerance_, kFinestContacts * SizeOf(model_));
  const std::size_t pairs = shared_->pairs.size();
  required_.resize(pairs);
  plane_.assign(pairs, Vector3d::Zero());
  box_axis_.assign(pairs, 0);
  contact_.assign(pairs, -1);
  touching_.reserve(pairs);
  order_.reserve(pairs);
  findings_.pairs.reserve(pairs);
  findings_.limits.reserve(model_.njnt);
  verdict_.contacts.reserve(pairs);
  rest_q_in_.reserve(model_.nq);
  verdict_.certified = !shared_->has_sdf_pairs;
  SetActive({});
  UpdateRest({});
}

void Verifier::SetActive(std::span<const mjtBool> active) {
  active_ = shared_->equalities;
  for (int e = 0; e < model_.neq; ++e) {
    if (!(active.empty() ? model_.eq_active0[e] : active[e])) active_[e] = 0;
  }
  SetScope(scope_);
}

void Verifier::SetScope(const Scope& scope) {
  scope_ = scope;
  active_in_scope_ = active_;
  for (std::size_t e = 0; e < scope.equalities.size(); ++e) {
    active_in_scope_[e] &= scope.equalities[e];
  }
  tendons_in_scope_ = shared_->tendons;
  for (std::size_t t = 0; t < scope.tendons.size(); ++t) tendons_in_scope_[t] &= scope.tendons[t];
}

// The pairs are sorted by the lower and the higher id of their geoms.
int Verifier::PairIndex(int geom1, int geom2, int guess) const {
  const auto& pairs = shared_->pairs;
  const std::pair<int, int> sought = Sorted(geom1, geom2);
  for (const int k : {guess, guess + 1}) {
    if (guess < 0 || k == static_cast<int>(pairs.size())) break;
    if (Sorted(pairs[k].geom1, pairs[k].geom2) == sought) return k;
  }
  const auto it = std::lower_bound(pairs.begin(), pairs.end(), sought,
                                   [](const CheckedPair& pair, const std::pair<int, int>& key) {
                                     return Sorted(pair.geom1, pair.geom2) < key;
                                   });
  if (it == pairs.end() || Sorted(it->geom1, it->geom2) != sought) return -1;
  return static_cast<int>(it - pairs.begin());
}

void Verifier::SetMocap(std::span<const double> pos, std::span<const double> quat) {
  for (int b = 1; b < model_.nbody; ++b) {
    const int mocap = model_.body_mocapid[b];
    if (mocap < 0) continue;
    const double* p = pos.empty() ? model_.body_pos + 3 * b : pos.data() + 3 * mocap;
    const double* r = quat.empty() ? model_.body_quat + 4 * b : quat.data() + 4 * mocap;
    std::copy(p, p + 3, data_->mocap_pos + 3 * mocap);
    std::copy(r, r + 4, data_->mocap_quat + 4 * mocap);
  }
  UpdateRest({});
}

// The least signed distance [m] of a pair that does not rest: the clearance or the margin that is
// kept (0 if no movable joint can separate the pair) less the overlap that the model allows.
double Verifier::Usual(const CheckedPair& pair) const {
  if (!pair.separable) return -pair.allowed;
  return std::max(clearance_, shared_->keeps_margins ? pair.margin : 0.0) - pair.allowed;
}

double Verifier::DepthAtRest(int geom1, int geom2) const {
  const int index = PairIndex(geom1, geom2);
  if (index < 0) return 0.0;
  return required_[index] < Usual(shared_->pairs[index]) ? required_[index] : 0.0;
}

bool Verifier::Within(int geom1, int geom2, double distance) const {
  const int index = PairIndex(geom1, geom2);
  if (index < 0) return false;
  if (shared_->pairs[index].sdf) return contact_[index] >= 0;
  if (Posed(index).SphereBound() >= distance) return false;
  return Read(index, distance, Depths::kSkipped).distance < distance;
}

// Sets required_: a pair that overlaps by no more than Options::rest in q_in may keep its depth.
// With an empty q_in no pair rests.
void Verifier::UpdateRest(std::span<const double> q_in) {
  const auto& pairs = shared_->pairs;
  for (std::size_t k = 0; k < pairs.size(); ++k) required_[k] = Usual(pairs[k]);
  rest_q_in_.assign(q_in.begin(), q_in.end());
  if (q_in.empty()) return;
  Pose(q_in);
  AskCollision();
  for (int k = 0; k < static_cast<int>(pairs.size()); ++k) {
    double depth = 0.0, size = 0.0;
    if (pairs[k].sdf) {
      depth = contact_[k] < 0 ? 0.0 : -data_->contact[contact_[k]].dist;
    } else if (Posed(k).SphereBound() < 0.0) {
      depth = -Read(k, 0.0, Depths::kMeasured).distance;
      size = Posed(k).size();
    }
    const bool rests = depth > 0.0 && depth <= rest_ + kRestRounding * rest_ + kSizeRounding * size;
    if (rests) required_[k] = std::min(required_[k], -depth);
  }
}

// Makes required_ refer to q_in. Returns false if q or q_in has an entry that is not finite.
bool Verifier::SetRest(std::span<const double> q, std::span<const double> q_in) {
  if (!(rest_ > 0.0)) q_in = {};
  if (!AllFinite(q) || !AllFinite(q_in)) return false;
  if (!std::equal(q_in.begin(), q_in.end(), rest_q_in_.begin(), rest_q_in_.end())) UpdateRest(q_in);
  return true;
}

void Verifier::Pose(std::span<const double> q) {
  ++queries_;
  std::copy(q.begin(), q.end(), data_->qpos);
  mj_kinematics(&model_, data_.get());
}

Reading Verifier::AskExact(int index, double cutoff, Depths depths) const {
  const CheckedPair& pair = shared_->pairs[index];
  double fromto[6] = {};
  Reading reading;
  reading.distance =
      exact_.Distance(*data_, pair, cutoff, tolerance_ + pair.allowed, depths, fromto);
  if (std::isnan(reading.distance)) reading.distance = -kInfinity;
  reading.p1_W = verify::VectorAt(fromto);
  reading.p2_W = verify::VectorAt(fromto + 3);
  Vector3d n = (reading.p2_W - reading.p1_W) * (reading.distance < 0.0 ? -1.0 : 1.0);
  // Witness points that coincide give no normal; the line of centres stands in for it.
  if (n.norm() < kClear * Posed(index).size()) {
    n = verify::VectorAt(data_->geom_xpos + 3 * pair.geom2) -
        verify::VectorAt(data_->geom_xpos + 3 * pair.geom1);
  }
  reading.n_W = n.norm() > 0.0 ? Vector3d(n.normalized()) : Vector3d::UnitZ();
  return reading;
}

// The pair's signed distance with witness points at the current pose. Of a pair that is farther
// apart than `cutoff` [m], the distance read may be any number from `cutoff` on.
Reading Verifier::Read(int index, double cutoff, Depths depths) const {
  const PosedPair posed = Posed(index);
  if (posed.pair.exact) return AskExact(index, cutoff, depths);
  if (posed.HasPlane()) return posed.AgainstPlane();
  if (posed.pair.terrain) return verify::TerrainPair(posed).Measure(cutoff);
  const verify::Search search =
      depths == Depths::kMeasured ? verify::Search::kGlobal : verify::Search::kLocal;
  return posed.ToWorld(verify::Measure(posed.Shapes(), cutoff, search));
}

Certificate Verifier::CertificateOf(int geom1, int geom2) const {
  const int index = PairIndex(geom1, geom2);
  if (index < 0) throw Error("the geoms are no pair that counts");
  return Posed(index).Decide(required_[index] - tolerance_);
}

// Returns kPlane if the signed distance of the pair is at least required_ less the tolerance. The
// answer depends on the pose alone, not on earlier calls.
Proof Verifier::Judge(int index) const {
  const double needed = required_[index] - tolerance_;
  if (shared_->pairs[index].terrain) return verify::TerrainPair(Posed(index)).Judge(needed);
  if (!shared_->pairs[index].exact) return Posed(index).Decide(needed).proof;
  const Depths depths = required_[index] > 0.0 ? Depths::kMeasured : Depths::kSkipped;
  const double cutoff = std::max(needed, 0.0) + tolerance_;
  return AskExact(index, cutoff, depths).distance >= needed ? Proof::kPlane : Proof::kPoints;
}

// True if Judge says kPlane. Cheaper proofs come first: bounding spheres, oriented boxes along the
// axis that was the widest in an earlier call, along all axes, the plane of an earlier call, a
// plane from one minimum-norm search, and, where cores overlap by less than they may, one from a
// climb.
bool Verifier::KeepsApart(int index) {
  const PosedPair posed = Posed(index);
  const double needed = required_[index] - tolerance_;
  if (posed.SphereBound() >= needed) return true;
  int& axis = box_axis_[index];
  if (posed.BoxGap(axis) >= needed) return true;
  const verify::AxisGap widest = posed.BoxBound();
  axis = widest.axis;
  if (widest.gap >= needed) return true;
  if (posed.pair.exact || posed.pair.terrain || posed.HasPlane()) {
    return Judge(index) == Proof::kPlane;
  }
  const ConvexPair placed = posed.Shapes();
  const double enough = needed + kClear * placed.size() + placed.radii();
  Vector3d& n = plane_[index];  // in the frame of the first shape; zero: none is known
  const bool had_plane = n.squaredNorm() > 0.0;
  if (had_plane && placed.CoreGap(n) >= enough) return true;
  verify::MinimumNormQuestion question;
  question.start = had_plane ? n : placed.between;
  if (!(question.start.squaredNorm() > 0.0)) question.start = Vector3d::UnitX();
  question.enough = enough;
  const verify::MinimumNorm found = verify::FindMinimumNorm(placed, question);
  if (found.holds_origin && enough < 0.0) {
    const verify::CoreGap top =
        verify::Climb(placed, question.start.normalized(), verify::kRoundingOfSize);
    n = top.n;
    if (top.gap >= enough) return true;
  } else {
    n = found.n;
    if (found.lower >= enough) return true;
  }
  const Certificate decided = posed.Decide(needed);
  if (decided.proof != Proof::kPlane) return false;
  n = verify::GeomRotation(*data_, posed.pair.geom1).transpose() * decided.n;
  return true;
}

bool Verifier::IsFree(std::span<const double> q, std::span<const double> q_in) {
  if (!SetRest(q, q_in)) return false;
  Pose(q);
  findings_.Clear();
  verdict_.limit_excess = verify::CheckLimits(model_, q, findings_.limits);
  std::erase_if(findings_.limits, [this](const verify::LimitExcess& limit) {
    const int body = model_.jnt_bodyid[limit.joint];
    return !scope_.bodies.empty() && !scope_.bodies[body];
  });
  verdict_.equality_residual =
      verify::CheckEqualities(model_, active_in_scope_, *data_, findings_.equalities);
  verdict_.tendon_excess =
      verify::CheckTendons(model_, tendons_in_scope_, *data_, findings_.tendons);
  if (!findings_.limits.empty() || !findings_.equalities.empty()) return false;
  if (!findings_.tendons.empty()) return false;
  const auto& pairs = shared_->pairs;
  const auto concerns = [&](int k) { return InScope(pairs[k].geom1, pairs[k].geom2); };
  if (too_near_ >= 0 && concerns(too_near_) && !KeepsApart(too_near_)) return false;
  for (const int k : sweep_.Near(*data_, reach_)) {
    if (k == too_near_ || !concerns(k) || KeepsApart(k)) continue;
    too_near_ = k;
    return false;
  }
  AskCollision();
  CheckContacts();
  CheckFields();
  FindDisputes();
  return !findings_.arena_full &&
         std::none_of(findings_.pairs.begin(), findings_.pairs.end(), [this](const Finding& f) {
           return f.violates && InScope(f.contact.geom[0], f.contact.geom[1]);
         });
}

const Verdict& Verifier::Check(std::span<const double> q, std::span<const double> q_in,
                               Depths depths, verify::Words words) {
  verdict_.free = false;
  verdict_.contacts.clear();
  verdict_.pushed_pairs = 0;
  violations_ = {};
  if (!SetRest(q, q_in)) {
    violations_.not_a_number = true;
    verdict_.reason = "the configuration is not a number";
    return verdict_;
  }
  Pose(q);
  findings_.Clear();
  AskCollision();
  verdict_.min_distance = clearance_ + range_;
  CheckContacts();
  CheckFields();
  CheckPairs(depths);
  verdict_.limit_excess = verify::CheckLimits(model_, q, findings_.limits);
  verdict_.equality_residual =
      verify::CheckEqualities(model_, active_, *data_, findings_.equalities);
  verdict_.tendon_excess =
      verify::CheckTendons(model_, shared_->tendons, *data_, findings_.tendons);
  FillViolations();
  FindDisputes();
  verify::WriteVerdict(model_, words, findings_, verdict_);
  return verdict_;
}

// Measures the pairs in ascending order of the lower bounds of their distances. It ends at the
// first bound above both the least distance so far and what freeness requires.
void Verifier::CheckPairs(Depths depths) {
  const double matters = std::max(tolerance_ + reach_, shared_->largest_margin);
  order_.clear();
  for (const int k : sweep_.Near(*data_, std::max(verdict_.min_distance, matters))) {
    const double bound = Posed(k).SphereBound();
    if (bound <= std::max(verdict_.min_distance, matters)) order_.emplace_back(bound, k);
  }
  std::sort(order_.begin(), order_.end());
  for (const auto& [bound, k] : order_) {
    const PosedPair posed = Posed(k);
    const double cutoff = std::max(verdict_.min_distance, matters);
    if (bound > cutoff) break;
    if (posed.BoxBound().gap > cutoff) continue;
    const bool needs_distance = depths == Depths::kSkipped && required_[k] > 0.0;
    const Reading reading = Read(k, cutoff, needs_distance ? Depths::kMeasured : depths);
    if (reading.distance >= cutoff) continue;
    verdict_.min_distance = std::min(verdict_.min_distance, reading.distance);
    verdict_.pushed_pairs +=
        posed.pair.margin > 0.0 && reading.distance < posed.pair.margin - tolerance_;
    const double needed = required_[k] - tolerance_;
    Proof proof = Proof::kPlane;
    if (posed.pair.exact) {
      proof = reading.distance >= needed ? Proof::kPlane : Proof::kPoints;
    } else if (!(reading.distance >= needed + kClear * posed.size())) {
      proof = Judge(k);
    }
    if (proof != Proof::kPlane || reading.distance < tolerance_) Report(k, reading, proof);
  }
}

void Verifier::Report(int index, const Reading& reading, Proof proof) {
  const CheckedPair& pair = shared_->pairs[index];
  Finding finding;
  finding.contact.geom = {pair.geom1, pair.geom2};
  finding.contact.distance = reading.distance;
  verify::SetPlace(reading.n_W, reading.p1_W, reading.p2_W, finding.contact);
  finding.required = required_[index];
  finding.violates = proof != Proof::kPlane;
  finding.unproven = proof == Proof::kUnproven;
  finding.frozen = !pair.separable;
  findings_.pairs.push_back(finding);
}

void Verifier::FillViolations() {
  violations_.arena_full = findings_.arena_full;
  violations_.limits = !findings_.limits.empty();
  violations_.equalities = !findings_.equalities.empty() || !findings_.tendons.empty();
  for (const Finding& finding : findings_.pairs) {
    if (!finding.violates) continue;
    (finding.frozen ? violations_.frozen : violations_.separable) = true;
    violations_.uncertified |= finding.unproven;
  }
}

}  // namespace mjcf_pdg
