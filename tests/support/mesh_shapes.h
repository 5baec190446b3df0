// Triangle meshes with known answers, and their MJCF.
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
  MeshShape& Append(const MeshShape& other);  // both in one mesh
  MeshShape& TurnInsideOut();
  MeshShape& Move(const Eigen::Matrix3d& R, const Eigen::Vector3d& t);
};

// A closed surface over the torus (u, v) in [0, 1)².
MeshShape TorusSurface(int nu, int nv, const std::function<Eigen::Vector3d(double, double)>& point);
// About the z axis: circles of radius `tube` about a circle of radius `ring`.
MeshShape Torus(double ring, double tube, int nu, int nv);
MeshShape TorusKnot(double size, double tube, int nu, int nv);
// A sphere of radius r(direction); latitude rings between two poles.
MeshShape Globe(int rings, int sectors, const std::function<double(const Eigen::Vector3d&)>& r);
MeshShape BoxMesh(const Eigen::Vector3d& half);
// A solid of revolution about z: the closed polygon `profile` of (radius, z), counterclockwise,
// with no point on the axis.
MeshShape Revolution(const std::vector<Eigen::Vector2d>& profile, int sectors);
// A cup standing on z = 0, open above: outer radius and height, wall thickness.
MeshShape Cup(double radius, double height, double wall, int sectors);

// <mesh name='...' vertex='...' face='...' attributes/>
std::string MeshXml(const std::string& name, const MeshShape& shape,
                    const std::string& attributes = {});

// A free body b1 with the geom g1 of these attributes and the body b2 with the mesh geom g2, fixed.
std::string MeshSceneXml(const MeshShape& fixed, const std::string& moving_geom,
                         const std::string& assets = {});
SceneOptions Exact();
// The same, meshes exact; `moving` is the asset of that name.
Scene MeshScene(const MeshShape& fixed, const std::string& moving_geom,
                const MeshShape& moving = BoxMesh({0.01, 0.01, 0.01}));

// qpos of a scene's only free joint.
std::vector<double> FreePose(const Eigen::Vector3d& p,
                             const Eigen::Quaterniond& turn = {1, 0, 0, 0});

// Is x inside the closed mesh: by the sum of the solid angles of its triangles. Slow.
bool InsideBySolidAngle(const MeshShape& shape, const Eigen::Vector3d& x);

}  // namespace mjcf_pdg::test

#endif  // MJCF_PDG_TESTS_SUPPORT_MESH_SHAPES_H_
