#include "model/height_field.h"

#include <algorithm>
#include <cmath>

namespace mjcf_pdg {
namespace {

// The first and the last of `cells` intervals on [-half, half] that [low, high] meets, as a
// half-open range; empty if it meets none.
std::array<int, 2> IntervalsUnder(double low, double high, double half, int cells) {
  if (!(high >= -half && low <= half)) return {0, 0};
  const double width = 2.0 * half / cells;
  // An edge shared by two intervals belongs to both.
  const double first = std::ceil((low + half) / width) - 1.0;
  const double last = std::floor((high + half) / width);
  return {static_cast<int>(std::clamp(first, 0.0, cells - 1.0)),
          static_cast<int>(std::clamp(last, 0.0, cells - 1.0)) + 1};
}

}  // namespace

HeightField::HeightField(const mjModel& model, int geom) {
  const int field = model.geom_dataid[geom];
  half_size_and_heights_ = model.hfield_size + 4 * field;
  heights_ = model.hfield_data + model.hfield_adr[field];
  rows_ = model.hfield_nrow[field];
  cols_ = model.hfield_ncol[field];
  dx_ = 2.0 * half_size_and_heights_[0] / (cols_ - 1);
  dy_ = 2.0 * half_size_and_heights_[1] / (rows_ - 1);
}

Eigen::AlignedBox3d HeightField::Box() const {
  const Eigen::Vector3d half(half_size_and_heights_[0], half_size_and_heights_[1], 0.0);
  return {-half - half_size_and_heights_[3] * Eigen::Vector3d::UnitZ(),
          half + half_size_and_heights_[2] * Eigen::Vector3d::UnitZ()};
}

CellRange HeightField::CellsUnder(const Eigen::AlignedBox2d& xy) const {
  const auto [col_begin, col_end] =
      IntervalsUnder(xy.min().x(), xy.max().x(), half_size_and_heights_[0], cols_ - 1);
  const auto [row_begin, row_end] =
      IntervalsUnder(xy.min().y(), xy.max().y(), half_size_and_heights_[1], rows_ - 1);
  return {row_begin, row_end, col_begin, col_end};
}

double HeightField::Highest(const CellRange& cells) const {
  float even = 0.0F, odd = 0.0F;  // two, so that one comparison need not wait for the other
  for (int row = cells.row_begin; row <= cells.row_end; ++row) {
    const float* heights = heights_ + row * cols_;
    for (int col = cells.col_begin; col < cells.col_end; col += 2) {
      even = std::max(even, heights[col]);
      odd = std::max(odd, heights[col + 1]);
    }
    even = std::max(even, heights[cells.col_end]);
  }
  return half_size_and_heights_[2] * std::max(even, odd);
}

std::array<Eigen::Vector3d, 3> HeightField::Triangle(int row, int col, int triangle) const {
  const Eigen::Vector3d low = Corner(row, col), high = Corner(row + 1, col + 1);
  if (triangle == 0) return {low, Corner(row, col + 1), high};
  return {low, high, Corner(row + 1, col)};
}

}  // namespace mjcf_pdg
