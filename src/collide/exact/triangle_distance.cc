#include "collide/exact/triangle_distance.h"

#include <fcl/narrowphase/detail/primitive_shape_algorithm/triangle_distance.h>

namespace mjcf_pdg {

double TriangleDistance(const Eigen::Vector3d a[3], const Eigen::Vector3d b[3],
                        Eigen::Vector3d& on_a, Eigen::Vector3d& on_b) {
  return fcl::detail::TriangleDistance<double>::triDistance(a, b, on_a, on_b);
}

}  // namespace mjcf_pdg
