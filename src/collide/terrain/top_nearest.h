// The nearest points of a prism's top and the core of a geom above it, in closed form.
//
// They are a guess, cheaper than a search: of a segment or a point it is right unless the
// core reaches below the top; of a box, unless two edges are nearest. The caller proves it by the
// plane between the points, or searches (OnTerrain::Ask).
#ifndef MJCF_PDG_SRC_COLLIDE_TERRAIN_TOP_NEAREST_H_
#define MJCF_PDG_SRC_COLLIDE_TERRAIN_TOP_NEAREST_H_

#include <Eigen/Dense>
#include <array>

namespace mjcf_pdg {

// The top triangle of a prism, counter-clockwise seen from above.
using Triangle = std::array<Eigen::Vector3d, 3>;

struct NearestPoints {
  Eigen::Vector3d p1, p2;  // on the top, on the core
};

// The core is the segment from a to b, which may be one point. Returns false if neither is above
// the plane of the top.
bool NearestOfSegment(const Triangle& top, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                      NearestPoints& nearest);

// If `lowest`, the core's point that is farthest against the normal of the top, is above the top
// itself, the two nearest points are it and the one below. Otherwise returns false.
bool NearestOfFace(const Triangle& top, const Eigen::Vector3d& lowest, NearestPoints& nearest);

// The corner of the top that is nearest to the box, whose axes are columns, and the point of the
// box nearest to it. Returns false if the box contains a corner.
bool NearestOfCorner(const Triangle& top, const Eigen::Vector3d& center,
                     const Eigen::Matrix3d& axes, const Eigen::Vector3d& half,
                     NearestPoints& nearest);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_COLLIDE_TERRAIN_TOP_NEAREST_H_
