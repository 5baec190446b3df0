// Edges of triangle meshes, and which triangles they connect.
#ifndef MJCF_PDG_SRC_MESH_MESH_EDGES_H_
#define MJCF_PDG_SRC_MESH_MESH_EDGES_H_

#include <Eigen/Dense>
#include <numeric>
#include <utility>
#include <vector>

namespace mjcf_pdg {

struct EdgeUse {
  int low, high;  // vertices
  int triangle;
  int corner;    // the edge begins there
  bool forward;  // from low to high
};

// The triangles of one edge stand together.
std::vector<EdgeUse> SortedEdgeUses(const Eigen::Matrix3Xi& triangles);

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

int CountOpenEdges(const Eigen::Matrix3Xi& triangles);

// Connected by edges of two triangles.
OrientedSets ConnectTriangles(const Eigen::Matrix3Xi& triangles);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_MESH_MESH_EDGES_H_
