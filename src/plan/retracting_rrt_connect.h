// RRT-Connect in which a step that is blocked is retracted to the contact space.
//
// Source: Kuffner & LaValle (2000), as in OMPL's RRTConnect, whose trees and parameters it has;
// Tang & Kim, Sec. 6.3.
#ifndef MJCF_PDG_SRC_PLAN_RETRACTING_RRT_CONNECT_H_
#define MJCF_PDG_SRC_PLAN_RETRACTING_RRT_CONNECT_H_

#include <ompl/geometric/planners/rrt/RRTConnect.h>

#include <cstdint>
#include <memory>
#include <string>

#include "plan/retraction.h"

namespace mjcf_pdg {

struct Retractions {
  std::unique_ptr<Retraction> growing;  // of the tree that grows towards a random sample
  std::unique_ptr<Retraction> joining;  // of the other, which then grows towards it until it is
                                        // blocked, and is retracted once; null: it is not
};

class RetractingRrtConnect : public ompl::geometric::RRTConnect {
 public:
  RetractingRrtConnect(const ompl::base::SpaceInformationPtr& space, const std::string& name,
                       Retractions retractions);

  std::int64_t retraction_queries() const;  // collision queries, those of the prover aside

  ompl::base::PlannerStatus solve(const ompl::base::PlannerTerminationCondition& ptc) override;

 private:
  // One step of `tree` towards `target`; `last` becomes the node where it ends. If it is blocked
  // and there is a `retraction`, it is retracted by that, which becomes null.
  GrowState Grow(TreeData& tree, const ompl::base::State* target, Retraction*& retraction,
                 Motion*& last);
  GrowState Join(TreeData& tree, const ompl::base::State* target,
                 const ompl::base::PlannerTerminationCondition& ptc, Motion*& last);
  Motion* Add(TreeData& tree, Motion* parent, const ompl::base::State* state);
  bool AddRoots();
  void Connect(const Motion* start_side, const Motion* goal_side);

  const Retractions retractions_;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_PLAN_RETRACTING_RRT_CONNECT_H_
