// The outer loop of a solve: check, search, verify, report. What is not verified is not solved.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "bound/lower_bound.h"
#include "mjcf_pdg/pdg.h"
#include "paper/paper_method.h"
#include "problem/problem.h"
#include "search/search.h"
#include "solve/inseparable.h"
#include "solve/options.h"
#include "start/selection.h"
#include "verify/verifier.h"

namespace mjcf_pdg {
namespace {

using Clock = std::chrono::steady_clock;

// A pair this near its required distance is reported as touching, in units of the tolerance.
constexpr double kTouching = 10.0;
// What the local optimization leaves between triangles [m]: their normals are those of the nearest
// points as long as they are apart, and guesses when they overlap.
constexpr double kStandOff = 2e-7;
// How much farther from q_in than a refused candidate, doubled until the verifier agrees [share].
constexpr double kFirstBeyond = 1e-4, kLastBeyond = 0.1;
constexpr double kForever = 1e9;  // longer time limits would overflow the clock: none [s]

std::vector<double> ToStd(const VectorXd& q) { return {q.data(), q.data() + q.size()}; }

// Half of the geoms that may move have a smaller bounding radius.
double TypicalSize(const SceneTables& tables) {
  const mjModel& m = *tables.model;
  std::vector<double> radii;
  for (int g = 0; g < m.ngeom; ++g) {
    const bool collides = m.geom_contype[g] || m.geom_conaffinity[g];
    if (collides && tables.body_moves[m.geom_bodyid[g]] && m.geom_rbound[g] > 0.0) {
      radii.push_back(m.geom_rbound[g]);
    }
  }
  if (radii.empty()) return 1.0;
  std::nth_element(radii.begin(), radii.begin() + radii.size() / 2, radii.end());
  return radii[radii.size() / 2];
}

Contact ToContact(const SceneTables& tables, const NearPair& near) {
  const Vector3d middle = 0.5 * (near.p1_W + near.p2_W);
  Contact contact;
  contact.geom = {tables.pairs[near.pair].geom1, tables.pairs[near.pair].geom2};
  contact.normal_W = {near.n_W.x(), near.n_W.y(), near.n_W.z()};
  contact.position_W = {middle.x(), middle.y(), middle.z()};
  contact.distance = near.distance;
  return contact;
}

bool Deeper(const Contact& a, const Contact& b) { return a.distance < b.distance; }

}  // namespace

struct Solver::Impl {
  Impl(const Scene& s, const Options& o)
      : scene(s),
        options(o),
        problem(scene.tables(), options),
        search(problem),
        paper(problem),
        verifier(scene.verifier_model(), options) {
    problem.size = TypicalSize(scene.tables());
    SetMocap({options.mocap_pos, options.mocap_quat});
  }

  void SetMocap(MocapPoses poses);
  void SetUp(const std::vector<double>& q_in);
  SearchOutcome Run(const std::vector<NearPair>& overlaps, std::optional<VectorXd> hint);
  bool FrozenOverlap(const std::vector<NearPair>& overlaps) const;
  bool SomeMove(const std::vector<NearPair>& overlaps) const;
  bool Accept(const Candidate& candidate, const std::vector<double>& q_in, Result& result);
  bool AcceptBest(SearchOutcome& outcome, const std::vector<double>& q_in, Result& result);
  bool AcceptLeastOverlap(const SearchOutcome& outcome, const std::vector<double>& q_in,
                          Result& result);
  void FillUnsolved(const SearchOutcome& outcome, const std::vector<double>& q_in, Result& result);
  void Repair(const std::vector<double>& q_in, std::optional<VectorXd> hint, Result& result);
  double NearestExact(double least);
  std::int64_t Queries() const {
    return problem.finder.queries() + search.hull_queries() + verifier.queries();
  }
  void FillContacts(Result& result);
  void Remember(const Result& result);
  void DeepenContactsIn(const std::vector<NearPair>& overlaps, Result& result) const;

  Scene scene;
  Options options;
  Problem problem;
  Search search;
  PaperMethod paper;
  Verifier verifier;
};

void Solver::Impl::SetMocap(MocapPoses poses) {
  problem.finder.SetMocap(poses);
  verifier.SetMocap(poses.pos, poses.quat);
  problem.mocap = std::move(poses);
}

// Everything that refers to q_in: the norm, the required distances. The verifier has seen it.
void Solver::Impl::SetUp(const std::vector<double>& q_in) {
  const SceneTables& tables = scene.tables();
  problem.finder.Forget();
  problem.q_in = Normalized(tables, ToEigen(q_in));
  problem.tolerances = Tolerances(options.tolerance);
  problem.norm.SetReference(problem.q_in, problem.mocap);
  problem.required.resize(static_cast<Eigen::Index>(tables.pairs.size()));
  for (std::size_t k = 0; k < tables.pairs.size(); ++k) {
    const KeptPair& pair = tables.pairs[k];
    double required = (pair.moves ? options.clearance : 0.0) - pair.allowed;
    if (pair.exact && pair.moves) required += problem.tolerances.aim + kStandOff;
    const double at_rest = verifier.DepthAtRest(pair.geom1, pair.geom2);
    if (at_rest < 0.0) required = std::min(required, at_rest);
    problem.required[static_cast<Eigen::Index>(k)] = required;
  }
}

bool Solver::Impl::FrozenOverlap(const std::vector<NearPair>& overlaps) const {
  return std::any_of(overlaps.begin(), overlaps.end(), [this](const NearPair& near) {
    return !scene.tables().pairs[near.pair].moves;
  });
}

bool Solver::Impl::SomeMove(const std::vector<NearPair>& overlaps) const {
  return overlaps.empty() ||  // but a joint is outside its limits
         std::any_of(overlaps.begin(), overlaps.end(), [this](const NearPair& near) {
           return scene.tables().pairs[near.pair].moves;
         });
}

SearchOutcome Solver::Impl::Run(const std::vector<NearPair>& overlaps,
                                std::optional<VectorXd> hint) {
  if (options.method == Method::kAuto) {
    if (hint && problem.Uses("user_pose")) {
      return search.Run(overlaps, FreeConfiguration{*std::move(hint), "user_pose"});
    }
    const bool coherent = options.trajectory && problem.Uses("motion_coherence");
    return search.Run(overlaps, coherent ? paper.Recall() : std::nullopt);
  }
  PaperResult result = paper.Run(hint);
  SearchOutcome outcome;
  outcome.starts = result.selections;
  outcome.iterations = result.iterations;
  if (result.free) {
    outcome.free.push_back({std::move(result.q), result.sigma, std::move(result.start)});
  }
  return outcome;
}

bool Solver::Impl::Accept(const Candidate& candidate, const std::vector<double>& q_in,
                          Result& result) {
  VectorXd q = candidate.q;
  Unwind(scene.tables(), problem.q_in, q);
  const Verdict& verdict = verifier.Check(ToStd(q), q_in, verify::Depths::kSkipped);
  if (!verdict.free) return false;
  result.status = Status::kSolved;
  result.q = ToStd(q);
  result.sigma = problem.norm.Sigma(q);
  result.start = candidate.start;
  result.min_distance = verdict.min_distance;
  result.certified = verdict.certified;
  return true;
}

// Polishes and verifies the candidates, best first. One that the verifier refuses is moved a little
// further out and asked about again: by a descent that keeps a distance, or else straight on.
bool Solver::Impl::AcceptBest(SearchOutcome& outcome, const std::vector<double>& q_in,
                              Result& result) {
  for (Candidate& candidate : outcome.free) {
    if (options.method == Method::kAuto && search.WorthPolishing()) {
      const LocalResult polished = search.Polish(candidate.q);
      outcome.iterations += polished.iterations;
      if (polished.free && polished.sigma < candidate.sigma) {
        candidate.q = polished.q;
        candidate.sigma = polished.sigma;
      }
    }
    if (Accept(candidate, q_in, result)) return true;
    const Tolerances usual = problem.tolerances;
    problem.tolerances.accept = 0.0;
    problem.tolerances.aim = -options.tolerance;
    const LocalResult retreated = search.Polish(candidate.q);
    problem.tolerances = usual;
    outcome.iterations += retreated.iterations;
    if (retreated.free && Accept({retreated.q, 0.0, candidate.start}, q_in, result)) return true;
    for (double beyond = kFirstBeyond; beyond < kLastBeyond; beyond *= 2.0) {
      const VectorXd q = Beyond(problem, problem.q_in, candidate.q, 1.0 + beyond);
      if (Accept({q, 0.0, candidate.start}, q_in, result)) return true;
    }
  }
  return false;
}

// Exact meshes that cross may do no more than touch: the verifier knows.
bool Solver::Impl::AcceptLeastOverlap(const SearchOutcome& outcome, const std::vector<double>& q_in,
                                      Result& result) {
  const VectorXd& q = outcome.least_overlap.q;
  return q.size() > 0 && Accept({q, 0.0, outcome.least_overlap_start}, q_in, result);
}

// The least overlap that the search saw, or q_in inside its limits if the verifier finds more
// there.
void Solver::Impl::FillUnsolved(const SearchOutcome& outcome, const std::vector<double>& q_in,
                                Result& result) {
  VectorXd inside = problem.q_in;
  TurnInsideLimits(scene.tables(), inside);
  VectorXd q = inside;
  result.start = "none";
  if (!outcome.free.empty()) {  // but for the verifier, or pairs that nothing moves
    q = outcome.free.front().q;
    result.start = outcome.free.front().start;
  } else if (outcome.least_overlap.q.size() > 0) {
    q = outcome.least_overlap.q;
    result.start = outcome.least_overlap_start;
  }
  Verdict verdict = verifier.Check(ToStd(q), q_in);
  if (verdict.min_distance < result.depth_in) {
    const Verdict& at_start = verifier.Check(ToStd(inside), q_in);
    if (at_start.min_distance > verdict.min_distance) {
      verdict = at_start;
      q = inside;
      result.start = "none";
    }
  }
  result.status = Status::kUnsolved;
  result.q = ToStd(q);
  result.sigma = problem.norm.Sigma(q);
  result.min_distance = verdict.min_distance;
  result.certified = verdict.certified;
  result.reason = problem.Expired() ? "time limit reached; " : "";
  result.reason += "no free configuration found from " + std::to_string(outcome.starts) +
                   " starts: " + verdict.reason + DescribeInseparable(problem, q);
}

// q_in penetrates: bound, search, verify.
void Solver::Impl::Repair(const std::vector<double>& q_in, std::optional<VectorXd> hint,
                          Result& result) {
  const std::vector<NearPair> overlaps = problem.OverlapsAtInput();
  DeepenContactsIn(overlaps, result);
  problem.sigma_lower_bound = SigmaLowerBound(problem, overlaps);
  result.sigma_lower_bound = problem.sigma_lower_bound;
  SearchOutcome outcome;
  if (SomeMove(overlaps)) outcome = Run(overlaps, std::move(hint));
  const bool solved = !FrozenOverlap(overlaps) && (AcceptBest(outcome, q_in, result) ||
                                                   AcceptLeastOverlap(outcome, q_in, result));
  if (!solved) FillUnsolved(outcome, q_in, result);
  result.stats.iterations = outcome.iterations;
  result.stats.starts = outcome.starts;
}

// The verifier was not asked how deep exact pairs overlap at q_in.
void Solver::Impl::DeepenContactsIn(const std::vector<NearPair>& overlaps, Result& result) const {
  for (Contact& contact : result.contacts_in) {
    for (const NearPair& near : overlaps) {
      const KeptPair& pair = scene.tables().pairs[near.pair];
      const bool same = contact.geom == std::array<int, 2>{pair.geom1, pair.geom2};
      if (!same || !pair.exact || near.distance >= contact.distance) continue;
      contact = ToContact(scene.tables(), near);
      result.depth_in = std::min(result.depth_in, near.distance);
    }
  }
  std::stable_sort(result.contacts_in.begin(), result.contacts_in.end(), Deeper);
}

// The least of `least` and the distances of exact pairs, where the finder is posed.
double Solver::Impl::NearestExact(double least) {
  std::vector<std::pair<double, int>> order;  // (bound, pair)
  for (int pair = 0; pair < static_cast<int>(scene.tables().pairs.size()); ++pair) {
    if (scene.tables().pairs[pair].exact) {
      order.emplace_back(problem.finder.DistanceBound(pair), pair);
    }
  }
  std::sort(order.begin(), order.end());
  NearPair near;
  for (const auto& [bound, pair] : order) {
    if (bound < least && problem.finder.Distance(pair, least, near)) least = near.distance;
  }
  return least;
}

// Contacts, and how near exact pairs are where the verifier only asked whether they overlap.
void Solver::Impl::FillContacts(Result& result) {
  problem.finder.Pose(ToEigen(result.q));
  const double reach = kTouching * options.tolerance;
  double nearest = std::numeric_limits<double>::infinity();  // of exact pairs
  for (const NearPair& near : problem.finder.Find(options.clearance + reach)) {
    if (scene.tables().pairs[near.pair].exact) nearest = std::min(nearest, near.distance);
    if (near.distance < std::max(0.0, problem.required[near.pair]) + reach) {
      result.contacts.push_back(ToContact(scene.tables(), near));
    }
  }
  if (result.status != Status::kUnsolved) {
    result.min_distance = std::isinf(nearest) ? NearestExact(result.min_distance)
                                              : std::min(result.min_distance, nearest);
  }
  std::stable_sort(result.contacts.begin(), result.contacts.end(), Deeper);
}

// Only the paper's method has a use for frames that overlap.
void Solver::Impl::Remember(const Result& result) {
  const VectorXd q = ToEigen(result.q);
  if (result.status == Status::kUnsolved) {
    paper.Remember(q);
  } else {
    paper.RememberFree(q);
  }
  const bool overlaps = result.status != Status::kAlreadyFree;
  if (overlaps && options.method == Method::kPaper) paper.Remember(problem.q_in);
}

Solver::Solver(const Scene& scene, const Options& options) {
  CheckOptions(options, *scene.model());
  const std::vector<std::string> equalities = scene.ActiveEqualities();
  if (!equalities.empty()) {
    throw Error("active equality constraint " + equalities.front() +
                " is not supported yet; active=\"false\" solves without it");
  }
  impl_ = std::make_unique<Impl>(scene, options);
}

Solver::~Solver() = default;
Solver::Solver(Solver&&) noexcept = default;
Solver& Solver::operator=(Solver&&) noexcept = default;

void Solver::SetMocap(const std::vector<double>& pos, const std::vector<double>& quat) {
  CheckMocap(pos, quat, *impl_->scene.model());
  impl_->SetMocap({pos, quat});
}

Result Solver::Solve(const std::vector<double>& q_in,
                     const std::optional<std::vector<double>>& free_hint) {
  impl_->scene.CheckConfiguration(q_in);
  if (free_hint) impl_->scene.CheckConfiguration(*free_hint);
  const Clock::time_point begin = Clock::now();
  Problem& problem = impl_->problem;
  if (impl_->options.time_limit < kForever) {
    const auto limit = std::chrono::duration<double>(impl_->options.time_limit);
    problem.deadline = begin + std::chrono::duration_cast<Clock::duration>(limit);
  }
  const std::int64_t queries_before = impl_->Queries();
  const std::int64_t lcp_before = impl_->search.lcp_steps() + impl_->paper.sweeps();

  Result result;
  const Verdict& at_start = impl_->verifier.Check(q_in, q_in, verify::Depths::kSkipped);
  result.depth_in = at_start.min_distance;
  result.contacts_in = at_start.contacts;
  result.limit_excess_in = at_start.limit_excess;
  if (at_start.free) {
    result.status = Status::kAlreadyFree;
    result.q = q_in;
    result.certified = at_start.certified;
    result.start = "none";
    impl_->SetUp(q_in);
    result.min_distance = at_start.min_distance;
  } else {
    impl_->SetUp(q_in);
    std::optional<VectorXd> hint;
    if (free_hint) hint = WithMovable(problem.tables, problem.q_in, ToEigen(*free_hint));
    impl_->Repair(q_in, std::move(hint), result);
  }
  impl_->FillContacts(result);
  if (result.status == Status::kAlreadyFree) result.depth_in = result.min_distance;
  if (impl_->options.trajectory) impl_->Remember(result);
  result.stats.collision_queries = static_cast<int>(impl_->Queries() - queries_before);
  result.stats.lcp_sweeps =
      static_cast<int>(impl_->search.lcp_steps() + impl_->paper.sweeps() - lcp_before);
  result.stats.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  return result;
}

}  // namespace mjcf_pdg
