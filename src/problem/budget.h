// What a solve has left to spend: the one place where a search looks at the clock.
#ifndef MJCF_PDG_SRC_PROBLEM_BUDGET_H_
#define MJCF_PDG_SRC_PROBLEM_BUDGET_H_

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
    deadline_ = Clock::time_point::max();
    // Longer ones would overflow the clock, and nobody waits for them.
    constexpr double kForever = 1e9;  // [s]
    if (budget.seconds > 0.0 && budget.seconds < kForever) {
      const std::chrono::duration<double> limit(budget.seconds);
      deadline_ = begin + std::chrono::duration_cast<Clock::duration>(limit);
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
  // `queries`: the finder's count now. Without a bound in seconds the clock is never read.
  bool Spent(std::int64_t queries) const {
    return queries >= last_query_ ||
           (deadline_ != Clock::time_point::max() && Clock::now() > deadline_);
  }

 private:
  static constexpr std::int64_t kNoLimit = std::numeric_limits<std::int64_t>::max();
  std::int64_t last_query_ = kNoLimit;
  Clock::time_point deadline_ = Clock::time_point::max();
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_PROBLEM_BUDGET_H_
