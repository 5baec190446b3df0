#include "peers/sampled_plan.h"

#include <ompl/base/DiscreteMotionValidator.h>
#include <ompl/base/PlannerData.h>
#include <ompl/base/ProblemDefinition.h>
#include <ompl/base/ScopedState.h>
#include <ompl/geometric/PathSimplifier.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <span>

#include "plan/configuration_space.h"

namespace mjcf_pdg::bench {
namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;
using Clock = std::chrono::steady_clock;

constexpr double kRange = 0.1;   // of the extent, as in src/plan/plan.cc
constexpr double kDense = 1e-4;  // of the extent

class NoContacts : public ob::StateValidityChecker {
 public:
  NoContacts(const ob::SpaceInformationPtr& space, std::shared_ptr<MujocoCheck> check)
      : ob::StateValidityChecker(space), check_(std::move(check)) {}
  bool isValid(const ob::State* state) const override {
    return si_->satisfiesBounds(state) &&
           check_->Overlap(ConfigurationSpace::Q(state).data()) == 0.0;
  }

 private:
  std::shared_ptr<MujocoCheck> check_;
};

std::shared_ptr<ConfigurationSpace> SpaceOf(const Scene& scene, const std::vector<double>& start,
                                            const std::vector<double>& goal,
                                            const Options& options) {
  return std::make_shared<ConfigurationSpace>(
      scene, MocapPoses{options.mocap_pos, options.mocap_quat}, ToEigen(start), ToEigen(goal));
}

// What Planning::Shorten in src/plan/plan.cc does.
void Shorten(og::PathGeometric& path) {
  og::PathSimplifier simplifier(path.getSpaceInformation());
  simplifier.reduceVertices(path);
  simplifier.shortcutPath(path);
  simplifier.smoothBSpline(path, 2, 0.01);
  simplifier.reduceVertices(path);
}

void Keep(const ConfigurationSpace& space, const og::PathGeometric& found, Path& path) {
  path.found = true;
  for (std::size_t k = 0; k < found.getStateCount(); ++k) {
    const VectorXd& q = ConfigurationSpace::Q(found.getState(static_cast<unsigned int>(k)));
    if (k > 0) path.length += space.Displacement(ToEigen(path.q.back()), q);
    path.q.emplace_back(q.data(), q.data() + q.size());
  }
}

}  // namespace

MujocoCheck::MujocoCheck(const Scene& scene, double tolerance)
    : scene_(scene), tolerance_(tolerance), data_(mj_makeData(scene.model()), mj_deleteData) {}

double MujocoCheck::Overlap(const double* q) {
  const mjModel& m = *scene_.model();
  mjData& d = *data_;
  ++queries_;
  mju_copy(d.qpos, q, static_cast<int>(m.nq));
  mj_kinematics(&m, &d);
  mj_collision(&m, &d);
  double deepest = 0.0;
  for (int c = 0; c < d.ncon; ++c) deepest = std::max(deepest, -d.contact[c].dist);
  return deepest > tolerance_ ? deepest : 0.0;
}

Path SampledPlan(const Scene& scene, const std::vector<double>& start,
                 const std::vector<double>& goal, const PlanOptions& options, double resolution) {
  const Clock::time_point begin = Clock::now();
  ompl::msg::setLogLevel(ompl::msg::LOG_NONE);
  ompl::RNG::setSeed(static_cast<std::uint_fast32_t>(options.options.seed % 0xffffffffu + 1));
  const auto space = std::make_shared<ConfigurationSpace>(
      *SpaceOf(scene, start, goal, options.options), options.options.seed, 1.0);
  const auto check = std::make_shared<MujocoCheck>(scene, options.options.tolerance);
  const auto information = std::make_shared<ob::SpaceInformation>(space);
  information->setStateValidityChecker(std::make_shared<NoContacts>(information, check));
  information->setMotionValidator(std::make_shared<ob::DiscreteMotionValidator>(information));
  information->setStateValidityCheckingResolution(resolution);
  information->setup();
  ob::ScopedState<> first(information->getStateSpace()), last(information->getStateSpace());
  ConfigurationSpace::Q(first.get()) = ToEigen(start);
  ConfigurationSpace::Q(last.get()) = ToEigen(goal);
  const auto problem = std::make_shared<ob::ProblemDefinition>(information);
  problem->setStartAndGoalStates(first, last);
  og::RRTConnect planner(information);
  planner.setRange(options.range > 0.0 ? options.range / space->extent() : kRange);
  planner.setProblemDefinition(problem);
  planner.setup();
  planner.solve(ob::PlannerTerminationCondition([&] {
    return std::chrono::duration<double>(Clock::now() - begin).count() >
               options.options.time_limit ||
           (options.max_samples > 0 && space->samples() >= options.max_samples);
  }));
  Path path;
  if (problem->hasExactSolution()) {
    og::PathGeometric found = *problem->getSolutionPath()->as<og::PathGeometric>();
    Shorten(found);
    Keep(*space, found, path);
  }
  ob::PlannerData data(information);
  planner.getPlannerData(data);
  path.nodes = static_cast<int>(data.numVertices());
  path.samples = space->samples();
  path.collision_queries = check->queries();
  path.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  return path;
}

double DeepestOverlap(const Scene& scene, const Path& path, const Options& options) {
  if (!path.found) return 0.0;
  const auto space = SpaceOf(scene, path.q.front(), path.q.back(), options);
  // MuJoCo fills the hulls of exact meshes: of those our own verifier is asked.
  const std::vector<char>& exact = scene.tables().exact;
  const bool filled = std::find(exact.begin(), exact.end(), 1) == exact.end();
  MujocoCheck check(scene, options.tolerance);
  Solver verifier(scene, options);
  const auto overlap = [&](const VectorXd& q) {
    if (filled) return check.Overlap(q.data());
    const std::span<const double> row(q.data(), static_cast<std::size_t>(q.size()));
    return verifier.IsFree(row) ? 0.0 : std::numeric_limits<double>::infinity();
  };
  const double step = kDense * space->extent();
  double deepest = 0.0;
  VectorXd q;
  for (std::size_t k = 1; k < path.q.size(); ++k) {
    const VectorXd from = ToEigen(path.q[k - 1]), to = ToEigen(path.q[k]);
    const int poses = 1 + static_cast<int>(std::ceil(space->Distance(from, to) / step));
    for (int i = 0; i <= poses; ++i) {
      space->Interpolate(from, to, static_cast<double>(i) / poses, q);
      deepest = std::max(deepest, overlap(q));
    }
  }
  return deepest;
}

}  // namespace mjcf_pdg::bench
