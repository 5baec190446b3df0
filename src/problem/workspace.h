// What the stages of a solve share beside the problem itself: the evaluators that are expensive to
// make, and the budget. One per solver; Begin makes the problem of a q_in.
#ifndef MJCF_PDG_SRC_PROBLEM_WORKSPACE_H_
#define MJCF_PDG_SRC_PROBLEM_WORKSPACE_H_

#include <vector>

#include "collide/contacts.h"
#include "norm/norm_evaluator.h"
#include "problem/budget.h"
#include "problem/problem.h"

namespace mjcf_pdg {

// One per thread. Neither copyable nor movable: stages keep references into it.
class Workspace {
 public:
  // Both are kept by reference. The norm refers to qpos0 until Begin: stages make their scratch by
  // it. Throws Error for unknown names in options.without.
  Workspace(const SceneTables& tables, const Options& options);
  Workspace(const Workspace&) = delete;
  Workspace& operator=(const Workspace&) = delete;

  // A new problem: q_in (nq) among obstacles at `mocap`. Everything that refers to q_in is set
  // here: the reference of the norm, the required distances. `rest`: per kept pair the distance
  // to which it may rest, negative, infinite of pairs that may not [m]; null: none may.
  void Begin(const Eigen::Ref<const VectorXd>& q_in, const MocapPoses& mocap = {},
             const VectorXd* rest = nullptr);
  // The same problem for other tables of the same model: as `other` poses it, with its budget.
  void Begin(const Workspace& other);

  const Problem& problem() const { return problem_; }

  // No pair that can move is nearer than required, by the solver's own distances. One query.
  bool Free(const VectorXd& q);
  // Pairs nearer than required at q_in; the finder stays posed there. One query.
  const std::vector<NearPair>& OverlapsAtInput();
  bool Spent() const { return budget.Spent(finder.queries()); }

  NormEvaluator norm;  // reference q_in
  ContactFinder finder;
  BudgetMeter budget;

 private:
  void SetRequired();

  Problem problem_;
  std::vector<NearPair> overlaps_;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_PROBLEM_WORKSPACE_H_
