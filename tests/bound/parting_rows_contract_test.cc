// What parting_rows.h promises of a row, against points that motions carry.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "bound/parting_rows.h"
#include "tests/bound/parting.h"

namespace mjcf_pdg::test {
namespace {

class PartingRowsContractTest : public MujocoTest {};

struct Posed {
  Parting parting;
  PartingRows rows;
  double length;

  Posed(const std::vector<Moves>& kinds, Random& rng)
      : parting(mjGEOM_BOX, mjGEOM_BOX, kinds, false, rng.Uniform(-2.0, 2.0), rng),
        length(parting.scale * std::pow(10.0, rng.Uniform(-2.0, 0.3))) {
    rows.Begin(parting.pool, length, 1);
    std::vector<int> movers(parting.pool.size());
    std::iota(movers.begin(), movers.end(), 0);
    const std::span<const int> all(movers);
    const int split = parting.pair.first[1];
    rows.AddPair(parting.pair, all.subspan(0, split), all.subspan(split));
  }

  // A motion no longer than `length` that turns nothing by more than a half.
  VectorXd Motion(Random& rng) const {
    VectorXd z = rng.Normals(parting.size());
    for (int k = 0; k < z.size(); ++k) z[k] *= rng.Chance(0.5);
    z *= length * rng.Uniform() / std::max(1e-300, z.norm());
    return z * std::min(1.0, 2.0 / std::max(1e-300, MostTurn(z)));
  }
  double Turn(const Limb& limb, const VectorXd& z) const {
    return (limb.turns * z.segment(limb.first, limb.size())).norm();
  }
  double MostTurn(const VectorXd& z) const {
    double most = 0.0;
    for (const Limb& limb : parting.limbs()) most = std::max(most, Turn(limb, z));
    return most;
  }
  // A motion in whitened coordinates; `straight` has turns times the cosines of half their angles.
  VectorXd Whitened(const VectorXd& z, VectorXd& straight) const {
    VectorXd x = z;
    straight = z;
    for (std::size_t k = 0; k < rows.coordinates().size(); ++k) {
      const Coordinates& at = rows.coordinates()[k];
      const Limb& limb = parting.limbs()[k];
      const auto part = z.segment(limb.first, limb.size());
      if (at.turns == 3 && at.slides == 3) {
        x.segment<3>(at.at) = limb.mover.T.llt().matrixL().solve(Vector3d(limb.slides * part));
      }
      if (at.turns == 3) {
        x.segment<3>(at.at + at.slides) =
            limb.mover.C.llt().matrixL().solve(Vector3d(limb.turns * part));
      }
      straight.segment(at.at, at.size()) = x.segment(at.at, at.size());
      const double sine = 0.5 * Turn(limb, z);
      straight.segment(at.at + at.slides, at.turns) *= std::sqrt(std::max(0.0, 1.0 - sine * sine));
    }
    return x;
  }
  // What is left of the overlap of two points along n.
  double Left(const Vector3d& n, const PartingRow& row, const VectorXd& z) const {
    return parting.pair.required +
           n.dot(parting.Carried(0, z) * row.a - parting.Carried(1, z) * row.b);
  }
};

VectorXd Lengths(const PartingRows& rows, const VectorXd& x) {
  VectorXd lengths(rows.coordinates().size());
  for (Eigen::Index k = 0; k < lengths.size(); ++k) {
    lengths[k] = std::sqrt(rows.coordinates()[k].SquaredNorm(x));
  }
  return lengths;
}

// For one kind of movers and one width of caps; says how often the bends were needed.
int ExpectHolds(const std::vector<Moves>& kinds, double widest, int seed) {
  Random rng(seed);
  int bent = 0, motions = 0;
  for (int trial = 0; trial < 300; ++trial) {
    Posed posed(kinds, rng);
    const Parting& parting = posed.parting;
    const Vector3d n = rng.UnitVector();
    const double eps = rng.Uniform(0.0, widest);
    const auto [a, b] = parting.pair.FarthestOver(n, eps);
    const PartingRow row = posed.rows.row(posed.rows.AddRow(0, n, eps, a, b));
    for (int k = 0; k < 60; ++k) {
      const VectorXd z = posed.Motion(rng);
      VectorXd straight;
      const VectorXd x = posed.Whitened(z, straight);
      if (!(x.norm() > 0.0)) continue;
      ++motions;
      const Vector3d aside = n.cross(rng.UnitVector()).normalized();
      const Vector3d n2 = Eigen::AngleAxisd(eps, aside) * n;
      const double left = posed.Left(n2, row, z);
      const double unbent = row.t - posed.rows.Dot(0, row, straight) - row.e * x.norm();
      const double bend = posed.rows.BendAlong(0, row, Lengths(posed.rows, x), x);
      EXPECT_GE(left, unbent - bend - 1e-9 * parting.scale) << "trial " << trial;
      // The bends hold for the whole cap by themselves.
      const PartingRow there = posed.rows.row(posed.rows.AddMiddle(0, n2, a, b));
      const double unbent2 = there.t - posed.rows.Dot(0, there, straight);
      EXPECT_GE(left, unbent2 - bend - 1e-9 * parting.scale) << "trial " << trial;
      bent += left < unbent;
    }
  }
  EXPECT_GT(motions, 5000);
  return bent;
}

TEST_F(PartingRowsContractTest, NoMotionOfSlidesUndoesMore) {
  EXPECT_EQ(ExpectHolds({Moves::kSlide}, 0.6, 1), 0);
}
TEST_F(PartingRowsContractTest, NoMotionOfHingesUndoesMore) {
  EXPECT_GT(ExpectHolds({Moves::kHinge}, 0.0, 2), 1000);
  EXPECT_GT(ExpectHolds({Moves::kHinge}, 0.6, 3), 20);
}
TEST_F(PartingRowsContractTest, NoMotionOfBallsUndoesMore) {
  EXPECT_GT(ExpectHolds({Moves::kBall}, 0.0, 4), 1000);
  EXPECT_GT(ExpectHolds({Moves::kBall}, 0.6, 5), 20);
}
TEST_F(PartingRowsContractTest, NoMotionOfAnyMoversUndoesMore) {
  EXPECT_GT(ExpectHolds({Moves::kSlide, Moves::kHinge, Moves::kBall, Moves::kFree}, 0.0, 6), 1000);
  EXPECT_GT(ExpectHolds({Moves::kSlide, Moves::kHinge, Moves::kBall, Moves::kFree}, 0.6, 7), 20);
}

// Bends of small motions are what is left of the second order, where nothing carries anything.
TEST_F(PartingRowsContractTest, ABendIsWhatIsLeftOfTheSecondOrder) {
  Random rng(8);
  int compared = 0;
  for (int trial = 0; trial < 400; ++trial) {
    Posed posed({Moves::kHinge, Moves::kBall}, rng);
    const Parting& parting = posed.parting;
    if (parting.pair.first[1] > 1 || parting.pool.size() - parting.pair.first[1] > 1) continue;
    const Vector3d n = rng.UnitVector();
    const auto [a, b] = parting.pair.FarthestOver(n, 0.0);
    const PartingRow row = posed.rows.row(posed.rows.AddRow(0, n, 0.0, a, b));
    VectorXd z = posed.Motion(rng), straight;
    if (!(posed.MostTurn(z) > 0.0)) continue;
    z *= 1e-3 / posed.MostTurn(z);
    const VectorXd x = posed.Whitened(z, straight);
    const double second = row.t - posed.rows.Dot(0, row, straight) - posed.Left(n, row, z);
    const double bend = posed.rows.BendAlong(0, row, Lengths(posed.rows, x), x);
    EXPECT_NEAR(bend / parting.scale, second / parting.scale, 1e-9) << "trial " << trial;
    compared += std::abs(bend) > 1e-7 * parting.scale;
  }
  EXPECT_GT(compared, 20);
}

TEST_F(PartingRowsContractTest, ARowThatIsDroppedLeavesTheOthers) {
  Random rng(9);
  Posed posed({Moves::kFree, Moves::kHinge}, rng);
  const auto add = [&](const Vector3d& n) {
    const auto [a, b] = posed.parting.pair.FarthestOver(n, 0.1);
    return posed.rows.AddRow(0, n, 0.1, a, b);
  };
  VectorXd straight;
  const VectorXd x = posed.Whitened(rng.Normals(posed.parting.size()), straight);
  const Vector3d n = rng.UnitVector(), other = rng.UnitVector();
  const int first = add(n);
  add(other);
  posed.rows.DropLast();
  const int again = add(n);
  EXPECT_EQ(posed.rows.num_rows(), 2);
  const PartingRow row1 = posed.rows.row(first), row2 = posed.rows.row(again);
  EXPECT_EQ(posed.rows.Dot(0, row1, x), posed.rows.Dot(0, row2, x));
  const VectorXd lengths = Lengths(posed.rows, x);
  EXPECT_EQ(posed.rows.BendAlong(0, row1, lengths, x), posed.rows.BendAlong(0, row2, lengths, x));
}

}  // namespace
}  // namespace mjcf_pdg::test
