// What a solve has left to spend: the one place where a search looks at the clock.
#ifndef MJCF_PDG_SRC_PROBLEM_BUDGET_H_
#define MJCF_PDG_SRC_PROBLEM_BUDGET_H_

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <limits>

#include "mjcf_pdg/types.h"

namespace mjcf_pdg {

class BudgetMeter {
 public:
  using Clock = std::chrono::steady_clock;

  // A solve that began at `begin`; `queries` is the finder's count then.
  void Begin(const Budget& budget, Clock::time_point begin, std::int64_t queries) {
    last_query_ = budget.queries > 0 ? queries + budget.queries : kNoLimit;
    begin_ = begin;
    seconds_ = std::numeric_limits<double>::infinity();
    // Longer ones would overflow the clock, and nobody waits for them.
    constexpr double kForever = 1e9;  // [s]
    if (budget.seconds > 0.0 && budget.seconds < kForever) {
      const double reserve = longest_verification_ + longest_step_;
      seconds_ = std::max(kLeastShare * budget.seconds, budget.seconds - reserve);
    }
  }
  // The same budget for a finder of another solve within this one, whose count is `queries` now and
  // ours `own`.
  BudgetMeter For(std::int64_t queries, std::int64_t own) const {
    BudgetMeter other = *this;
    if (last_query_ != kNoLimit) other.last_query_ += queries - own;
    return other;
  }
  // Queries that the finder did not make: the verifier's.
  void Charge(std::int64_t queries) {
    if (last_query_ != kNoLimit) last_query_ -= queries;
  }
  // `queries`: the finder's count now.
  bool Spent(std::int64_t queries) const { return queries >= last_query_ || Late(); }
  // Of the bound in seconds alone, or a share of it; without one the clock is never read.
  bool Late(double share = 1.0) const { return HasDeadline() && Since(begin_) > share * seconds_; }
  bool HasDeadline() const { return seconds_ < std::numeric_limits<double>::infinity(); }

  // What is found must be verified within the budget, and a step that has begun is not interrupted:
  // searches end as much earlier as the longest of both took of late. `begin`: as Now said.
  Clock::time_point Now() const { return HasDeadline() ? Clock::now() : Clock::time_point(); }
  void Verified(Clock::time_point begin) { Remember(begin, longest_verification_); }
  void Stepped(Clock::time_point begin) { Remember(begin, longest_step_); }

 private:
  static double Since(Clock::time_point begin) {
    return std::chrono::duration<double>(Clock::now() - begin).count();
  }
  void Remember(Clock::time_point begin, double& longest) const {
    if (HasDeadline()) longest = std::max(kForgetting * longest, Since(begin));
  }

  static constexpr std::int64_t kNoLimit = std::numeric_limits<std::int64_t>::max();
  std::int64_t last_query_ = kNoLimit;
  // Searches keep this share of the budget, however long verifications take.
  static constexpr double kLeastShare = 0.5;
  static constexpr double kForgetting = 0.99;  // each time: one that was interrupted passes
  Clock::time_point begin_;
  double seconds_ = std::numeric_limits<double>::infinity();  // from begin_ to the end of searches
  double longest_verification_ = 0.0, longest_step_ = 0.0;    // [s]
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_PROBLEM_BUDGET_H_
