// A bounding volume hierarchy of oriented boxes over the triangles of a mesh, with up to four
// children per box. TriangleBvh (triangle_bvh.h) and BvhPair (collide/exact) traverse it.
//
// FCL partitions the triangles and fits the boxes. The queries are our own, because they are
// faster: they handle a box's children side by side, one per lane of a SIMD register, and give
// lower bounds instead of FCL's exact distances of volumes. Lengths are in the caller's unit,
// points in the mesh's frame.
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
  Matrix4f frame;  // homogeneous transform: columns 0-2 are the unit axes, column 3 is the centre
  Vector3f half;   // half lengths along the axes

  auto Axis(int i) const { return frame.col(i).head<3>(); }
  auto Center() const { return frame.col(3).head<3>(); }
  // The components of a vector along the axes.
  Vector3d Along(const Vector3d& v) const {
    return frame.topLeftCorner<3, 3>().cast<double>().transpose() * v;
  }
};

// A child of a box with the lower bound that a query gives for it.
struct BoundedBox {
  double bound = 0.0;
  int box = 0;
};

// Up to four children, sorted by ascending bound.
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

  // Boxes are known by numbers. The children of a box that is no leaf are FirstChild(box) and the
  // following, NumChildren(box) in all. A leaf has one triangle.
  static constexpr int kRoot = 0;
  bool IsLeaf(int box) const { return GroupOf(box).child[box % 4] < 0; }
  int TriangleOf(int leaf) const { return ~GroupOf(leaf).child[leaf % 4]; }
  int FirstChild(int box) const { return 4 * GroupOf(box).child[box % 4]; }
  int NumChildren(int box) const { return groups_[GroupOf(box).child[box % 4]].size; }
  // True if the triangle is below the box.
  bool Holds(int box, int triangle) const {
    const int place = places_[triangle] - GroupOf(box).first[box % 4];
    return place >= 0 && place < GroupOf(box).count[box % 4];
  }
  // One of the triangles below the box: the middle one in the order of the leaves.
  int MiddleTriangle(int box) const {
    return order_[GroupOf(box).first[box % 4] + GroupOf(box).count[box % 4] / 2];
  }
  const OrientedBox& BoxOf(int box) const { return boxes_[box]; }
  float HalfDiagonal(int box) const { return GroupOf(box).half_diagonal[box % 4]; }

  // The largest distance of a vertex from the origin.
  float scale() const { return scale_; }
  // An upper bound of the rounding error (float) of a distance between things that are all within
  // `largest` of the origin.
  static float Rounding(float largest) { return 1e-6f * largest; }

  // The queries below take a box that is no leaf, and return only the children that may pass.

  // The children whose distance to the box `other`, given in this mesh's frame, may be below
  // `cutoff`. The bound is a lower bound of that distance, less `rounding`; it is negative if the
  // two boxes may overlap, and the smaller the deeper they do.
  BoundedBoxes ChildrenNear(int box, const OrientedBox& other, float cutoff, float rounding) const;
  // The children whose distance to the point x may be below `cutoff`, with lower bounds of it.
  BoundedBoxes ChildrenNear(int box, const Vector3d& x, double cutoff) const;
  // The children that the segment from p to p + along may cross. The bound is a lower bound of the
  // parameter in [0, 1] at which it enters the box.
  BoundedBoxes ChildrenOn(int box, const Vector3d& p, const Vector3d& along) const;

  // A lower bound of the distance of x from the root's box; not positive if x is inside.
  float RootDistance(const Vector3d& x) const;

 private:
  using Lanes = Eigen::Array4f;
  // The children of one box, one per lane. Box number b is lane b % 4 of group b / 4.
  struct Group {
    Lanes center[3], axes[3][3], half[3];  // axes[i][k]: component k of axis i
    Lanes half_diagonal;
    int child[4];            // the group of its children, or for a leaf ~triangle
    int first[4], count[4];  // the triangles below: order_[first, first + count)
    int size = 0;            // the number of lanes in use
  };
  struct Builder;

  const Group& GroupOf(int box) const { return groups_[box / 4]; }
  Lanes SquaredDistances(const Group& group, const Vector3f& x) const;

  std::vector<Group> groups_;
  std::vector<OrientedBox> boxes_;  // the same boxes as single objects, by number
  std::vector<int> order_;          // the triangles in the order of the leaves
  std::vector<int> places_;         // per triangle: its place in order_
  float scale_ = 0.0f;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_MESH_BOX_TREE_H_
