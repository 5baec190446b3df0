// The runs of a search. One of the three planners of Table IV that has not found a path after some
// samples begins anew: a few samples in the right place make a path soon or not at all. The runs
// are independent, each with random numbers of its own, so that several threads may be at different
// ones. They come in rounds, in each of which steps are whole and short. Of planners that retract,
// two runs of a round are careful (plan/contact_slide.h); of one that retracts by penetration
// depth, three of seven begin with smaller bodies or geoms, or thinner ones (plan/shrunk_scenes.h),
// and retract the path as they grow (plan/tightening.h).
#ifndef MJCF_PDG_SRC_PLAN_RUNS_H_
#define MJCF_PDG_SRC_PLAN_RUNS_H_

#include <cstdint>
#include <functional>
#include <vector>

#include "plan/configuration_space.h"
#include "plan/plan.h"

namespace mjcf_pdg {

struct RunsInput {
  const Scene& scene;
  const PlanOptions& options;
  const ConfigurationSpace& space;
  VectorXd start, goal;         // free (nq)
  double clearance = 0.0;       // that contact samples keep, in some rounds less [m]
  std::function<bool()> ended;  // asked by one thread at a time whether to give up; never empty
};

struct Runs {
  std::vector<VectorXd> path;  // empty: none was found
  // Of all runs up to the one that found it.
  int nodes = 0;
  std::int64_t samples = 0, collision_queries = 0;
};

// The path is that of the first run that finds one, in their order and not in time: the same at any
// number of threads, unless the search is ended.
Runs Search(const RunsInput& input);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_PLAN_RUNS_H_
