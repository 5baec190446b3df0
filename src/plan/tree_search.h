// Searches of one planner in one scene, from one configuration to another.
#ifndef MJCF_PDG_SRC_PLAN_TREE_SEARCH_H_
#define MJCF_PDG_SRC_PLAN_TREE_SEARCH_H_

#include <ompl/base/SpaceInformation.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "plan/configuration_space.h"
#include "plan/motion_prover.h"
#include "plan/plan.h"
#include "plan/planners.h"

namespace mjcf_pdg {

struct TreeSearchInput {
  const Scene& scene;
  const PlanOptions& options;
  std::shared_ptr<ConfigurationSpace> space;
  ContactSlide::Options slide;  // of retractions (plan/retraction.h)
  double step_share;            // of the length of a planner's step, in (0, 1]
  std::function<bool()> ended;  // whether to give up; never empty
};

// The length of a planner's step, √σ [m]: the one that the options give, or a share of the extent.
double StepLength(const PlanOptions& options, const ConfigurationSpace& space);

// What searches have cost.
struct SearchCost {
  int nodes = 0;                       // of all trees
  std::int64_t collision_queries = 0;  // configurations that were posed

  void operator+=(const SearchCost& other) {
    nodes += other.nodes;
    collision_queries += other.collision_queries;
  }
};

// One planner, one space and one prover for any number of searches. Use one per thread.
class TreeSearch {
 public:
  // Throws Error for an unknown planner.
  explicit TreeSearch(const TreeSearchInput& input);

  // A path whose motions are proven free, from one free configuration to another (nq); empty if
  // `samples` samples make none.
  std::vector<VectorXd> Find(const VectorXd& from, const VectorXd& to, std::int64_t samples);
  // The same with samples around the motion between the two, some lengths of it away, and steps
  // that are as short. For planners that retract.
  std::vector<VectorXd> FindNear(const VectorXd& from, const VectorXd& to, std::int64_t samples);

  MotionProver& prover() { return *prover_; }
  const std::shared_ptr<MotionProver>& shared_prover() const { return prover_; }
  double step() const { return range_ * input_.space->extent(); }  // of Find [m]
  SearchCost cost() const;  // of all that was done, the prover's queries included

 private:
  const TreeSearchInput input_;
  const double range_;  // of a step, a share of the space's extent
  const std::shared_ptr<MotionProver> prover_;
  const ompl::base::SpaceInformationPtr information_;
  NamedPlanner named_;
  bool used_ = false;  // the planner has searched
  int nodes_ = 0;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_PLAN_TREE_SEARCH_H_
