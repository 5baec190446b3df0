#include "solid_pair.h"

#include <fcl/narrowphase/detail/primitive_shape_algorithm/triangle_distance.h>

#include <algorithm>
#include <queue>
#include <utility>

namespace mjcf_pdg {
namespace {

// FCL's distance of volumes uses tolerances of 1e-7 inside: taken off to stay a lower bound.
constexpr double kBoxSlack = 1e-6;
constexpr double kFaceLike = 0.9;         // cosine between a row's normal and a face's
constexpr double kSameDirection = 0.999;  // cosine; nearer ones are merged
constexpr int kMaxPatches = 16;           // of each surface
constexpr int kMaxQueries = 48;           // for the patches of each surface
constexpr double kPatchPerMargin = 0.5, kPatchPerSize = 0.125;

struct Patch {
  NearestTriangles near;
  int node = 0;
};

struct NearestFirst {
  bool operator()(const Patch& x, const Patch& y) const {
    return std::pair(x.near.distance, x.node) > std::pair(y.near.distance, y.node);
  }
};

}  // namespace

double SolidPair::BoxDistance(int node_a, int node_b) const {
  return fcl::distance(pose_.R, pose_.t, a_.BoxOf(node_a).rss, b_.BoxOf(node_b).rss) - kBoxSlack;
}

NearestTriangles SolidPair::OfTriangles(int a, int b) const {
  const Vector3d first[3] = {a_.Corner(a, 0), a_.Corner(a, 1), a_.Corner(a, 2)};
  const Vector3d second[3] = {pose_ * b_.Corner(b, 0), pose_ * b_.Corner(b, 1),
                              pose_ * b_.Corner(b, 2)};
  NearestTriangles near;
  near.a = a;
  near.b = b;
  near.distance =
      fcl::detail::TriangleDistance<double>::triDistance(first, second, near.pa, near.pb);
  return near;
}

NearestTriangles SolidPair::Nearest(int node_a, int node_b, double cutoff,
                                    const NearestTriangles* warm) const {
  NearestTriangles best;
  if (warm && warm->a >= 0) best = OfTriangles(warm->a, warm->b);
  if (!(best.distance < cutoff)) {
    best = NearestTriangles();
    best.distance = cutoff;
  }
  Descend(node_a, node_b, best);
  return best;
}

void SolidPair::Descend(int node_a, int node_b, NearestTriangles& best) const {
  const bool leaf_a = a_.IsLeaf(node_a), leaf_b = b_.IsLeaf(node_b);
  if (leaf_a && leaf_b) {
    const NearestTriangles near = OfTriangles(a_.TriangleOf(node_a), b_.TriangleOf(node_b));
    if (near.distance < best.distance) best = near;
    return;
  }
  const bool split_a = leaf_b || (!leaf_a && a_.HalfDiagonal(node_a) > b_.HalfDiagonal(node_b));
  std::pair<int, int> near = {node_a, node_b}, far = near;
  if (split_a) {
    near.first = a_.LeftChild(node_a);
    far.first = a_.RightChild(node_a);
  } else {
    near.second = b_.LeftChild(node_b);
    far.second = b_.RightChild(node_b);
  }
  double d_near = BoxDistance(near.first, near.second), d_far = BoxDistance(far.first, far.second);
  if (d_far < d_near) {
    std::swap(near, far);
    std::swap(d_near, d_far);
  }
  if (best.distance > 0.0 && d_near < best.distance) Descend(near.first, near.second, best);
  if (best.distance > 0.0 && d_far < best.distance) Descend(far.first, far.second, best);
}

Vector3d SolidPair::Normal(const NearestTriangles& near) const {
  const Vector3d between = near.pb - near.pa;
  if (between.norm() > kTouching) return between.normalized();
  if (a_.closed()) return a_.Normal(near.a);
  return -(pose_.R * b_.Normal(near.b));
}

// Splits the nearest part first; one child inherits its answer.
void SolidPair::PatchesOf(bool of_a, double margin, double patch, const NearestTriangles& first,
                          std::vector<NearestTriangles>& out) const {
  const Solid& solid = of_a ? a_ : b_;
  std::priority_queue<Patch, std::vector<Patch>, NearestFirst> parts;
  parts.push({first, 0});
  int queries = 0;
  for (int found = 0; found < kMaxPatches && !parts.empty() && queries < kMaxQueries;) {
    const Patch part = parts.top();
    parts.pop();
    if (solid.IsLeaf(part.node) || solid.HalfDiagonal(part.node) <= 0.5 * patch) {
      if (part.near.distance > kTouching) {
        out.push_back(part.near);
        ++found;
      }
      continue;
    }
    for (const int child : {solid.LeftChild(part.node), solid.RightChild(part.node)}) {
      NearestTriangles near = part.near;
      if (!solid.Holds(child, of_a ? near.a : near.b)) {
        near = of_a ? Nearest(child, 0, margin, nullptr) : Nearest(0, child, margin, nullptr);
        ++queries;
      }
      if (near.a >= 0) parts.push({near, child});
    }
  }
}

// The other side of a patch's border is no obstacle: a direction that is neither a face's nor that
// of mutually nearest points says nothing about where the meshes would meet.
bool SolidPair::BoundsMotion(const NearestTriangles& near) const {
  const Vector3d n = (near.pb - near.pa) / near.distance;
  if (std::abs(n.dot(a_.Normal(near.a))) > kFaceLike) return true;
  if (std::abs(n.dot(pose_.R * b_.Normal(near.b))) > kFaceLike) return true;
  const double nearly = near.distance * (1.0 - 1e-6);
  const RelativePose a_in_b = pose_.Inverse();
  return a_.Nearest(near.pb, nearly).triangle < 0 &&
         b_.Nearest(a_in_b * near.pa, nearly).triangle < 0;
}

void SolidPair::Features(double margin, const NearestTriangles& first,
                         std::vector<SignedGap>& out) const {
  const double patch =
      std::max(kPatchPerMargin * margin, 2.0 * kPatchPerSize * std::min(a_.radius(), b_.radius()));
  std::vector<NearestTriangles> found;
  PatchesOf(true, margin, patch, first, found);
  PatchesOf(false, margin, patch, first, found);
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& x, const auto& y) { return x.distance < y.distance; });
  const std::size_t begin = out.size();
  for (const NearestTriangles& near : found) {
    if (out.size() - begin >= static_cast<std::size_t>(kMaxFeatures)) break;
    const Vector3d n = Normal(near);
    auto same = [&](const SignedGap& gap) {
      return gap.n.dot(n) > kSameDirection && (gap.p1 - near.pa).norm() < 0.5 * patch;
    };
    if (std::any_of(out.begin() + static_cast<std::ptrdiff_t>(begin), out.end(), same)) continue;
    if (!BoundsMotion(near)) continue;
    out.push_back({near.distance, near.pa, near.pb, n});
  }
}

}  // namespace mjcf_pdg
