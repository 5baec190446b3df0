// Closed triangle meshes that are easy to describe, and MJCF scenes with them.
#ifndef MJCF_PDG_TESTS_SUPPORT_MESH_SHAPES_H_
#define MJCF_PDG_TESTS_SUPPORT_MESH_SHAPES_H_

#include <Eigen/Dense>
#include <functional>
#include <string>
#include <vector>

#include "mjcf_pdg/scene.h"

namespace mjcf_pdg::test {

struct MeshShape {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Eigen::Vector3i> faces;  // outward by the right-hand rule

  Eigen::Matrix3Xd Vertices() const;
  Eigen::Matrix3Xi Faces() const;
  // Each changes the shape and returns it.
  MeshShape& Append(const MeshShape& other);  // adds the other's vertices and faces
  MeshShape& TurnInsideOut();
  MeshShape& Move(const Eigen::Matrix3d& R, const Eigen::Vector3d& t);
};

// The closed surface of the points point(u, v) for (u, v) in [0, 1)², periodic in both, with nu ×
// nv vertices.
MeshShape TorusSurface(int nu, int nv, const std::function<Eigen::Vector3d(double, double)>& point);
// A torus about the z axis: a tube of radius `tube` around a circle of radius `ring`.
MeshShape Torus(double ring, double tube, int nu, int nv);
// A tube of radius `tube` around a torus knot that winds twice around z and three times around the
// ring.
MeshShape TorusKnot(double size, double tube, int nu, int nv);
// The surface at the distance r(d) from the origin in each unit direction d: two poles, and `rings`
// - 1 circles of latitude between them.
MeshShape Globe(int rings, int sectors, const std::function<double(const Eigen::Vector3d&)>& r);
// A box with these half-sizes.
MeshShape BoxMesh(const Eigen::Vector3d& half);
// A solid of revolution about z: the closed polygon `profile` of (radius, z), counterclockwise,
// with no point on the axis.
MeshShape Revolution(const std::vector<Eigen::Vector2d>& profile, int sectors);
// A cup that stands on z = 0 and is open at the top, with this outer radius and height; `wall` is
// the thickness of wall and floor.
MeshShape Cup(double radius, double height, double wall, int sectors);

// <mesh name='...' vertex='...' face='...' attributes/>
std::string MeshXml(const std::string& name, const MeshShape& shape,
                    const std::string& attributes = {});

// A scene with a free body b1, whose geom g1 has the attributes `moving_geom`, and a fixed body b2,
// whose geom g2 is the mesh. `assets` is more XML of <asset>.
std::string MeshSceneXml(const MeshShape& fixed, const std::string& moving_geom,
                         const std::string& assets = {});
SceneOptions Exact();  // options with exact_mesh on
// That scene with meshes as their triangles, where the asset "moving" is the mesh `moving`.
Scene MeshScene(const MeshShape& fixed, const std::string& moving_geom,
                const MeshShape& moving = BoxMesh({0.01, 0.01, 0.01}));

// The configuration of a scene whose only joint is free.
std::vector<double> FreePose(const Eigen::Vector3d& p,
                             const Eigen::Quaterniond& turn = {1, 0, 0, 0});

// True if x is inside the closed mesh, by the sum of the solid angles of its triangles. Slow.
bool InsideBySolidAngle(const MeshShape& shape, const Eigen::Vector3d& x);

}  // namespace mjcf_pdg::test

#endif  // MJCF_PDG_TESTS_SUPPORT_MESH_SHAPES_H_
