// Signed distance functions f of MuJoCo's convex primitives, and the minimum of f on a triangle:
// the basis of SdfMesh (sdf_mesh.h).
//
// The signed distance of a convex set is a convex function, so that f(y) >= f(x) + ∇f(x)·(y - x):
// this gives certified lower bounds over boxes and triangles. An ellipsoid's nearest surface point
// is found as the root of a function of one variable (Eberly, Distance from a point to an ellipse,
// an ellipsoid, or a hyperellipsoid). Points are in the primitive's own frame; lengths may be in
// any unit, the same for all.
#ifndef MJCF_PDG_SRC_COLLIDE_EXACT_PRIMITIVE_SDF_H_
#define MJCF_PDG_SRC_COLLIDE_EXACT_PRIMITIVE_SDF_H_

#include <Eigen/Dense>

namespace mjcf_pdg {

struct SdfValue {
  double f = 0.0;            // signed distance, negative inside
  Eigen::Vector3d gradient;  // ∇f, unit: the outward normal at the nearest surface point
};

// A plane (it fills the half space z < 0), sphere, capsule, ellipsoid or cylinder.
struct PrimitiveSdf {
  int type = 0;                                    // mjtGeom
  Eigen::Vector3d size = Eigen::Vector3d::Zero();  // as mjModel::geom_size

  SdfValue At(const Eigen::Vector3d& x) const;
  // The support point: the primitive's farthest point along `direction`, a unit vector. Not for
  // planes.
  Eigen::Vector3d Support(const Eigen::Vector3d& direction) const;
  // The radius of the smallest ball about the origin that contains the primitive; infinite for a
  // plane.
  double OuterRadius() const;
};

// The minimum of f on a triangle, and the point x at which it is attained.
struct SdfMinimum {
  double f = 0.0;
  Eigen::Vector3d x;
};

// If the minimum of f on the triangle is below `cutoff`, returns it to within `accuracy`. Otherwise
// f >= cutoff all over the triangle, and f = cutoff is returned.
SdfMinimum MinimumOnTriangle(const PrimitiveSdf& field, const Eigen::Vector3d corners[3],
                             double cutoff, double accuracy);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_COLLIDE_EXACT_PRIMITIVE_SDF_H_
