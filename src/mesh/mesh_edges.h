// Edges of triangle meshes, and which triangles they connect: the basis of mesh repair and of the
// convexity and component tests. Triangles are 3 × nt matrices of vertex indices.
#ifndef MJCF_PDG_SRC_MESH_MESH_EDGES_H_
#define MJCF_PDG_SRC_MESH_MESH_EDGES_H_

#include <Eigen/Dense>
#include <numeric>
#include <utility>
#include <vector>

namespace mjcf_pdg {

// One side of one triangle.
struct EdgeUse {
  int low, high;  // the edge's vertices, low <= high
  int triangle;
  int corner;    // the corner of the triangle (0-2) at which the side begins
  bool forward;  // the side runs from low to high
};

// All sides of all triangles, sorted so that the uses of an edge are adjacent.
std::vector<EdgeUse> SortedEdgeUses(const Eigen::Matrix3Xi& triangles);

// Calls visit(first, count) for each edge: its uses are first[0] to first[count - 1]. `uses` comes
// from SortedEdgeUses.
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

// Disjoint sets (union-find) over 0 ... n - 1 in which each member knows whether it is oriented
// against its set's root.
class OrientedSets {
 public:
  explicit OrientedSets(int n) : parent_(n), turned_(n, 0) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }

  // The root of i's set: its smallest member.
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
  // True if i is oriented against its root.
  bool Turned(int i) {
    Root(i);
    return turned_[i] != 0;
  }

  // Unites the sets of i and j. `turned`: i and j are oriented against each other.
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

// The number of edges that are not used exactly once in each direction.
int CountOpenEdges(const Eigen::Matrix3Xi& triangles);

// The sets of triangles connected by edges that exactly two triangles use. A triangle is turned if
// its orientation is opposite to that of the root.
OrientedSets ConnectTriangles(const Eigen::Matrix3Xi& triangles);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_MESH_MESH_EDGES_H_
