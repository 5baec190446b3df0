// RRT-Connect in which a step that is blocked is retracted to the contact space.
//
// Source: Kuffner & LaValle (2000), as in OMPL's RRTConnect, whose trees and parameters it has;
// Tang & Kim, Sec. 6.3. The tree that grows towards the random sample retracts; the other one,
// which then grows towards the first until it is blocked, does so once, if `both`.
#ifndef MJCF_PDG_SRC_PLAN_RETRACTING_RRT_CONNECT_H_
#define MJCF_PDG_SRC_PLAN_RETRACTING_RRT_CONNECT_H_

#include <ompl/geometric/planners/rrt/RRTConnect.h>

#include <memory>
#include <string>

#include "plan/retraction.h"

namespace mjcf_pdg {

class RetractingRrtConnect : public ompl::geometric::RRTConnect {
 public:
  RetractingRrtConnect(const ompl::base::SpaceInformationPtr& space, const std::string& name,
                       std::unique_ptr<Retraction> retraction, bool both);

  ompl::base::PlannerStatus solve(const ompl::base::PlannerTerminationCondition& ptc) override;

 private:
  // One step of `tree` towards `target`; `last` becomes the node where it ends. If it is blocked
  // and `retract` is true, it is retracted, and `retract` becomes false.
  GrowState Grow(TreeData& tree, const ompl::base::State* target, bool& retract, Motion*& last);
  GrowState Join(TreeData& tree, const ompl::base::State* target,
                 const ompl::base::PlannerTerminationCondition& ptc, Motion*& last);
  Motion* Add(TreeData& tree, Motion* parent, const ompl::base::State* state);
  bool AddRoots(const ompl::base::PlannerTerminationCondition& ptc);
  void Connect(const Motion* start_side, const Motion* goal_side);

  const std::unique_ptr<Retraction> retraction_;
  const bool both_;  // trees retract
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_PLAN_RETRACTING_RRT_CONNECT_H_
