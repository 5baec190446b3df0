#include "search/search.h"

#include <algorithm>
#include <cmath>

namespace mjcf_pdg {

// How far to go, by effort. Measured in bench/: success first, then σ, then time.
struct Search::Plan {
  // The search ends when so many independent starts have ended at the best answer: fewer where that
  // is near what is proven.
  int agree_near_proven = 3, agree = 6;
  int queries = 800;       // collision queries after which no further start is made
  double box_tests = 9e3;  // ... and per dof, of triangle meshes, unless the answer is very far
  double evaluations = 1000.0;  // ... and estimated time since something was free [evaluations]
  bool follows = true;          // exact meshes: a frame may trust the last one's answer
  int blind = 20;               // noisy starts while nothing is free, then as many anywhere
};

namespace {

// Names of starts, of Components (pdg.h).
constexpr char kDirect[] = "direct", kMirror[] = "mirror", kNoiseStart[] = "noise", kHop[] = "hop";
constexpr char kHulls[] = "hulls", kPairByPair[] = "pair_by_pair";
constexpr char kTranslation[] = "constrained_translation", kAnywhereStart[] = "anywhere";
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kAgreement = 1.01;  // σ over the best: the same answer
constexpr double kNearProven = 5.0;  // σ over its lower bound: contacts hardly interact
constexpr double kGiveUp = 1.15;     // a start whose prediction is worse than this is dropped
constexpr double kWorthARun = 5.0;   // σ over the best, where a varied start comes free
constexpr double kDragged = 2.0;     // √σ over its least possible, up to which frames follow
constexpr int kFramesFollowed = 5;   // ... and so many in a row
constexpr double kFarthest = 4.0;    // times the distance of a start: where its ray ends
// Answers so many times as far as meshes are deep in each other: there may well be a nearer one.
constexpr double kFar = 2.5, kVeryFar = 10.0;
// Patient tries to come out of overlapping meshes the short way, at such noise [depth].
constexpr int kWaysOut = 5, kPatientSteps = 120;
constexpr double kNudge = 0.2;
// LocalOptions::last_chances of a start near its answer, and at it.
constexpr int kHintChances = 2, kPolishChances = 3;
// Spreads of the noisy starts, in turn: how far the nearest answer's basin reaches is not known.
constexpr double kNoise[] = {5.0, 2.0, 3.0, 8.0};
// Time of a query, of a pair distance and of an LCP's step per dof [evaluations], the latter two
// over the distances at q_in but no fewer than kFewDistances.
constexpr double kPerQuery = 0.3, kPerDistance = 0.8, kPerStepAndDof = 0.03;
constexpr int kFewDistances = 4;
constexpr Hop kHops[] = {Hop::kFromBest, Hop::kFromInput, Hop::kMirrored};

LocalOptions Coarse() {
  LocalOptions options;
  options.max_iterations = 40;
  options.convergence = 1e-3;
  return options;
}

bool MovedByFreeJointsOnly(const SceneTables& tables, int pair) {
  const mjModel& m = *tables.model;
  for (const int geom : {tables.pairs[pair].geom1, tables.pairs[pair].geom2}) {
    for (int body = m.geom_bodyid[geom]; body > 0; body = m.body_parentid[body]) {
      for (int k = 0; k < m.body_jntnum[body]; ++k) {
        if (m.jnt_type[m.body_jntadr[body] + k] != mjJNT_FREE) return false;
      }
    }
  }
  return true;
}

}  // namespace

Search::Search(Problem& problem)
    : problem_(problem),
      local_(problem),
      iteration_(problem),
      hulls_(problem),
      parting_(problem),
      starts_(problem),
      random_(0) {}

Search::Plan Search::PlanFor(Effort effort) {
  switch (effort) {
    case Effort::kFast:
      return {.agree_near_proven = 1, .agree = 1, .queries = 0, .evaluations = kInfinity};
    case Effort::kDefault:
      return {};
    case Effort::kMax:
      return {.agree_near_proven = 8,
              .agree = 12,
              .queries = 4000,
              .box_tests = kInfinity,
              .evaluations = kInfinity,
              .follows = false,
              .blind = 80};
  }
  return {};
}

double Search::BestSigma() const { return HasFree() ? outcome_.free.front().sigma : kInfinity; }

bool Search::Done(const Plan& plan) const {
  if (!HasFree()) return false;
  if (BestSigma() <= kAgreement * problem_.sigma_lower_bound) return true;  // the nearest: proven
  const bool near_proven = BestSigma() <= kNearProven * problem_.sigma_lower_bound;
  const int enough = near_proven ? plan.agree_near_proven : plan.agree;
  if (agreeing_ >= enough || Evaluations() >= plan.evaluations) return true;
  const std::int64_t queries = problem_.finder.queries() - first_query_;
  if (!exact_) return queries >= plan.queries;
  // More queries: most of them only ask whether a configuration is free.
  if (Exceeds(kVeryFar)) return queries >= 3 * plan.queries;
  const auto box_tests = static_cast<double>(problem_.finder.box_tests() - first_box_test_);
  return 2 * queries >= 3 * plan.queries || box_tests >= plan.box_tests * problem_.tables.n;
}

double Search::Evaluations() const {
  const auto queries = static_cast<double>(problem_.finder.queries() - free_query_);
  const auto distances = static_cast<double>(problem_.finder.distances() - free_distance_);
  const auto steps = static_cast<double>(local_.lcp_steps() - free_lcp_step_);
  const double in_distances = kPerDistance * distances + kPerStepAndDof * problem_.tables.n * steps;
  return kPerQuery * queries + in_distances / std::max(kFewDistances, problem_.input_distances);
}

bool Search::Try(const VectorXd& q, const std::string& start, const LocalOptions& options) {
  if (problem_.Expired() && outcome_.starts > 0) return false;
  ++outcome_.starts;
  LocalOptions bounded = options;
  if (HasFree() && problem_.Uses("early_exit")) {
    bounded.give_up_sigma = kGiveUp * BestSigma();
    bounded.known = &outcome_.free.front().q;
    bounded.known_sigma = BestSigma();
  }
  LocalResult result = local_.Run(q, bounded);
  outcome_.iterations += result.iterations;
  Count(result, start);
  const bool promising = !result.hopeless;
  if (result.free && !HasFree()) {
    free_query_ = problem_.finder.queries();
    free_distance_ = problem_.finder.distances();
    free_lcp_step_ = local_.lcp_steps();
  }
  if (result.free) {
    Candidate candidate{std::move(result.q), result.sigma, start};
    auto place =
        std::upper_bound(outcome_.free.begin(), outcome_.free.end(), candidate,
                         [](const Candidate& a, const Candidate& b) { return a.sigma < b.sigma; });
    outcome_.free.insert(place, std::move(candidate));
  } else if (outcome_.least_overlap.q.size() == 0 ||
             result.violation < outcome_.least_overlap.violation) {
    outcome_.least_overlap = std::move(result);
    outcome_.least_overlap_start = start;
  }
  return promising;
}

// A hop comes from the best answer, so its return there says nothing; nor do translations in other
// directions, which symmetry makes as long.
void Search::Count(const LocalResult& result, const std::string& start) {
  const bool independent = start != kHop;
  if (result.free && result.sigma * kAgreement < BestSigma()) {
    agreeing_ = independent;
  } else if (result.reached_known || (result.free && result.sigma <= kAgreement * BestSigma())) {
    agreeing_ += independent && start != kTranslation;
  }
}

// The paper's way: a pose that may be free goes through contact-space projection and iteration, for
// motions that no local step from q_in can find; local optimization finishes, or tries if it is
// not.
void Search::TryFreePose(const VectorXd& q_f, const std::string& start) {
  if (problem_.Expired() && outcome_.starts > 0) return;
  const IterationResult result = iteration_.Run(q_f);
  outcome_.iterations += result.iterations;
  Try(result.q, start, LocalOptions{});
}

void Search::TryTranslations(const std::vector<NearPair>& overlaps) {
  for (const VectorXd& q_f : starts_.ConstrainedTranslation(overlaps, problem_.q_in)) {
    TryFreePose(q_f, kTranslation);
    if (HasFree()) return;
  }
}

// Exact meshes: the nearest free poses on the translations of Eq. 20, on the way out.
void Search::TryRays(const std::vector<NearPair>& overlaps) {
  const std::span<const VectorXd> far = starts_.ConstrainedTranslation(overlaps, center_);
  for (const FreeOnRay& free : starts_.FirstFree(center_, far, kInfinity)) {
    Try(free.q, kTranslation, Coarse());
  }
}

// The frames of a trajectory drag the answer along, in the end far from the nearest. Where only
// free bodies move and nothing else has, √σ is a metric: the nearest is no nearer than the frame
// last searched had it, less what q_in has moved since.
bool Search::Follows(const Plan& plan) {
  const SceneTables& tables = problem_.tables;
  bool near = plan.follows && problem_.options.trajectory && searched_ && HasFree() &&
              frames_followed_ < kFramesFollowed && searched_->mocap == problem_.mocap &&
              WithMovable(tables, searched_->q_in, problem_.q_in) == problem_.q_in &&
              std::all_of(
                  tables.joints.begin(), tables.joints.end(),
                  [](const JointEntry& joint) { return joint.type == mjJNT_FREE; });
  if (near) {
    const double least = searched_->rms - std::sqrt(problem_.norm.Sigma(searched_->q_in));
    near = std::sqrt(BestSigma()) < kDragged * least;
  }
  if (near) ++frames_followed_;
  return near;
}

// How deep two triangle meshes overlap says little: the way there, and beyond, is followed to where
// they are apart first.
void Search::TryOnRay(const VectorXd& q, const std::string& start) {
  if (!exact_) {
    Try(q, start, Coarse());
    return;
  }
  starts_.Beyond(center_, q, kFarthest, far_);
  for (const FreeOnRay& free : starts_.FirstFree(center_, {&far_, 1}, kWorthARun * BestSigma())) {
    Try(free.q, start, Coarse());
  }
}

// A noisy start, a hop, a noisy start, and so on; noise alone while nothing is free. The hop comes
// early: noisy starts agree on a wrong answer sooner than it finds a better one.
void Search::TryVaried(const Plan& plan) {
  const bool noise = problem_.Uses(kNoiseStart), hops = problem_.Uses(kHop);
  for (int k = 0; !Done(plan) && !problem_.Expired(); ++k) {
    if (hops && HasFree() && (k % 3 == 1 || !noise)) {
      TryHop(kHops[(noise ? k / 3 : k) % 3]);
    } else {
      if (!noise) return;
      // Nothing free yet: the scale is a guess, widened from try to try.
      const double widened = HasFree() ? 1.0 : 1.0 + 0.5 * k;
      TryNoise(widened * kNoise[k % 4]);
    }
    if (!HasFree() && k + 1 == plan.blind) return;
  }
}

void Search::TryNoise(double spread) {
  double sigma = BestSigma();
  if (!HasFree()) {
    sigma = std::max(outcome_.least_overlap.sigma, 1e-6);
    if (!std::isfinite(sigma)) sigma = problem_.size * problem_.size;
  }
  starts_.Gaussian(center_, sigma, spread, random_, start_);
  TryOnRay(start_, kNoiseStart);
}

void Search::TryHop(Hop hop) {
  starts_.ContactHop(outcome_.free.front().q, BestSigma(), hop, random_, start_);
  TryOnRay(start_, kHop);
}

// Nothing near q_in worked: anywhere inside the limits, and home from there.
void Search::TryAnywhere(const Plan& plan) {
  for (int k = 0; k < plan.blind && !HasFree() && !problem_.Expired(); ++k) {
    starts_.Uniform(center_, random_, start_);
    Try(start_, kAnywhereStart, LocalOptions{});
  }
  if (!HasFree()) return;
  TryFreePose(outcome_.free.front().q, kAnywhereStart);
}

// Translations take a rigid body out the short way, but a finger over the rim of a cup, where its
// joints could take it back through the wall: links are parted pair by pair first. The direct start
// knows only how deep the meshes overlap: it comes last, and only if translations found nothing
// near. A hint does not replace these.
void Search::TryExact(const Plan& plan, const std::vector<NearPair>& overlaps) {
  const std::size_t hinted = outcome_.free.size();
  const bool rigid = std::all_of(overlaps.begin(), overlaps.end(), [this](const NearPair& near) {
    return MovedByFreeJointsOnly(problem_.tables, near.pair);
  });
  if (!rigid && problem_.Uses(kHulls)) {
    if (const std::optional<VectorXd> q = hulls_.Start()) Try(*q, kHulls, Coarse());
  }
  if (!rigid && problem_.Uses(kPairByPair)) {
    if (const std::optional<VectorXd> q = parting_.Start(center_)) Try(*q, kPairByPair, Coarse());
  }
  if (problem_.Uses(kTranslation)) TryRays(overlaps);
  const bool found = outcome_.free.size() > hinted;
  if (!problem_.Uses(kDirect) || (found && Done(plan))) return;
  if (Exceeds(kFar)) {
    TryFromWithin();
  } else if (!found || !rigid) {
    Try(center_, kDirect, Coarse());
  }
}

// A nut leaves its bolt along the axis only. Its own contacts lead it out, if all of them are seen
// and no step is longer than the overlap. A try that leads to nothing better is given up early.
void Search::TryFromWithin() {
  LocalOptions patient = Coarse();
  patient.max_iterations = kPatientSteps;
  patient.depths = Depths::kSearched;
  patient.largest_step = depth_;
  for (int k = 0; k < kWaysOut && Exceeds(k == 0 ? kFar : kVeryFar) && !problem_.Expired(); ++k) {
    start_ = center_;
    if (k > 0) starts_.Gaussian(center_, depth_ * depth_, kNudge, random_, start_);
    if (!Try(start_, kDirect, patient)) return;
  }
}

SearchOutcome Search::Run(const std::vector<NearPair>& overlaps,
                          const std::optional<FreeConfiguration>& hint) {
  outcome_ = {};
  agreeing_ = 0;
  random_ = Random(problem_.options.seed);
  first_query_ = problem_.finder.queries();
  first_box_test_ = problem_.finder.box_tests();
  depth_ = 0.0;
  for (const NearPair& near : overlaps) {
    depth_ = std::max(depth_, problem_.options.clearance - near.distance);
  }
  Plan plan = PlanFor(problem_.options.effort);
  center_ = problem_.q_in;
  TurnInsideLimits(problem_.tables, center_);
  exact_ = std::any_of(overlaps.begin(), overlaps.end(), [this](const NearPair& near) {
    return problem_.tables.pairs[near.pair].exact;
  });
  if (exact_) {
    plan.evaluations = kInfinity;
    LocalOptions near = Coarse();
    near.last_chances = kHintChances;
    if (hint) Try(hint->q, hint->start, near);
    if (Follows(plan)) return std::move(outcome_);
    TryExact(plan, overlaps);
    first_query_ = problem_.finder.queries();  // the budget is for what varies from there
  } else {
    if (problem_.Uses(kDirect)) Try(center_, kDirect, LocalOptions{});
    if (hint) Try(hint->q, hint->start, LocalOptions{});
  }
  if (HasFree() && !Done(plan) && problem_.Uses(kMirror)) {
    starts_.Mirrored(outcome_.free.front().q, start_);
    TryOnRay(start_, kMirror);
  }
  TryVaried(plan);
  if (!HasFree()) {
    if (problem_.Uses(kTranslation)) TryTranslations(overlaps);
    if (!HasFree() && problem_.Uses(kAnywhereStart)) TryAnywhere(plan);
    first_query_ = problem_.finder.queries();  // the search for a nearer one begins here
    if (HasFree()) TryVaried(plan);
  }
  searched_.reset();
  frames_followed_ = 0;
  if (HasFree()) searched_ = {problem_.q_in, problem_.mocap, std::sqrt(BestSigma())};
  return std::move(outcome_);
}

// It takes a fifth of a fast solve of exact meshes, for 1e-3 of σ.
bool Search::WorthPolishing() const {
  const bool in_haste = problem_.options.effort == Effort::kFast || frames_followed_ > 0;
  return problem_.Uses("polish") && !(exact_ && in_haste);
}

LocalResult Search::Polish(const VectorXd& q) {
  LocalOptions options;
  options.max_iterations = 15;
  options.convergence = 1e-6;
  options.trust_radius = 0.05;
  options.last_chances = kPolishChances;
  return local_.Run(q, options);
}

}  // namespace mjcf_pdg
