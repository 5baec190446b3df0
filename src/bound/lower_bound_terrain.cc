#include "bound/lower_bound_terrain.h"

#include <algorithm>
#include <limits>

#include "model/height_field.h"

namespace mjcf_pdg {
namespace {

using Eigen::Vector2d;

// Half the width of a rectangle [depth]. With 1 alone √bound is up to 12 % lower on the stairs,
// waves and noise of bench/terrain_bench, with 0.25 or 16 in addition at most 0.3 % higher.
constexpr double kWidths[] = {0.5, 1.0, 2.0, 4.0, 8.0};
// Larger rectangles are passed over, since each corner below one is looked at [cells].
constexpr int kMostCells = 4096;
// The slope of a top follows a normal that is no flatter than this [cosine].
constexpr double kFlattest = 0.2;

// The mean slope of the surface over the cells, from one side to the other.
Vector2d MeanSlope(const HeightField& field, const CellRange& cells) {
  Vector2d rise = Vector2d::Zero();
  for (int row = cells.row_begin; row <= cells.row_end; ++row) {
    rise.x() += field.Corner(row, cells.col_end).z() - field.Corner(row, cells.col_begin).z();
  }
  for (int col = cells.col_begin; col <= cells.col_end; ++col) {
    rise.y() += field.Corner(cells.row_end, col).z() - field.Corner(cells.row_begin, col).z();
  }
  const Vector2d run =
      (field.Corner(cells.row_end, cells.col_end) - field.Corner(cells.row_begin, cells.col_begin))
          .head<2>();
  return {rise.x() / (run.x() * (cells.rows() + 1)), rise.y() / (run.y() * (cells.cols() + 1))};
}

// The height at the origin of the highest plane of that slope that is nowhere above the surface.
double Highest(const HeightField& field, const CellRange& cells, const Vector2d& slope) {
  double height = std::numeric_limits<double>::infinity();
  for (int row = cells.row_begin; row <= cells.row_end; ++row) {
    for (int col = cells.col_begin; col <= cells.col_end; ++col) {
      const Vector3d corner = field.Corner(row, col);
      height = std::min(height, corner.z() - slope.dot(corner.head<2>()));
    }
  }
  return height;
}

// In the frame of the field. Returns false if the top is not above the base all over.
bool Fill(const HeightField& field, const CellRange& cells, const Vector2d& slope,
          InscribedSolid& solid) {
  const double height = Highest(field, cells, slope);
  for (int k = 0; k < 4; ++k) {
    const Vector3d corner = field.Corner(k & 1 ? cells.row_end : cells.row_begin,
                                         k & 2 ? cells.col_end : cells.col_begin);
    const double top = height + slope.dot(corner.head<2>());
    if (!(top > field.base())) return false;
    solid.corners_W[2 * k] = {corner.x(), corner.y(), top};
    solid.corners_W[2 * k + 1] = {corner.x(), corner.y(), field.base()};
  }
  solid.up_W = Vector3d(-slope.x(), -slope.y(), 1.0).normalized();
  return true;
}

}  // namespace

void FindInscribed(const PosedModel& posed, int field_geom, const NearPair& near, double deep,
                   std::vector<InscribedSolid>& solids) {
  solids.clear();
  const HeightField field(*posed.model(), field_geom);
  const Vector3d x_W = AsVector(posed.data()->geom_xpos + 3 * field_geom);
  const Matrix3d R = AsMatrix(posed.data()->geom_xmat + 9 * field_geom);
  const Vector2d at = (R.transpose() * (near.p2_W - x_W)).head<2>();
  const Vector3d n = R.transpose() * near.n_W;
  for (const double width : kWidths) {
    const Vector2d half = Vector2d::Constant(width * deep);
    const CellRange cells = field.CellsUnder({Vector2d(at - half), Vector2d(at + half)});
    if (cells.empty() || cells.rows() > kMostCells / cells.cols()) continue;
    std::array<Vector2d, 3> slopes = {Vector2d::Zero(), MeanSlope(field, cells), {}};
    int count = 2;
    if (n.z() > kFlattest) slopes[count++] = -n.head<2>() / n.z();
    for (int k = 0; k < count; ++k) {
      InscribedSolid solid;
      if (!Fill(field, cells, slopes[k], solid)) continue;
      for (Vector3d& corner : solid.corners_W) corner = x_W + R * corner;
      solid.up_W = R * solid.up_W;
      solids.push_back(solid);
    }
  }
}

}  // namespace mjcf_pdg
