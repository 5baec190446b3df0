// Trajectories of 200 frames made after the description of Puma1, Puma2 and Hand in the paper's
// Table III.
#ifndef MJCF_PDG_BENCH_TRAJECTORIES_H_
#define MJCF_PDG_BENCH_TRAJECTORIES_H_

#include <string>
#include <vector>

#include "mjcf_pdg/scene.h"

namespace mjcf_pdg::bench {

inline constexpr int kFrames = 200;

struct Trajectory {
  const char* name;
  const char* model;             // below models/
  const char* first_key;         // keyframe that gives all entries of qpos that do not change
  std::vector<int> entries;      // indices of the entries of qpos that change
  std::vector<double> from, to;  // their values in the first and the last frame
  double paper_ms;               // mean time of a frame in the paper [ms]
  double paper_iterations;       // mean iterations of a frame in the paper
};

const std::vector<Trajectory>& Trajectories();

// `count` >= 2 evenly spaced frames of nq entries. Throws Error if the scene lacks the keyframe.
std::vector<std::vector<double>> Frames(const Scene& scene, const Trajectory& trajectory,
                                        int count = kFrames);

}  // namespace mjcf_pdg::bench

#endif  // MJCF_PDG_BENCH_TRAJECTORIES_H_
