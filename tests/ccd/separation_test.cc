#include "ccd/separation.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "tests/ccd/line.h"

namespace mjcf_pdg::test {
namespace {

class SeparationTest : public MujocoTest {};

TEST_F(SeparationTest, TheWitnessNormalOfACloseePairProvesItsDistance) {
  Random rng(3);
  double worst = 0.0;
  int proven = 0;
  for (const Scene& scene : Scenes(rng)) {
    Line line(scene);
    Separation separation(line.tables);
    for (int trial = 0; trial < 100; ++trial) {
      line.Set(RandomConfiguration(scene, rng), line.dq);
      line.Pose(0.0);
      for (const NearPair& near : line.finder.Find(0.3)) {
        const KeptPair& kept = line.tables.pairs[near.pair];
        if (near.distance < 1e-3) continue;
        Vector3d n = near.n_W;
        if (line.tables.model->geom_type[kept.geom1] == mjGEOM_PLANE) {
          n = AsMatrix(line.finder.posed().data()->geom_xmat + 9 * kept.geom1).col(2);
        }
        const double by_plane = separation.Distance(line.finder.posed(), kept.geom1, kept.geom2, n);
        EXPECT_LE(by_plane, near.distance + 1e-7);
        worst = std::max(worst, near.distance - by_plane);
        ++proven;
        // Any other plane proves less, never more.
        const Vector3d other = (n + 0.3 * rng.UnitVector()).normalized();
        EXPECT_LE(separation.Distance(line.finder.posed(), kept.geom1, kept.geom2, other),
                  near.distance + 1e-7);
      }
    }
  }
  std::printf("  distance less what its plane proves: at most %.1e m, %d pairs\n", worst, proven);
  EXPECT_GT(proven, 1000);
  EXPECT_LT(worst, 1e-4);
}

// Steps are safe: the distance, sampled along each, stays above the floor.
TEST_F(SeparationTest, NoSafeStepCrossesItsFloor) {
  Random rng(4);
  int steps = 0, whole = 0;
  for (const Scene& scene : Scenes(rng)) {
    Line line(scene);
    Separation separation(line.tables);
    for (int trial = 0; trial < 200; ++trial) {
      line.Set(RandomConfiguration(scene, rng), RandomTangent(line, rng));
      line.Pose(0.0);
      const int pair = rng.Index(scene.num_kept_pairs()), bodies = line.BodyPairOf(pair);
      NearPair near;
      if (!line.bound.Moves(bodies) || !line.finder.Distance(pair, 0.5, near)) continue;
      if (near.distance < 1e-3) continue;
      const KeptPair& kept = line.tables.pairs[pair];
      const double floor = near.distance * rng.Uniform(-0.5, 0.9);
      const RelativeMotion motion = line.bound.Geoms(line.finder.posed(), bodies, pair, 1.0);
      const double step =
          separation.SafeStep(line.finder.posed(), kept, near.n_W, motion, floor, 1.0);
      steps += step > 0.0;
      whole += step == 1.0;
      for (int i = 1; i <= 50; ++i) {
        line.Pose(step * i / 50);
        if (line.finder.Distance(pair, 0.5, near)) {
          EXPECT_GE(near.distance, floor - 1e-7) << step;
        }
      }
    }
  }
  std::printf("  %d safe steps, %d over the whole line\n", steps, whole);
  EXPECT_GT(steps, 300);
  EXPECT_GT(whole, 10);
}

// Over a horizon that is safe as a whole, a step is that horizon; so the longest of those says what
// a step over a longer one might have been.
TEST_F(SeparationTest, AStepIsMostOfTheLongestSafeOne) {
  Random rng(5);
  int steps = 0, long_enough = 0;
  for (const Scene& scene : Scenes(rng)) {
    Line line(scene);
    Separation separation(line.tables);
    for (int trial = 0; trial < 200; ++trial) {
      // Fast motions, so that steps are a small part of the horizon.
      const double speed = std::pow(10.0, rng.Uniform(0.0, 2.5));
      line.Set(RandomConfiguration(scene, rng), speed * RandomTangent(line, rng));
      line.Pose(0.0);
      const int pair = rng.Index(scene.num_kept_pairs()), bodies = line.BodyPairOf(pair);
      NearPair near;
      if (!line.bound.Moves(bodies) || !line.finder.Distance(pair, 0.5, near)) continue;
      if (near.distance < 1e-3) continue;
      const double floor = near.distance * rng.Uniform(-0.5, 0.9);
      const RelativeMotion motion = line.bound.Geoms(line.finder.posed(), bodies, pair, 1.0);
      const auto step = [&](double horizon) {
        return separation.SafeStep(line.finder.posed(), line.tables.pairs[pair], near.n_W, motion,
                                   floor, horizon);
      };
      if (step(1.0) == 1.0) continue;
      double longest = 1.0;
      while (longest > 1e-6 && step(longest) < longest) longest *= 0.98;
      if (longest <= 1e-6) continue;
      ++steps;
      long_enough += step(1.0) >= 0.75 * longest;
    }
  }
  std::printf("  %d of %d steps are three quarters of the longest\n", long_enough, steps);
  EXPECT_GT(steps, 200);
  EXPECT_GE(long_enough, 0.99 * steps);
}

}  // namespace
}  // namespace mjcf_pdg::test
