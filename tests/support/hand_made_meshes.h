// Triangle meshes whose volume, area and edges are known, and ways to damage them.
#ifndef MJCF_PDG_TESTS_SUPPORT_HAND_MADE_MESHES_H_
#define MJCF_PDG_TESTS_SUPPORT_HAND_MADE_MESHES_H_

#include <cmath>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "mesh/triangle_mesh.h"

namespace mjcf_pdg::test {

// A box between `low` and `low + size` of 8 vertices and 12 triangles that face outwards.
inline TriangleMesh CuboidMesh(const Eigen::Vector3d& size,
                               const Eigen::Vector3d& low = {0, 0, 0}) {
  TriangleMesh mesh = {Eigen::Matrix3Xd(3, 8), Eigen::Matrix3Xi(3, 12)};
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.col(i) = low + size.cwiseProduct(Eigen::Vector3d(i & 1, i >> 1 & 1, i >> 2 & 1));
  }
  mesh.triangles << 0, 0, 4, 4, 0, 0, 2, 2, 0, 0, 1, 1,  //
      3, 2, 5, 7, 1, 5, 6, 7, 4, 6, 3, 7,                //
      1, 3, 7, 6, 5, 4, 7, 3, 6, 2, 7, 5;
  return mesh;
}

// A unit cube.
inline TriangleMesh CubeMesh(const Eigen::Vector3d& low = {0, 0, 0}) {
  return CuboidMesh(Eigen::Vector3d::Ones(), low);
}

// The corner of the unit cube at the origin: volume 1/6.
inline TriangleMesh TetrahedronMesh() {
  TriangleMesh mesh = {Eigen::Matrix3Xd::Zero(3, 4), Eigen::Matrix3Xi(3, 4)};
  mesh.vertices.rightCols(3).setIdentity();
  mesh.triangles << 0, 0, 0, 1,  //
      2, 1, 3, 2,                //
      1, 3, 2, 3;
  return mesh;
}

// A torus about z of n × n quads, cut into triangles. `ring` is the radius of its circle, `tube`
// that of the tube around it.
inline TriangleMesh TorusMesh(double ring, double tube, int n) {
  TriangleMesh mesh = {Eigen::Matrix3Xd(3, n * n), Eigen::Matrix3Xi(3, 2 * n * n)};
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const double u = 2 * EIGEN_PI * i / n, v = 2 * EIGEN_PI * j / n;
      const double radius = ring + tube * std::cos(v);
      mesh.vertices.col(i * n + j) << radius * std::cos(u), radius * std::sin(u),
          tube * std::sin(v);
      const int a = i * n + j, b = (i + 1) % n * n + j, c = (i + 1) % n * n + (j + 1) % n,
                d = i * n + (j + 1) % n;
      mesh.triangles.col(2 * a) << a, b, c;
      mesh.triangles.col(2 * a + 1) << a, c, d;
    }
  }
  return mesh;
}

inline TriangleMesh InsideOut(TriangleMesh mesh) {
  mesh.triangles.row(1).swap(mesh.triangles.row(2));
  return mesh;
}

// The mesh without one triangle.
inline TriangleMesh Without(const TriangleMesh& mesh, int triangle) {
  std::vector<int> kept;
  for (int t = 0; t < mesh.triangles.cols(); ++t) {
    if (t != triangle) kept.push_back(t);
  }
  return {mesh.vertices, mesh.triangles(Eigen::all, kept)};
}

// Both meshes in one.
inline TriangleMesh Together(const TriangleMesh& a, const TriangleMesh& b) {
  TriangleMesh both;
  both.vertices.resize(3, a.vertices.cols() + b.vertices.cols());
  both.vertices << a.vertices, b.vertices;
  both.triangles.resize(3, a.triangles.cols() + b.triangles.cols());
  both.triangles << a.triangles, b.triangles.array() + static_cast<int>(a.vertices.cols());
  return both;
}

// The mesh with three vertices for each triangle, as an STL file has it.
inline TriangleMesh Soup(const TriangleMesh& mesh) {
  const Eigen::VectorXi corners = mesh.triangles.reshaped();
  TriangleMesh soup = {mesh.vertices(Eigen::all, corners), mesh.triangles};
  soup.triangles.reshaped() = Eigen::VectorXi::LinSpaced(corners.size(), 0, corners.size() - 1);
  return soup;
}

inline std::string ObjText(const TriangleMesh& mesh) {
  std::ostringstream text;
  text.precision(9);
  for (const auto& p : mesh.vertices.colwise()) text << "v " << p.transpose() << "\n";
  for (const auto& t : mesh.triangles.colwise()) {
    text << "f " << (t.array() + 1).transpose() << "\n";
  }
  return text.str();
}

}  // namespace mjcf_pdg::test

#endif  // MJCF_PDG_TESTS_SUPPORT_HAND_MADE_MESHES_H_
