// The interface of a method that searches for the nearest free configuration. AutoMethod (search/)
// and PaperMethod (paper/) implement it.
#ifndef MJCF_PDG_SRC_PROBLEM_STRATEGY_H_
#define MJCF_PDG_SRC_PROBLEM_STRATEGY_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "problem/problem.h"

namespace mjcf_pdg {

// What is known before the search; the problem itself is the workspace's.
struct StrategyInput {
  const std::vector<NearPair>& overlaps;  // pairs nearer than required at q_in
  int distances_at_input = 0;             // pair distances that the query for them took
  double sigma_lower_bound = 0.0;         // no free configuration has a smaller σ; 0: unknown [m²]
  // A tighter one [m²], where a free configuration with this σ [m²] is known. It takes as long as
  // ten queries or more. Empty: there is none.
  std::function<double(double)> tighten = {};
  const VectorXd* hint = nullptr;  // nq, a configuration that may be free; null: none
  // nq, an answer of the same problem with fewer trees, where one is known: it is where the search
  // begins.
  const VectorXd* of_fewer = nullptr;
};

// A configuration and the start that the search reached it from.
struct Candidate {
  VectorXd q;                                              // nq
  double sigma = std::numeric_limits<double>::infinity();  // [m²]
  Component start = Component::kNone;
};

// The nearest free candidates of a search, by σ ascending. Only kSlots are kept, in memory that is
// made once: the verifier hardly ever refuses the first of them.
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
  // Inserts a candidate, behind older ones of the same σ. If there are more than kSlots then, the
  // one with the largest σ is dropped.
  void Insert(const VectorXd& q, double sigma, Component start);

 private:
  std::array<Candidate, kSlots + 1> slots_;
  std::size_t count_ = 0;
};

// What a search found. The object is kept, and refilled by each solve.
struct Outcome {
  Candidates free;           // free by the solver's own distances; the verifier has not seen them
  bool has_overlap = false;  // some start ended in an overlap; of those:
  Candidate least_overlap;   // the one with the least violation
  double least_violation = 0.0;  // its sum of overlaps beyond what descents aim at [m]
  // The one with the least σ, of those that were not given up; σ is infinite if there is none.
  Candidate nearest_overlap;
  int starts = 0;
  int iterations = 0;
  double sigma_lower_bound = 0.0;  // that the search itself has proven [m²]

  void Reserve(int nq);  // makes room for configurations of nq entries
  void Clear();
};

// One per solver.
class Strategy {
 public:
  virtual ~Strategy() = default;

  // Searches from the workspace's q_in. The outcome is valid until the next call.
  virtual Outcome& Run(const StrategyInput& input) = 0;

  // Whether the search ends sooner where StrategyInput::sigma_lower_bound is known.
  virtual bool UsesLowerBound() const = 0;

  // After Run: descends from a free candidate to full precision. Returns true, and changes it, if
  // that is nearer.
  virtual bool Polish(Candidate& candidate) = 0;
  // For a candidate that the verifier refuses: finds a configuration near it that keeps every
  // required distance in full, without using the tolerance. Returns false if there is none nearby.
  virtual bool Retreat(const Candidate& candidate, VectorXd& q) = 0;

  // Counts since construction: steps of LCP solvers, and collision queries by other finders than
  // the workspace's.
  virtual std::int64_t lcp_steps() const = 0;
  virtual std::int64_t other_queries() const = 0;

  // Motion coherence (Options::trajectory): keeps `q` for later frames to start from. It is a
  // frame's answer if `free`; else what was found, or given, where there is none.
  virtual void Remember(const VectorXd& q, bool free) = 0;
  virtual void Forget() = 0;  // all that Remember keeps
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_PROBLEM_STRATEGY_H_
