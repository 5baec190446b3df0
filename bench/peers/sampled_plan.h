// A planner as one has it with OMPL and MuJoCo alone, beside our own: OMPL's RRTConnect, which asks
// MuJoCo whether there are contacts at configurations along an edge. Nothing between them is looked
// at, so its paths need not be free.
#ifndef MJCF_PDG_BENCH_PEERS_SAMPLED_PLAN_H_
#define MJCF_PDG_BENCH_PEERS_SAMPLED_PLAN_H_

#include <mujoco/mujoco.h>

#include <cstdint>
#include <memory>
#include <vector>

#include "plan/plan.h"

namespace mjcf_pdg::bench {

// How far such configurations are apart, a share of the space's extent: OMPL's, if nothing is said.
inline constexpr double kUsualResolution = 0.01;

// MuJoCo's yes or no. Use one per thread.
class MujocoCheck {
 public:
  // An overlap of up to `tolerance` [m] is none.
  MujocoCheck(const Scene& scene, double tolerance);
  // How deep the deepest contact at q (nq entries) is [m]; 0 if all is free.
  double Overlap(const double* q);
  std::int64_t queries() const { return queries_; }

 private:
  const Scene scene_;
  const double tolerance_;
  std::unique_ptr<mjData, void (*)(mjData*)> data_;
  std::int64_t queries_ = 0;
};

// Of the options all but the planner's name count as in Plan: space, distance, samples, length of a
// step and what shortens the path are the same. Ends are taken as they are. Nothing is certified.
Path SampledPlan(const Scene& scene, const std::vector<double>& start,
                 const std::vector<double>& goal, const PlanOptions& options, double resolution);

// The deepest overlap that MuJoCo finds along the path [m], at configurations that are a hundred
// times closer to each other than is usual; infinite if our verifier finds one where there are
// exact meshes, which MuJoCo does not have.
double DeepestOverlap(const Scene& scene, const Path& path, const Options& options);

}  // namespace mjcf_pdg::bench

#endif  // MJCF_PDG_BENCH_PEERS_SAMPLED_PLAN_H_
