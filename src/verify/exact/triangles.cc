#include "verify/exact/triangles.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

namespace mjcf_pdg::verify {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

void AppendFan(const std::array<Vector3d, 4>& corners, Triangles& triangles) {
  triangles.push_back({corners[0], corners[1], corners[2]});
  triangles.push_back({corners[0], corners[2], corners[3]});
}

}  // namespace

Triangles BoxTriangles(const Vector3d& half) {
  Triangles triangles;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      const Vector3d c = side * half[axis] * Vector3d::Unit(axis);
      const Vector3d u = half[(axis + 1) % 3] * Vector3d::Unit((axis + 1) % 3);
      const Vector3d v = side * half[(axis + 2) % 3] * Vector3d::Unit((axis + 2) % 3);
      AppendFan({c - u - v, c + u - v, c + u + v, c - u + v}, triangles);
    }
  }
  return triangles;
}

Triangles MeshTriangles(const mjModel& m, int mesh, bool exact) {
  const int* face = m.mesh_face + 3 * m.mesh_faceadr[mesh];
  int count = m.mesh_facenum[mesh];
  if (!exact) {
    const int* graph = m.mesh_graph + m.mesh_graphadr[mesh];
    count = graph[1];
    face = graph + 2 + 3 * graph[0] + 3 * count;
  }
  Triangles triangles(count);
  for (int t = 0; t < count; ++t) {
    for (int k = 0; k < 3; ++k) {
      const float* p = m.mesh_vert + 3 * (m.mesh_vertadr[mesh] + face[3 * t + k]);
      triangles[t][k] = Vector3d(p[0], p[1], p[2]);
    }
  }
  return triangles;
}

double LeastMove(const std::array<Vector3d, 3>& s, const std::array<Vector3d, 3>& t,
                 Vector3d& direction) {
  Matrix3d S, T;
  S << s[0], s[1], s[2];
  T << t[0], t[1], t[2];
  Matrix3d s_edges, t_edges;
  s_edges << s[1] - s[0], s[2] - s[1], s[0] - s[2];
  t_edges << t[1] - t[0], t[2] - t[1], t[0] - t[2];
  const Vector3d s_normal = s_edges.col(0).cross(s_edges.col(1));
  const Vector3d t_normal = t_edges.col(0).cross(t_edges.col(1));
  std::vector<Vector3d> axes = {s_normal, t_normal};
  for (int i = 0; i < 3; ++i) {
    axes.push_back(s_edges.col(i).cross(s_normal));
    axes.push_back(t_edges.col(i).cross(t_normal));
    for (int j = 0; j < 3; ++j) axes.push_back(s_edges.col(i).cross(t_edges.col(j)));
  }
  double least = kInfinity;
  for (const Vector3d& axis : axes) {
    if (!(axis.norm() > 1e-12 * s_edges.norm() * t_edges.norm())) continue;
    const Vector3d n = axis.normalized();
    const double up = (n.transpose() * S).maxCoeff() - (n.transpose() * T).minCoeff();
    const double down = (n.transpose() * T).maxCoeff() - (n.transpose() * S).minCoeff();
    if (std::min(up, down) >= least) continue;
    least = std::min(up, down);
    direction = up < down ? n : Vector3d(-n);
  }
  return std::isfinite(least) ? std::max(least, 0.0) : 0.0;
}

int CountOpenEdges(const Triangles& triangles) {
  using Place = std::array<double, 3>;
  std::map<std::pair<Place, Place>, int> surplus;  // per edge: forward less backward uses
  for (const auto& triangle : triangles) {
    Place corners[3];
    for (int k = 0; k < 3; ++k) corners[k] = {triangle[k][0], triangle[k][1], triangle[k][2]};
    for (int k = 0; k < 3; ++k) {
      const Place &from = corners[k], &to = corners[(k + 1) % 3];
      if (from < to) ++surplus[{from, to}];
      if (to < from) --surplus[{to, from}];
    }
  }
  return static_cast<int>(std::count_if(surplus.begin(), surplus.end(),
                                        [](const auto& edge) { return edge.second != 0; }));
}

bool IsBoundaryOfHull(const Triangles& triangles, const VertexTree& vertices) {
  // Share of the largest distance from the origin: four roundings of a coordinate to float.
  constexpr double kFloatRounding = 5e-7;
  double largest = 0.0;
  for (const Vector3d& p : vertices.vertices()) largest = std::max(largest, p.norm());
  const auto on_hull = [&](const std::array<Vector3d, 3>& t) {
    Vector3d n = (t[1] - t[0]).cross(t[2] - t[0]);
    if (!(n.norm() > 0.0)) return true;
    n.normalize();
    return n.dot(vertices.Support(n) - t[0]) <= kFloatRounding * largest;
  };
  return std::all_of(triangles.begin(), triangles.end(), on_hull) &&
         CountOpenEdges(triangles) == 0 && Pieces(triangles).size() == 1;
}

std::vector<std::vector<int>> Pieces(const Triangles& triangles) {
  std::vector<std::pair<std::array<double, 3>, int>> corners;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (const Vector3d& p : triangles[t]) corners.push_back({{p[0], p[1], p[2]}, int(t)});
  }
  std::sort(corners.begin(), corners.end());
  std::vector<int> piece(triangles.size());
  std::iota(piece.begin(), piece.end(), 0);
  auto find = [&](int t) {
    while (piece[t] != t) t = piece[t] = piece[piece[t]];
    return t;
  };
  for (std::size_t i = 1; i < corners.size(); ++i) {
    if (corners[i].first == corners[i - 1].first) {
      piece[find(corners[i].second)] = find(corners[i - 1].second);
    }
  }
  std::vector<int> place(triangles.size(), -1);  // index in `pieces` by root; -1: none yet
  std::vector<std::vector<int>> pieces;
  for (int t = 0; t < static_cast<int>(triangles.size()); ++t) {
    int& of_root = place[find(t)];
    if (of_root < 0) {
      of_root = static_cast<int>(pieces.size());
      pieces.emplace_back();
    }
    pieces[of_root].push_back(t);
  }
  return pieces;
}

}  // namespace mjcf_pdg::verify
