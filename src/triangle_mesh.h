// Triangle meshes as plain arrays: flaws, their repair, closedness, mass properties.
//
// A triangle's corners run counter-clockwise seen from outside. An edge of a sound closed surface
// is used once in each direction.
#ifndef MJCF_PDG_SRC_TRIANGLE_MESH_H_
#define MJCF_PDG_SRC_TRIANGLE_MESH_H_

#include <Eigen/Dense>
#include <vector>

namespace mjcf_pdg {

struct TriangleMesh {
  Eigen::Matrix3Xd vertices;   // [m]
  Eigen::Matrix3Xi triangles;  // columns of `vertices`
};

// What RepairMesh found. Counts are of triangles unless said otherwise.
struct MeshRepairs {
  int repeated_corners = 0;    // two corners are one vertex: removed
  int duplicates = 0;          // has the corners of an earlier triangle, in any order: removed
  int non_manifold_edges = 0;  // edges of more than two triangles: the surface is cut apart there
  int turned = 0;              // turned over to agree with their neighbours
  int inward_components = 0;   // closed components that were inside out: turned over
};

struct MeshTopology {
  int components = 0;
  int open_edges = 0;         // not used once in each direction; 0: the surface is closed
  int zero_area = 0;          // triangles with collinear corners, which may be needed to close it
  int nested_components = 0;  // inside another one without being its cavity: counted twice
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

// The mesh of a welded one in which nothing that can be repaired unambiguously is left: see
// MeshRepairs. Of each component the majority of the triangles keeps its orientation, unless it is
// closed: then outer surfaces face outwards and cavities inwards (a component in an odd number of
// others that already faces inwards is a cavity). Vertices where the surface is cut apart are
// repeated, so the result must not be welded again.
TriangleMesh RepairMesh(const TriangleMesh& welded, MeshRepairs* repairs);

// Of a repaired mesh; components are connected by edges of two triangles.
MeshTopology FindTopology(const TriangleMesh& mesh);

// No edge of a closed mesh is reflex by more than corners that are off by `rounding` [m] can make
// it, facing outwards or inwards as a whole.
bool LocallyConvex(const TriangleMesh& mesh, double rounding);

double SurfaceArea(const TriangleMesh& mesh);  // [m²]

// Of the solid that a closed mesh bounds, by signed tetrahedra; negative if it faces inwards.
SolidProperties FindSolidProperties(const TriangleMesh& mesh);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_TRIANGLE_MESH_H_
