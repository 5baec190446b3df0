// What a planner asks of the scene: is a configuration free, is the motion between two free? Edges
// are proven by CCDg (mjcf_pdg/motion.h), not sampled. Motions are those of the ConfigurationSpace,
// each straight piece of them proven.
#ifndef MJCF_PDG_SRC_PLAN_MOTION_PROVER_H_
#define MJCF_PDG_SRC_PLAN_MOTION_PROVER_H_

#include <ompl/base/MotionValidator.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/StateValidityChecker.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "mjcf_pdg/motion.h"
#include "plan/configuration_space.h"

namespace mjcf_pdg {

// Use one per thread. Configurations have nq entries.
class MotionProver {
 public:
  // Of the options, those of MotionChecker count.
  MotionProver(const Scene& scene, const Options& options,
               std::shared_ptr<const ConfigurationSpace> space)
      : checker_(scene, options), space_(std::move(space)) {}

  bool IsFree(const VectorXd& q);
  // Whether the motion is proven free, in the one direction or the other: it goes through the same
  // configurations, but a motion may begin at a contact and not end there.
  bool IsFree(const VectorXd& from, const VectorXd& to);
  // How far the motion is free: up to its t in [0, 1], as in ConfigurationSpace::Interpolate.
  struct FreePart {
    bool all;
    double t;
  };
  FreePart Move(const VectorXd& from, const VectorXd& to);
  // Whether the last motion was certified to be what it was said to be.
  bool certified() const { return certified_; }
  std::int64_t queries() const { return queries_; }  // configurations posed

 private:
  const Motion& GoStraight(const VectorXd& from, const VectorXd& to);

  MotionChecker checker_;
  const std::shared_ptr<const ConfigurationSpace> space_;
  bool certified_ = true;
  std::int64_t queries_ = 0;
};

// Takes out corners of a path between two that can be joined by a free motion, until `ended` says
// to stop: from each corner the last is tried, then one half as far on, and so on.
void Straighten(MotionProver& prover, const std::function<bool()>& ended,
                std::vector<VectorXd>& corners);

// Makes `prover` decide for `space`, which must be over a ConfigurationSpace. Once `ended` says so,
// no motion is free: planners ask between samples whether to go on, but RRTConnect not while it
// grows one tree towards the other.
void UseProver(const std::shared_ptr<MotionProver>& prover, std::function<bool()> ended,
               const ompl::base::SpaceInformationPtr& space);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_PLAN_MOTION_PROVER_H_
