// What the lower bound is asked about. Part of lower_bound.h and joint_boxes.h.
#ifndef MJCF_PDG_SRC_BOUND_LOWER_BOUND_INPUT_H_
#define MJCF_PDG_SRC_BOUND_LOWER_BOUND_INPUT_H_

#include <vector>

#include "collide/contacts.h"
#include "model/kinematics.h"
#include "norm/norm_evaluator.h"
#include "problem/budget.h"

namespace mjcf_pdg {

// Of distances, taken off what bounds claim [tolerances].
inline constexpr double kRounding = 1e-3;

struct LowerBoundInput {
  const SceneTables& tables;
  const NormEvaluator& norm;  // reference q_in
  const PosedModel& posed;    // posed at q_in
  // At q_in. A pair left out costs tightness, never truth; pairs that are free already are skipped.
  const std::vector<NearPair>& overlaps;
  const VectorXd& required;  // per kept pair: smallest distance that counts as free [m]
  Metric metric = Metric::kSequential;
  double tolerance = 1e-6;  // overlap beyond `required` that still counts as free [m]
  int max_cells = 200;      // effort: pieces of the sphere of directions; 0: moment arms alone
  const BudgetMeter* budget = nullptr;  // of time: what is not proven by then is not claimed
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_BOUND_LOWER_BOUND_INPUT_H_
