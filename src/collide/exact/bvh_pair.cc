#include "collide/exact/bvh_pair.h"

#include <algorithm>
#include <queue>
#include <tuple>
#include <utility>

#include "collide/exact/triangle_distance.h"

namespace mjcf_pdg {
namespace {

// A feature whose normal has at least this cosine with that of a face counts as the face's.
constexpr double kFaceLike = 0.9;
constexpr int kGuesses = 3;              // rounds of the alternating projection in Guess
constexpr std::size_t kMaxPatches = 32;  // the most pairs of patches whose distance is measured
// A pair of patches is not measured if each of the two has been in this many measured pairs.
constexpr int kPerPatch = 2;
constexpr int kMaxParts = 3000;         // the most pairs of boxes that Patches looks at
constexpr double kLargestMargin = 0.1;  // of features [smaller mesh's radius]
// A patch is as wide as the larger of kPatchPerMargin · margin and kPatchPerRadius · the smaller
// mesh's radius.
constexpr double kPatchPerMargin = 0.5, kPatchPerRadius = 0.25;

// A box of each mesh, waiting in the queue of Patches.
struct Part {
  double bound = 0.0;  // a lower bound of the distance of their triangles
  int a = BoxTree::kRoot, b = BoxTree::kRoot;
};

struct NearestFirst {
  bool operator()(const Part& x, const Part& y) const {
    return std::tuple(x.bound, x.a, x.b) > std::tuple(y.bound, y.a, y.b);
  }
};

Matrix4f Homogeneous(const RelativePose& pose) {
  Matrix4f matrix = Matrix4f::Identity();
  matrix.topLeftCorner<3, 3>() = pose.R.cast<float>();
  matrix.topRightCorner<3, 1>() = pose.t.cast<float>();
  return matrix;
}

// The signed gap between the projections of two triangles on n, times the length of n.
double GapAlong(const Vector3d& n, const Vector3d a[3], const Vector3d b[3]) {
  const Eigen::Array3d on_a(n.dot(a[0]), n.dot(a[1]), n.dot(a[2]));
  const Eigen::Array3d on_b(n.dot(b[0]), n.dot(b[1]), n.dot(b[2]));
  return std::max(on_b.minCoeff() - on_a.maxCoeff(), on_a.minCoeff() - on_b.maxCoeff());
}

}  // namespace

BvhPair::BvhPair(const TriangleBvh& a, const TriangleBvh& b, const RelativePose& b_in_a)
    : a_(a),
      b_(b),
      pose_(b_in_a),
      b_in_a_(Homogeneous(b_in_a)),
      a_in_b_(Homogeneous(b_in_a.Inverse())),
      rounding_(BoxTree::Rounding(a.tree().scale() + b.tree().scale() +
                                  static_cast<float>(b_in_a.t.lpNorm<1>()))) {}

BoundedBoxes BvhPair::ChildrenNear(Boxes boxes, bool of_a, double cutoff) const {
  ++box_tests_;
  const float below = static_cast<float>(cutoff);
  if (of_a) {
    OrientedBox other = b_.tree().BoxOf(boxes.b);
    other.frame = b_in_a_ * other.frame;
    return a_.tree().ChildrenNear(boxes.a, other, below, rounding_);
  }
  OrientedBox other = a_.tree().BoxOf(boxes.a);
  other.frame = a_in_b_ * other.frame;
  return b_.tree().ChildrenNear(boxes.b, other, below, rounding_);
}

BvhPair::Corners BvhPair::CornersOf(int a, int b) const {
  Corners at;
  for (int k = 0; k < 3; ++k) {
    at.a[k] = a_.Corner(a, k);
    at.b[k] = pose_ * b_.Corner(b, k);
  }
  return at;
}

NearestTriangles BvhPair::OfTriangles(int a, int b) const {
  return OfTriangles(a, b, CornersOf(a, b));
}

NearestTriangles BvhPair::OfTriangles(int a, int b, const Corners& at) {
  NearestTriangles near;
  near.a = a;
  near.b = b;
  near.distance = TriangleDistance(at.a, at.b, near.pa, near.pb);
  return near;
}

bool BvhPair::Apart(int a, int b, const Corners& at, double cutoff,
                    const NearestTriangles& best) const {
  if (GapAlong(a_.Normal(a), at.a, at.b) >= cutoff) return true;
  if (GapAlong(pose_.R * b_.Normal(b), at.a, at.b) >= cutoff) return true;
  return best.a >= 0 && GapAlong(best.pb - best.pa, at.a, at.b) >= cutoff * best.distance;
}

NearestTriangles BvhPair::Nearest(Boxes boxes, double cutoff, const NearestTriangles* warm,
                                  double share) const {
  NearestTriangles best;
  if (warm && warm->a >= 0) best = OfTriangles(warm->a, warm->b);
  if (!(best.distance < cutoff)) {
    best = NearestTriangles();
    best.distance = cutoff;
  }
  Descend(boxes, share, best);
  return best;
}

// Alternating projection: from the centre of b to the nearest point of a, from there to the nearest
// point of b, and so on. The result is often the nearest pair, and an upper bound in any case.
NearestTriangles BvhPair::Guess() const {
  const RelativePose a_in_b = pose_.Inverse();
  SurfacePoint on_a, on_b;
  Vector3d x = pose_ * b_.center();
  for (int k = 0; k < kGuesses; ++k) {
    on_a = a_.NearestFrom(on_a, x);
    on_b = b_.NearestFrom(on_b, a_in_b * on_a.p);
    x = pose_ * on_b.p;
  }
  return OfTriangles(on_a.triangle, on_b.triangle);
}

void BvhPair::Descend(Boxes boxes, double share, NearestTriangles& best) const {
  const bool leaf_a = a_.tree().IsLeaf(boxes.a), leaf_b = b_.tree().IsLeaf(boxes.b);
  if (leaf_a && leaf_b) {
    const int a = a_.tree().TriangleOf(boxes.a), b = b_.tree().TriangleOf(boxes.b);
    const Corners at = CornersOf(a, b);
    if (Apart(a, b, at, share * best.distance, best)) return;
    const NearestTriangles near = OfTriangles(a, b, at);
    if (near.distance < best.distance) best = near;
    return;
  }
  const bool split_a =
      leaf_b || (!leaf_a && a_.tree().HalfDiagonal(boxes.a) > b_.tree().HalfDiagonal(boxes.b));
  for (const BoundedBox& child : ChildrenNear(boxes, split_a, share * best.distance)) {
    if (!(best.distance > 0.0) || child.bound >= share * best.distance) return;
    (split_a ? boxes.a : boxes.b) = child.box;
    Descend(boxes, share, best);
  }
}

Vector3d BvhPair::Normal(const NearestTriangles& near) const {
  const Vector3d between = near.pb - near.pa;
  if (between.norm() > kTouching) return between.normalized();
  if (a_.closed()) return a_.Normal(near.a);
  return -(pose_.R * b_.Normal(near.b));
}

// Best-first search: the two boxes with the smallest lower bound are split until each is a patch or
// a leaf; then the nearest triangles of the two patches are sought.
void BvhPair::Patches(double margin, double patch, std::vector<NearestTriangles>& out) const {
  std::priority_queue<Part, std::vector<Part>, NearestFirst> parts;
  parts.push({});
  auto is_patch = [patch](const BoxTree& tree, int box) {
    return tree.IsLeaf(box) || tree.HalfDiagonal(box) <= 0.5 * patch;
  };
  std::vector<int> asked_a, asked_b;  // the pairs of patches measured so far
  auto known = [](const std::vector<int>& asked, int patch_box) {
    return std::count(asked.begin(), asked.end(), patch_box) >= kPerPatch;
  };
  for (int looked_at = 0; looked_at < kMaxParts && asked_a.size() < kMaxPatches; ++looked_at) {
    if (parts.empty()) return;
    const Part part = parts.top();
    parts.pop();
    const bool patch_a = is_patch(a_.tree(), part.a), patch_b = is_patch(b_.tree(), part.b);
    if (patch_a && patch_b) {
      if (known(asked_a, part.a) && known(asked_b, part.b)) continue;
      asked_a.push_back(part.a);
      asked_b.push_back(part.b);
      const NearestTriangles near = Nearest({part.a, part.b}, margin, nullptr, kNearly);
      if (near.a >= 0 && near.distance > kTouching) out.push_back(near);
      continue;
    }
    const bool split_a =
        patch_b || (!patch_a && a_.tree().HalfDiagonal(part.a) > b_.tree().HalfDiagonal(part.b));
    for (const BoundedBox& child : ChildrenNear({part.a, part.b}, split_a, margin)) {
      Part half = part;
      (split_a ? half.a : half.b) = child.box;
      half.bound = child.bound;
      parts.push(half);
    }
  }
}

// The nearest points of two patches may be on a patch's border, beyond which the surface goes on:
// the direction between them then says nothing about where the meshes would meet. It does if it is
// nearly the normal of one of the two faces, or if each point is the other mesh's nearest one.
bool BvhPair::BoundsMotion(const NearestTriangles& near) const {
  const Vector3d n = (near.pb - near.pa) / near.distance;
  if (std::abs(n.dot(a_.Normal(near.a))) > kFaceLike) return true;
  if (std::abs(n.dot(pose_.R * b_.Normal(near.b))) > kFaceLike) return true;
  const double nearly = near.distance * (1.0 - 1e-6);
  const RelativePose a_in_b = pose_.Inverse();
  return a_.Nearest(near.pb, nearly).triangle < 0 &&
         b_.Nearest(a_in_b * near.pa, nearly).triangle < 0;
}

void BvhPair::Features(double margin, const NearestTriangles& first,
                       std::vector<SignedGap>& out) const {
  const double size = std::min(a_.radius(), b_.radius());
  margin = std::min(margin, std::max(2.0 * first.distance, kLargestMargin * size));
  const double patch = std::max(kPatchPerMargin * margin, kPatchPerRadius * size);
  std::vector<NearestTriangles> found;
  if (first.distance > kTouching) found.push_back(first);
  Patches(margin, patch, found);
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& x, const auto& y) { return x.distance < y.distance; });
  const std::size_t begin = out.size();
  for (const NearestTriangles& near : found) {
    if (out.size() - begin >= static_cast<std::size_t>(kMaxFeatures)) break;
    const Vector3d n = Normal(near);
    auto same = [&](const SignedGap& gap) {
      return gap.n.dot(n) > kSameFeature && (gap.p1 - near.pa).norm() < 0.5 * patch;
    };
    if (std::any_of(out.begin() + static_cast<std::ptrdiff_t>(begin), out.end(), same)) continue;
    if (!BoundsMotion(near)) continue;
    out.push_back({near.distance, near.pa, near.pb, n});
  }
}

}  // namespace mjcf_pdg
