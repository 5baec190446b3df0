// Trajectories of 200 frames made up after the words of the paper's Table III: Puma1, Puma2, Hand.
#ifndef MJCF_PDG_BENCH_TRAJECTORIES_H_
#define MJCF_PDG_BENCH_TRAJECTORIES_H_

#include <string>
#include <vector>

#include "mjcf_pdg/scene.h"

namespace mjcf_pdg::bench {

inline constexpr int kFrames = 200;

struct Trajectory {
  const char* name;
  const char* model;         // below models/
  const char* first_key;     // where the frames that `from` and `to` do not name come from
  std::vector<int> entries;  // of qpos, that change
  std::vector<double> from, to;
  double paper_ms;
  double paper_iterations;
};

const std::vector<Trajectory>& Trajectories();

// `count` >= 2 frames, evenly spaced. Throws Error if the scene has no such keyframe.
std::vector<std::vector<double>> Frames(const Scene& scene, const Trajectory& trajectory,
                                        int count = kFrames);

}  // namespace mjcf_pdg::bench

#endif  // MJCF_PDG_BENCH_TRAJECTORIES_H_
