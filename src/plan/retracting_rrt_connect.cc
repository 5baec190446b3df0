#include "plan/retracting_rrt_connect.h"

#include <ompl/base/ScopedState.h>
#include <ompl/base/goals/GoalSampleableRegion.h>

#include <algorithm>
#include <vector>

namespace mjcf_pdg {

namespace ob = ompl::base;

namespace {

// A step that comes less near to where it goes ends the growth of a tree [share of the step], as in
// careful slides (plan/retraction.cc). Steps that nothing brings back come as near as they are
// long.
constexpr double kLeastProgress = 0.01;

}  // namespace

RetractingRrtConnect::RetractingRrtConnect(const ob::SpaceInformationPtr& space,
                                           const std::string& name, Retractions retractions)
    : RRTConnect(space), retractions_(std::move(retractions)) {
  setName(name);
}

std::int64_t RetractingRrtConnect::retraction_queries() const {
  return retractions_.growing->queries() +
         (retractions_.joining ? retractions_.joining->queries() : 0);
}

RetractingRrtConnect::Motion* RetractingRrtConnect::Add(TreeData& tree, Motion* parent,
                                                        const ob::State* state) {
  auto* motion = new Motion(si_);  // freed by RRTConnect::freeMemory
  si_->copyState(motion->state, state);
  motion->parent = parent;
  motion->root = parent ? parent->root : motion->state;
  tree->add(motion);
  return motion;
}

RetractingRrtConnect::GrowState RetractingRrtConnect::Grow(TreeData& tree, const ob::State* target,
                                                           Retraction*& retraction, Motion*& last) {
  ob::ScopedState<> end(si_->getStateSpace());
  Motion wanted;
  wanted.state = const_cast<ob::State*>(target);  // only read, to be compared with nodes
  Motion* const near = tree->nearest(&wanted);
  const double distance = si_->distance(near->state, target);
  const bool reaches = distance <= maxDistance_;
  si_->getStateSpace()->interpolate(near->state, target, reaches ? 1.0 : maxDistance_ / distance,
                                    end.get());
  // Where a constraint can be met in two ways, steps towards the other are brought back, all of
  // them, or lead a little nearer each time and never there.
  const double left = si_->distance(end.get(), target);
  if (!reaches && !(distance - left > kLeastProgress * maxDistance_)) return TRAPPED;
  if (si_->checkMotion(near->state, end.get())) {
    last = Add(tree, near, end.get());
    return reaches ? REACHED : ADVANCED;
  }
  if (!retraction) return TRAPPED;
  const std::vector<VectorXd>& chain =
      retraction->Retract(ConfigurationSpace::Q(near->state), ConfigurationSpace::Q(end.get()));
  retraction = nullptr;
  last = near;
  for (const VectorXd& q : chain) {
    ConfigurationSpace::Q(end.get()) = q;
    last = Add(tree, last, end.get());
  }
  return chain.empty() ? TRAPPED : ADVANCED;
}

// Grows towards a node of the other tree until it is reached or something is in the way.
RetractingRrtConnect::GrowState RetractingRrtConnect::Join(
    TreeData& tree, const ob::State* target, const ob::PlannerTerminationCondition& ptc,
    Motion*& last) {
  Retraction* retraction = retractions_.joining.get();
  GrowState state = ADVANCED;
  while (state == ADVANCED && !ptc) state = Grow(tree, target, retraction, last);
  return state;
}

bool RetractingRrtConnect::AddRoots() {
  while (const ob::State* state = pis_.nextStart()) Add(tStart_, nullptr, state);
  if (tGoal_->size() == 0) {
    if (const ob::State* state = pis_.nextGoal()) Add(tGoal_, nullptr, state);
  }
  return tStart_->size() > 0 && tGoal_->size() > 0;
}

// The way from the start to where the trees meet, and on to the goal.
void RetractingRrtConnect::Connect(const Motion* start_side, const Motion* goal_side) {
  std::vector<const ob::State*> states;
  for (; start_side; start_side = start_side->parent) states.push_back(start_side->state);
  std::reverse(states.begin(), states.end());
  for (goal_side = goal_side->parent; goal_side; goal_side = goal_side->parent) {
    states.push_back(goal_side->state);
  }
  auto path = std::make_shared<ompl::geometric::PathGeometric>(si_);
  for (const ob::State* state : states) path->append(state);
  pdef_->addSolutionPath(path, false, 0.0, getName());
}

ob::PlannerStatus RetractingRrtConnect::solve(const ob::PlannerTerminationCondition& ptc) {
  checkValidity();
  if (!AddRoots()) return ob::PlannerStatus::INVALID_START;
  if (!sampler_) sampler_ = si_->allocStateSampler();
  ob::ScopedState<> sample(si_->getStateSpace());
  for (bool from_start = true; !ptc; from_start = !from_start) {
    TreeData& tree = from_start ? tStart_ : tGoal_;
    TreeData& other = from_start ? tGoal_ : tStart_;
    sampler_->sampleUniform(sample.get());
    Motion* node = nullptr;
    Retraction* retraction = retractions_.growing.get();
    if (Grow(tree, sample.get(), retraction, node) == TRAPPED) continue;
    Motion* met = nullptr;
    if (Join(other, node->state, ptc, met) != REACHED) continue;
    Connect(from_start ? node : met, from_start ? met : node);
    return ob::PlannerStatus::EXACT_SOLUTION;
  }
  return ob::PlannerStatus::TIMEOUT;
}

}  // namespace mjcf_pdg
