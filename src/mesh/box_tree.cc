#include "mesh/box_tree.h"

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/OBB.h>

#include <array>
#include <cmath>
#include <limits>

namespace mjcf_pdg {
namespace {

// An upper bound of the rounding error of a segment's parameter, which is in [0, 1].
constexpr float kRoundingOfParameter = 1e-6f;

using Bvh = fcl::BVHModel<fcl::OBB<double>>;

Bvh BuildBvh(const Matrix3Xd& vertices, const Matrix3Xi& triangles) {
  Bvh tree;
  tree.beginModel(static_cast<int>(triangles.cols()), static_cast<int>(vertices.cols()));
  std::vector<Vector3d> points;
  for (Eigen::Index v = 0; v < vertices.cols(); ++v) points.push_back(vertices.col(v));
  std::vector<fcl::Triangle> faces;
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    faces.emplace_back(triangles(0, t), triangles(1, t), triangles(2, t));
  }
  tree.addSubModel(points, faces);
  tree.endModel();
  return tree;
}

}  // namespace

// Collapses FCL's binary tree into groups of up to four descendants of a node.
struct BoxTree::Builder {
  const Bvh& bvh;
  BoxTree& tree;

  void Fill(int group, int lane, int node) {
    const fcl::BVNode<fcl::OBB<double>>& from = bvh.getBV(node);
    const fcl::OBB<double>& box = from.bv;
    Group& to = tree.groups_[group];
    // By how much points may be outside the box once its centre and axes are rounded to float.
    const double slack = 2e-7 * (box.extent.norm() + box.To.norm());
    OrientedBox& shape = tree.boxes_[4 * group + lane];
    shape.frame.setIdentity();
    shape.frame.topLeftCorner<3, 3>() = box.axis.cast<float>();
    shape.frame.topRightCorner<3, 1>() = box.To.cast<float>();
    shape.half = ((1.0 + 1e-7) * box.extent.array() + slack).matrix().cast<float>();
    for (int i = 0; i < 3; ++i) {
      to.center[i][lane] = shape.Center()[i];
      to.half[i][lane] = shape.half[i];
      for (int k = 0; k < 3; ++k) to.axes[i][k][lane] = shape.Axis(i)[k];
    }
    to.half_diagonal[lane] = static_cast<float>(box.extent.norm());
    to.first[lane] = from.first_primitive;
    to.count[lane] = from.num_primitives;
    to.child[lane] = from.isLeaf() ? ~from.primitiveId() : 0;
    if (!from.isLeaf()) return;
    tree.places_[from.primitiveId()] = from.first_primitive;
    tree.order_[from.first_primitive] = from.primitiveId();
  }

  // Adds the group of a node's descendants: from its two children on, the largest that is no leaf
  // is replaced by its own two until there are four.
  void AddChildren(int group, int lane, int node) {
    std::array<int, 4> nodes = {bvh.getBV(node).leftChild(), bvh.getBV(node).rightChild()};
    int size = 2;
    while (size < 4) {
      int largest = -1;
      for (int k = 0; k < size; ++k) {
        if (bvh.getBV(nodes[k]).isLeaf()) continue;
        if (largest < 0 || Size(nodes[k]) > Size(nodes[largest])) largest = k;
      }
      if (largest < 0) break;
      nodes[size++] = bvh.getBV(nodes[largest]).rightChild();
      nodes[largest] = bvh.getBV(nodes[largest]).leftChild();
    }
    const int below = Add(size);
    tree.groups_[group].child[lane] = below;
    for (int k = 0; k < size; ++k) Fill(below, k, nodes[k]);
    for (int k = 0; k < size; ++k) {
      if (!bvh.getBV(nodes[k]).isLeaf()) AddChildren(below, k, nodes[k]);
    }
  }

  double Size(int node) const { return bvh.getBV(node).bv.extent.squaredNorm(); }

  // Appends a group with `size` lanes in use and returns its number. The unused lanes take part in
  // the arithmetic, so they are set to 0; their results are not read.
  int Add(int size) {
    Group group;
    for (int i = 0; i < 3; ++i) {
      group.center[i] = group.half[i] = Lanes::Zero();
      for (int k = 0; k < 3; ++k) group.axes[i][k] = Lanes::Zero();
    }
    group.half_diagonal = Lanes::Zero();
    for (int k = 0; k < 4; ++k) group.child[k] = group.first[k] = group.count[k] = 0;
    group.size = size;
    tree.groups_.push_back(group);
    tree.boxes_.resize(4 * tree.groups_.size());
    return static_cast<int>(tree.groups_.size()) - 1;
  }
};

BoxTree::BoxTree(const Matrix3Xd& vertices, const Matrix3Xi& triangles)
    : order_(triangles.cols()),
      places_(triangles.cols()),
      scale_(static_cast<float>(std::sqrt(vertices.colwise().squaredNorm().maxCoeff()))) {
  const Bvh bvh = BuildBvh(vertices, triangles);
  groups_.reserve(triangles.cols() / 2 + 1);
  boxes_.reserve(4 * groups_.capacity());
  Builder builder{bvh, *this};
  builder.Add(1);
  builder.Fill(0, 0, 0);
  if (!bvh.getBV(0).isLeaf()) builder.AddChildren(0, 0, 0);
  groups_.shrink_to_fit();
  boxes_.shrink_to_fit();
}

namespace {

Eigen::Array4f Dot(const Eigen::Array4f x[3], const Vector3f& y) {
  return x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
}

// (cutoff + rounding)², or -1 if the sum is not positive and no distance can be below it.
float Squared(float cutoff, float rounding) {
  const float farthest = cutoff + rounding;
  return farthest > 0.0f ? farthest * farthest : -1.0f;
}

}  // namespace

// Both boxes are projected on the three axes of either. The gaps between the projections on the
// axes of one box are components of a lower bound of the distance. If all projections overlap, the
// bound is minus the smallest overlap, so that the boxes that are deepest in each other come first.
BoundedBoxes BoxTree::ChildrenNear(int box, const OrientedBox& other, float cutoff,
                                   float rounding) const {
  const int index = GroupOf(box).child[box % 4];
  const Group& group = groups_[index];
  const float farthest = Squared(cutoff, rounding);
  BoundedBoxes out;
  Lanes d[3], reach_on_other[3], squared = Lanes::Zero(), squared_other = Lanes::Zero();
  Lanes widest = Lanes::Constant(-std::numeric_limits<float>::infinity());
  for (int k = 0; k < 3; ++k) {
    d[k] = group.center[k] - other.Center()[k];
    reach_on_other[k] = Lanes::Constant(other.half[k]);
  }
  for (int i = 0; i < 3; ++i) {
    const Lanes* axis = group.axes[i];
    Lanes reach = group.half[i];
    for (int k = 0; k < 3; ++k) {
      const Lanes cosine = Dot(axis, other.Axis(k)).abs();
      reach += cosine * other.half[k];
      reach_on_other[k] += cosine * group.half[i];
    }
    const Lanes apart = (axis[0] * d[0] + axis[1] * d[1] + axis[2] * d[2]).abs() - reach;
    widest = widest.max(apart);
    squared += apart.max(0.0f).square();
  }
  if ((squared >= farthest).all()) return out;
  for (int k = 0; k < 3; ++k) {
    const Lanes apart = Dot(d, other.Axis(k)).abs() - reach_on_other[k];
    widest = widest.max(apart);
    squared_other += apart.max(0.0f).square();
  }
  squared = squared.max(squared_other);
  const Lanes bound = (widest > 0.0f).select(squared.sqrt(), widest) - rounding;
  for (int k = 0; k < group.size; ++k) {
    if (squared[k] < farthest) out.Insert({bound[k], 4 * index + k});
  }
  return out;
}

BoxTree::Lanes BoxTree::SquaredDistances(const Group& group, const Vector3f& x) const {
  const Lanes d[3] = {x[0] - group.center[0], x[1] - group.center[1], x[2] - group.center[2]};
  Lanes squared = Lanes::Zero();
  for (int i = 0; i < 3; ++i) {
    const Lanes* axis = group.axes[i];
    const Lanes along = axis[0] * d[0] + axis[1] * d[1] + axis[2] * d[2];
    squared += (along.abs() - group.half[i]).max(0.0f).square();
  }
  return squared;
}

BoundedBoxes BoxTree::ChildrenNear(int box, const Vector3d& x, double cutoff) const {
  const int index = GroupOf(box).child[box % 4];
  const Group& group = groups_[index];
  const Vector3f point = x.cast<float>();
  const float rounding = Rounding(scale_ + point.lpNorm<1>());
  const float farthest = Squared(static_cast<float>(cutoff), rounding);
  const Lanes squared = SquaredDistances(group, point);
  BoundedBoxes out;
  for (int k = 0; k < group.size; ++k) {
    if (squared[k] < farthest) out.Insert({std::sqrt(squared[k]) - rounding, 4 * index + k});
  }
  return out;
}

float BoxTree::RootDistance(const Vector3d& x) const {
  const Vector3f point = x.cast<float>();
  return std::sqrt(SquaredDistances(groups_[0], point)[0]) - Rounding(scale_ + point.lpNorm<1>());
}

// The slab test: along each axis of a box, the segment is between the two faces for an interval of
// its parameter; the three intervals must meet.
BoundedBoxes BoxTree::ChildrenOn(int box, const Vector3d& p, const Vector3d& along) const {
  const int index = GroupOf(box).child[box % 4];
  const Group& group = groups_[index];
  const Vector3f from = p.cast<float>(), way = along.cast<float>();
  const float rounding = Rounding(scale_ + from.lpNorm<1>() + way.lpNorm<1>());
  const Lanes d[3] = {from[0] - group.center[0], from[1] - group.center[1],
                      from[2] - group.center[2]};
  Lanes enter = Lanes::Zero(), leave = Lanes::Ones();
  for (int i = 0; i < 3; ++i) {
    const Lanes* axis = group.axes[i];
    const Lanes start = axis[0] * d[0] + axis[1] * d[1] + axis[2] * d[2];
    const Lanes step = axis[0] * way[0] + axis[1] * way[1] + axis[2] * way[2];
    const Lanes reach = group.half[i] + rounding;
    // If the segment is parallel to the slab, the interval is huge inside, and far from [0, 1]
    // outside.
    const Lanes safe = (step.abs() < 1e-30f).select(1e-30f, step);
    const Lanes per_length = 1.0f / safe;
    const Lanes middle = -start * per_length, half = reach * per_length.abs();
    enter = enter.max(middle - half);
    leave = leave.min(middle + half);
  }
  BoundedBoxes out;
  for (int k = 0; k < group.size; ++k) {
    if (enter[k] <= leave[k] + kRoundingOfParameter) out.Insert({enter[k], 4 * index + k});
  }
  return out;
}

}  // namespace mjcf_pdg
