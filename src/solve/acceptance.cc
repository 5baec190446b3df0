#include "solve/acceptance.h"

#include <algorithm>

namespace mjcf_pdg {
namespace {

// How much farther from q_in than a refused candidate, doubled until the verifier agrees [share].
constexpr double kFirstBeyond = 1e-4, kLastBeyond = 0.1;

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
// that keeps a distance, or else straight on.
bool Acceptance::AcceptCandidate(Candidate& candidate) {
  if (!work_.Spent()) strategy_.Polish(candidate);
  if (IsFree(candidate.q, candidate.start)) return true;
  if (work_.Spent()) return false;
  const bool retreated = strategy_.Retreat(candidate, trial_);
  if (retreated && IsFree(trial_, candidate.start)) return true;
  for (double beyond = kFirstBeyond; beyond < kLastBeyond && !work_.Spent(); beyond *= 2.0) {
    starts_.Beyond(problem_.q_in, candidate.q, 1.0 + beyond, trial_);
    if (IsFree(trial_, candidate.start)) return true;
  }
  return false;
}

bool Acceptance::IsFree(const VectorXd& q, Component start) {
  trial_ = q;
  Unwind(problem_.tables, problem_.q_in, trial_);
  q_.assign(trial_.data(), trial_.data() + trial_.size());
  start_ = start;
  work_.budget.Charge(1);
  return verifier_.Check(q_, *q_in_, verify::Depths::kSkipped).free;
}

}  // namespace mjcf_pdg
