// A tree of oriented boxes over the triangles of a mesh, four children side by side.
//
// FCL partitions the triangles and fits the boxes; asking is our own, because it is faster: a lane
// of SIMD registers per child, and lower bounds instead of FCL's exact distances of volumes.
// Lengths are in the caller's units.
#ifndef MJCF_PDG_SRC_MESH_BOX_TREE_H_
#define MJCF_PDG_SRC_MESH_BOX_TREE_H_

#include <Eigen/Dense>
#include <vector>

namespace mjcf_pdg {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Matrix3Xi;
using Eigen::Matrix4f;
using Eigen::Vector3d;
using Eigen::Vector3f;

struct OrientedBox {
  Matrix4f frame;  // homogeneous: its directions and its centre
  Vector3f half;   // lengths along them

  auto Axis(int i) const { return frame.col(i).head<3>(); }
  auto Center() const { return frame.col(3).head<3>(); }
  // The components of a vector along the directions.
  Vector3d Along(const Vector3d& v) const {
    return frame.topLeftCorner<3, 3>().cast<double>().transpose() * v;
  }
};

// A child of a box, and a bound of what is asked about it.
struct BoundedBox {
  double bound = 0.0;
  int box = 0;
};

// At most four children, the smallest bound first.
class BoundedBoxes {
 public:
  void Insert(BoundedBox item) {
    int k = size_++;
    for (; k > 0 && item.bound < items_[k - 1].bound; --k) items_[k] = items_[k - 1];
    items_[k] = item;
  }
  const BoundedBox* begin() const { return items_; }
  const BoundedBox* end() const { return items_ + size_; }

 private:
  BoundedBox items_[4];
  int size_ = 0;
};

class BoxTree {
 public:
  BoxTree() = default;
  // vertices (3 × nv), triangles (3 × nt > 0) of vertex indices, none without area.
  BoxTree(const Matrix3Xd& vertices, const Matrix3Xi& triangles);

  // Boxes have numbers, those of children follow each other.
  static constexpr int kRoot = 0;
  bool IsLeaf(int box) const { return GroupOf(box).child[box % 4] < 0; }
  int TriangleOf(int leaf) const { return ~GroupOf(leaf).child[leaf % 4]; }
  int FirstChild(int box) const { return 4 * GroupOf(box).child[box % 4]; }
  int NumChildren(int box) const { return groups_[GroupOf(box).child[box % 4]].size; }
  bool Holds(int box, int triangle) const {
    const int place = places_[triangle] - GroupOf(box).first[box % 4];
    return place >= 0 && place < GroupOf(box).count[box % 4];
  }
  // One of the triangles below the box, from the middle of their order.
  int MiddleTriangle(int box) const {
    return order_[GroupOf(box).first[box % 4] + GroupOf(box).count[box % 4] / 2];
  }
  const OrientedBox& BoxOf(int box) const { return boxes_[box]; }
  float HalfDiagonal(int box) const { return GroupOf(box).half_diagonal[box % 4]; }

  // The largest distance of a vertex from the origin.
  float scale() const { return scale_; }
  // Error of a bound between things that are all within this distance from the origin.
  static float Rounding(float largest) { return 1e-6f * largest; }

  // The children of `box` whose triangles may be nearer than `cutoff` to the other box, given in
  // the same frame; bounds of the distance, less `rounding`, or negative: how deep the boxes are in
  // each other.
  BoundedBoxes ChildrenNear(int box, const OrientedBox& other, float cutoff, float rounding) const;
  // The same to a point.
  BoundedBoxes ChildrenNear(int box, const Vector3d& x, double cutoff) const;
  // Those that the segment from p to p + along may cross.
  BoundedBoxes ChildrenOn(int box, const Vector3d& p, const Vector3d& along) const;

  // Bounds of the root, as above.
  float RootDistance(const Vector3d& x) const;

 private:
  using Lanes = Eigen::Array4f;
  struct Group {
    Lanes center[3], axes[3][3], half[3];  // axes[i][k]: component k of direction i
    Lanes half_diagonal;
    int child[4];            // a group, or ~triangle
    int first[4], count[4];  // places of the triangles below
    int size = 0;
  };
  struct Builder;

  const Group& GroupOf(int box) const { return groups_[box / 4]; }
  Lanes SquaredDistances(const Group& group, const Vector3f& x) const;

  std::vector<Group> groups_;
  std::vector<OrientedBox> boxes_;  // the same, one by one
  std::vector<int> order_;          // the triangles in the order of the leaves
  std::vector<int> places_;         // of triangles in it
  float scale_ = 0.0f;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_MESH_BOX_TREE_H_
