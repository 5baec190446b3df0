// Random pairs of convex geoms in random poses, what the verifier claims about them, and an oracle
// that tests each claim against its proof: planes against support functions, common points against
// the formulas and faces of the shapes. The oracle shares no code with the verifier.
#ifndef MJCF_PDG_TESTS_SUPPORT_POSE_TRIALS_H_
#define MJCF_PDG_TESTS_SUPPORT_POSE_TRIALS_H_

#include <mujoco/mujoco.h>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace mjcf_pdg::test {

// Counts of one kind of poses: the verifier's claims, and where MuJoCo alone would contradict them.
struct PoseTally {
  long poses = 0;
  long free = 0, overlapping = 0;  // claims with a proof
  long unproven = 0;               // claimed not free, without a proof
  // mj_collision: no contact though the geoms overlap; a deep contact though they are free.
  long collision_missed = 0, collision_invented = 0;
  // mj_geomDistance: no overlap beyond the tolerance though there is one; such an overlap though
  // not.
  long distance_missed = 0, distance_invented = 0;
  // The solver's own distances, held against the proofs: no overlap by more than the tolerance and
  // a half though there is one, one by more than half of it though there is none; of the overlaps
  // that the slow oracle measured, those whose depth is off by more than 1e-3 of the smaller geom.
  long solver_missed = 0, solver_invented = 0, depths = 0, solver_wrong_depths = 0;
  // Another library, where it has an answer: no overlap though there is one of more than the
  // tolerance, an overlap though a plane shows a gap of more than half of it.
  long library_asked = 0, library_missed = 0, library_invented = 0;
};

// Whether geoms 0 and 1 overlap at a pose, by another library; nothing if it has no answer.
using OtherLibrary = std::function<std::optional<bool>(const mjData&)>;

struct PoseTrials {
  // Poses at random; with faces, edges and middles aligned; with an overlap near the tolerance.
  PoseTally random, aligned, near;
  std::vector<std::string> wrong;  // the first claims that the oracle refutes, in words
  long wrong_count = 0;            // all of them
};

// Tries about `poses` poses over all pairs of types, in scales of 1e-3 to 1e3 m, with sizes from a
// hundredth of the scale to the scale, and hulls of 4 to 200 points. The tolerance is 1e-6 of the
// scale. `library`, if it is not empty, makes the other library of each pair's model.
PoseTrials RunPoseTrials(long poses, std::uint64_t seed,
                         const std::function<OtherLibrary(const mjModel&)>& library = {});

}  // namespace mjcf_pdg::test

#endif  // MJCF_PDG_TESTS_SUPPORT_POSE_TRIALS_H_
