// Cuts polygons into triangles that leave no crack between neighbouring polygons.
#ifndef MJCF_PDG_SRC_IMPORT_POLYGON_H_
#define MJCF_PDG_SRC_IMPORT_POLYGON_H_

#include <Eigen/Dense>
#include <array>
#include <vector>

namespace mjcf_pdg {

// Returns the n - 2 triangles of a polygon, as indices of its corners (3 × n, n ≥ 3). Ears are cut
// off in the plane with the polygon's mean normal. Each side of the polygon is a side of one
// triangle, even between collinear corners, so that neighbouring polygons still fit. Triangles
// without area are avoided where that is possible. Any input gives n - 2 triangles, also a polygon
// that crosses itself.
std::vector<std::array<int, 3>> CutPolygon(const Eigen::Matrix3Xd& corners);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_IMPORT_POLYGON_H_
