// Triangle meshes as plain arrays, with welding, local convexity and mass properties.
//
// A triangle's corners run counter-clockwise seen from outside. On a sound closed surface, each
// edge is used once in each direction.
#ifndef MJCF_PDG_SRC_MESH_TRIANGLE_MESH_H_
#define MJCF_PDG_SRC_MESH_TRIANGLE_MESH_H_

#include <Eigen/Dense>
#include <vector>

namespace mjcf_pdg {

struct TriangleMesh {
  Eigen::Matrix3Xd vertices;   // [m]
  Eigen::Matrix3Xi triangles;  // three vertices each: column numbers of `vertices`
};

// Of a solid of density 1. If the triangles face inwards, volume and inertia are negative.
struct SolidProperties {
  double volume = 0.0;                                // [m³]
  Eigen::Vector3d center = Eigen::Vector3d::Zero();   // of mass [m]
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  // rotational, about the centre [m⁵]
};

// The mesh with vertices of equal coordinates merged into one and unused vertices dropped. Vertices
// are ordered by their first use in a triangle.
TriangleMesh WeldVertices(const TriangleMesh& mesh);

// True if a closed mesh has no reflex edge, whether all its triangles face outwards or all inwards.
// An edge counts as reflex only if errors of its corners by `rounding` [m] cannot explain it. False
// if an edge has not exactly two triangles.
bool LocallyConvex(const TriangleMesh& mesh, double rounding);

double SurfaceArea(const TriangleMesh& mesh);  // [m²]

// The properties of the solid that a closed mesh bounds, by signed tetrahedra.
SolidProperties FindSolidProperties(const TriangleMesh& mesh);
// The same for the given triangles. `middle` is the apex of all tetrahedra: a point near the solid,
// since the volumes of tetrahedra from afar would cancel.
SolidProperties FindSolidProperties(const Eigen::Matrix3Xd& vertices,
                                    const Eigen::Matrix3Xi& triangles,
                                    const Eigen::Vector3d& middle);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_MESH_TRIANGLE_MESH_H_
