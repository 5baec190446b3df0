// Two triangle meshes: their nearest triangles, and all features within a margin.
//
// Our own traversals, because FCL's have no early out at a cutoff, no warm start and no margin,
// with FCL's distance of triangles. Tree units (triangle_bvh.h); everything in the frame of mesh a.
#ifndef MJCF_PDG_SRC_COLLIDE_EXACT_BVH_PAIR_H_
#define MJCF_PDG_SRC_COLLIDE_EXACT_BVH_PAIR_H_

#include <cstdint>
#include <vector>

#include "base/signed_gap.h"
#include "mesh/triangle_bvh.h"

namespace mjcf_pdg {

// The nearest points of two meshes, or of parts of them.
struct NearestTriangles {
  double distance = std::numeric_limits<double>::infinity();  // 0 when triangles intersect
  Vector3d pa = Vector3d::Zero(), pb = Vector3d::Zero();
  int a = -1, b = -1;  // triangles; -1: nothing below the cutoff
};

// Where the second mesh is in the first one's frame: x_a = R x_b + t.
struct RelativePose {
  Matrix3d R = Matrix3d::Identity();
  Vector3d t = Vector3d::Zero();

  Vector3d operator*(const Vector3d& x) const { return R * x + t; }
  RelativePose Inverse() const { return {R.transpose(), -(R.transpose() * t)}; }
};

class BvhPair {
 public:
  BvhPair(const TriangleBvh& a, const TriangleBvh& b, const RelativePose& b_in_a);

  const TriangleBvh& a() const { return a_; }
  const TriangleBvh& b() const { return b_; }
  const RelativePose& pose() const { return pose_; }

  // Below `cutoff`, or a == b == -1. `warm`: triangles that were nearest before, or null.
  NearestTriangles Nearest(double cutoff, const NearestTriangles* warm = nullptr) const {
    const NearestTriangles guess = warm && warm->a >= 0 ? *warm : Guess();
    return Nearest({}, cutoff, &guess, 1.0);
  }
  // The same, but some may be nearer by a fifth; quicker. Triangles that intersect are found.
  NearestTriangles RoughlyNearest(double cutoff, const NearestTriangles* warm) const {
    return Nearest({}, cutoff, warm, kNearly);
  }

  // Rows for a contact matrix: of pairs of patches of the two surfaces the nearest points, if
  // nearer than `margin` and apart. The margin is cut to twice the distance of `first` or a tenth
  // of the smaller mesh's radius; a patch is half of it wide, but a quarter of that radius at
  // least. Only points whose direction is locally that of a face, or which are nearest to each
  // other, bound the motion: others are left out. Nearest first, similar ones merged, at most
  // kMaxFeatures. n points from a to b. `first` is the result of Nearest(margin) or
  // RoughlyNearest(margin).
  void Features(double margin, const NearestTriangles& first, std::vector<SignedGap>& out) const;

  NearestTriangles OfTriangles(int a, int b) const;

  // A box of each mesh.
  struct Boxes {
    int a = BoxTree::kRoot, b = BoxTree::kRoot;
  };
  // The children of one of the two, of mesh a or else b, that may be nearer than `cutoff` to the
  // other.
  BoundedBoxes ChildrenNear(Boxes boxes, bool of_a, double cutoff) const;
  // Boxes whose children were compared with another so far: the work, whatever the machine.
  std::int64_t box_tests() const { return box_tests_; }
  // Unit, from a to b, for near.distance > 0.
  Vector3d Normal(const NearestTriangles& near) const;

  // Below this, triangles count as intersecting.
  static constexpr double kTouching = 1e-9;
  static constexpr int kMaxFeatures = 16;

 private:
  static constexpr double kNearly = 0.8;
  struct Corners {
    Vector3d a[3], b[3];
  };
  Corners CornersOf(int a, int b) const;
  static NearestTriangles OfTriangles(int a, int b, const Corners& at);
  // Some direction tells that the triangles are no nearer than `cutoff`.
  bool Apart(int a, int b, const Corners& at, double cutoff, const NearestTriangles& best) const;
  // `share`: others as near as that share of the distance found may be missed.
  NearestTriangles Nearest(Boxes boxes, double cutoff, const NearestTriangles* warm,
                           double share) const;
  NearestTriangles Guess() const;
  void Descend(Boxes boxes, double share, NearestTriangles& best) const;
  void Patches(double margin, double patch, std::vector<NearestTriangles>& out) const;
  bool BoundsMotion(const NearestTriangles& near) const;

  const TriangleBvh& a_;
  const TriangleBvh& b_;
  RelativePose pose_;
  Matrix4f b_in_a_, a_in_b_;  // the same, rounded
  float rounding_;            // of bounds
  mutable std::int64_t box_tests_ = 0;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_COLLIDE_EXACT_BVH_PAIR_H_
