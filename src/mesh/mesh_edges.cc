#include "mesh/mesh_edges.h"

#include <algorithm>
#include <tuple>

namespace mjcf_pdg {

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

int CountOpenEdges(const Eigen::Matrix3Xi& triangles) {
  int open = 0;
  ForEachEdge(SortedEdgeUses(triangles), [&](const EdgeUse* edge, int count) {
    if (count != 2 || edge[0].forward == edge[1].forward) ++open;
  });
  return open;
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

}  // namespace mjcf_pdg
