// Planners by name: our three, and those of OMPL, which end with the first path that they find.
#ifndef MJCF_PDG_SRC_PLAN_PLANNERS_H_
#define MJCF_PDG_SRC_PLAN_PLANNERS_H_

#include <ompl/base/Planner.h>

#include <functional>
#include <string>
#include <vector>

#include "plan/retracting_rrt_connect.h"

namespace mjcf_pdg {

std::vector<std::string> PlannerNames();

// Whether the planner is one of the three of Table IV: these begin anew after some samples.
bool BeginsAnew(const std::string& planner);

// Whether the planner retracts samples, and whether by penetration depth.
bool Retracts(const std::string& planner);
bool RetractsByPdg(const std::string& planner);

struct NamedPlanner {
  ompl::base::PlannerPtr planner;
  RetractingRrtConnect* retracting = nullptr;           // the same, if it retracts
  ompl::base::OptimizationObjectivePtr objective = {};  // of the problem, if it asks for one
};

// `range` is the length of a step, a share of the space's extent, the same for all that have one.
// Throws Error, which lists the names, for an unknown one.
NamedPlanner MakePlanner(const std::string& name, double range, const RetractionInput& input,
                         const ompl::base::SpaceInformationPtr& space);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_PLAN_PLANNERS_H_
