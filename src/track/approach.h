// Where the follower may go in one tick: straight towards a target, as far as
// TrackOptions::max_step and, if it is asked for, a proof of the motion allow.
#ifndef MJCF_PDG_SRC_TRACK_APPROACH_H_
#define MJCF_PDG_SRC_TRACK_APPROACH_H_

#include "ccd/ccdg.h"
#include "problem/workspace.h"

namespace mjcf_pdg {

class Approach {
 public:
  // `max_step` [rad or m] may be infinite.
  Approach(Workspace& work, double max_step);

  // Sets q() to the configuration on the way from `from`, which is free, to `to` that is as far as
  // max_step allows; returns which share of the way that is, in [0, 1].
  double Cut(const VectorXd& from, const VectorXd& to);
  // The same, but no farther than the motion is proven free before the tick's time is over.
  double CutToProof(const VectorXd& from, const VectorXd& to);
  // How many ticks the straight way takes, by max_step alone.
  double Ticks(const VectorXd& from, const VectorXd& to);
  const VectorXd& q() const { return q_; }

 private:
  double ShareAllowed(const VectorXd& from, const VectorXd& to);

  const Workspace& work_;
  const Problem& problem_;
  Ccdg ccd_;
  CcdOptions ccd_options_;
  BudgetMeter deadline_;
  double max_step_;
  VectorXd dq_, q_;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_TRACK_APPROACH_H_
