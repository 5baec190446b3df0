#include "trajectories.h"

#include <algorithm>

namespace mjcf_pdg::bench {

const std::vector<Trajectory>& Trajectories() {
  static const std::vector<Trajectory> all = {
      // The arm moves past the car's side with its forearm stretched into the car.
      {"Puma1", "puma/puma_car.xml", "arm_through_door", {1}, {-2.2}, {2.2}, 27.9, 3.1},
      // The upper arm comes down onto the robot's own cart, which stands in the running board.
      {"Puma2", "puma/puma_car.xml", "own_cart_and_running_board", {4}, {0.6}, {-0.75}, 14.9, 2.3},
      // The hand moves from above the cap down to the shoulder of the bottle.
      {"Hand", "hand/hand_bottle.xml", "hand_down_to_shoulder", {2}, {0.27}, {0.13}, 71.6, 1.9},
  };
  return all;
}

std::vector<std::vector<double>> Frames(const Scene& scene, const Trajectory& trajectory,
                                        int count) {
  const std::vector<std::string> keys = scene.KeyNames();
  const auto key = std::find(keys.begin(), keys.end(), trajectory.first_key);
  if (key == keys.end()) throw Error(std::string("no keyframe ") + trajectory.first_key);
  std::vector<double> q = scene.KeyQpos(static_cast<int>(key - keys.begin()));
  std::vector<std::vector<double>> frames;
  for (int k = 0; k < count; ++k) {
    const double t = k / (count - 1.0);
    for (std::size_t i = 0; i < trajectory.entries.size(); ++i) {
      q[trajectory.entries[i]] = (1.0 - t) * trajectory.from[i] + t * trajectory.to[i];
    }
    frames.push_back(q);
  }
  return frames;
}

}  // namespace mjcf_pdg::bench
