#include "solve/acceptance.h"

#include <algorithm>

namespace mjcf_pdg {
namespace {

// How much farther from q_in than a refused candidate, doubled until the verifier agrees [share].
constexpr double kFirstBeyond = 1e-4, kLastBeyond = 0.1;
// ... than one that is proven but disputed, where no more than 1 % of the way is worth it.
constexpr double kBeyondDisputed = 0.01;

}  // namespace

bool Acceptance::Accept(Outcome& outcome, const VectorXd* hint) {
  for (std::size_t k = 0; k < outcome.free.size() && (k == 0 || !work_.Spent()); ++k) {
    if (AcceptCandidate(outcome.free[k])) return true;
  }
  const Candidate& least = outcome.least_overlap;
  if (outcome.has_overlap && !work_.Spent() && IsFree(least.q, least.start)) return true;
  return hint && IsFree(*hint, Component::kUserPose);
}

// One that the verifier refuses is moved a little further out and asked about again: by a descent
// that keeps a distance, or else straight on. So is one that MuJoCo's contacts dispute, since
// people simulate what they get; but a proof is enough where that does not help.
bool Acceptance::AcceptCandidate(Candidate& candidate) {
  if (!work_.Spent()) strategy_.Polish(candidate);
  const bool proven = IsFree(candidate.q, candidate.start);
  if (proven && !verifier_.disputed()) return true;
  if (!work_.Spent() && AcceptFartherOut(candidate, proven)) return true;
  return proven && IsFree(candidate.q, candidate.start);
}

// `proven`: the candidate itself is free, but disputed, so that only
// what nobody disputes is better.
bool Acceptance::AcceptFartherOut(const Candidate& candidate, bool proven) {
  const auto better = [&] {
    return IsFree(trial_, candidate.start) && !(proven && verifier_.disputed());
  };
  if (strategy_.Retreat(candidate, trial_) && better()) return true;
  const double last_beyond = proven ? kBeyondDisputed : kLastBeyond;
  for (double beyond = kFirstBeyond; beyond < last_beyond && !work_.Spent(); beyond *= 2.0) {
    starts_.Beyond(problem_.q_in, candidate.q, 1.0 + beyond, trial_);
    if (better()) return true;
  }
  return false;
}

bool Acceptance::IsFree(const VectorXd& q, Component start) {
  trial_ = q;
  Unwind(problem_.tables, problem_.q_in, trial_);
  q_.assign(trial_.data(), trial_.data() + trial_.size());
  start_ = start;
  work_.budget.Charge(1);
  const BudgetMeter::Clock::time_point begin = work_.budget.Now();
  const bool free = verifier_.IsFree(q_, *q_in_);
  work_.budget.Verified(begin);
  return free;
}

}  // namespace mjcf_pdg
