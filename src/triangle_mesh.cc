#include "triangle_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

namespace mjcf_pdg {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

struct EdgeUse {
  int low, high;  // vertices
  int triangle;
  int corner;    // the edge begins there
  bool forward;  // from low to high
};

// The triangles of one edge stand together.
std::vector<EdgeUse> SortedEdgeUses(const Eigen::Matrix3Xi& triangles) {
  std::vector<EdgeUse> uses;
  uses.reserve(static_cast<std::size_t>(triangles.size()));
  for (int t = 0; t < triangles.cols(); ++t) {
    for (int corner = 0; corner < 3; ++corner) {
      const int a = triangles(corner, t), b = triangles((corner + 1) % 3, t);
      uses.push_back({std::min(a, b), std::max(a, b), t, corner, a < b});
    }
  }
  std::sort(uses.begin(), uses.end(), [](const EdgeUse& x, const EdgeUse& y) {
    return std::tie(x.low, x.high, x.triangle) < std::tie(y.low, y.high, y.triangle);
  });
  return uses;
}

// Calls visit(first, count) for each edge.
template <typename Visit>
void ForEachEdge(const std::vector<EdgeUse>& uses, Visit visit) {
  for (std::size_t begin = 0, end = 0; begin < uses.size(); begin = end) {
    while (end < uses.size() && uses[end].low == uses[begin].low &&
           uses[end].high == uses[begin].high) {
      ++end;
    }
    visit(&uses[begin], static_cast<int>(end - begin));
  }
}

// Disjoint sets; each member knows whether it is turned against the first of its set.
class OrientedSets {
 public:
  explicit OrientedSets(int n) : parent_(n), turned_(n, 0) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }

  // The smallest member.
  int Root(int i) {
    int root = i;
    bool turned = false;
    for (; parent_[root] != root; root = parent_[root]) turned ^= turned_[root];
    while (parent_[i] != root) {
      const int next = parent_[i];
      const bool rest = turned ^ turned_[i];
      parent_[i] = root;
      turned_[i] = turned;
      turned = rest;
      i = next;
    }
    return root;
  }
  bool Turned(int i) {
    Root(i);
    return turned_[i] != 0;
  }

  void Join(int i, int j, bool turned = false) {
    const bool relative = turned ^ Turned(i) ^ Turned(j);
    int a = Root(i), b = Root(j);
    if (a == b) return;  // a contradiction (a Möbius strip) stays as an open edge
    if (a > b) std::swap(a, b);
    parent_[b] = a;
    turned_[b] = relative;
  }

 private:
  std::vector<int> parent_;
  std::vector<char> turned_;
};

void TurnOver(Eigen::Matrix3Xi& triangles, Index t) { std::swap(triangles(1, t), triangles(2, t)); }

Eigen::Matrix3Xi Columns(const Eigen::Matrix3Xi& triangles, const std::vector<Index>& kept) {
  return triangles(Eigen::all, kept);
}

Eigen::Matrix3Xi WithoutRepeatedCorners(const Eigen::Matrix3Xi& triangles) {
  std::vector<Index> kept;
  for (Index t = 0; t < triangles.cols(); ++t) {
    const Eigen::Vector3i v = triangles.col(t);
    if (v[0] != v[1] && v[1] != v[2] && v[2] != v[0]) kept.push_back(t);
  }
  return Columns(triangles, kept);
}

Eigen::Matrix3Xi WithoutDuplicates(const Eigen::Matrix3Xi& triangles) {
  std::vector<std::pair<std::array<int, 3>, Index>> keys;
  for (Index t = 0; t < triangles.cols(); ++t) {
    std::array<int, 3> corners = {triangles(0, t), triangles(1, t), triangles(2, t)};
    std::sort(corners.begin(), corners.end());
    keys.emplace_back(corners, t);
  }
  std::sort(keys.begin(), keys.end());
  std::vector<Index> kept;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (i == 0 || keys[i].first != keys[i - 1].first) kept.push_back(keys[i].second);
  }
  std::sort(kept.begin(), kept.end());
  return Columns(triangles, kept);
}

// Corners that meet at a vertex stay together only if edges of exactly two triangles connect them.
// Where more triangles meet at an edge, the ways around its ends decide which belong together.
int CutNonManifoldEdges(TriangleMesh* mesh) {
  const std::vector<EdgeUse> uses = SortedEdgeUses(mesh->triangles);
  OrientedSets corners(static_cast<int>(mesh->triangles.size()));
  int cut = 0;
  ForEachEdge(uses, [&](const EdgeUse* edge, int count) {
    if (count > 2) ++cut;
    if (count != 2) return;
    const auto corner = [](const EdgeUse& use, bool at_low) {
      return 3 * use.triangle + (use.forward == at_low ? use.corner : (use.corner + 1) % 3);
    };
    for (const bool at_low : {true, false}) {
      corners.Join(corner(edge[0], at_low), corner(edge[1], at_low));
    }
  });
  if (cut == 0) return 0;
  std::vector<int> vertex_of(static_cast<std::size_t>(mesh->triangles.size()), -1);
  std::vector<Index> source;
  Eigen::Matrix3Xi triangles = mesh->triangles;
  for (int i = 0; i < triangles.size(); ++i) {
    int& vertex = vertex_of[corners.Root(i)];
    if (vertex < 0) {
      vertex = static_cast<int>(source.size());
      source.push_back(mesh->triangles(i % 3, i / 3));
    }
    triangles(i % 3, i / 3) = vertex;
  }
  *mesh = {mesh->vertices(Eigen::all, source), std::move(triangles)};
  return cut;
}

OrientedSets ConnectTriangles(const Eigen::Matrix3Xi& triangles) {
  OrientedSets sets(static_cast<int>(triangles.cols()));
  ForEachEdge(SortedEdgeUses(triangles), [&](const EdgeUse* edge, int count) {
    if (count == 2) {
      sets.Join(edge[0].triangle, edge[1].triangle, edge[0].forward == edge[1].forward);
    }
  });
  return sets;
}

// Returns how many triangles were turned over.
int AgreeWithNeighbours(Eigen::Matrix3Xi* triangles) {
  OrientedSets sets = ConnectTriangles(*triangles);
  std::vector<int> votes(static_cast<std::size_t>(triangles->cols()), 0);  // per root
  for (int t = 0; t < triangles->cols(); ++t) votes[sets.Root(t)] += sets.Turned(t) ? 1 : -1;
  int turned = 0;
  for (int t = 0; t < triangles->cols(); ++t) {
    if (sets.Turned(t) == (votes[sets.Root(t)] > 0)) continue;
    TurnOver(*triangles, t);
    ++turned;
  }
  return turned;
}

int CountOpenEdges(const Eigen::Matrix3Xi& triangles) {
  int open = 0;
  ForEachEdge(SortedEdgeUses(triangles), [&](const EdgeUse* edge, int count) {
    if (count != 2 || edge[0].forward == edge[1].forward) ++open;
  });
  return open;
}

SolidProperties SolidAround(const Vector3d& middle, const Eigen::Matrix3Xd& vertices,
                            const Eigen::Matrix3Xi& triangles) {
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

// How often the surface goes around p, from solid angles (van Oosterom & Strackee 1983).
double WindingNumber(const Eigen::Matrix3Xd& vertices, const Eigen::Matrix3Xi& triangles,
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

struct Component {
  std::vector<Index> members;  // triangles of the whole mesh
  Eigen::Matrix3Xi triangles;  // those
  bool closed = false;
  double volume = 0.0;  // if closed
  Eigen::AlignedBox3d box;
  std::vector<std::size_t> containers = {};  // closed components around it
};

std::vector<Component> SplitComponents(const TriangleMesh& mesh) {
  OrientedSets sets = ConnectTriangles(mesh.triangles);
  std::vector<int> index(static_cast<std::size_t>(mesh.triangles.cols()), -1);  // per root
  std::vector<Component> components;
  for (int t = 0; t < mesh.triangles.cols(); ++t) {
    int& i = index[sets.Root(t)];
    if (i < 0) {
      i = static_cast<int>(components.size());
      components.emplace_back();
    }
    components[i].members.push_back(t);
  }
  for (Component& component : components) {
    component.triangles = Columns(mesh.triangles, component.members);
    component.closed = CountOpenEdges(component.triangles) == 0;
    for (const int v : component.triangles.reshaped()) component.box.extend(mesh.vertices.col(v));
    if (!component.closed) continue;
    component.volume =
        SolidAround(component.box.center(), mesh.vertices, component.triangles).volume;
  }
  return components;
}

void FindContainers(const Eigen::Matrix3Xd& vertices, std::vector<Component>* components) {
  for (Component& inner : *components) {
    if (!inner.closed) continue;
    const Vector3d p = vertices(Eigen::all, inner.triangles.col(0)).rowwise().mean();
    for (std::size_t i = 0; i < components->size(); ++i) {
      const Component& outer = (*components)[i];
      if (&outer == &inner || !outer.closed || !outer.box.contains(inner.box)) continue;
      if (std::abs(WindingNumber(vertices, outer.triangles, p)) > 0.5) {
        inner.containers.push_back(i);
      }
    }
  }
}

// An outer surface that faces inwards is turned over with everything in it: in a file that is all
// inside out, the cavities are too. Returns how many components that were.
int FaceOutwards(TriangleMesh* mesh) {
  std::vector<Component> components = SplitComponents(*mesh);
  FindContainers(mesh->vertices, &components);
  int inward = 0;
  for (const Component& component : components) {
    const auto is_outer = [&](std::size_t i) { return components[i].containers.empty(); };
    const auto outer =
        std::find_if(component.containers.begin(), component.containers.end(), is_outer);
    const double volume =
        outer == component.containers.end() ? component.volume : components[*outer].volume;
    if (!component.closed || volume >= 0.0) continue;
    for (const Index t : component.members) TurnOver(mesh->triangles, t);
    ++inward;
  }
  return inward;
}

}  // namespace

TriangleMesh WeldVertices(const TriangleMesh& mesh) {
  const Eigen::Matrix3Xd& p = mesh.vertices;
  std::vector<int> order(static_cast<std::size_t>(p.cols()));
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](int i) { return std::tuple(p(0, i), p(1, i), p(2, i)); };
  std::sort(order.begin(), order.end(), [&](int i, int j) { return key(i) < key(j); });
  std::vector<int> group(order.size());  // of each vertex
  for (std::size_t k = 0, last = 0; k < order.size(); ++k) {
    if (key(order[k]) != key(order[last])) last = k;
    group[order[k]] = static_cast<int>(last);
  }
  std::vector<int> vertex_of(order.size(), -1);  // of each group
  std::vector<Index> source;
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

TriangleMesh RepairMesh(const TriangleMesh& welded, MeshRepairs* repairs) {
  *repairs = {};
  TriangleMesh mesh = {welded.vertices, WithoutRepeatedCorners(welded.triangles)};
  repairs->repeated_corners = static_cast<int>(welded.triangles.cols() - mesh.triangles.cols());
  const Index with_duplicates = mesh.triangles.cols();
  mesh.triangles = WithoutDuplicates(mesh.triangles);
  repairs->duplicates = static_cast<int>(with_duplicates - mesh.triangles.cols());
  repairs->non_manifold_edges = CutNonManifoldEdges(&mesh);
  repairs->turned = AgreeWithNeighbours(&mesh.triangles);
  repairs->inward_components = FaceOutwards(&mesh);
  return mesh;
}

MeshTopology FindTopology(const TriangleMesh& mesh) {
  std::vector<Component> components = SplitComponents(mesh);
  FindContainers(mesh.vertices, &components);
  MeshTopology topology;
  topology.components = static_cast<int>(components.size());
  topology.open_edges = CountOpenEdges(mesh.triangles);
  for (const Component& component : components) {
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

bool LocallyConvex(const TriangleMesh& mesh, double rounding) {
  constexpr double kOffPlane = 4.0;  // roundings
  const double outwards = FindSolidProperties(mesh).volume < 0.0 ? -1.0 : 1.0;
  const auto corner = [&](int t, int k) { return mesh.vertices.col(mesh.triangles(k % 3, t)); };
  // How the corner that `use` has opposite the edge stands above the other triangle's plane.
  const auto reflex = [&](const EdgeUse& plane, const EdgeUse& use) {
    const Vector3d a = corner(plane.triangle, plane.corner);
    const Vector3d edge = corner(plane.triangle, plane.corner + 1) - a;
    const Vector3d normal = edge.cross(corner(plane.triangle, plane.corner + 2) - a);
    const Vector3d to_corner = corner(use.triangle, use.corner + 2) - a;
    const double height = outwards * normal.dot(to_corner) / normal.norm();
    // How much a corner's error is enlarged: across the edge by the plane's tilt, along it beyond.
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

SolidProperties FindSolidProperties(const TriangleMesh& mesh) {
  // From the middle: far from the origin the tetrahedra would cancel.
  Eigen::AlignedBox3d box;
  for (const auto& p : mesh.vertices.colwise()) box.extend(Vector3d(p));
  return mesh.vertices.cols() == 0 ? SolidProperties{}
                                   : SolidAround(box.center(), mesh.vertices, mesh.triangles);
}

}  // namespace mjcf_pdg
