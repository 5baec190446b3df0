// Polygons cut into triangles so that no crack is left between neighbours.
#ifndef MJCF_PDG_SRC_IMPORT_POLYGON_H_
#define MJCF_PDG_SRC_IMPORT_POLYGON_H_

#include <Eigen/Dense>
#include <array>
#include <vector>

namespace mjcf_pdg {

// The triangles of a polygon, two fewer than it has corners (3 × n, n ≥ 3), by cutting off ears in
// the plane that fits it best. Each side of the polygon is a side of one of them, whatever the
// corners are, collinear ones included: what meets the polygon there still fits. Where corners are
// collinear, triangles without area are avoided if possible.
std::vector<std::array<int, 3>> CutPolygon(const Eigen::Matrix3Xd& corners);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_IMPORT_POLYGON_H_
