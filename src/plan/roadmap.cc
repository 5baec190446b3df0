#include "plan/roadmap.h"

namespace mjcf_pdg {

namespace ob = ompl::base;

// Returns whether there are a start and a goal.
bool Roadmap::AddEnds(const ob::PlannerTerminationCondition& ended) {
  while (const ob::State* start = pis_.nextStart()) {
    startM_.push_back(addMilestone(si_->cloneState(start)));
  }
  while (goalM_.empty()) {
    const ob::State* goal = pis_.nextGoal(ended);
    if (!goal) break;
    goalM_.push_back(addMilestone(si_->cloneState(goal)));
  }
  return !startM_.empty() && !goalM_.empty();
}

ob::PlannerStatus Roadmap::solve(const ob::PlannerTerminationCondition& ended) {
  // Milestones that are drawn between two looks for a path, and then by random bounces from those
  // that few others could be joined to: twice as many of the former, as OMPL has it by time.
  constexpr unsigned long kDrawn = 20, kBounced = 10;
  checkValidity();
  if (!AddEnds(ended)) return ob::PlannerStatus::INVALID_START;
  ob::PathPtr path;
  const auto until = [&](unsigned long milestones) {
    return ob::PlannerTerminationCondition([&ended, this, most = milestoneCount() + milestones] {
      return ended || milestoneCount() >= most;
    });
  };
  while (!maybeConstructSolution(startM_, goalM_, path)) {
    if (ended) return ob::PlannerStatus::TIMEOUT;
    growRoadmap(until(kDrawn));
    expandRoadmap(until(kBounced));
  }
  pdef_->addSolutionPath(ob::PlannerSolution(path));
  return ob::PlannerStatus::EXACT_SOLUTION;
}

}  // namespace mjcf_pdg
