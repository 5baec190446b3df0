// Random pairs of convex geoms in random poses, the claims of the independent check about them,
// and an oracle that holds each claim against its proof: planes against support functions, common
// points against the formulas and faces of the shapes. Shares no code with the check.
#ifndef MJCF_PDG_TESTS_SUPPORT_POSE_TRIALS_H_
#define MJCF_PDG_TESTS_SUPPORT_POSE_TRIALS_H_

#include <cstdint>
#include <string>
#include <vector>

namespace mjcf_pdg::test {

// How many of a kind of poses, and what MuJoCo says of them alone.
struct PoseTally {
  long poses = 0;
  long free = 0, overlapping = 0;  // claims
  long unproven = 0;               // neither a plane nor a common point was found: not free
  long collision_missed = 0, collision_invented = 0;  // mj_collision: no contact; a contact
  long distance_missed = 0, distance_invented = 0;    // mj_geomDistance: sign beyond the tolerance
};

struct PoseTrials {
  PoseTally random, aligned, near;  // near: within a few tolerances of the tolerance
  std::vector<std::string> wrong;   // claims that the oracle refutes, in words, at most a few
  long wrong_count = 0;
};

// `poses` of them over all pairs of types, scales of 1e-3 to 1e3 m and thin, flat, tiny and huge
// shapes, hulls of 4 to 200 vertices. The tolerance is 1e-6 of the scale.
PoseTrials RunPoseTrials(long poses, std::uint64_t seed);

}  // namespace mjcf_pdg::test

#endif  // MJCF_PDG_TESTS_SUPPORT_POSE_TRIALS_H_
