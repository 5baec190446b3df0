#include "optimize/free_factor.h"

#include <algorithm>
#include <cmath>

#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Bodies with three coordinates in a row, and contacts of each with the next: columns of two.
struct Row {
  Row(Random& rng, int bodies) {
    const int body = rng.Index(bodies - 1);
    support = {{3 * body, 3}, {3 * body + 3, 3}};
    column.setZero(3 * bodies);
    column.segment(3 * body, 6) = rng.Normals(6);
  }
  Support support;
  VectorXd column;
};

// Appends `row` as the LCP does.
void Append(const std::vector<Row>& free, const Row& row, FreeFactor& factor) {
  VectorXd forward(free.size());
  for (std::size_t k = 0; k < free.size(); ++k) forward[k] = free[k].column.dot(row.column);
  factor.SolveForward(forward);
  factor.Append(forward, std::sqrt(row.column.squaredNorm() - forward.squaredNorm()));
}

MatrixXd Gram(const std::vector<Row>& rows) {
  const auto f = static_cast<Eigen::Index>(rows.size());
  MatrixXd gram(f, f);
  for (Eigen::Index i = 0; i < f; ++i) {
    for (Eigen::Index j = 0; j < f; ++j) gram(i, j) = rows[i].column.dot(rows[j].column);
  }
  return gram;
}

// Two of a body's three contacts at most, so that the rows are independent.
bool Fits(const std::vector<Row>& free, const Row& row) {
  return std::count_if(free.begin(), free.end(), [&](const Row& other) {
           return other.support.first.begin == row.support.first.begin;
         }) < 2;
}

TEST(FreeFactorTest, SolvesAsADenseFactorizationAnewWhileRowsComeAndGo) {
  Random rng(21);
  FreeFactor factor;
  std::vector<Row> free;
  int removed = 0, solved = 0;
  for (int k = 0; k < 600; ++k) {
    const Row row(rng, 12);
    if (!free.empty() && rng.Chance(0.4)) {
      const int gone = rng.Index(static_cast<int>(free.size()));
      free.erase(free.begin() + gone);
      factor.Remove(gone);
      ++removed;
    } else if (rng.Chance(0.02)) {
      const int kept = static_cast<int>(free.size()) / 2;
      free.erase(free.begin() + kept, free.end());
      factor.Truncate(kept);
    } else if (Fits(free, row)) {
      Append(free, row, factor);
      free.push_back(row);
    }
    ASSERT_EQ(factor.size(), free.size());
    if (free.empty()) continue;
    const MatrixXd gram = Gram(free);
    VectorXd rhs = rng.Normals(factor.size());
    rhs.head(rng.Index(factor.size())).setZero();
    VectorXd x = rhs;
    factor.SolveForward(x);
    EXPECT_NEAR(x.squaredNorm(), rhs.dot(gram.ldlt().solve(rhs)), 1e-7 * x.squaredNorm());
    factor.SolveBackward(x);
    EXPECT_LT((gram * x - rhs).norm(), 1e-9 * (1.0 + gram.norm() * x.norm()));
    ++solved;
  }
  EXPECT_GT(removed, 100);
  EXPECT_GT(solved, 500);
}

TEST(FreeFactorTest, NeighboursComeSoonAfterEachOther) {
  Random rng(22);
  for (int trial = 0; trial < 20; ++trial) {
    constexpr int kBodies = 40;
    std::vector<Support> supports;
    std::vector<int> rows;
    for (int body = 0; body + 1 < kBodies; ++body) {
      supports.push_back({{3 * body, 3}, {3 * body + 3, 3}});
      rows.push_back(body);
    }
    for (int i = kBodies - 2; i > 0; --i) std::swap(rows[i], rows[rng.Index(i + 1)]);
    const std::vector<int> before = rows;
    OrderByNeighbours(supports, rows);
    EXPECT_TRUE(std::is_permutation(rows.begin(), rows.end(), before.begin()));
    for (int i = 1; i < kBodies - 1; ++i) {  // from one end of the row of bodies to the other
      EXPECT_EQ(std::abs(rows[i] - rows[i - 1]), 1);
    }
    rows = before;
    OrderByNeighbours({}, rows);
    EXPECT_EQ(rows, before);
  }
}

}  // namespace
}  // namespace mjcf_pdg::test
