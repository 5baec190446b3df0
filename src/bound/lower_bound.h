// The proven side of the bracket: no free configuration has a smaller σ.
//
// Source: the levers-at-q_in bound (an overlap of depth δ cannot be undone unless points move by
// δ), made directional. The derivation is at the head of lower_bound.cc.
#ifndef MJCF_PDG_SRC_BOUND_LOWER_BOUND_H_
#define MJCF_PDG_SRC_BOUND_LOWER_BOUND_H_

#include <vector>

#include "collide/contacts.h"
#include "model/kinematics.h"
#include "norm/norm_evaluator.h"
#include "problem/workspace.h"

namespace mjcf_pdg {

struct LowerBoundInput {
  const SceneTables& tables;
  const NormEvaluator& norm;  // reference q_in
  const PosedModel& posed;    // posed at q_in
  // At q_in. A pair left out costs tightness, never truth; pairs that are free already are skipped.
  const std::vector<NearPair>& overlaps;
  const VectorXd& required;  // per kept pair: smallest distance that counts as free [m]
  Metric metric = Metric::kSequential;
  double tolerance = 1e-6;  // overlap beyond `required` that still counts as free [m]
  int max_cells = 200;      // effort: pieces of the sphere of directions; 0: levers alone
};

// A lower bound of σ over all free configurations [m²], >= 0.
double SigmaLowerBound(const LowerBoundInput& input);

// The same for the workspace's problem; its finder is posed at q_in. `cells`: as max_cells.
inline double SigmaLowerBound(const Workspace& work, const std::vector<NearPair>& overlaps,
                              int cells) {
  const Problem& problem = work.problem();
  return SigmaLowerBound({problem.tables, work.norm, work.finder.posed(), overlaps,
                          problem.required, problem.options.metric, problem.options.tolerance,
                          cells});
}

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_BOUND_LOWER_BOUND_H_
