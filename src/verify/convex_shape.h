// Convex geoms and their Minkowski difference, as the independent check sees them.
//
// Source: support functions of convex sets (Rockafellar 1970, §13); van den Bergen 2003, ch. 4.
//
// A shape is a core and a ball that rolls around it: a point for a sphere, a segment for a capsule,
// itself for the others. Everything here is in the frame of the first shape of a pair, so that
// numbers are as large as the shapes and their distance, wherever in the world they are.
#ifndef MJCF_PDG_SRC_VERIFY_CONVEX_SHAPE_H_
#define MJCF_PDG_SRC_VERIFY_CONVEX_SHAPE_H_

#include <mujoco/mujoco.h>

#include <Eigen/Dense>
#include <memory>

#include "verify/vertex_tree.h"

namespace mjcf_pdg::verify {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Sphere, capsule, ellipsoid, cylinder, box or the convex hull of a mesh's vertices; geom frame.
struct ConvexShape {
  int type = mjGEOM_SPHERE;                              // mjtGeom
  Vector3d size = Vector3d::Zero();                      // of the core, MuJoCo's meaning [m]
  double radius = 0.0;                                   // of the ball around the core [m]
  double extent = 0.0;                                   // no point is farther from the origin [m]
  std::shared_ptr<const VertexTree> vertices = nullptr;  // of a mesh

  // A point of the core that is farthest along n (not zero, not necessarily unit).
  Vector3d Support(const Vector3d& n) const;
};

// A point p = b - a of the difference of two cores: a of the first, b of the second.
struct DifferencePoint {
  Vector3d a, b, p;
};

// The second shape is at `between` in the frame of the first, turned by `turn`.
struct ConvexPair {
  const ConvexShape& first;
  const ConvexShape& second;
  Matrix3d turn;
  Vector3d between;

  double radii() const { return first.radius + second.radius; }
  double size() const { return first.extent + second.extent; }  // what lengths are relative to

  // The point of the cores' difference with the least n · p. For a unit vector n from the first
  // shape to the second, that is how far a plane with the normal n keeps the cores apart.
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

#endif  // MJCF_PDG_SRC_VERIFY_CONVEX_SHAPE_H_
