// What lower_bound_pair.h promises is proven of a pair, against motions that part it.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "bound/lower_bound_pair.h"
#include "tests/bound/parting.h"

namespace mjcf_pdg::test {
namespace {

class LowerBoundPairContractTest : public MujocoTest {};

const std::vector<Moves> kAllMoves = {Moves::kSlide, Moves::kHinge, Moves::kBall, Moves::kFree};

Parting RandomParting(const std::vector<Moves>& kinds, Random& rng) {
  int type1 = kSolids[rng.Index(6)], type2 = kSolids[rng.Index(6)];
  return Parting(type1, type2, kinds, false, rng.Uniform(-3.0, 3.0), rng);
}

// A unit vector no farther from n than eps.
Vector3d Within(double eps, const Vector3d& n, Random& rng) {
  const double angle = rng.Chance(0.3) ? eps : eps * rng.Uniform();
  const Vector3d axis = n.cross(rng.UnitVector()).normalized();
  return Eigen::AngleAxisd(angle, axis) * n;
}

TEST_F(LowerBoundPairContractTest, NoMotionPartsThePairAcrossADirectionOfACapForLess) {
  Random rng(1);
  std::vector<double> exact, wide;
  for (int trial = 0; trial < 1200; ++trial) {
    const Parting parting = RandomParting(kAllMoves, rng);
    if (!parting.overlaps()) continue;
    const Vector3d n = trial % 3 ? rng.UnitVector() : parting.n_W;
    const double eps = trial % 2 ? rng.Uniform(0.0, trial % 4 == 1 ? 0.2 : mjPI / 2) : 0.0;
    const double root = parting.pair.RootFor(n, eps);
    ASSERT_GE(root, 0.0);
    const double cheap = parting.CheapRoot(Within(eps, n, rng), rng);
    EXPECT_LE(root, cheap * kSlack) << "trial " << trial << ", eps " << eps;
    if (!std::isfinite(cheap)) continue;
    (eps > 0.0 ? wide : exact).push_back(root / cheap);
  }
  EXPECT_GT(exact.size(), 200u);
  EXPECT_GT(wide.size(), 200u);
  EXPECT_GT(Median(exact), 0.6);
  EXPECT_GT(*std::max_element(wide.begin(), wide.end()), 0.6);
}

// Where the overlap alone is said to prove a root, the points themselves prove it, too.
TEST_F(LowerBoundPairContractTest, AnOverlapThatIsEnoughProvesTheRoot) {
  Random rng(12);
  int settled = 0;
  std::vector<double> of_root;
  for (int trial = 0; trial < 1200; ++trial) {
    const Parting parting = RandomParting(kAllMoves, rng);
    if (!parting.overlaps()) continue;
    const Vector3d n = trial % 3 ? rng.UnitVector() : parting.n_W;
    const double root = parting.pair.RootFor(n, 0.0);
    if (!(root > 0.0) || !std::isfinite(root)) continue;
    const PairProblem::Ease ease = parting.pair.MostEase();
    const double enough = root * std::pow(10.0, rng.Uniform(-2.0, 0.5));
    const double overlap = PairProblem::EnoughOverlap(ease, enough);
    const std::array<ConvexGeom, 2>& geom = parting.pair.geom;
    const double t =
        parting.pair.required + n.dot(geom[0].Support(n) - geom[1].Support(Vector3d(-n)));
    if (t < overlap) continue;
    ++settled;
    of_root.push_back(enough / root);
    EXPECT_LE(enough, root * (1.0 + 1e-9)) << "trial " << trial;
    EXPECT_GE(parting.pair.RootFor(n, 0.0, {.enough = enough, .overlap = overlap}), enough);
  }
  EXPECT_GT(settled, 100);
  EXPECT_GT(*std::max_element(of_root.begin(), of_root.end()), 0.5);
}

// Slides alone: the pair is parted across n by what its overlap along n is, √S = t / √(nᵀTn).
TEST_F(LowerBoundPairContractTest, WhatSlidesPartAcrossOneDirectionIsBoundExactly) {
  Random rng(2);
  int exact = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const Parting parting = RandomParting({Moves::kSlide}, rng);
    const Vector3d n = rng.UnitVector();
    const double t = -parting.Excess(n, VectorXd::Zero(6));
    if (!(t > 1e-3 * parting.scale)) continue;
    double along = 0.0;
    for (const Mover& mover : parting.pool) along += n.dot(mover.T * n);
    ++exact;
    const double root = t / std::sqrt(along);
    EXPECT_NEAR(parting.pair.RootFor(n, 0.0), root, 1e-6 * root);
  }
  EXPECT_GT(exact, 200);
}

TEST_F(LowerBoundPairContractTest, AFloorIsReturnedIfItIsMore) {
  Random rng(3);
  int more = 0, less = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const Parting parting = RandomParting(kAllMoves, rng);
    const Vector3d n = rng.UnitVector();
    const double eps = trial % 2 ? rng.Uniform(0.0, 0.3) : 0.0;
    const double root = parting.pair.RootFor(n, eps), S = parting.pair.MomentArmS(0.0);
    EXPECT_EQ(S > 0.0, parting.pair.needed > 0.0);
    const double floor = rng.Uniform(0.5, 1.5);
    (floor > 1.0 ? more : less) += root > 0.0;
    EXPECT_DOUBLE_EQ(parting.pair.RootFor(n, eps, {.floor = floor * root}),
                     std::max(floor, 1.0) * root);
    EXPECT_DOUBLE_EQ(parting.pair.MomentArmS(floor * S), std::max(floor, 1.0) * S);
    EXPECT_GE(parting.pair.RootFor(n, eps, {.floor = 1e9}), 1e9);
    EXPECT_EQ(parting.pair.MomentArmS(1e300), 1e300);
  }
  EXPECT_GT(more, 50);
  EXPECT_GT(less, 50);
}

TEST_F(LowerBoundPairContractTest, NoMotionPartsThePairForLessThanItsMomentArmsSay) {
  Random rng(4);
  std::vector<double> ratios;
  for (int trial = 0; trial < 300; ++trial) {
    const Parting parting = RandomParting(kAllMoves, rng);
    if (!parting.overlaps()) continue;
    const double root = std::sqrt(parting.pair.MomentArmS(0.0));
    double cheapest = kInfinity;
    for (int k = 0; k < 8; ++k) {
      const Vector3d n = k == 0 ? parting.n_W : Within(k < 5 ? 0.5 : mjPI, parting.n_W, rng);
      cheapest = std::min(cheapest, parting.CheapRoot(n, rng, 15));
    }
    EXPECT_LE(root, cheapest * kSlack) << "trial " << trial;
    if (std::isfinite(cheapest)) ratios.push_back(root / cheapest);
  }
  EXPECT_GT(ratios.size(), 150u);
  EXPECT_GT(Median(ratios), 0.2);
}

TEST_F(LowerBoundPairContractTest, NoMotionLeavesAPlaneForLess) {
  Random rng(5);
  std::vector<double> ratios;
  for (int trial = 0; trial < 400; ++trial) {
    const Parting parting(mjGEOM_PLANE, kSolids[trial % 6], kAllMoves, true, rng.Uniform(-3.0, 3.0),
                          rng);
    if (!parting.overlaps()) continue;
    const double root = parting.pair.RootForPlane(nullptr);
    const Vector3d n = parting.pair.geom[0].R.col(2);
    EXPECT_TRUE(std::isfinite(root));
    const double cheap = parting.CheapRoot(n, rng);
    EXPECT_LE(root, cheap * kSlack) << "trial " << trial;
    if (std::isfinite(cheap)) ratios.push_back(root / cheap);
  }
  EXPECT_GT(ratios.size(), 150u);
  EXPECT_GT(Median(ratios), 0.7);
}

TEST_F(LowerBoundPairContractTest, NoMotionPartsThePairForLessThanTheSearchProves) {
  Random rng(6);
  std::vector<DirectionCell> heap;
  std::vector<double> ratios;
  for (int trial = 0; trial < 250; ++trial) {
    Parting parting = RandomParting(kAllMoves, rng);
    if (!parting.overlaps()) continue;
    parting.pair.hope = parting.pair.RootFor(parting.n_W, 0.0);
    int cells = trial % 2 ? 2000 : 300;
    const double root = SearchDirections(parting.pair, 0.0, nullptr, cells, heap);
    EXPECT_LE(root, 1.2 * parting.pair.hope) << "trial " << trial;
    EXPECT_GT(cells, -4);
    double cheapest = kInfinity;
    for (int k = 0; k < 12; ++k) {
      const Vector3d n = k == 0 ? parting.n_W : Within(k < 6 ? 0.5 : mjPI, parting.n_W, rng);
      cheapest = std::min(cheapest, parting.CheapRoot(n, rng, 15));
    }
    EXPECT_LE(root, cheapest * kSlack) << "trial " << trial;
    if (std::isfinite(cheapest)) ratios.push_back(root / cheapest);
  }
  EXPECT_GT(ratios.size(), 100u);
  EXPECT_GT(Median(ratios), 0.4);
}

// Two balls that slides part: every direction counts the same but for the overlap along it.
TEST_F(LowerBoundPairContractTest, TheSearchProvesNearlyAllThatCanBeProvenOfBallsOnSlides) {
  Random rng(7);
  std::vector<DirectionCell> heap;
  int searched = 0;
  for (int trial = 0; trial < 60; ++trial) {
    Parting parting(mjGEOM_SPHERE, mjGEOM_SPHERE, kAllMoves, true, rng.Uniform(-3.0, 3.0), rng);
    if (!parting.overlaps()) continue;
    ++searched;
    Mover mover;
    const double mass = rng.Uniform(0.1, 10.0);
    mover.T = Matrix3d::Identity() / mass;
    mover.slide = 1.0 / std::sqrt(mass);
    parting.pool = {mover};
    parting.pair.first = {0, trial % 2, 1};
    const double root = parting.pair.needed * std::sqrt(mass);
    parting.pair.hope = parting.pair.RootFor(parting.n_W, 0.0);
    EXPECT_NEAR(parting.pair.hope, root, 1e-6 * root);
    EXPECT_NEAR(parting.pair.MomentArmS(0.0), root * root, 1e-6 * root * root);
    int cells = 5000;
    EXPECT_LE(SearchDirections(parting.pair, 0.0, nullptr, cells, heap), root * kSlack);
    EXPECT_GE(heap.front().root, 0.96 * root);
  }
  EXPECT_GT(searched, 20);
}

TEST_F(LowerBoundPairContractTest, CellsCoverAllDirectionsAndEachIsProvenForItsOwn) {
  Random rng(8);
  std::vector<DirectionCell> heap;
  int searched = 0, proven = 0;
  for (int trial = 0; trial < 60; ++trial) {
    Parting parting = RandomParting(kAllMoves, rng);
    if (!parting.overlaps()) continue;
    parting.pair.hope = parting.pair.RootFor(parting.n_W, 0.0);
    ++searched;
    int cells = kFirstCells + (trial % 2 ? 300 : 0);
    const double root = SearchDirections(parting.pair, 0.0, nullptr, cells, heap);
    if (trial % 2 == 0) {
      EXPECT_EQ(heap.size(), static_cast<std::size_t>(kFirstCells));
      EXPECT_EQ(cells, 0);
    }
    EXPECT_EQ(root, heap.front().root);
    double area = 0.0;
    for (const DirectionCell& cell : heap) {
      EXPECT_GE(cell.root, root);
      area += 4.0 * cell.half * cell.half;
      const Vector3d middle = cell.Direction(0, 0);
      const Vector3d n = cell.Direction(rng.Uniform(-1.0, 1.0), rng.Uniform(-1.0, 1.0));
      EXPECT_NEAR(n.norm(), 1.0, 1e-12);
      EXPECT_LE(std::acos(std::min(1.0, n.dot(middle))), cell.Radius(middle));
      if (!rng.Chance(0.1)) continue;
      const double cheap = parting.CheapRoot(n, rng, 10);
      EXPECT_LE(cell.root, cheap * kSlack);
      proven += cell.root > 0.0 && std::isfinite(cheap);
    }
    EXPECT_NEAR(area, 24.0, 1e-9) << "six faces of 2 by 2";
    for (int k = 0; k < 100; ++k) {
      const Vector3d n = rng.UnitVector();
      EXPECT_TRUE(std::any_of(heap.begin(), heap.end(), [&n](const DirectionCell& cell) {
        const Vector3d middle = cell.Direction(0, 0);
        return n.dot(middle) >= std::cos(cell.Radius(middle));
      }));
    }
  }
  EXPECT_GT(searched, 20);
  EXPECT_GT(proven, 50);
}

TEST_F(LowerBoundPairContractTest, TheSearchGivesUpWhereItCannotBeatTheFloor) {
  Random rng(9);
  std::vector<DirectionCell> heap;
  int went_on = 0, searched = 0;
  for (int trial = 0; trial < 60; ++trial) {
    Parting parting = RandomParting(kAllMoves, rng);
    if (!parting.overlaps()) continue;
    ++searched;
    parting.pair.hope = parting.pair.RootFor(parting.n_W, 0.0);
    int cells = 1000;
    const double first = SearchDirections(parting.pair, parting.pair.hope, nullptr, cells, heap);
    EXPECT_EQ(cells, 1000 - kFirstCells);
    cells = 1000;
    const double all = SearchDirections(parting.pair, 0.0, nullptr, cells, heap);
    EXPECT_GE(all, first);
    went_on += cells < 1000 - kFirstCells;
  }
  EXPECT_GT(searched, 20);
  EXPECT_GT(2 * went_on, searched);
}

TEST_F(LowerBoundPairContractTest, WhatIsProvenWhenTheTimeIsOverHolds) {
  Random rng(10);
  const auto now = BudgetMeter::Clock::now();
  BudgetMeter late, early, endless;
  late.Begin({.seconds = 100.0}, now - std::chrono::seconds(26), 0);
  early.Begin({.seconds = 1e6}, now - std::chrono::seconds(24), 0);
  EXPECT_TRUE(BoundIsLate(&late));
  EXPECT_FALSE(BoundIsLate(&early));
  EXPECT_FALSE(BoundIsLate(&endless));
  EXPECT_FALSE(BoundIsLate(nullptr));
  std::vector<DirectionCell> heap;
  for (int trial = 0; trial < 60; ++trial) {
    Parting parting = RandomParting(kAllMoves, rng);
    parting.pair.hope = parting.pair.RootFor(parting.n_W, 0.0);
    int cells = 300;
    EXPECT_EQ(SearchDirections(parting.pair, 0.0, &late, cells, heap), 0.0);
    EXPECT_EQ(cells, 300);
    const double in_time = SearchDirections(parting.pair, 0.0, &early, cells, heap);
    cells = 300;
    EXPECT_EQ(in_time, SearchDirections(parting.pair, 0.0, nullptr, cells, heap));
    const Parting plane(mjGEOM_PLANE, mjGEOM_MESH, kAllMoves, true, 0.0, rng);
    EXPECT_LE(plane.pair.RootForPlane(&late), plane.pair.RootForPlane(&early));
    EXPECT_EQ(plane.pair.RootForPlane(&early), plane.pair.RootForPlane(nullptr));
  }
}

// No motion at all is no way out; a plane that cannot be left is bound by a number all the same.
TEST_F(LowerBoundPairContractTest, WhatNothingMovesIsNeverParted) {
  Random rng(11);
  Parting parting(mjGEOM_PLANE, mjGEOM_BOX, kAllMoves, true, 0.0, rng);
  const Vector3d n = parting.pair.geom[0].R.col(2), along = n.unitOrthogonal();
  Mover mover;
  mover.T = along * along.transpose();
  mover.slide = 1.0;
  parting.pool = {mover};
  parting.pair.first = {0, 0, 1};
  parting.pair.required = 1.0;
  const double root = parting.pair.RootForPlane(nullptr);
  EXPECT_TRUE(std::isfinite(root));
  EXPECT_GE(root, 0.0);
  parting.pair.first = {0, 0, 0};
  EXPECT_EQ(parting.pair.RootForPlane(nullptr), 0.0);
  parting.pair.first = {0, 0, 1};
  parting.pair.geom[0] = parting.geoms.Filled(1);
  EXPECT_GT(parting.pair.RootFor(n, 0.0), 1e6);
  parting.pair.first = {0, 0, 0};
  EXPECT_EQ(parting.pair.RootFor(n, 0.0), kInfinity);
  EXPECT_EQ(parting.pair.MomentArmS(0.25), 0.25);
}

}  // namespace
}  // namespace mjcf_pdg::test
