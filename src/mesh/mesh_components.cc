#include "mesh/mesh_components.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "mesh/mesh_edges.h"
#include "mesh/triangle_bvh.h"

namespace mjcf_pdg {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Index;

std::vector<MeshComponent> SplitComponents(const TriangleMesh& mesh) {
  OrientedSets sets = ConnectTriangles(mesh.triangles);
  std::vector<int> index(static_cast<std::size_t>(mesh.triangles.cols()), -1);  // per root
  std::vector<MeshComponent> components;
  for (int t = 0; t < mesh.triangles.cols(); ++t) {
    int& i = index[sets.Root(t)];
    if (i < 0) {
      i = static_cast<int>(components.size());
      components.emplace_back();
    }
    components[i].members.push_back(t);
  }
  for (MeshComponent& component : components) {
    component.triangles = mesh.triangles(Eigen::all, component.members);
    component.closed = CountOpenEdges(component.triangles) == 0;
    for (const int v : component.triangles.reshaped()) component.box.extend(mesh.vertices.col(v));
    if (!component.closed) continue;
    component.volume =
        FindSolidProperties(mesh.vertices, component.triangles, component.box.center()).volume;
  }
  return components;
}

// A balanced tree over the bounding boxes of the closed components.
class ComponentBoxes {
 public:
  explicit ComponentBoxes(const std::vector<MeshComponent>& components) : components_(components) {
    for (int i = 0; i < static_cast<int>(components.size()); ++i) {
      if (components[i].closed) order_.push_back(i);
    }
    if (!order_.empty()) Build(0, static_cast<int>(order_.size()));
  }

  // Calls visit(i) for each component whose box contains the given one.
  template <typename Visit>
  void ForEachAround(const AlignedBox3d& box, Visit visit, int node = 0) const {
    if (nodes_.empty() || !nodes_[node].box.contains(box)) return;
    if (nodes_[node].second_child > 0) {
      ForEachAround(box, visit, node + 1);
      ForEachAround(box, visit, nodes_[node].second_child);
    } else if (const int i = order_[nodes_[node].begin]; components_[i].box.contains(box)) {
      visit(i);
    }
  }

 private:
  struct Node {
    AlignedBox3d box;      // around all components below
    int begin = 0;         // the first of them in order_; a leaf has one
    int second_child = 0;  // 0: a leaf
  };

  void Build(int begin, int end) {
    const std::size_t node = nodes_.size();
    nodes_.push_back({{}, begin});
    for (int i = begin; i < end; ++i) nodes_[node].box.extend(components_[order_[i]].box);
    if (end - begin == 1) return;
    Index axis;
    nodes_[node].box.sizes().maxCoeff(&axis);
    const int middle = (begin + end) / 2;
    std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                     [&](int i, int j) {
                       return components_[i].box.center()[axis] < components_[j].box.center()[axis];
                     });
    Build(begin, middle);
    nodes_[node].second_child = static_cast<int>(nodes_.size());
    Build(middle, end);
  }

  const std::vector<MeshComponent>& components_;
  std::vector<int> order_;
  std::vector<Node> nodes_;  // depth first: a node's first child follows it
};

// Points just below the surface of a closed component, under up to kMost of its triangles. They are
// not on the surface, so that a component that touches it there has them clearly outside.
std::vector<Vector3d> PointsInside(const Eigen::Matrix3Xd& vertices,
                                   const MeshComponent& component) {
  constexpr double kDepth = 1e-5;  // depth below the triangle [square root of twice its area]
  constexpr Index kMost = 16;
  const double inwards = component.volume < 0.0 ? 1.0 : -1.0;
  const Index n = component.triangles.cols();
  std::vector<Vector3d> points;
  for (Index k = 0; k < std::min(n, kMost); ++k) {
    const auto corners = component.triangles.col(k * n / std::min(n, kMost));
    const Vector3d a = vertices.col(corners[0]), b = vertices.col(corners[1]),
                   c = vertices.col(corners[2]);
    const Vector3d normal = (b - a).cross(c - a);
    const double depth = inwards * kDepth * std::sqrt(normal.norm());
    points.push_back((a + b + c) / 3.0 + depth * normal.normalized());
  }
  return points;
}

// The winding number of the surface round p, from solid angles (van Oosterom & Strackee 1983).
double WindingNumber(const Eigen::Matrix3Xd& vertices, const Matrix3Xi& triangles,
                     const Vector3d& p) {
  double solid_angle = 0.0;
  for (const auto& corners : triangles.colwise()) {
    const Vector3d a = vertices.col(corners[0]) - p, b = vertices.col(corners[1]) - p,
                   c = vertices.col(corners[2]) - p;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    solid_angle += 2.0 * std::atan2(a.dot(b.cross(c)),
                                    la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return solid_angle / (4.0 * EIGEN_PI);
}

TriangleBvh SolidOf(const Eigen::Matrix3Xd& vertices, const MeshComponent& component) {
  const Eigen::VectorXi corners = component.triangles.reshaped();
  Matrix3Xi triangles(3, component.triangles.cols());
  std::iota(triangles.reshaped().begin(), triangles.reshaped().end(), 0);
  return {vertices(Eigen::all, corners), triangles};
}

void FindContainers(const Eigen::Matrix3Xd& vertices, std::vector<MeshComponent>* components) {
  // For up to this many candidates, winding numbers by solid angles take less time than a tree.
  constexpr std::size_t kFew = 3;
  const ComponentBoxes boxes(*components);
  // Per component: those that may be inside it, by their boxes.
  std::vector<std::vector<int>> candidates(components->size());
  for (int i = 0; i < static_cast<int>(components->size()); ++i) {
    const MeshComponent& inner = (*components)[i];
    if (!inner.closed) continue;
    boxes.ForEachAround(inner.box, [&](int outer) {
      if (outer != i && (*components)[outer].volume != 0.0) candidates[outer].push_back(i);
    });
  }
  for (int outer = 0; outer < static_cast<int>(components->size()); ++outer) {
    if (candidates[outer].empty()) continue;
    std::optional<TriangleBvh> tree;
    if (candidates[outer].size() > kFew) tree.emplace(SolidOf(vertices, (*components)[outer]));
    const auto contains = [&](const Vector3d& p) {
      return tree ? tree->Contains(kTreeUnits * p)
                  : std::abs(WindingNumber(vertices, (*components)[outer].triangles, p)) > 0.5;
    };
    for (const int i : candidates[outer]) {
      MeshComponent& inner = (*components)[i];
      // All points must be inside: components that only reach into each other do not contain each
      // other.
      const std::vector<Vector3d> points = PointsInside(vertices, inner);
      if (std::all_of(points.begin(), points.end(), contains)) inner.containers.push_back(outer);
    }
  }
}

}  // namespace

std::vector<MeshComponent> FindComponents(const TriangleMesh& mesh) {
  std::vector<MeshComponent> components = SplitComponents(mesh);
  FindContainers(mesh.vertices, &components);
  return components;
}

MeshTopology FindTopology(const TriangleMesh& mesh) {
  const std::vector<MeshComponent> components = FindComponents(mesh);
  MeshTopology topology;
  topology.components = static_cast<int>(components.size());
  topology.open_edges = CountOpenEdges(mesh.triangles);
  for (const MeshComponent& component : components) {
    const bool cavity = component.containers.size() % 2 == 1;
    if (!component.containers.empty() && cavity != (component.volume < 0.0)) {
      ++topology.nested_components;
    }
  }
  for (const auto& corners : mesh.triangles.colwise()) {
    const Vector3d a = mesh.vertices.col(corners[0]);
    const Vector3d normal =
        (mesh.vertices.col(corners[1]) - a).cross(mesh.vertices.col(corners[2]) - a);
    if (normal.isZero(0.0)) ++topology.zero_area;
  }
  return topology;
}

}  // namespace mjcf_pdg
