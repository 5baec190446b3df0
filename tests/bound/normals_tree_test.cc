// What is proven of pairs that are parted together, against motions that part them, and where the
// least is known.
#include "bound/normals_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "tests/bound/bound_check.h"
#include "tests/bound/parting.h"

namespace mjcf_pdg::test {
namespace {

class NormalsTreeTest : public MujocoTest {};

// √S that is proven of a pair alone.
double Proven(const Parting& parting, double known, int nodes) {
  NormalsTree tree;
  tree.Begin(parting.pool, known);
  std::vector<int> movers(parting.pool.size());
  std::iota(movers.begin(), movers.end(), 0);
  const std::span<const int> all(movers);
  tree.rows().AddPair(parting.pair, all.subspan(0, parting.pair.first[1]),
                      all.subspan(parting.pair.first[1]));
  return tree.Search(nodes, nullptr);
}

// For one kind of movers: nothing parts the pair for less, and little more does.
void ExpectHolds(const std::vector<Moves>& kinds, int seed, double tight) {
  Random rng(seed);
  std::vector<double> ratios;
  for (int trial = 0; trial < 240; ++trial) {
    const bool plane = trial % 8 == 0;
    const int first = plane ? mjGEOM_PLANE : kSolids[rng.Index(6)];
    const Parting parting(first, kSolids[rng.Index(6)], kinds, plane, rng.Uniform(-3.0, 3.0), rng);
    if (!parting.overlaps()) continue;
    double cheapest = kInfinity;
    for (int k = 0; k < (plane ? 1 : 10); ++k) {
      const Vector3d n = k == 0 ? parting.n_W : (parting.n_W + rng.Normals(3)).normalized();
      cheapest =
          std::min(cheapest, parting.CheapRoot(plane ? parting.pair.geom[0].R.col(2) : n, rng, 40));
    }
    if (!std::isfinite(cheapest)) continue;
    const double known = cheapest * (trial % 2 ? 1.0 : rng.Uniform(1.0, 4.0));
    for (const int nodes : {1, 40, 800}) {
      EXPECT_LE(Proven(parting, known, nodes), cheapest * kSlack)
          << "trial " << trial << ", nodes " << nodes;
    }
    ratios.push_back(Proven(parting, cheapest, 800) / cheapest);
  }
  EXPECT_GT(ratios.size(), 80u);
  EXPECT_GT(Median(ratios), tight);
}

TEST_F(NormalsTreeTest, NothingPartsAPairOnSlidesForLess) { ExpectHolds({Moves::kSlide}, 1, 0.95); }
TEST_F(NormalsTreeTest, NothingPartsAPairOnHingesForLess) { ExpectHolds({Moves::kHinge}, 2, 0.7); }
TEST_F(NormalsTreeTest, NothingPartsAPairOnBallsForLess) { ExpectHolds({Moves::kBall}, 3, 0.7); }
TEST_F(NormalsTreeTest, NothingPartsAPairOfFreeBodiesForLess) {
  ExpectHolds({Moves::kFree}, 4, 0.8);
}
TEST_F(NormalsTreeTest, NothingPartsAPairOfAnyMoversForLess) {
  ExpectHolds({Moves::kSlide, Moves::kHinge, Moves::kBall, Moves::kFree}, 5, 0.7);
}

// A box that slides into a corner must leave both walls; each alone is left for less.
TEST_F(NormalsTreeTest, ACornerIsLeftByBothWalls) {
  const AtStart at(Scene::FromString(R"(<mujoco><worldbody>
    <geom type="box" size=".1 2 2" pos="-.1 0 0"/><geom type="box" size="2 .1 2" pos="0 -.1 0"/>
    <body><joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/>
    <geom type="box" size=".2 .2 .2"/></body></worldbody></mujoco>)"),
                   Configuration({0.15, 0.16}));
  const double exact = std::pow(0.05 - kTolerance, 2) + std::pow(0.04 - kTolerance, 2);
  EXPECT_LT(at.Bound(1000), 0.7 * exact);
  EXPECT_LE(at.Tightened(10.0 * exact, 2000), exact * kSlack);
  EXPECT_GE(at.Tightened(10.0 * exact, 2000), 0.97 * exact);
}

// A ball in a ball leaves it the way that it is off its centre, whichever that is.
TEST_F(NormalsTreeTest, EveryDirectionIsAWayOut) {
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody><geom size=".1"/>
    <body><joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/>
    <joint type="slide" axis="0 0 1"/><geom size=".1"/></body></worldbody></mujoco>)");
  const double exact = std::pow(0.01 - kTolerance, 2);
  for (const FirstCell& first : FirstCells()) {
    const AtStart at(scene, 0.19 * first.n);
    EXPECT_LE(at.Tightened(10.0 * exact, 500), exact * kSlack) << first.n.transpose();
    EXPECT_GE(at.Tightened(10.0 * exact, 500), 0.97 * exact) << first.n.transpose();
  }
}

// A free box lies in the floor with a whole face: it would have to turn about a corner if only one
// point counted.
TEST_F(NormalsTreeTest, AFaceThatLiesInTheFloorIsLiftedWhole) {
  const AtStart at(Scene::FromString(R"(<mujoco><worldbody><geom type="plane" size="1 1 1"/>
    <body><freejoint/><geom type="box" size=".2 .2 .1"/></body></worldbody></mujoco>)"),
                   Configuration({0, 0, 0.095, 1, 0, 0, 0}));
  const double exact = std::pow(0.005 - kTolerance, 2);
  EXPECT_LT(at.Bound(), 0.8 * exact);
  EXPECT_LE(at.Tightened(4.0 * exact, 200), exact * kSlack);
  EXPECT_GE(at.Tightened(4.0 * exact, 200), 0.98 * exact);
}

// A box between two walls that leave no room must pass one of them, 56 cm away. That is all that is
// asked about if something nearer is said to be known.
TEST_F(NormalsTreeTest, NoMoreIsSaidThanWhatIsKnown) {
  const AtStart at(Scene::FromString(R"(<mujoco><worldbody>
    <geom type="box" size=".1 2 2" pos="-.25 0 0"/><geom type="box" size=".1 2 2" pos=".25 0 0"/>
    <body><joint type="slide" axis="1 0 0"/><geom type="box" size=".2 .2 .2"/></body>
    </worldbody></mujoco>)"),
                   Configuration({0.01}));
  EXPECT_LE(at.Tightened(0.2, 2000), 0.2 * kSlack);
  EXPECT_GE(at.Tightened(0.2, 2000), 0.99 * 0.2);
  EXPECT_LE(at.Tightened(0.5, 2000), 0.56 * 0.56);
}

}  // namespace
}  // namespace mjcf_pdg::test
