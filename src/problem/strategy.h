// A way to search for the nearest free configuration: what the solver asks of it and gets back.
// The two are AutoMethod (method auto) and PaperMethod (method paper).
#ifndef MJCF_PDG_SRC_PROBLEM_STRATEGY_H_
#define MJCF_PDG_SRC_PROBLEM_STRATEGY_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "problem/problem.h"

namespace mjcf_pdg {

// What is known before the search; the problem itself is the workspace's.
struct StrategyInput {
  const std::vector<NearPair>& overlaps;  // pairs nearer than required at q_in
  int distances_at_input = 0;             // pair distances that the query for them took
  double sigma_lower_bound = 0.0;         // of every free configuration [m²]
  const VectorXd* hint = nullptr;         // nq, a configuration that may be free; null: none
};

// A configuration and the start that the search reached it from.
struct Candidate {
  VectorXd q;                                              // nq
  double sigma = std::numeric_limits<double>::infinity();  // [m²]
  Component start = Component::kNone;
};

// The nearest free candidates of a search, the least σ first. A fixed number of slots, made once:
// the verifier hardly ever refuses the first, and never yet refused kSlots of them.
class Candidates {
 public:
  static constexpr std::size_t kSlots = 16;

  void Reserve(int nq);
  void Clear() { count_ = 0; }
  bool empty() const { return count_ == 0; }
  std::size_t size() const { return count_; }
  Candidate& operator[](std::size_t k) { return slots_[k]; }
  const Candidate& operator[](std::size_t k) const { return slots_[k]; }
  const Candidate& front() const { return slots_[0]; }
  // Among equals the older stays first. Beyond kSlots the farthest is dropped.
  void Insert(const VectorXd& q, double sigma, Component start);

 private:
  std::array<Candidate, kSlots + 1> slots_;
  std::size_t count_ = 0;
};

// What a search leaves: kept and refilled from solve to solve.
struct Outcome {
  Candidates free;          // by the solver's own distances
  Candidate least_overlap;  // the best that is not free, if has_overlap
  bool has_overlap = false;
  double least_violation = 0.0;  // of it: Σ of overlaps beyond what is aimed at [m]
  int starts = 0;
  int iterations = 0;

  void Reserve(int nq);  // room for all of it
  void Clear();
};

// One per solver.
class Strategy {
 public:
  virtual ~Strategy() = default;

  // Searches from the workspace's q_in. The outcome is valid until the next call.
  virtual Outcome& Run(const StrategyInput& input) = 0;

  // A last descent from a free candidate to full precision: true if it became nearer. After Run.
  virtual bool Polish(Candidate& candidate) = 0;
  // A configuration near the candidate that keeps every required distance without using any of the
  // tolerance; false if none was found. For candidates that the verifier refuses.
  virtual bool Retreat(const Candidate& candidate, VectorXd& q) = 0;

  virtual std::int64_t lcp_steps() const = 0;  // so far
  // Collision queries so far, besides those of the workspace's finder.
  virtual std::int64_t other_queries() const = 0;

  // Motion coherence (Options::trajectory): a frame's answer, or what was found or given of one
  // that has none, for later frames to start from.
  virtual void Remember(const VectorXd& q, bool free) = 0;
  virtual void Forget() = 0;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_PROBLEM_STRATEGY_H_
