// A height field geom as the solid that MuJoCo collides: below every triangle of its surface, two
// per cell of the grid, stands a prism down to a flat base.
//
// Rows of the grid follow y and columns follow x. The diagonal that parts a cell goes from its
// corner of least x and y to the opposite one (MuJoCo 4.0, engine_collision_convex.c; a test
// compares). Lengths in m, in the frame of the geom.
#ifndef MJCF_PDG_SRC_MODEL_HEIGHT_FIELD_H_
#define MJCF_PDG_SRC_MODEL_HEIGHT_FIELD_H_

#include <mujoco/mujoco.h>

#include <Eigen/Dense>
#include <array>

namespace mjcf_pdg {

// Cells [row_begin, row_end) × [col_begin, col_end).
struct CellRange {
  int row_begin = 0, row_end = 0, col_begin = 0, col_end = 0;

  int rows() const { return row_end - row_begin; }
  int cols() const { return col_end - col_begin; }
  bool empty() const { return rows() <= 0 || cols() <= 0; }
};

// A view of the model's arrays. The model must outlive it.
class HeightField {
 public:
  // `geom` must be a height field.
  HeightField(const mjModel& model, int geom);

  // Bounds of the solid.
  Eigen::AlignedBox3d Box() const;
  // The cells that the rectangle meets, its edges included.
  CellRange CellsUnder(const Eigen::AlignedBox2d& xy) const;
  // A point of the surface, a corner of cells.
  Eigen::Vector3d Corner(int row, int col) const { return {X(col), Y(row), Height(row, col)}; }
  double X(int col) const { return col * dx_ - half_size_and_heights_[0]; }
  double Y(int row) const { return row * dy_ - half_size_and_heights_[1]; }
  // z of the highest corner of these cells, of which there must be some.
  double Highest(const CellRange& cells) const;
  double base() const { return -half_size_and_heights_[3]; }  // z of the base
  // The three corners of a cell's triangle, 0 or 1, counter-clockwise seen from above.
  std::array<Eigen::Vector3d, 3> Triangle(int row, int col, int triangle) const;
  double Height(int row, int col) const {  // z of that corner
    return half_size_and_heights_[2] * heights_[row * cols_ + col];
  }
  // Between corners, along x and along y.
  double dx() const { return dx_; }
  double dy() const { return dy_; }

 private:
  const double* half_size_and_heights_;  // half sizes along x and y, largest z, depth of the base
  const float* heights_;                 // rows_ × cols_, shares of the largest z
  int rows_, cols_;                      // of corners
  double dx_, dy_;                       // between corners
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_MODEL_HEIGHT_FIELD_H_
