// A collision-free path between two configurations, its edges proven free.
//
// Source: Tang & Kim, Sec. 6.3 and Table IV. The planners are OMPL's or, for the two that retract,
// built on it.
#ifndef MJCF_PDG_SRC_PLAN_PLAN_H_
#define MJCF_PDG_SRC_PLAN_PLAN_H_

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "mjcf_pdg/pdg.h"

namespace mjcf_pdg {

struct PlanOptions {
  std::string planner = "birrt-pdg";  // PlannerNames
  // Of these count tolerance, clearance, seed, the mocap poses, report_contacts (of the ends as
  // given) and time_limit, for all of Plan [s].
  Options options = {};
  // The length of a step [m]; 0: a tenth of the largest √σ between random configurations.
  double range = 0.0;
  // Ends the search after runs that may draw so many; 0: no bound.
  std::int64_t max_samples = 0;
  // Several are used by planners that begin anew; the path is the same at any number.
  int threads = 1;
  // Asked between samples, by one thread at a time, whether to go on; empty: always.
  std::function<bool()> go_on = {};
};

// What the last proof of an edge of a path took.
struct EdgeProof {
  bool certified = false;  // proven; false if an SDF was near and it was only sampled
  int poses = 0;           // configurations that were posed
  double length = 0.0;     // √σ [m]
};

struct Path {
  bool found = false;
  // Every edge has been proven free; false if an SDF was near one and it was only sampled.
  bool certified = false;
  // From start to goal, nq entries each; empty if not found. Straight motions lead from each to the
  // next. Where equality constraints are held that straight motions leave, they are short, so that
  // the constraints hold along them to kEqualityTolerance.
  std::vector<std::vector<double>> q;
  std::vector<int> corners;      // of q: both ends, and where the path turns rather than bends
  std::vector<EdgeProof> edges;  // one less than q
  double length = 0.0;           // Σ√σ of the edges [m]
  // What became of the ends: free already, repaired, or not to be repaired, and then nothing is
  // planned. They are repaired to the nearest configuration that is free.
  Result start, goal;
  std::string reason;  // why nothing was found, in words; else empty
  int nodes = 0;       // of the planner's trees, those of runs that were given up included
  std::int64_t samples = 0;
  // Configurations that were posed, for whatever reason: motions, repairs, retractions.
  std::int64_t collision_queries = 0;
  double seconds = 0.0;  // wall time of it all [s]
};

// Plans from `start` to `goal` (nq entries each). The same seed and max_samples give the same path,
// unless the time limit or `go_on` ends the search. Throws Error for a bad configuration, option or
// planner's name, or if start and goal differ in a frozen joint.
Path Plan(const Scene& scene, const std::vector<double>& start, const std::vector<double>& goal,
          const PlanOptions& options);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_PLAN_PLAN_H_
