// The least change of a hinge by the norm. Part of lower_bound.h and joint_boxes.h.
#ifndef MJCF_PDG_SRC_BOUND_LEAST_CHORD_H_
#define MJCF_PDG_SRC_BOUND_LEAST_CHORD_H_

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>

namespace mjcf_pdg {

// The least sin²(Δ/2) over Δ in [low, high] [rad] (Eq. 17).
inline double LeastChord(double low, double high) {
  if (std::floor(high / (2 * mjPI)) >= std::ceil(low / (2 * mjPI))) return 0.0;
  return std::min(std::pow(std::sin(low / 2), 2), std::pow(std::sin(high / 2), 2));
}

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_BOUND_LEAST_CHORD_H_
