// Signed distance functions of MuJoCo's smooth primitives, and their least value on a triangle.
//
// The signed distance f of a convex set is a convex function of slope 1 outside and at most 1
// inside: f(y) >= f(x) + ∇f(x)·(y - x). That gives certified lower bounds over boxes and triangles.
// Ellipsoid: the nearest point is the root of a function of one variable (Eberly, Distance from a
// point to an ellipse, an ellipsoid, or a hyperellipsoid). The primitive's own frame, any unit of
// length.
#ifndef MJCF_PDG_SRC_COLLIDE_EXACT_PRIMITIVE_SDF_H_
#define MJCF_PDG_SRC_COLLIDE_EXACT_PRIMITIVE_SDF_H_

#include <Eigen/Dense>

namespace mjcf_pdg {

struct SdfValue {
  double f = 0.0;            // signed distance
  Eigen::Vector3d gradient;  // unit: outward normal of the primitive's nearest surface point
};

// Plane (half space z < 0), sphere, capsule, ellipsoid, cylinder.
struct PrimitiveSdf {
  int type = 0;                                    // mjtGeom
  Eigen::Vector3d size = Eigen::Vector3d::Zero();  // MuJoCo's meaning

  SdfValue At(const Eigen::Vector3d& x) const;
  // The primitive's farthest point along a unit vector; not for planes.
  Eigen::Vector3d Support(const Eigen::Vector3d& direction) const;
  // Of a ball about the origin that holds the primitive; infinite for a plane.
  double OuterRadius() const;
};

// Where f is least on a triangle.
struct SdfMinimum {
  double f = 0.0;
  Eigen::Vector3d x;
};

// The minimum to within `accuracy`, if it is below `cutoff`; otherwise f >= cutoff is certain and
// returned as f = cutoff.
SdfMinimum MinimumOnTriangle(const PrimitiveSdf& field, const Eigen::Vector3d corners[3],
                             double cutoff, double accuracy);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_COLLIDE_EXACT_PRIMITIVE_SDF_H_
