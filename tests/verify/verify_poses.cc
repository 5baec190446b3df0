// A million poses of pairs of convex geoms, each claim of the independent check held against its
// proof, and what the solver, MuJoCo and FCL say of them: cmake --build BUILD --target
// verify_poses, then BUILD/verify_poses [POSES [SEED]]. Exits with 1 if a claim is wrong.
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>

#include "library/library.h"
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
  std::printf(
      "         the solver misses %ld overlaps and invents %ld; %ld of %ld depths are wrong\n",
      tally.solver_missed, tally.solver_invented, tally.solver_wrong_depths, tally.depths);
  std::printf("         FCL, asked %ld times, misses %ld and invents %ld\n", tally.library_asked,
              tally.library_missed, tally.library_invented);
}

// FCL's own tests of primitives, and GJK for the others. Its depths are not asked: for some poses
// its EPA ends the process.
mjcf_pdg::test::OtherLibrary Fcl(const mjModel& m) {
  std::shared_ptr<mjcf_pdg::bench::Library> fcl = mjcf_pdg::bench::MakeFcl(m, false);
  return [fcl](const mjData& d) { return fcl->Overlap(d, 0, 1); };
}

}  // namespace

int main(int argc, char** argv) {
  const long poses = argc > 1 ? std::atol(argv[1]) : 1000000;
  const auto seed = static_cast<std::uint64_t>(argc > 2 ? std::atol(argv[2]) : 1);
  const mjcf_pdg::test::PoseTrials trials = mjcf_pdg::test::RunPoseTrials(poses, seed, Fcl);
  Print("random", trials.random);
  Print("aligned", trials.aligned);
  Print("near", trials.near);
  std::printf("wrong claims: %ld\n", trials.wrong_count);
  for (const std::string& wrong : trials.wrong) std::printf("  %s\n", wrong.c_str());
  return trials.wrong_count == 0 ? 0 : 1;
}
