// What height_field.h promises, against the field that was written and MuJoCo's own collisions.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "model/height_field.h"
#include "tests/support/terrain.h"

namespace mjcf_pdg::test {
namespace {

using Eigen::AlignedBox2d;
using Eigen::Vector2d;
using Eigen::Vector3d;

class HeightFieldContractTest : public MujocoTest {};

struct Written {
  Written(int rows, int cols, double scale, Random& rng)
      : field(NoisyField(rows, cols, scale * rng.Uniform(0.5, 2.0), scale * rng.Uniform(0.5, 2.0),
                         scale * rng.Uniform(0.1, 1.0), rng)) {
    field.base = scale * rng.Uniform(0.05, 0.5);
    field.pose = "pos='1 2 3' quat='.5 .1 .7 -.3'";
    model = LoadModel(
        FieldXml(field, {.size = Vector3d::Constant(0.1 * scale), .attributes = "mass='1'"}));
  }
  HeightField Read() const {
    return HeightField(*model, mj_name2id(model.get(), mjOBJ_GEOM, "field"));
  }

  Field field;
  ModelPtr model;
};

TEST_F(HeightFieldContractTest, CornersBaseAndBoxAreThoseOfTheFieldWhateverItsSize) {
  Random rng(1);
  for (int trial = 0; trial < 40; ++trial) {
    const double scale = std::pow(10.0, rng.Uniform(-3.0, 3.0));
    const Written written(2 + rng.Index(6), 2 + rng.Index(6), scale, rng);
    const Field& field = written.field;
    const HeightField read = written.Read();
    EXPECT_NEAR(read.base(), -field.base, 1e-12 * scale);
    EXPECT_NEAR(read.dx() * (field.cols - 1), 2.0 * field.half_x, 1e-12 * scale);
    EXPECT_NEAR(read.dy() * (field.rows - 1), 2.0 * field.half_y, 1e-12 * scale);
    Eigen::AlignedBox3d box(Vector3d(0.0, 0.0, -field.base));
    for (int row = 0; row < field.rows; ++row) {
      for (int col = 0; col < field.cols; ++col) {
        const Vector3d corner = field.Corner(row, col);
        box.extend(corner);
        EXPECT_LT((read.Corner(row, col) - corner).norm(), 1e-6 * scale);
        EXPECT_EQ(read.Height(row, col), read.Corner(row, col).z());
        EXPECT_LE((read.Corner(row, col) - read.Box().max()).maxCoeff(), 1e-12 * scale);
        EXPECT_GE((read.Corner(row, col) - read.Box().min()).minCoeff(), -1e-12 * scale);
      }
    }
    EXPECT_LT((read.Box().min() - box.min()).norm(), 1e-6 * scale);
    EXPECT_LT((read.Box().max() - box.max()).norm(), 1e-6 * scale);
  }
}

TEST_F(HeightFieldContractTest, TheTrianglesOfACellTileItUpwardAndShareTheRisingDiagonal) {
  Random rng(2);
  const Written written(5, 4, 1.0, rng);
  const HeightField read = written.Read();
  for (int row = 0; row + 1 < written.field.rows; ++row) {
    for (int col = 0; col + 1 < written.field.cols; ++col) {
      const Vector3d low = read.Corner(row, col), high = read.Corner(row + 1, col + 1);
      double area = 0.0;
      std::vector<Vector3d> others;
      for (const int k : {0, 1}) {
        const std::array<Vector3d, 3> t = read.Triangle(row, col, k);
        const double twice = (t[1] - t[0]).cross(t[2] - t[0]).z();
        EXPECT_GT(twice, 0.0) << "counter-clockwise";
        area += 0.5 * twice;
        EXPECT_EQ(std::count(t.begin(), t.end(), low), 1);
        EXPECT_EQ(std::count(t.begin(), t.end(), high), 1);
        for (const Vector3d& p : t) {
          if (p != low && p != high) others.push_back(p);
        }
      }
      EXPECT_NEAR(area, read.dx() * read.dy(), 1e-12);
      ASSERT_EQ(others.size(), 2u);
      EXPECT_TRUE(std::count(others.begin(), others.end(), read.Corner(row, col + 1)) == 1 &&
                  std::count(others.begin(), others.end(), read.Corner(row + 1, col)) == 1);
    }
  }
}

// The z of the surface over a point of a cell, by the triangles.
double SurfaceAt(const HeightField& field, int row, int col, const Vector2d& xy) {
  for (const int k : {0, 1}) {
    const std::array<Vector3d, 3> t = field.Triangle(row, col, k);
    Eigen::Matrix2d edges;
    edges << (t[1] - t[0]).head<2>(), (t[2] - t[0]).head<2>();
    const Vector2d s = edges.inverse() * (xy - t[0].head<2>());
    if (s.minCoeff() < -1e-9 || s.sum() > 1.0 + 1e-9) continue;
    return t[0].z() + s[0] * (t[1] - t[0]).z() + s[1] * (t[2] - t[0]).z();
  }
  ADD_FAILURE() << "no triangle";
  return 0.0;
}

// A small ball just below the surface collides in MuJoCo, one just above does not.
TEST_F(HeightFieldContractTest, TheSurfaceIsTheOneThatMuJoCoCollides) {
  Random rng(3);
  Field flat = NoisyField(6, 5, 1.0, 1.0, 0.2, rng);
  flat.base = 0.3;
  const ModelPtr model =
      LoadModel(FieldXml(flat, {.size = Vector3d::Constant(1e-3), .attributes = "mass='1'"}));
  const DataPtr data(mj_makeData(model.get()));
  const HeightField read(*model, mj_name2id(model.get(), mjOBJ_GEOM, "field"));
  int telling = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const int row = rng.Index(5), col = rng.Index(4);
    const Vector3d low = read.Corner(row, col);
    const double u = rng.Uniform(0.1, 0.9), v = rng.Uniform(0.1, 0.9);
    const Vector2d xy = low.head<2>() + Vector2d(u * read.dx(), v * read.dy());
    const double z = SurfaceAt(read, row, col, xy);
    // By the other diagonal.
    const double h10 = read.Height(row, col + 1), h01 = read.Height(row + 1, col),
                 h11 = read.Height(row + 1, col + 1), h00 = low.z();
    const double other = u + v < 1.0 ? h00 + u * (h10 - h00) + v * (h01 - h00)
                                     : h11 + (1 - u) * (h01 - h11) + (1 - v) * (h10 - h11);
    telling += std::abs(other - z) > 0.02;
    for (const double side : {-0.01, 0.01}) {
      const double q[] = {xy.x(), xy.y(), z + side, 1, 0, 0, 0};
      std::copy(q, q + 7, data->qpos);
      mj_kinematics(model.get(), data.get());
      mj_collision(model.get(), data.get());
      EXPECT_EQ(data->ncon > 0, side < 0.0) << row << " " << col << " " << u << " " << v;
    }
  }
  EXPECT_GT(telling, 100);
}

// ---- Cells under a rectangle ----

// Half sizes and counts for which all coordinates of corners are exact.
ModelPtr ExactField(int rows, int cols, double scale, Random& rng) {
  Field field = NoisyField(rows, cols, scale, 2.0 * scale, scale, rng);
  return LoadModel(
      FieldXml(field, {.size = Vector3d::Constant(0.1 * scale), .attributes = "mass='1'"}));
}

bool Meets(const AlignedBox2d& xy, const Vector3d& low, const Vector3d& high) {
  return xy.min().x() <= high.x() && xy.max().x() >= low.x() && xy.min().y() <= high.y() &&
         xy.max().y() >= low.y();
}

TEST_F(HeightFieldContractTest, TheCellsUnderARectangleAreThoseItMeetsWithItsEdges) {
  Random rng(4);
  int none = 0, some = 0, on_edges = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const int rows = (1 << rng.Index(4)) + 1, cols = (1 << rng.Index(4)) + 1;
    const double scale = std::pow(2.0, -10 + rng.Index(21));
    static ModelPtr model;
    if (trial % 50 == 0) model = ExactField(rows, cols, scale, rng);
    const HeightField read(*model, mj_name2id(model.get(), mjOBJ_GEOM, "field"));
    const Vector3d half = read.Box().max();
    const int field = model->geom_dataid[1];
    const int nrow = model->hfield_nrow[field], ncol = model->hfield_ncol[field];
    const auto coordinate = [&](double extent, double step) {
      const double x = rng.Uniform(-1.3, 1.3) * extent;
      if (rng.Chance(0.5)) return x;
      ++on_edges;
      return std::round((x + extent) / step) * step - extent;
    };
    AlignedBox2d xy;
    for (int k = 0; k < 2; ++k) {
      const double x = coordinate(half.x(), read.dx()), y = coordinate(half.y(), read.dy());
      if (k == 0 || rng.Chance(0.8)) xy.extend(Vector2d(x, y));
    }
    const CellRange range = read.CellsUnder(xy);
    int met = 0;
    for (int row = 0; row + 1 < nrow; ++row) {
      for (int col = 0; col + 1 < ncol; ++col) {
        const bool meets = Meets(xy, read.Corner(row, col), read.Corner(row + 1, col + 1));
        const bool within = row >= range.row_begin && row < range.row_end &&
                            col >= range.col_begin && col < range.col_end;
        EXPECT_EQ(within, meets) << "trial " << trial << " cell " << row << " " << col;
        met += meets;
      }
    }
    EXPECT_EQ(range.empty(), met == 0);
    EXPECT_EQ(std::max(0, range.rows()) * std::max(0, range.cols()), met);
    ++(met > 0 ? some : none);
  }
  EXPECT_GT(none, 100);
  EXPECT_GT(some, 500);
  EXPECT_GT(on_edges, 500);
}

// Where corners are rounded, a rectangle in the middle of a cell is, and ends of the world are.
TEST_F(HeightFieldContractTest, CellsUnderPointsNothingAndEverything) {
  Random rng(5);
  for (int trial = 0; trial < 40; ++trial) {
    const double scale = std::pow(10.0, rng.Uniform(-3.0, 3.0));
    const Written written(2 + rng.Index(9), 2 + rng.Index(9), scale, rng);
    const HeightField read = written.Read();
    const int rows = written.field.rows - 1, cols = written.field.cols - 1;
    const int row = rng.Index(rows), col = rng.Index(cols);
    const Vector2d at =
        read.Corner(row, col).head<2>() +
        Vector2d(rng.Uniform(0.01, 0.99) * read.dx(), rng.Uniform(0.01, 0.99) * read.dy());
    const CellRange one = read.CellsUnder(AlignedBox2d(at));
    EXPECT_EQ(one.row_begin, row);
    EXPECT_EQ(one.row_end, row + 1);
    EXPECT_EQ(one.col_begin, col);
    EXPECT_EQ(one.col_end, col + 1);
    EXPECT_TRUE(read.CellsUnder(AlignedBox2d()).empty());
    const double infinity = std::numeric_limits<double>::infinity();
    const CellRange all =
        read.CellsUnder(AlignedBox2d(Vector2d::Constant(-infinity), Vector2d::Constant(infinity)));
    EXPECT_EQ(all.rows(), rows);
    EXPECT_EQ(all.cols(), cols);
  }
}

}  // namespace
}  // namespace mjcf_pdg::test
