#include "mesh/triangle_mesh.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

#include "mesh/mesh_edges.h"

namespace mjcf_pdg {

using Eigen::Index;
using Eigen::Vector3d;

TriangleMesh WeldVertices(const TriangleMesh& mesh) {
  const Eigen::Matrix3Xd& p = mesh.vertices;
  std::vector<int> order(static_cast<std::size_t>(p.cols()));
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](int i) { return std::tuple(p(0, i), p(1, i), p(2, i)); };
  std::sort(order.begin(), order.end(), [&](int i, int j) { return key(i) < key(j); });
  std::vector<int> group(order.size());  // per vertex: the same for equal coordinates
  for (std::size_t k = 0, last = 0; k < order.size(); ++k) {
    if (key(order[k]) != key(order[last])) last = k;
    group[order[k]] = static_cast<int>(last);
  }
  std::vector<int> vertex_of(order.size(), -1);  // per group: the new vertex
  std::vector<Index> source;                     // per new vertex: an old one
  Eigen::Matrix3Xi triangles = mesh.triangles;
  for (int& corner : triangles.reshaped()) {
    int& vertex = vertex_of[group[corner]];
    if (vertex < 0) {
      vertex = static_cast<int>(source.size());
      source.push_back(corner);
    }
    corner = vertex;
  }
  return {p(Eigen::all, source), std::move(triangles)};
}

bool LocallyConvex(const TriangleMesh& mesh, double rounding) {
  // A corner may stand above the other triangle's plane by this many enlarged roundings.
  constexpr double kOffPlane = 4.0;
  const double outwards = FindSolidProperties(mesh).volume < 0.0 ? -1.0 : 1.0;
  const auto corner = [&](int t, int k) { return mesh.vertices.col(mesh.triangles(k % 3, t)); };
  // True if the corner of use.triangle opposite to the edge stands above the plane of the other
  // triangle by more than rounding can explain.
  const auto reflex = [&](const EdgeUse& plane, const EdgeUse& use) {
    const Vector3d a = corner(plane.triangle, plane.corner);
    const Vector3d edge = corner(plane.triangle, plane.corner + 1) - a;
    const Vector3d normal = edge.cross(corner(plane.triangle, plane.corner + 2) - a);
    const Vector3d to_corner = corner(use.triangle, use.corner + 2) - a;
    const double height = outwards * normal.dot(to_corner) / normal.norm();
    // Errors of the plane's corners tilt it: the error of the height grows with the distance from
    // the edge, relative to the plane's triangle, and with the distance beyond the edge's ends.
    const double along = edge.dot(to_corner) / edge.squaredNorm();
    const double across = edge.cross(to_corner).norm() / normal.norm();
    const double beyond = std::max({0.0, -along, along - 1.0});
    return height > kOffPlane * rounding * (1.0 + across + 2.0 * beyond);
  };
  bool convex = true;
  const std::vector<EdgeUse> uses = SortedEdgeUses(mesh.triangles);
  ForEachEdge(uses, [&](const EdgeUse* edge, int count) {
    convex = convex && count == 2 && !reflex(edge[0], edge[1]) && !reflex(edge[1], edge[0]);
  });
  return convex;
}

double SurfaceArea(const TriangleMesh& mesh) {
  double area = 0.0;
  for (const auto& corners : mesh.triangles.colwise()) {
    const Vector3d a = mesh.vertices.col(corners[0]);
    area +=
        0.5 * (mesh.vertices.col(corners[1]) - a).cross(mesh.vertices.col(corners[2]) - a).norm();
  }
  return area;
}

SolidProperties FindSolidProperties(const Eigen::Matrix3Xd& vertices,
                                    const Eigen::Matrix3Xi& triangles, const Vector3d& middle) {
  SolidProperties solid;
  Vector3d first_moment = Vector3d::Zero();
  Eigen::Matrix3d second_moment = Eigen::Matrix3d::Zero();
  for (const auto& corners : triangles.colwise()) {
    const Eigen::Matrix3d p = vertices(Eigen::all, corners).colwise() - middle;
    const double volume = p.determinant() / 6.0;
    const Vector3d sum = p.rowwise().sum();
    solid.volume += volume;
    first_moment += volume / 4.0 * sum;
    second_moment += volume / 20.0 * (p * p.transpose() + sum * sum.transpose());
  }
  if (solid.volume == 0.0) return solid;
  const Vector3d offset = first_moment / solid.volume;
  second_moment -= solid.volume * offset * offset.transpose();
  solid.center = middle + offset;
  solid.inertia = second_moment.trace() * Eigen::Matrix3d::Identity() - second_moment;
  return solid;
}

SolidProperties FindSolidProperties(const TriangleMesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const auto& p : mesh.vertices.colwise()) box.extend(Vector3d(p));
  return mesh.vertices.cols() == 0
             ? SolidProperties{}
             : FindSolidProperties(mesh.vertices, mesh.triangles, box.center());
}

}  // namespace mjcf_pdg
