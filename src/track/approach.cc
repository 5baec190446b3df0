#include "track/approach.h"

#include "track/detour.h"

namespace mjcf_pdg {

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

double Approach::Ticks(const VectorXd& from, const VectorXd& to) {
  Difference(problem_.tables, from, to, dq_);
  return LargestStep(problem_.tables, dq_) / max_step_;
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
