// OMPL's PRM without its clock and its thread: what grows the roadmap, and when a path is looked
// for, follows from how many milestones there are, so that the same seed makes the same path.
#ifndef MJCF_PDG_SRC_PLAN_ROADMAP_H_
#define MJCF_PDG_SRC_PLAN_ROADMAP_H_

#include <ompl/geometric/planners/prm/PRM.h>

namespace mjcf_pdg {

class Roadmap : public ompl::geometric::PRM {
 public:
  // `star`: a milestone is joined to more and more neighbours as the roadmap grows (PRM*).
  Roadmap(const ompl::base::SpaceInformationPtr& information, bool star) : PRM(information, star) {}

  // Ends with the first path, or when `ended` says so; may be called again to go on.
  ompl::base::PlannerStatus solve(const ompl::base::PlannerTerminationCondition& ended) override;

 private:
  bool AddEnds(const ompl::base::PlannerTerminationCondition& ended);
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_PLAN_ROADMAP_H_
