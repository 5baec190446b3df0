// The nearest triangles of two meshes a and b and, where they are apart, all contact features
// within a margin. ExactContacts makes one BvhPair per query of a pair.
//
// Both bounding volume hierarchies are traversed at once. The traversals are our own, because FCL's
// have no early out at a cutoff, no warm start and no margin; the distance of two triangles is
// FCL's (triangle_distance.h). Lengths are in tree units (triangle_bvh.h), points and directions in
// the frame of mesh a.
#ifndef MJCF_PDG_SRC_COLLIDE_EXACT_BVH_PAIR_H_
#define MJCF_PDG_SRC_COLLIDE_EXACT_BVH_PAIR_H_

#include <cstdint>
#include <vector>

#include "base/relative_pose.h"
#include "base/signed_gap.h"
#include "mesh/triangle_bvh.h"

namespace mjcf_pdg {

// The nearest points of two meshes, or of parts of them, with the triangles that they are on.
struct NearestTriangles {
  double distance = std::numeric_limits<double>::infinity();  // 0 when triangles intersect
  Vector3d pa = Vector3d::Zero(), pb = Vector3d::Zero();      // on a and b; any if they intersect
  int a = -1, b = -1;  // triangles; -1: no two triangles are nearer than the cutoff
};

// Refers to both meshes, which must outlive it. Counts its box tests, so use it in one thread.
class BvhPair {
 public:
  BvhPair(const TriangleBvh& a, const TriangleBvh& b, const RelativePose& b_in_a);

  const TriangleBvh& a() const { return a_; }
  const TriangleBvh& b() const { return b_; }
  const RelativePose& pose() const { return pose_; }

  // The nearest triangles, if nearer than `cutoff`; otherwise a = b = -1 and distance = cutoff.
  // `warm`: the triangles that were nearest at an earlier pose, or null.
  NearestTriangles Nearest(double cutoff, const NearestTriangles* warm = nullptr) const {
    const NearestTriangles guess = warm && warm->a >= 0 ? *warm : Guess();
    return Nearest({}, cutoff, &guess, 1.0);
  }
  // As Nearest and faster, but the true distance may be as small as kNearly times the one returned.
  // If any triangles intersect, two such triangles are returned.
  NearestTriangles RoughlyNearest(double cutoff, const NearestTriangles* warm) const {
    return Nearest({}, cutoff, warm, kNearly);
  }

  // Appends the features from which a contact matrix gets its rows: the nearest points of pairs of
  // surface patches that are apart and nearer than the margin. The margin used is
  // min(margin, max(2 · first.distance, r/10)), r the smaller mesh's radius; a patch is
  // max(used margin / 2, r/4) wide. A feature is kept only
  // if it bounds the motion (BoundsMotion); of similar features the nearest is kept. The nearest
  // comes first; there are at most kMaxFeatures. n points from a to b. `first` is the result of
  // Nearest(margin) or RoughlyNearest(margin).
  void Features(double margin, const NearestTriangles& first, std::vector<SignedGap>& out) const;

  // The nearest points of triangle a of mesh a and triangle b of mesh b.
  NearestTriangles OfTriangles(int a, int b) const;

  // A box of mesh a's hierarchy and a box of mesh b's.
  struct Boxes {
    int a = BoxTree::kRoot, b = BoxTree::kRoot;
  };
  // The children of boxes.a (if `of_a`) or of boxes.b that may be nearer than `cutoff` to the other
  // box, with lower bounds of their distances to it.
  BoundedBoxes ChildrenNear(Boxes boxes, bool of_a, double cutoff) const;
  // How often ChildrenNear was called: a measure of work that does not depend on the machine.
  std::int64_t box_tests() const { return box_tests_; }
  // The unit normal from a to b. For distances up to kTouching it is that of a triangle.
  Vector3d Normal(const NearestTriangles& near) const;

  static constexpr double kTouching = 1e-9;  // nearer triangles count as intersecting
  static constexpr int kMaxFeatures = 16;
  // Features in one place are merged above this cosine of the angle between their normals.
  static constexpr double kSameFeature = 0.999;

 private:
  static constexpr double kNearly = 0.8;  // see RoughlyNearest
  struct Corners {
    Vector3d a[3], b[3];
  };
  Corners CornersOf(int a, int b) const;
  static NearestTriangles OfTriangles(int a, int b, const Corners& at);
  // True if one of three directions (the two normals, and the one between the points of `best`)
  // proves that the triangles are at least `cutoff` apart.
  bool Apart(int a, int b, const Corners& at, double cutoff, const NearestTriangles& best) const;
  // The nearest triangles below the two boxes. The true distance is at least `share` times the one
  // returned; 1 asks for the nearest.
  NearestTriangles Nearest(Boxes boxes, double cutoff, const NearestTriangles* warm,
                           double share) const;
  // Two triangles that are likely to be near each other: a start of the search without `warm`.
  NearestTriangles Guess() const;
  // Replaces `best` by nearer triangles below the two boxes.
  void Descend(Boxes boxes, double share, NearestTriangles& best) const;
  // Appends the nearest triangles of pairs of patches (boxes of at most `patch` in diameter) that
  // are apart and nearer than `margin`.
  void Patches(double margin, double patch, std::vector<NearestTriangles>& out) const;
  // False for nearest points of two patches that do not hinder the meshes' motion.
  bool BoundsMotion(const NearestTriangles& near) const;

  const TriangleBvh& a_;
  const TriangleBvh& b_;
  RelativePose pose_;
  Matrix4f b_in_a_, a_in_b_;  // pose_ and its inverse, rounded to float
  float rounding_;            // by how much rounding may make the boxes' bounds too large
  mutable std::int64_t box_tests_ = 0;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_COLLIDE_EXACT_BVH_PAIR_H_
