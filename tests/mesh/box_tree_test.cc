// Trees of boxes: what they hold, and that their bounds bound.
#include "mesh/box_tree.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/mesh_shapes.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

class BoxTreeTest : public ::testing::Test {
 protected:
  BoxTreeTest() : tree_(shape_.Vertices(), shape_.Faces()) {}

  int NumTriangles() const { return static_cast<int>(shape_.faces.size()); }
  Vector3d Corner(int triangle, int k) const { return shape_.vertices[shape_.faces[triangle][k]]; }
  Vector3d RandomPoint(int triangle) {
    double u = rng_.Uniform(0, 1), v = rng_.Uniform(0, 1);
    if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
    return (1.0 - u - v) * Corner(triangle, 0) + u * Corner(triangle, 1) + v * Corner(triangle, 2);
  }
  // All boxes, parents first.
  std::vector<int> Boxes() const {
    std::vector<int> boxes = {BoxTree::kRoot};
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      if (tree_.IsLeaf(boxes[i])) continue;
      for (int k = 0; k < tree_.NumChildren(boxes[i]); ++k) {
        boxes.push_back(tree_.FirstChild(boxes[i]) + k);
      }
    }
    return boxes;
  }
  bool Returned(const BoundedBoxes& boxes, int box) const {
    return std::any_of(boxes.begin(), boxes.end(), [&](const auto& b) { return b.box == box; });
  }

  Random rng_{71};
  const MeshShape shape_ = TorusKnot(500.0, 90.0, 40, 9);
  const BoxTree tree_;
};

TEST_F(BoxTreeTest, EveryTriangleIsInOneLeafAndInTheBoxesAboveIt) {
  std::vector<int> leaves(NumTriangles(), 0);
  for (const int box : Boxes()) {
    EXPECT_TRUE(tree_.Holds(box, tree_.MiddleTriangle(box)));
    const OrientedBox shape = tree_.BoxOf(box);
    int held = 0;
    for (int t = 0; t < NumTriangles(); ++t) {
      if (!tree_.Holds(box, t)) continue;
      ++held;
      for (int k = 0; k < 3; ++k) {
        const Vector3d local = shape.Along(Corner(t, k) - shape.Center().cast<double>());
        EXPECT_LE((local.cwiseAbs() - shape.half.cast<double>()).maxCoeff(), 1e-4);
      }
    }
    if (!tree_.IsLeaf(box)) {
      int below = 0;
      for (int k = 0; k < tree_.NumChildren(box); ++k) {
        for (int t = 0; t < NumTriangles(); ++t) below += tree_.Holds(tree_.FirstChild(box) + k, t);
      }
      EXPECT_EQ(below, held);
      continue;
    }
    EXPECT_EQ(held, 1);
    ++leaves[tree_.TriangleOf(box)];
  }
  EXPECT_EQ(std::count(leaves.begin(), leaves.end(), 1), NumTriangles());
}

TEST_F(BoxTreeTest, BoundsAreNeverAboveADistance) {
  int tight = 0;
  for (const int box : Boxes()) {
    if (tree_.IsLeaf(box)) continue;
    OrientedBox other;
    other.frame.setIdentity();
    other.frame.topLeftCorner<3, 3>() = rng_.UnitQuat().matrix().cast<float>();
    other.frame.topRightCorner<3, 1>() = rng_.InBox(900.0).cast<float>();
    other.half = Vector3f(30.0f, 60.0f, 5.0f);
    const Vector3d point = rng_.InBox(900.0);
    const BoundedBoxes near =
        tree_.ChildrenNear(box, other, 1e9f, BoxTree::Rounding(2.0f * tree_.scale()));
    const BoundedBoxes near_point = tree_.ChildrenNear(box, point, 1e9);
    EXPECT_TRUE(std::is_sorted(near.begin(), near.end(),
                               [](const auto& a, const auto& b) { return a.bound < b.bound; }));
    for (const BoundedBox& child : near) {
      double least = 1e9;
      for (int t = 0; t < NumTriangles(); ++t) {
        if (!tree_.Holds(child.box, t)) continue;
        const Vector3d x = other.Along(RandomPoint(t) - other.Center().cast<double>());
        least = std::min(least, (x.cwiseAbs() - other.half.cast<double>()).cwiseMax(0.0).norm());
      }
      EXPECT_LE(child.bound, least);
      tight += child.bound > 0.8 * least;
    }
    for (const BoundedBox& child : near_point) {
      for (int t = 0; t < NumTriangles(); ++t) {
        if (!tree_.Holds(child.box, t)) continue;
        EXPECT_LE(child.bound, (RandomPoint(t) - point).norm());
      }
    }
    if (near.begin() == near.end()) continue;
    const double cutoff = near.begin()->bound + 1.0;
    for (const BoundedBox& child : tree_.ChildrenNear(box, point, cutoff)) {
      EXPECT_LT(child.bound, cutoff);
    }
  }
  EXPECT_GT(tight, 50) << "bounds worth having";
}

TEST_F(BoxTreeTest, ASegmentThroughATriangleMeetsAllBoxesAboveIt) {
  int met = 0, asked = 0;
  for (int t = 0; t < NumTriangles(); ++t) {
    const Vector3d x = RandomPoint(t), p = x + rng_.InBox(300.0);
    // Some end in the triangle, some beyond.
    const Vector3d along = (t % 2 ? 1.0 : 1.7) * (x - p);
    for (const int box : Boxes()) {
      if (tree_.IsLeaf(box)) continue;
      const BoundedBoxes on = tree_.ChildrenOn(box, p, along);
      for (int k = 0; k < tree_.NumChildren(box); ++k) {
        const int child = tree_.FirstChild(box) + k;
        ++asked;
        met += Returned(on, child);
        EXPECT_TRUE(!tree_.Holds(child, t) || Returned(on, child));
      }
    }
  }
  EXPECT_LT(met, asked / 4) << "most boxes are elsewhere";
}

TEST_F(BoxTreeTest, OneTriangleIsALeaf) {
  MeshShape one;
  one.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  one.faces = {{0, 1, 2}};
  const BoxTree tree(one.Vertices(), one.Faces());
  EXPECT_TRUE(tree.IsLeaf(BoxTree::kRoot));
  EXPECT_EQ(tree.TriangleOf(BoxTree::kRoot), 0);
  EXPECT_NEAR(tree.RootDistance({0, 0, 2}), 2.0, 1e-4);
  EXPECT_LE(tree.RootDistance({0, 0, 2}), 2.0);
}

}  // namespace
}  // namespace mjcf_pdg::test
