#include "solve/report.h"

#include <algorithm>

#include "solve/inseparable.h"

namespace mjcf_pdg {
namespace {

void Assign(const VectorXd& q, std::vector<double>& out) {
  out.assign(q.data(), q.data() + q.size());
}

// Geoms that touched and are no farther apart than this still touch, for a grasp or a footing [m].
constexpr double kKeptContact = 1e-3;

// Long enough for every Result::start, so that warm results do not allocate.
constexpr std::size_t kLongestStart = 32;

// Whether a configuration that is not free is still worth going to from another one: it is no
// deeper, and either less deep, or fewer pairs are too near, or equality constraints and tendon
// limits that did not hold do, or are nearer to it. How far apart others are does not count: that
// is known only as far as distances are reported.
bool Improves(const Verdict& there, const Verdict& here, const Options& options) {
  const double tolerance = options.tolerance;
  const auto nearest = [&options](const Verdict& v) {
    double least = options.clearance;
    for (const Contact& contact : v.contacts) least = std::min(least, contact.distance);
    return least;
  };
  if (nearest(there) < nearest(here) - tolerance) return false;
  const auto too_near = [&options](const Verdict& v) {
    return std::count_if(v.contacts.begin(), v.contacts.end(), [&options](const Contact& contact) {
      return contact.distance < options.clearance - options.tolerance;
    });
  };
  const auto broken = [](const Verdict& v) {
    return std::max(v.equality_residual, v.tendon_excess);
  };
  const bool holds_better =
      broken(here) > kEqualityTolerance &&
      broken(there) <= std::max(kEqualityTolerance, broken(here) - kEqualityTolerance);
  return nearest(there) > nearest(here) + tolerance || too_near(there) < too_near(here) ||
         holds_better;
}

}  // namespace

void Reporter::Clear(Result& result) {
  result.status = Status::kUnsolved;
  result.cause = Cause::kNone;
  result.sigma = result.sigma_lower_bound = 0.0;
  result.depth_in = result.min_distance = result.limit_excess_in = 0.0;
  result.equality_residual_in = result.equality_residual = 0.0;
  result.tendon_excess_in = result.tendon_excess = 0.0;
  result.certified = false;
  result.start.reserve(kLongestStart);
  result.start.clear();
  result.reason.clear();
  result.contacts_in.clear();
  result.contacts.clear();
  result.contacts_kept = result.pushed_pairs = 0;
  result.switched = result.under_way = false;
  result.stats = {};
}

bool Reporter::Input(const std::vector<double>& q_in, Result& result) {
  const bool free = Reports() ? MeasureInput(q_in, result) : verifier_.IsFree(q_in, q_in);
  result.equality_residual_in = verifier_.verdict().equality_residual;
  result.tendon_excess_in = verifier_.verdict().tendon_excess;
  if (free) FillFree(q_in, result);
  return free;
}

// What is to be reported of q_in.
bool Reporter::MeasureInput(const std::vector<double>& q_in, Result& result) {
  const Verdict& verdict =
      verifier_.Check(q_in, q_in, verify::Depths::kMeasured, verify::Words::kSkipped);
  result.depth_in = verdict.min_distance;
  result.limit_excess_in = verdict.limit_excess;
  if (problem_.options.report_contacts) result.contacts_in = verdict.contacts;
  return verdict.free;
}

// The verifier was last asked about q_in.
void Reporter::FillFree(const std::vector<double>& q_in, Result& result) {
  if (Reports()) {
    Answer(verifier_.verdict(), result);
    CountKeptContacts(result);
  } else {
    AnswerUnmeasured(result);
    result.depth_in = result.min_distance;
  }
  result.status = Status::kAlreadyFree;
  result.q = q_in;
  result.start = NameOf(Component::kNone);
}

void Reporter::Overlaps(const std::vector<NearPair>& overlaps, Result& result) const {
  if (Reports()) return;
  result.limit_excess_in = LimitExcess(problem_.tables, problem_.q_in);
  result.depth_in = problem_.options.clearance - problem_.options.tolerance;
  for (const NearPair& near : overlaps) result.depth_in = std::min(result.depth_in, near.distance);
}

void Reporter::Solved(const std::vector<double>& q_in, const Answered& answer, Result& result) {
  result.status = Status::kSolved;
  result.q = answer.q;
  result.sigma = answer.sigma ? *answer.sigma : Sigma(answer.q);
  result.start = NameOf(answer.start);
  if (Reports()) {
    Answer(answer.checked ? verifier_.verdict() : verifier_.Check(answer.q, q_in), result);
    CountKeptContacts(result);
  } else {
    AnswerUnmeasured(result);
  }
}

double Reporter::Sigma(const std::vector<double>& q) {
  q_ = Eigen::Map<const VectorXd>(q.data(), static_cast<Eigen::Index>(q.size()));
  return work_.norm.Sigma(q_);
}

void Reporter::Answer(const Verdict& verdict, Result& result) const {
  result.min_distance = verdict.min_distance;
  result.certified = verdict.certified;
  result.equality_residual = verdict.equality_residual;
  result.tendon_excess = verdict.tendon_excess;
  result.pushed_pairs = verdict.pushed_pairs;
  if (problem_.options.report_contacts) result.contacts = verdict.contacts;
}

// At the configuration that the verifier was last asked about.
void Reporter::CountKeptContacts(Result& result) const {
  result.contacts_kept = 0;
  for (const Contact& contact : result.contacts_in) {
    result.contacts_kept += verifier_.Within(contact.geom[0], contact.geom[1], kKeptContact);
  }
}

// Of what is free: at least so far from everything.
void Reporter::AnswerUnmeasured(Result& result) const {
  result.min_distance = problem_.options.clearance - problem_.options.tolerance;
  result.certified = verifier_.certified();
  result.equality_residual = verifier_.verdict().equality_residual;
  result.tendon_excess = verifier_.verdict().tendon_excess;
}

void Reporter::Unsolved(const std::vector<double>& q_in, const Outcome* outcome, bool frozen,
                        Result& result) {
  const auto check = [&](const std::vector<double>& q) -> const Verdict& {
    return verifier_.Check(q, q_in, depths_of_unsolved);
  };
  work_.ReferNorm();
  VectorXd inside = problem_.q_in;
  TurnInsideLimits(problem_.tables, inside);
  work_.equality.Project(inside);
  const Candidate* candidate = nullptr;
  if (outcome && !outcome->free.empty()) {  // but for the verifier
    candidate = &outcome->free.front();
  } else if (outcome && outcome->has_overlap) {
    candidate = &outcome->least_overlap;
  }
  // Once the budget is spent the depth that the search knows is good enough.
  if (!Reports() && !work_.Spent()) result.depth_in = check(q_in).min_distance;
  Assign(candidate ? candidate->q : inside, result.q);
  result.start = NameOf(candidate ? candidate->start : Component::kNone);
  Verdict verdict = check(result.q);
  if (candidate) {
    std::vector<double> q_inside;
    Assign(inside, q_inside);
    const Verdict& at_start = check(q_inside);
    if (!Improves(verdict, at_start, problem_.options)) {
      verdict = at_start;
      result.q = q_inside;
      result.start = NameOf(Component::kNone);
    } else if (problem_.options.report_contacts) {
      check(result.q);  // whose contacts are counted
    }
  }
  result.status = Status::kUnsolved;
  result.sigma = work_.norm.Sigma(ToEigen(result.q));
  Answer(verdict, result);
  CountKeptContacts(result);
  SayWhy(outcome, frozen, verdict, result);
}

void Reporter::SayWhy(const Outcome* outcome, bool frozen, const Verdict& verdict, Result& result) {
  const std::string inseparable = DescribeInseparable(work_, ToEigen(result.q));
  const bool spent = work_.Spent();
  if (frozen) {
    result.cause = Cause::kFrozen;
  } else if (std::max(verdict.equality_residual, verdict.tendon_excess) > kEqualityTolerance) {
    result.cause = Cause::kEquality;
  } else if (!inseparable.empty()) {
    result.cause = Cause::kPermanent;
  } else if (spent) {
    result.cause = Cause::kBudget;
  } else {
    result.cause = outcome && !outcome->free.empty() ? Cause::kNotVerified : Cause::kNotFound;
  }
  if (spent) result.reason = work_.budget.Late() ? "time limit reached; " : "budget spent; ";
  result.reason += "no free configuration found from " +
                   std::to_string(outcome ? outcome->starts : 0) + " starts: " + verdict.reason +
                   inseparable;
}

}  // namespace mjcf_pdg
