// Convex geoms and their Minkowski difference, as the verifier sees them.
//
// Source: support functions of convex sets (Rockafellar 1970, §13); van den Bergen 2003, ch. 4.
//
// A shape is the Minkowski sum of a core and a ball about the origin. The core is a point for a
// sphere, a segment for a capsule, and the shape itself (with a ball of radius 0) for all others. A
// pair is treated in the frame of its first shape, so that coordinates are no larger than the
// shapes and their distance, wherever in the world they are.
#ifndef MJCF_PDG_SRC_VERIFY_CONVEX_CONVEX_SHAPE_H_
#define MJCF_PDG_SRC_VERIFY_CONVEX_CONVEX_SHAPE_H_

#include <mujoco/mujoco.h>

#include <Eigen/Dense>
#include <array>
#include <memory>

#include "verify/convex/vertex_tree.h"

namespace mjcf_pdg::verify {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// A sphere, capsule, ellipsoid, cylinder, box, the convex hull of a mesh's vertices, in the geom
// frame, or one prism of a height field.
struct ConvexShape {
  int type = mjGEOM_SPHERE;                              // mjtGeom
  Vector3d size = Vector3d::Zero();                      // of the core, as in geom_size [m]
  double radius = 0.0;                                   // of the ball around the core [m]
  double extent = 0.0;                                   // largest distance from the origin [m]
  std::shared_ptr<const VertexTree> vertices = nullptr;  // of a mesh; else null
  const std::array<Vector3d, 6>* prism = nullptr;        // corners, of a height field; else null

  // Support function: a point of the core that is farthest along n, which need not be a unit vector
  // but must not be zero.
  Vector3d Support(const Vector3d& n) const;
};

// A point p = b - a of the Minkowski difference of two cores: a is of the first, b of the second.
struct DifferencePoint {
  Vector3d a, b, p;
};

// Two posed shapes: in the frame of the first, the second has the origin `between` [m] and the
// rotation `turn`. The shapes must outlive the pair.
struct ConvexPair {
  const ConvexShape& first;
  const ConvexShape& second;
  Matrix3d turn;
  Vector3d between;

  double radii() const { return first.radius + second.radius; }
  // The length that tolerances and rounding errors of the pair are given relative to [m].
  double size() const { return first.extent + second.extent; }

  // The point of the cores' difference with the least n · p, which is CoreGap(n): along the unit
  // vector n, from the first shape to the second, the cores are that far apart (negative: they
  // overlap).
  DifferencePoint Support(const Vector3d& n) const {
    DifferencePoint point;
    point.a = first.Support(n);
    point.b = between + turn * second.Support(-(turn.transpose() * n));
    point.p = point.b - point.a;
    return point;
  }
  double CoreGap(const Vector3d& n) const { return n.dot(Support(n).p); }
};

}  // namespace mjcf_pdg::verify

#endif  // MJCF_PDG_SRC_VERIFY_CONVEX_CONVEX_SHAPE_H_
