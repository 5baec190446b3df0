// A million poses of pairs of convex geoms, each claim of the independent check held against its
// proof, and what MuJoCo says of them alone: cmake --build BUILD --target verify_poses, then
// BUILD/verify_poses [POSES [SEED]]. Exits with 1 if a claim is wrong.
#include <cstdio>
#include <cstdlib>

#include "tests/support/pose_trials.h"

namespace {

void Print(const char* kind, const mjcf_pdg::test::PoseTally& tally) {
  const auto share = [](long part, long whole) {
    return whole > 0 ? 100.0 * static_cast<double>(part) / static_cast<double>(whole) : 0.0;
  };
  std::printf("%-8s %9ld poses: %9ld free, %9ld overlapping, %ld unproven\n", kind, tally.poses,
              tally.free, tally.overlapping, tally.unproven);
  std::printf(
      "         MuJoCo alone: mj_collision misses %.4f %% of the overlaps and invents "
      "%.4f %% of the free,\n                       mj_geomDistance misses %.4f %% and "
      "invents %.4f %%\n",
      share(tally.collision_missed, tally.overlapping), share(tally.collision_invented, tally.free),
      share(tally.distance_missed, tally.overlapping), share(tally.distance_invented, tally.free));
}

}  // namespace

int main(int argc, char** argv) {
  const long poses = argc > 1 ? std::atol(argv[1]) : 1000000;
  const auto seed = static_cast<std::uint64_t>(argc > 2 ? std::atol(argv[2]) : 1);
  const mjcf_pdg::test::PoseTrials trials = mjcf_pdg::test::RunPoseTrials(poses, seed);
  Print("random", trials.random);
  Print("aligned", trials.aligned);
  Print("near", trials.near);
  std::printf("wrong claims: %ld\n", trials.wrong_count);
  for (const std::string& wrong : trials.wrong) std::printf("  %s\n", wrong.c_str());
  return trials.wrong_count == 0 ? 0 : 1;
}
