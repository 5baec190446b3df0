#include "track/approach.h"

#include <algorithm>

namespace mjcf_pdg {
namespace {

// How far the joint that moves farthest moves [rad or m].
double LargestStep(const SceneTables& tables, const VectorXd& dq) {
  double largest = 0.0;
  for (const JointEntry& joint : tables.joints) {
    if (joint.ndof == 1) {
      largest = std::max(largest, std::abs(dq[joint.col]));
      continue;
    }
    for (int k = 0; k < joint.ndof; k += 3) {
      largest = std::max(largest, dq.segment<3>(joint.col + k).norm());
    }
  }
  return largest;
}

}  // namespace

Approach::Approach(Workspace& work, double max_step)
    : work_(work),
      problem_(work.problem()),
      ccd_(work.problem().tables, work.finder),
      max_step_(max_step),
      dq_(work.problem().tables.n),
      q_(work.problem().tables.model->nq) {
  ccd_options_.tolerance = problem_.options.tolerance;
  ccd_options_.budget = &deadline_;
}

double Approach::ShareAllowed(const VectorXd& from, const VectorXd& to) {
  Difference(problem_.tables, from, to, dq_);
  const double step = LargestStep(problem_.tables, dq_);
  return step > max_step_ ? max_step_ / step : 1.0;
}

double Approach::Cut(const VectorXd& from, const VectorXd& to) {
  const double share = ShareAllowed(from, to);
  if (share == 1.0) {
    q_ = to;
  } else {
    dq_ *= share;
    Integrate(problem_.tables, from, dq_, q_);
  }
  return share;
}

double Approach::CutToProof(const VectorXd& from, const VectorXd& to) {
  const double share = ShareAllowed(from, to);
  dq_ *= share;
  deadline_ = work_.budget.Deadline();
  const CcdResult& proven = ccd_.Move({from, dq_, &problem_.required}, ccd_options_);
  if (share == 1.0 && proven.outcome == CcdOutcome::kFree) {
    q_ = to;
    return 1.0;
  }
  q_ = proven.q;
  return share * proven.t;
}

}  // namespace mjcf_pdg
