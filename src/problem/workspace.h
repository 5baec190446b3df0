// What the stages of a solve share beside the problem itself: the evaluators that are expensive to
// make, and the budget. One per solver; Begin makes the problem of a q_in.
#ifndef MJCF_PDG_SRC_PROBLEM_WORKSPACE_H_
#define MJCF_PDG_SRC_PROBLEM_WORKSPACE_H_

#include <memory>
#include <vector>

#include "collide/contacts.h"
#include "equality/equality_constraints.h"
#include "norm/norm_evaluator.h"
#include "problem/budget.h"
#include "problem/problem.h"
#include "problem/recorder.h"

namespace mjcf_pdg {

// One per thread. Neither copyable nor movable: stages keep references into it.
class Workspace {
 public:
  // Keeps references to both arguments. Until Begin the norm's reference is qpos0, or what `data`
  // is posed at, so that stages can size their memory. Throws Error for unknown names in
  // options.without.
  // `data`: to be posed in turn with another workspace of the same model
  // (PosedModel::shared_data); Begin takes it over.
  Workspace(const SceneTables& tables, const Options& options,
            const std::shared_ptr<mjData>& data = nullptr);
  Workspace(const Workspace&) = delete;
  Workspace& operator=(const Workspace&) = delete;

  // Makes the problem of q_in (nq) among obstacles at `mocap`, and with it all that refers to q_in:
  // the norm's reference and the required distances. `rest` gives, per kept pair, the negative
  // distance that it may keep, infinite for a pair that may not overlap at all [m]; null: none may.
  void Begin(const Eigen::Ref<const VectorXd>& q_in, const MocapPoses& mocap = {},
             const VectorXd* rest = nullptr);
  // The same but for the norm's reference, which looks at every body, and which ReferNorm sets if
  // it is not set yet.
  void BeginWithoutNorm(const Eigen::Ref<const VectorXd>& q_in, const MocapPoses& mocap = {},
                        const VectorXd* rest = nullptr);
  void ReferNorm();
  // Makes `other`'s problem, for tables of the same model whose collision geoms differ (hulls
  // instead of triangles), with what is left of its budget.
  void Begin(const Workspace& other);

  const Problem& problem() const { return problem_; }

  // Whether no movable pair is nearer than required, by the solver's own distances, and equality
  // constraints hold. One query.
  bool Free(const VectorXd& q);
  // The pairs nearer than required at q_in, where the finder stays posed. One query. Valid until
  // the next call.
  const std::vector<NearPair>& OverlapsAtInput();
  // Makes `unwound` q without whole turns that bring it no nearer to q_in (model/kinematics.h), or
  // q itself where couplings forbid whole turns of one joint alone.
  void Unwound(const VectorXd& q, VectorXd& unwound);
  bool Watched() const { return recorder && recorder->watched(); }
  bool Spent() const { return budget.Spent(finder.queries()); }

  NormEvaluator norm;  // reference q_in
  ContactFinder finder;
  EqualityConstraints equality;
  BudgetMeter budget;
  // Of the solver; null: descents are not told to anybody, as those on convex hulls, which solve
  // another problem.
  Recorder* recorder = nullptr;
  // Begin keeps the starting points of distances that the last problem left. The last digits of
  // distances then depend on what was asked before.
  bool remembers_distances = false;

 private:
  VectorXd RequiredDistances() const;

  Problem problem_;
  VectorXd usual_;           // Problem::required where nothing rests
  double farthest_ = 0.0;    // the largest of them: what may overlap is no farther apart [m]
  bool norm_refers_ = true;  // to q_in
  bool rested_ = false;      // something may rest in the present problem
  std::vector<NearPair> overlaps_;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_PROBLEM_WORKSPACE_H_
