// The vertices of a mesh in a tree of bounding boxes. It answers exactly which vertex is farthest
// along a direction, without relying on a convex hull.
#ifndef MJCF_PDG_SRC_VERIFY_CONVEX_VERTEX_TREE_H_
#define MJCF_PDG_SRC_VERIFY_CONVEX_VERTEX_TREE_H_

#include <Eigen/Dense>
#include <vector>

namespace mjcf_pdg::verify {

class VertexTree {
 public:
  explicit VertexTree(std::vector<Eigen::Vector3d> vertices);  // at least one

  // The vertex v with the largest n · v.
  const Eigen::Vector3d& Support(const Eigen::Vector3d& n) const;

  const std::vector<Eigen::Vector3d>& vertices() const { return vertices_; }

 private:
  struct Node {
    Eigen::Vector3d center, half;  // of the box about its vertices
    int begin = 0, end = 0;        // range of its vertices in vertices_
    int second = 0;                // node of the second child, 0: a leaf; the first child is next
  };
  void Build(int begin, int end);
  // Updates `farthest`, an index in vertices_, and its reach n · v, `most`, from those below the
  // node.
  void Search(int node, const Eigen::Vector3d& n, double& most, int& farthest) const;

  std::vector<Eigen::Vector3d> vertices_;
  std::vector<Node> nodes_;
};

}  // namespace mjcf_pdg::verify

#endif  // MJCF_PDG_SRC_VERIFY_CONVEX_VERTEX_TREE_H_
