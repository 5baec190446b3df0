#include "collide/exact/sdf_mesh.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <queue>
#include <utility>

#include "collide/exact/triangle_distance.h"

namespace mjcf_pdg {
namespace {

// How exactly minima of f are found, and the smallest depth that defines a direction [tree units;
// 2e-11 m in scenes of size 0.1 m].
constexpr double kAccuracy = 1e-7;
// Patches ends after this many patches, or searches below a box.
constexpr int kMaxPatches = 32, kMaxQueries = 128;
// The width of a patch, per margin and at least per size: the smaller of the mesh's radius and the
// primitive's.
constexpr double kPatchPerMargin = 0.5, kPatchPerSize = 0.25;
constexpr int kAscents = 3;  // the most steps to deeper points in AppendWayFromWithin
// How far from p the straight way out may meet the surface [tree units; 2e-7 m in scenes of size
// 0.1 m].
constexpr double kBeyond = 1e-3;

// A box of the mesh with its minimum of f, waiting in the queue of Patches.
struct Patch {
  SdfNearest nearest;
  int box = BoxTree::kRoot;
};

struct NearestFirst {
  bool operator()(const Patch& x, const Patch& y) const {
    return std::pair(x.nearest.f, x.box) > std::pair(y.nearest.f, y.box);
  }
};

}  // namespace

double SdfMesh::LowerBound(int box) const {
  const OrientedBox& shape = mesh_.tree().BoxOf(box);
  const SdfValue center = field_.At(pose_ * shape.Center().cast<double>());
  const Vector3d gradient = shape.Along(pose_.R.transpose() * center.gradient);
  return center.f - gradient.cwiseAbs().dot(shape.half.cast<double>()) - kAccuracy;
}

BoundedBoxes SdfMesh::ChildrenBelow(int box, double cutoff) const {
  BoundedBoxes out;
  const int first = mesh_.tree().FirstChild(box);
  for (int child = first; child < first + mesh_.tree().NumChildren(box); ++child) {
    const double bound = LowerBound(child);
    if (bound < cutoff) out.Insert({bound, child});
  }
  return out;
}

void SdfMesh::AskTriangle(int triangle, SdfNearest& best) const {
  Vector3d corners[3];
  for (int k = 0; k < 3; ++k) corners[k] = pose_ * mesh_.Corner(triangle, k);
  SdfMinimum least;
  if (field_.type == mjGEOM_SPHERE) {
    least.x = NearestOnTriangle(Vector3d::Zero(), corners[0], corners[1], corners[2]);
    least.f = field_.At(least.x).f;
  } else if (field_.type == mjGEOM_CAPSULE) {
    const Vector3d end(0.0, 0.0, field_.size[1]), core[3] = {-end, end, end};
    Vector3d on_core;
    const double distance = TriangleDistance(corners, core, least.x, on_core);
    least.f = distance - field_.size[0];
    if (distance == 0.0) {
      // The points mean nothing: take the one where the segment crosses the triangle's plane.
      const Vector3d n = pose_.R * mesh_.Normal(triangle);
      const double low = n.dot(-end - corners[0]), high = n.dot(end - corners[0]);
      const double along = low == high ? 0.5 : std::clamp(low / (low - high), 0.0, 1.0);
      least.x = (2.0 * along - 1.0) * end;
    }
  } else {
    least = MinimumOnTriangle(field_, corners, best.f, kAccuracy);
  }
  if (least.f < best.f) best = {least.f, pose_.Inverse() * least.x, triangle};
}

SdfNearest SdfMesh::Nearest(double cutoff, int warm) const {
  return Below(BoxTree::kRoot, cutoff, warm);
}

SdfNearest SdfMesh::Below(int box, double cutoff, int warm) const {
  SdfNearest best;
  best.f = cutoff;
  if (warm >= 0) AskTriangle(warm, best);
  if (LowerBound(box) < best.f) Descend(box, best);
  return best;
}

void SdfMesh::Descend(int box, SdfNearest& best) const {
  if (mesh_.tree().IsLeaf(box)) return AskTriangle(mesh_.tree().TriangleOf(box), best);
  for (const BoundedBox& child : ChildrenBelow(box, best.f)) {
    if (child.bound < best.f) Descend(child.box, best);
  }
}

SignedGap SdfMesh::Gap(const SdfNearest& nearest) const {
  SignedGap gap;
  const SdfValue value = field_.At(pose_ * nearest.x);
  gap.distance = nearest.f;
  gap.p2 = nearest.x;
  gap.n = pose_.R.transpose() * value.gradient;
  gap.p1 = gap.p2 - nearest.f * gap.n;
  return gap;
}

bool SdfMesh::Contained() const {
  if (!mesh_.closed()) return false;
  if (field_.type == mjGEOM_PLANE) return false;  // infinite
  return mesh_.Contains(pose_.Inverse() * Vector3d::Zero());
}

double SdfMesh::PatchSize(double margin) const {
  const double size = std::min(mesh_.radius(), field_.OuterRadius());
  return std::max(kPatchPerMargin * margin, kPatchPerSize * size);
}

void SdfMesh::Patches(double margin, double patch, const SdfNearest& first,
                      std::vector<SdfNearest>& out) const {
  std::priority_queue<Patch, std::vector<Patch>, NearestFirst> parts;
  parts.push({first, BoxTree::kRoot});
  int queries = 0;
  for (int found = 0; found < kMaxPatches && !parts.empty() && queries < kMaxQueries;) {
    const Patch part = parts.top();
    parts.pop();
    const BoxTree& tree = mesh_.tree();
    if (tree.IsLeaf(part.box) || tree.HalfDiagonal(part.box) <= 0.5 * patch) {
      out.push_back(part.nearest);
      ++found;
      continue;
    }
    const int first_child = tree.FirstChild(part.box);
    for (int child = first_child; child < first_child + tree.NumChildren(part.box); ++child) {
      SdfNearest nearest = part.nearest;
      if (!tree.Holds(child, nearest.triangle)) {
        nearest = Below(child, margin, -1);
        ++queries;
      }
      if (nearest.triangle >= 0) parts.push({nearest, child});
    }
  }
}

void SdfMesh::Features(double margin, const SdfNearest& first, std::vector<SignedGap>& out) const {
  const double patch = PatchSize(margin);
  std::vector<SdfNearest> found;
  Patches(margin, patch, first, found);
  const std::size_t begin = out.size();
  for (const SdfNearest& nearest : found) {  // nearest first
    if (out.size() - begin >= static_cast<std::size_t>(BvhPair::kMaxFeatures)) break;
    if (nearest.f <= 0.0 && !out.empty()) continue;  // AppendOverlaps has reported the overlap
    const SignedGap gap = Gap(nearest);
    auto same = [&](const SignedGap& other) {
      return other.n.dot(gap.n) > BvhPair::kSameFeature && (other.p2 - gap.p2).norm() < 0.5 * patch;
    };
    if (std::any_of(out.begin() + static_cast<std::ptrdiff_t>(begin), out.end(), same)) continue;
    out.push_back(gap);
  }
}

// The first way leads from the support point along `outward` to the tangent plane at p, if the
// surface is not met before. The second comes from a few ascents: from a support point to its
// nearest surface point, and on to the support point against that direction, while that is deeper.
void SdfMesh::AppendWayFromWithin(const Vector3d& p, Vector3d outward,
                                  std::vector<WayOut>& ways) const {
  const Vector3d start = pose_.Inverse() * field_.Support(pose_.R * -outward);
  const double straight = outward.dot(p - start);
  std::vector<double> crossings;
  mesh_.Crossings(start, start + (straight + kBeyond) * outward, crossings);
  const bool clear =
      !crossings.empty() && crossings.front() * (straight + kBeyond) >= straight - kBeyond;
  if (straight > kAccuracy && clear && mesh_.Contains(start)) {
    ways.push_back({{-straight, start, start + straight * outward, -outward}, true});
  }
  WayOut best;
  for (int k = 0; k < kAscents; ++k) {
    const Vector3d y = pose_.Inverse() * field_.Support(pose_.R * -outward);
    const SurfacePoint nearest = mesh_.Nearest(y);
    if (!(nearest.distance > -best.gap.distance) || !mesh_.Contains(y)) break;
    outward = (nearest.p - y).normalized();
    best.gap.distance = -nearest.distance;
    best.gap.p1 = y;
    best.gap.p2 = nearest.p;
    best.gap.n = -outward;
  }
  if (best.gap.distance < -kAccuracy) ways.push_back(best);
}

void SdfMesh::AppendOverlaps(std::vector<SignedGap>& out) const {
  const double patch = PatchSize(0.0);
  std::vector<SdfNearest> found;
  const SdfNearest first = Nearest(0.0);
  if (first.triangle >= 0) Patches(0.0, patch, first, found);
  std::vector<WayOut> ways;
  for (const SdfNearest& nearest : found) {
    WayOut way;
    way.gap = Gap(nearest);
    way.faces_apart = !mesh_.closed() || way.gap.n.dot(mesh_.Normal(nearest.triangle)) < 0.0;
    if (field_.type == mjGEOM_PLANE) way.faces_apart = true;
    // Where the mesh passes through the core of a sphere or capsule, ∇f is not defined.
    const bool round = field_.type == mjGEOM_SPHERE || field_.type == mjGEOM_CAPSULE;
    if (round && nearest.f + field_.size[0] < kAccuracy) way.faces_apart = false;
    ways.push_back(way);
    if (!mesh_.closed() || field_.type == mjGEOM_PLANE) continue;
    AppendWayFromWithin(nearest.x, mesh_.Normal(nearest.triangle), ways);
  }
  if (mesh_.closed() && field_.type != mjGEOM_PLANE) {
    const Vector3d center = pose_.Inverse() * Vector3d::Zero();
    const SurfacePoint nearest = mesh_.Nearest(center);
    const bool inside = mesh_.Contains(center);
    const Vector3d out_of_mesh = (nearest.p - center) * (inside ? 1.0 : -1.0);
    if (nearest.distance > kAccuracy) {
      AppendWayFromWithin(nearest.p, out_of_mesh.normalized(), ways);
    }
  }
  AppendDeepest(ways, patch, out);
}

}  // namespace mjcf_pdg
