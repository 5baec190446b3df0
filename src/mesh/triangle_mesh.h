// Triangle meshes as plain arrays: welding, convexity, mass properties.
//
// A triangle's corners run counter-clockwise seen from outside. An edge of a sound closed surface
// is used once in each direction.
#ifndef MJCF_PDG_SRC_MESH_TRIANGLE_MESH_H_
#define MJCF_PDG_SRC_MESH_TRIANGLE_MESH_H_

#include <Eigen/Dense>
#include <vector>

namespace mjcf_pdg {

struct TriangleMesh {
  Eigen::Matrix3Xd vertices;   // [m]
  Eigen::Matrix3Xi triangles;  // columns of `vertices`
};

// Volume [m³], centre [m] and, about the centre and for density 1, rotational inertia [m⁵].
struct SolidProperties {
  double volume = 0.0;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
};

// Vertices with equal coordinates become one; those of no triangle are dropped. The order of first
// use by a triangle is the new order.
TriangleMesh WeldVertices(const TriangleMesh& mesh);

// No edge of a closed mesh is reflex by more than corners that are off by `rounding` [m] can make
// it, facing outwards or inwards as a whole.
bool LocallyConvex(const TriangleMesh& mesh, double rounding);

double SurfaceArea(const TriangleMesh& mesh);  // [m²]

// Of the solid that a closed mesh bounds, by signed tetrahedra; negative if it faces inwards.
SolidProperties FindSolidProperties(const TriangleMesh& mesh);
// The same of some triangles; `middle` is a point near them: far from it the tetrahedra cancel.
SolidProperties FindSolidProperties(const Eigen::Matrix3Xd& vertices,
                                    const Eigen::Matrix3Xi& triangles,
                                    const Eigen::Vector3d& middle);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_MESH_TRIANGLE_MESH_H_
