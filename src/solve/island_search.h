// Solves a scene of many kinematic trees island by island (model/island.h).
//
// Trees that overlap at q_in form an island; so do trees that only leave their limits or violate
// equality constraints or limited tendons. Each island is solved by itself. Trees that its answer
// touches join it, and if the answer comes nearer by pushing them aside, the larger island is
// solved, too. So it is if some start ended in an overlap with other trees before it came as far as
// the answer. The nearer answer counts. Answers of islands that touch each other are united in the
// same way. The search of an island that has grown begins at the answer of the smaller one.
#ifndef MJCF_PDG_SRC_SOLVE_ISLAND_SEARCH_H_
#define MJCF_PDG_SRC_SOLVE_ISLAND_SEARCH_H_

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "model/island.h"
#include "problem/workspace.h"
#include "solve/stages.h"
#include "verify/verifier.h"

namespace mjcf_pdg {

class IslandSearch {
 public:
  // Both arguments must outlive this object. `work` is the scene's; islands pose its finder's data,
  // and its norm refers to q_in only if there is a hint.
  IslandSearch(Workspace& work, Verifier& verifier);

  // What Run solves besides the problem of the scene's workspace.
  struct Input {
    const std::vector<double>& q_in;        // as the user gave it
    const std::vector<NearPair>& overlaps;  // nearer than required there
    const VectorXd* at_rest = nullptr;      // per kept pair of the scene; null: none may rest
    const VectorXd* hint = nullptr;         // as in StrategyInput
  };
  // Returns true if q() is free by the verifier.
  bool Run(const Input& input);

  const std::vector<double>& q() const { return q_; }  // nq
  double sigma() const { return sigma_; }              // of q() [m²]
  // The start that led to the costliest island's answer.
  Component start() const { return start_; }
  // What was found, all islands together. Where not all of them are free it holds the least
  // overlap.
  Outcome& outcome() { return outcome_; }
  double sigma_lower_bound() const { return sigma_lower_bound_; }  // [m²]

  // In all solves so far: calls of the islands' finders, steps of their LCPs.
  std::int64_t queries() const { return queries_; }
  std::int64_t lcp_steps() const { return lcp_steps_; }

 private:
  // An island with all that is needed to solve it; kept for later solves that have the same.
  struct Part {
    Part(const Workspace& scene, const MovableTrees& trees, std::vector<int> of,
         Verifier& verifier);

    Island island;
    Workspace work;
    Stages stages;
    VectorXd at_rest;  // per kept pair of the island
    VectorXd hint;     // nq
  };
  // A set of trees in the present solve, and the best that is known for it.
  struct Group {
    std::vector<int> trees;  // ascending; empty: all have joined another group
    bool pending = true;     // it has not been solved yet
    bool blocked = false;    // some tree that has joined may have kept it from a nearer answer
    bool free = false;       // q is, by the verifier, with all other groups as in q_in
    bool candidate = false;  // ... by the solver's distances
    double sigma = 0.0, sigma_lower_bound = 0.0;
    VectorXd q;  // nq: q_in but for its trees
    Component start = Component::kNone;
  };

  void Seed(const std::vector<NearPair>& overlaps);
  std::size_t GroupOf(int tree);
  std::span<Group> Groups() { return std::span(groups_).first(num_groups_); }
  bool Several() const;
  void Unite(std::size_t a, int tree);
  void UniteHeld();
  Group* Pending();
  Part& PartOf(const std::vector<int>& trees);
  void Solve(Group& group, const Input& input);
  void BeginPart(Part& part, const Input& input);
  bool Helps(Part& part, const Group& group);
  void SearchAndAccept(Part& part, const Input& input, Group& group);
  struct Answer {
    const VectorXd& q;
    Component start;
    bool free;  // by the verifier
  };
  void Keep(Part& part, Group& group, const Answer& answer);
  void LetTouchedJoin(Part& part, const Outcome& found, Group& group);
  template <typename Join>
  bool UniteWhereTouching(Workspace& work, const VectorXd& q, const Join& join);
  bool UniteTouched(std::size_t of, Workspace& work, const VectorXd& q);
  bool UniteTouching();
  void Compose();

  Workspace& work_;
  Verifier& verifier_;
  MovableTrees trees_;
  std::vector<std::vector<int>> held_;  // trees that one held constraint or tendon joins, each
  std::vector<std::unique_ptr<Part>> parts_;
  std::size_t next_part_ = 0;  // the one to be replaced next
  std::int64_t queries_ = 0, lcp_steps_ = 0;

  std::vector<Group> groups_;  // of the present solve the first num_groups_; the others are room
  std::size_t num_groups_ = 0;
  std::vector<int> group_of_;  // per tree; -1: none
  Outcome outcome_;
  std::vector<double> q_;
  VectorXd composed_, accepted_;
  VectorXd known_;  // where the search of an island that has grown begins (nq)
  Candidate pushed_;
  std::vector<double> of_hint_;
  Component start_ = Component::kNone;
  double sigma_ = 0.0, sigma_lower_bound_ = 0.0;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_SOLVE_ISLAND_SEARCH_H_
