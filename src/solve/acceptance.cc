#include "solve/acceptance.h"

#include <algorithm>
#include <limits>

#include "base/tuning.h"

namespace mjcf_pdg {

namespace tune = tuning::acceptance;

// A hint that is nearer than a candidate goes before it: where the budget ended the search before
// it came to the hint, that may be so.
bool Acceptance::Accept(Outcome& outcome, const VectorXd* hint) {
  const double of_hint = hint ? work_.norm.Sigma(*hint) : std::numeric_limits<double>::infinity();
  bool asked = !hint;
  for (std::size_t k = 0; k < outcome.free.size() && (k == 0 || !work_.Spent()); ++k) {
    if (!asked && of_hint < outcome.free[k].sigma) {
      if (IsFree(*hint, Component::kUserPose)) return true;
      asked = true;
    }
    if (AcceptCandidate(outcome.free[k])) return true;
  }
  const Candidate& least = outcome.least_overlap;
  if (outcome.has_overlap && !work_.Spent() && IsFree(least.q, least.start)) return true;
  return !asked && IsFree(*hint, Component::kUserPose);
}

// A candidate that the verifier refuses is moved a little farther out and verified again. The same
// is tried with one that is proven free but in which MuJoCo still finds contacts, since people
// simulate what they get; if that does not help, the proof is enough.
bool Acceptance::AcceptCandidate(Candidate& candidate) {
  if (!work_.Spent()) strategy_.Polish(candidate);
  const bool proven = IsFree(candidate.q, candidate.start);
  if (proven && !verifier_.disputed_by_contacts()) return true;
  if (!work_.Spent() && AcceptFartherOut(candidate, proven)) return true;
  return proven && IsFree(candidate.q, candidate.start);
}

// By a descent that keeps more distance, or else straight on from q_in. `proven`: the candidate
// itself is proven free but MuJoCo disputes it, so that only what MuJoCo does not dispute is
// better.
bool Acceptance::AcceptFartherOut(const Candidate& candidate, bool proven) {
  const auto better = [&] {
    return IsFree(trial_, candidate.start) && !(proven && verifier_.disputed_by_contacts());
  };
  if (strategy_.Retreat(candidate, trial_) && better()) return true;
  const double last_beyond = proven ? tune::kBeyondDisputed : tune::kLastBeyond;
  for (double beyond = tune::kFirstBeyond; beyond < last_beyond && !work_.Spent(); beyond *= 2.0) {
    starts_.Beyond(problem_.q_in, candidate.q, 1.0 + beyond, trial_);
    if (better()) return true;
  }
  return false;
}

bool Acceptance::IsFree(const VectorXd& q, Component start) {
  work_.Unwound(q, unwound_);
  q_.assign(unwound_.data(), unwound_.data() + unwound_.size());
  start_ = start;
  work_.budget.Charge(1);
  const BudgetMeter::Clock::time_point begin = work_.budget.Now();
  const bool free = verifier_.IsFree(q_, *q_in_);
  work_.budget.Verified(begin);
  return free;
}

}  // namespace mjcf_pdg
