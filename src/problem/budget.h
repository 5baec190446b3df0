// What a solve has left of its budget of queries and seconds: the only clock that ends anything.
//
// Begun by SolverCore and asked, through Workspace::Spent, between the starts of a search and their
// steps (search, start, optimize, paper), between the poses of a motion (ccd), by the acceptance
// and by islands (solve), and by the tracker (track). The bound gets a quarter of the seconds.
#ifndef MJCF_PDG_SRC_PROBLEM_BUDGET_H_
#define MJCF_PDG_SRC_PROBLEM_BUDGET_H_

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <limits>

#include "base/tuning.h"
#include "mjcf_pdg/types.h"

namespace mjcf_pdg {

class BudgetMeter {
 public:
  using Clock = std::chrono::steady_clock;

  // A solve begins, at the time `begin`, when the finder has counted `queries`.
  void Begin(const Budget& budget, Clock::time_point begin, std::int64_t queries) {
    last_query_ = budget.queries > 0 ? queries + budget.queries : kNoLimit;
    begin_ = begin;
    seconds_ = std::numeric_limits<double>::infinity();
    // Longer budgets would overflow the clock; they count as none.
    constexpr double kForever = 1e9;  // [s]
    if (budget.seconds > 0.0 && budget.seconds < kForever) {
      const double reserve = longest_verification_ + longest_step_;
      seconds_ = std::max(tuning::budget::kLeastSearch * budget.seconds, budget.seconds - reserve);
    }
  }
  // What is left for a search within this one that has a finder of its own: `queries` is the count
  // of that finder now, `own` that of ours. It is a copy, because the steps of that search take
  // other times: reported to ours, they would make it forget its longest one.
  BudgetMeter For(std::int64_t queries, std::int64_t own) const {
    BudgetMeter other = *this;
    if (last_query_ != kNoLimit) other.last_query_ += queries - own;
    return other;
  }
  // Its seconds alone, for what asks other questions than queries.
  BudgetMeter Deadline() const {
    BudgetMeter other = *this;
    other.last_query_ = kNoLimit;
    return other;
  }
  // Counts queries that the finder did not make, as those of the verifier.
  void Charge(std::int64_t queries) {
    if (last_query_ != kNoLimit) last_query_ -= queries;
  }
  // How many queries are left when the finder has counted `queries`.
  std::int64_t Left(std::int64_t queries) const { return last_query_ - queries; }
  // Whether the budget is spent when the finder has counted `queries`.
  bool Spent(std::int64_t queries) const { return queries >= last_query_ || Late(); }
  // Whether `share` of the budget in seconds is spent; false, without reading the clock, if there
  // is no such budget.
  bool Late(double share = 1.0) const { return HasDeadline() && Since(begin_) > share * seconds_; }
  // How long ago Begin's `begin` was [s].
  double Elapsed() const { return Since(begin_); }
  bool HasDeadline() const { return seconds_ < std::numeric_limits<double>::infinity(); }

  // A step that has begun is not interrupted, and what is found must be verified within the budget.
  // So searches end earlier, by the longest recent step and the longest recent verification. Both
  // are reported here when they end, with the time that Now gave when they began.
  Clock::time_point Now() const { return HasDeadline() ? Clock::now() : Clock::time_point(); }
  void Verified(Clock::time_point begin) { Remember(begin, longest_verification_); }
  void Stepped(Clock::time_point begin) { Remember(begin, longest_step_); }

 private:
  static double Since(Clock::time_point begin) {
    return std::chrono::duration<double>(Clock::now() - begin).count();
  }
  void Remember(Clock::time_point begin, double& longest) const {
    if (HasDeadline()) longest = std::max(tuning::budget::kForgetting * longest, Since(begin));
  }

  static constexpr std::int64_t kNoLimit = std::numeric_limits<std::int64_t>::max();
  std::int64_t last_query_ = kNoLimit;
  Clock::time_point begin_;
  double seconds_ = std::numeric_limits<double>::infinity();  // from begin_ to the end of searches
  double longest_verification_ = 0.0, longest_step_ = 0.0;    // [s]
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_PROBLEM_BUDGET_H_
