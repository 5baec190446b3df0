// How high a height field reaches below a rectangle, at most: looked up by blocks of cells.
#ifndef MJCF_PDG_SRC_COLLIDE_TERRAIN_HIGHEST_BLOCKS_H_
#define MJCF_PDG_SRC_COLLIDE_TERRAIN_HIGHEST_BLOCKS_H_

#include <Eigen/Dense>
#include <vector>

#include "model/height_field.h"

namespace mjcf_pdg {

// It has a copy of the greatest heights: those of the model may not change. Lengths in m, in the
// frame of the geom.
class HighestBlocks {
 public:
  // `geom` must be a height field.
  HighestBlocks(const mjModel& model, int geom);

  // No point of the surface above the rectangle, its edges included, is higher; -infinity if there
  // is no block.
  double Above(const Eigen::AlignedBox2d& xy) const;
  double highest() const { return most_; }  // of the whole surface

 private:
  double x_begin_ = 0.0, y_begin_ = 0.0;  // where the first block begins
  double per_x_ = 0.0, per_y_ = 0.0;      // blocks per length
  int rows_ = 0, cols_ = 0;               // of blocks
  std::vector<double> highest_;           // rows_ × cols_
  double most_ = 0.0;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_COLLIDE_TERRAIN_HIGHEST_BLOCKS_H_
