#include "verify/exact_pair.h"

#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "verify/exact/mesh_solid.h"
#include "verify/exact/primitive_distance.h"
#include "verify/exact/triangles.h"

namespace mjcf_pdg::verify {
namespace {

using RowMajor3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Most crossing pairs of triangles that FCL is asked for: to measure an overlap, and to detect one.
constexpr std::size_t kMaxTrianglePairs = 100000;
constexpr std::size_t kFewPairs = 4;
// Shares of the sum of the two bodies' extents. An overlap of kMaxTrianglePairs or more crossings
// is at least the first one deep. An overlap that no translation proves to be permitted counts as
// deeper than permitted by the second one.
constexpr double kUnmeasured = 1e-3, kUnproven = 1e-9;
// Directions in which a translation may separate two bodies: crossings add directions until there
// are this many, and none whose cosine with a known one exceeds kSameDirection.
constexpr std::size_t kMaxDirections = 12;
constexpr double kSameDirection = 0.98;
// Number of triangles per body of which points are looked for inside the other: at first a few,
// which find most overlaps, then more.
constexpr int kFewAsked = 30, kAllAsked = 200;

// A lower bound of the primitive's signed distance on the triangle [m]: the distance is convex, so
// it lies above its tangent plane at the triangle's middle. Returns -infinity if the middle is
// inside the primitive, where the distance has kinks and differences give no gradient.
double LinearBound(int type, const Vector3d& size, const Vector3d corners[3]) {
  constexpr double kDifferences = 1e-5;  // error of the gradient by differences
  const Vector3d middle = (corners[0] + corners[1] + corners[2]) / 3.0;
  const double at_middle = RoundDistanceAt(type, size, middle);
  double reach = 0.0;
  for (int k = 0; k < 3; ++k) reach = std::max(reach, (corners[k] - middle).norm());
  if (at_middle < kDifferences * reach) return -kInfinity;
  const Vector3d n = RoundNormalAt(type, size, middle);
  double fall = 0.0;
  for (int k = 0; k < 3; ++k) fall = std::min(fall, n.dot(corners[k] - middle));
  return at_middle + fall - kDifferences * reach;
}

}  // namespace

struct ExactPairs::Asked {
  const mjData& posed;
  const CheckedPair& pair;
  const MeshSolid *first, *second;  // of geom 1 (null: a plane or round primitive) and geom 2
  double permitted;                 // [m]
  Depths depths;
  double* fromto;
  Vector3d shift_W = Vector3d::Zero();  // translation that geom 2 gets in addition to its pose [m]

  Matrix3d R(int geom) const { return Eigen::Map<const RowMajor3>(posed.geom_xmat + 9 * geom); }
  Vector3d Origin(int geom) const {
    const Vector3d origin = Eigen::Map<const Vector3d>(posed.geom_xpos + 3 * geom);
    return geom == pair.geom2 ? Vector3d(origin + shift_W) : origin;
  }
  fcl::Transform3<double> FclPose(int geom) const {
    fcl::Transform3<double> pose;
    pose.linear() = R(geom);
    pose.translation() = Scale() * Origin(geom);
    return pose;
  }
  // Pairs of triangles that intersect according to FCL, at most `most` of them.
  using Crossings = fcl::CollisionResult<double>;
  Crossings FirstCrossings(std::size_t most) const {
    Crossings crossings;
    fcl::collide(&first->tree, FclPose(pair.geom1), &second->tree, FclPose(pair.geom2),
                 fcl::CollisionRequest<double>(most), crossings);
    return crossings;
  }
  double Scale() const { return second->scale; }  // units of FCL's trees per metre
  double Extent() const { return first->extent + second->extent; }
  double TrianglesOverlap(const Crossings& crossings) const;
  std::vector<Vector3d> WaysApart(const Crossings& crossings) const;
  void Witness(const Vector3d& p1_W, const Vector3d& p2_W) const {
    Eigen::Map<Vector3d>(fromto, 3) = p1_W;
    Eigen::Map<Vector3d>(fromto + 3, 3) = p2_W;
  }
};

// One body of the pair, whose points are looked for inside the other.
struct ExactPairs::Side {
  Side(const Asked& pair, bool is_first)
      : asked(pair),
        of_first(is_first),
        from(is_first ? pair.pair.geom1 : pair.pair.geom2),
        in(is_first ? pair.pair.geom2 : pair.pair.geom1),
        source(is_first ? *pair.first : *pair.second),
        target(is_first ? *pair.second : *pair.first) {}

  // How deep p (in this body's geom frame) is inside the other body [m], 0 if it is not; `out_W` is
  // the unit direction of the way out.
  double DepthOf(const Vector3d& p, Vector3d& out_W) const {
    Vector3d out = Vector3d::Zero();
    const Vector3d there = asked.R(in).transpose() * (InWorld(p) - asked.Origin(in));
    const double depth = target.DepthOf(there, out);
    out_W = asked.R(in) * out;
    return depth;
  }
  Vector3d InWorld(const Vector3d& p) const { return asked.Origin(from) + asked.R(from) * p; }
  // Makes a point of this body and the point where it would leave the other the witness points.
  void Witness(const Vector3d& p_W, const Vector3d& exit_W) const {
    of_first ? asked.Witness(p_W, exit_W) : asked.Witness(exit_W, p_W);
  }

  const Asked& asked;
  const bool of_first;
  const int from, in;  // geoms
  const MeshSolid &source, &target;
};

double ExactPairs::Distance(const mjData& posed, const CheckedPair& pair, double cutoff,
                            double permitted, Depths depths, double fromto[6]) const {
  const Asked asked{
      posed,  pair,  model_.solids[pair.geom1].get(), model_.solids[pair.geom2].get(), permitted,
      depths, fromto};
  return asked.first ? BvhDistance(asked, cutoff) : RoundDistance(asked, cutoff);
}

// Returns minus the depth [m] of the deepest point found inside the other body, 0 if none is
// inside, and makes it the witness. Tried are the probes of both bodies, and a vertex and the
// middle of up to `triangles` triangles of each.
double ExactPairs::Deepest(const Asked& asked, int triangles) const {
  double deepest = 0.0;
  for (const bool of_first : {true, false}) {
    const Side side(asked, of_first);
    auto ask = [&](const Vector3d& p, double most) {
      Vector3d out_W;
      const double depth = std::min(most, side.DepthOf(p, out_W));
      if (depth <= -deepest) return;
      deepest = -depth;
      side.Witness(side.InWorld(p), side.InWorld(p) + depth * out_W);
    };
    for (const auto& [p, inside] : side.source.probes) ask(p, inside > 0.0 ? inside : kInfinity);
    const Triangles& all = side.source.triangles;
    const std::size_t count = std::min<std::size_t>(triangles, all.size());
    for (std::size_t k = 0; k < count; ++k) {
      const auto& t = all[k * all.size() / count];
      ask(t[0], kInfinity);
      ask((t[0] + t[1] + t[2]) / 3.0, kInfinity);
    }
  }
  return deepest;
}

// Surfaces that coincide need not cross, and their points are not inside. Points at some distances
// below and above the middles of some triangles may be inside both bodies: returns minus the depth
// [m] of the deepest, 0 if none is. Its depth is the shorter of its ways out of the two bodies.
double ExactPairs::CommonPoint(const Asked& asked) const {
  constexpr int kTriangles = 20;
  double deepest = 0.0;
  for (const bool of_first : {true, false}) {
    const Side side(asked, of_first);
    const auto& triangles = side.source.triangles;
    for (std::size_t k = 0; k < triangles.size(); k += 1 + triangles.size() / kTriangles) {
      const auto& t = triangles[k];
      const Vector3d n = (t[1] - t[0]).cross(t[2] - t[0]).normalized();
      for (const double share : {0.1, -0.1, 1e-2, -1e-2, 1e-3, -1e-3}) {
        const Vector3d x = (t[0] + t[1] + t[2]) / 3.0 - share * side.source.extent * n;
        Vector3d out, out_W;
        const double own = side.source.DepthOf(x, out);
        if (own <= -deepest) continue;
        const double depth = std::min(own, side.DepthOf(x, out_W));
        if (depth <= -deepest) continue;
        deepest = -depth;
        side.Witness(side.InWorld(x), side.InWorld(x) + depth * out_W);
      }
    }
  }
  return deepest;
}

// Returns minus the depth [m] of the overlap as the triangles tell it: of each crossing pair the
// least translation that separates it, of all pairs the largest. Sets the witness points.
double ExactPairs::Asked::TrianglesOverlap(const Crossings& crossings) const {
  const int g1 = pair.geom1, g2 = pair.geom2;
  const Matrix3d R1 = R(g1), R2 = R(g2);
  double overlap = 0.0;
  for (std::size_t k = 0; k < crossings.numContacts(); ++k) {
    std::array<Vector3d, 3> s, t;
    for (int c = 0; c < 3; ++c) {
      s[c] = Origin(g1) + R1 * first->triangles[crossings.getContact(k).b1][c];
      t[c] = Origin(g2) + R2 * second->triangles[crossings.getContact(k).b2][c];
    }
    Vector3d n = Vector3d::UnitZ();
    const double move = LeastMove(s, t, n);
    if (k > 0 && move <= overlap) continue;
    overlap = move;
    const Vector3d middle = (s[0] + s[1] + s[2] + t[0] + t[1] + t[2]) / 6.0;
    Witness(middle + 0.5 * move * n, middle - 0.5 * move * n);
  }
  if (crossings.numContacts() >= kMaxTrianglePairs)
    overlap = std::max(overlap, kUnmeasured * Extent());
  return -overlap;
}

// Unit directions along which a translation of the second body may separate the two: normals of
// crossing triangles (of a surface that is not closed, both ways), and the sum of these.
std::vector<Vector3d> ExactPairs::Asked::WaysApart(const Crossings& crossings) const {
  std::vector<Vector3d> ways;
  auto add = [&](const Vector3d& n_W) {
    auto same = [&](const Vector3d& known) { return known.dot(n_W) > kSameDirection; };
    if (std::none_of(ways.begin(), ways.end(), same)) ways.push_back(n_W);
  };
  auto normal_W = [&](int geom, const MeshSolid& shape, std::intptr_t triangle) {
    const auto& t = shape.triangles[triangle];
    return Vector3d(R(geom) * (t[1] - t[0]).cross(t[2] - t[0]).normalized());
  };
  for (std::size_t k = 0; k < crossings.numContacts() && ways.size() < kMaxDirections; ++k) {
    const Vector3d n1_W = normal_W(pair.geom1, *first, crossings.getContact(k).b1);
    const Vector3d n2_W = normal_W(pair.geom2, *second, crossings.getContact(k).b2);
    add(n1_W);
    add(-n2_W);
    if (!first->closed) add(-n1_W);
    if (!second->closed) add(n2_W);
  }
  Vector3d sum = Vector3d::Zero();
  for (const Vector3d& n_W : ways) sum += n_W;
  if (sum.norm() > 1e-6) ways.push_back(sum.normalized());
  return ways;
}

// True if a translation of the second body by `permitted` along one of the directions separates the
// two, which proves that they overlap by no more. Measured depths prove no such thing: that of
// crossing triangles is limited by the size of the triangles, and points inside may miss the
// deepest.
bool ExactPairs::PartedByAMove(const Asked& asked, const std::vector<Vector3d>& ways_W) const {
  return std::any_of(ways_W.begin(), ways_W.end(), [&](const Vector3d& n_W) {
    Asked moved = asked;
    double unheard[6];
    moved.fromto = unheard;
    moved.shift_W = asked.permitted * n_W;
    return !moved.FirstCrossings(1).isCollision() && Deepest(moved, 0) >= 0.0;
  });
}

// Returns minus the depth [m] of two bodies whose triangles intersect.
double ExactPairs::BvhOverlap(const Asked& asked) const {
  const Asked::Crossings crossings = asked.FirstCrossings(kMaxTrianglePairs);
  double least = asked.TrianglesOverlap(crossings);
  double witness[6];
  std::copy(asked.fromto, asked.fromto + 6, witness);
  auto take = [&](double depth) {
    if (depth >= least) return false;
    least = depth;
    std::copy(asked.fromto, asked.fromto + 6, witness);
    return true;
  };
  const double deepest_of_interest = asked.permitted + rest_;
  const bool enough = take(Deepest(asked, kFewAsked)) && least < -deepest_of_interest;
  if (!enough) take(Deepest(asked, kAllAsked));
  if (!enough && least >= -deepest_of_interest) take(CommonPoint(asked));
  std::copy(witness, witness + 6, asked.fromto);
  if (least >= -asked.permitted && !PartedByAMove(asked, asked.WaysApart(crossings))) {
    least = -asked.permitted - kUnproven * asked.Extent();
  }
  return least;
}

// The signed distance of two bodies of triangles: what Distance returns.
double ExactPairs::BvhDistance(const Asked& asked, double cutoff) const {
  const Asked::Crossings crossings = asked.FirstCrossings(kFewPairs);
  if (crossings.isCollision()) {
    const double overlap = asked.TrianglesOverlap(crossings);
    const bool told = asked.depths == Depths::kSkipped && overlap < -asked.permitted - rest_;
    return told ? overlap : BvhOverlap(asked);
  }
  const double inside = Deepest(asked, 0);
  if (inside < 0.0) return inside;
  if (asked.depths == Depths::kSkipped) return kInfinity;
  fcl::DistanceRequest<double> wish(true);
  fcl::DistanceResult<double> nearest;
  nearest.min_distance = asked.Scale() * cutoff;
  fcl::distance(&asked.first->tree, asked.FclPose(asked.pair.geom1), &asked.second->tree,
                asked.FclPose(asked.pair.geom2), wish, nearest);
  if (nearest.b1 < 0) return kInfinity;
  asked.Witness(nearest.nearest_points[0] / asked.Scale(),
                nearest.nearest_points[1] / asked.Scale());
  return nearest.min_distance / asked.Scale();
}

// The signed distance of a plane or round primitive (geom 1) and a mesh: what Distance returns.
double ExactPairs::RoundDistance(const Asked& asked, double cutoff) const {
  const mjModel& m = model_.unblinded;
  const int round = asked.pair.geom1, mesh = asked.pair.geom2, type = m.geom_type[round];
  const Vector3d size = Eigen::Map<const Vector3d>(m.geom_size + 3 * round);
  const Matrix3d R = asked.R(round).transpose() * asked.R(mesh);
  const Vector3d origin = asked.R(round).transpose() * (asked.Origin(mesh) - asked.Origin(round));
  std::vector<std::pair<double, std::size_t>> order;
  const Triangles& triangles = asked.second->triangles;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const Vector3d middle = (triangles[t][0] + triangles[t][1] + triangles[t][2]) / 3.0;
    double reach = 0.0;
    for (const Vector3d& p : triangles[t]) reach = std::max(reach, (p - middle).norm());
    const double bound = RoundDistanceAt(type, size, origin + R * middle) - reach;
    if (bound < cutoff) order.emplace_back(bound, t);
  }
  std::sort(order.begin(), order.end());
  double least = cutoff;
  Vector3d at = Vector3d::Zero();
  for (const auto& [bound, t] : order) {
    if (bound >= least) break;
    Vector3d corners[3], x;
    for (int k = 0; k < 3; ++k) corners[k] = origin + R * triangles[t][k];
    if (LinearBound(type, size, corners) > least) continue;
    const double distance = RoundDistanceOnTriangle(type, size, corners, x);
    if (distance >= least) continue;
    least = distance;
    at = x;
  }
  Vector3d out;
  const Vector3d center = -(R.transpose() * origin);
  const double inside = type == mjGEOM_PLANE ? 0.0 : asked.second->DepthOf(center, out);
  const Matrix3d R_W = asked.R(round);
  // The primitive's centre is inside the mesh, deeper than the mesh's surface is inside the
  // primitive.
  if (inside > std::max(0.0, -least)) {
    const Vector3d center_W = asked.Origin(round);
    asked.Witness(center_W, center_W + inside * (asked.R(mesh) * out));
    return -inside;
  }
  if (least >= cutoff) return kInfinity;
  const Vector3d at_W = asked.Origin(round) + R_W * at;
  asked.Witness(at_W - least * (R_W * RoundNormalAt(type, size, at)), at_W);
  return least;
}

}  // namespace mjcf_pdg::verify
