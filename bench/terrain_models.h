// A humanoid and a quadruped on grounds of all kinds, as MJCF text.
#ifndef MJCF_PDG_BENCH_TERRAIN_MODELS_H_
#define MJCF_PDG_BENCH_TERRAIN_MODELS_H_

#include <string>
#include <vector>

namespace mjcf_pdg::bench {

// "humanoid": 32 degrees of freedom, capsules with box feet. "quadruped": 18, a box on legs of
// capsules with ball feet. Both are of the size of the real ones.
std::vector<std::string> TerrainRobots();
// "plane", and the height fields "waves", "stairs" and "noise": 200 × 200 corners, 10 m × 10 m.
// Waves of 0.15 m height and 1.6 m length; steps of 0.4 m by 0.12 m up to a ridge; heights up to
// 0.05 m at random on gentle hills.
std::vector<std::string> Grounds();

// The robot above the ground.
std::string TerrainXml(const std::string& robot, const std::string& ground);

}  // namespace mjcf_pdg::bench

#endif  // MJCF_PDG_BENCH_TERRAIN_MODELS_H_
