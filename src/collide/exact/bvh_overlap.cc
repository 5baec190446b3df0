#include "collide/exact/bvh_overlap.h"

#include <algorithm>
#include <queue>
#include <tuple>
#include <utility>

namespace mjcf_pdg {
namespace {

// Smaller depths define no direction [tree units; 2e-11 m in scenes of size 0.1 m].
constexpr double kNoDepth = 1e-7;
// The search ends when no point can be deeper than this factor times the deepest found.
constexpr double kDeepEnough = 1.1;
// A point is reported if it is deeper than this share of the deepest found so far on its side.
constexpr double kWorthARow = 0.3;
// Where no point is deeper than this, AppendCommonPoint tries, too [smaller mesh's radius].
constexpr double kShallow = 1e-3;
constexpr int kMaxWays = 8;  // the most gaps of one overlap
// Vertices are rounded to 6e-8 of the scene's size (MuJoCo stores float). Triangles of resting
// faces cross by that; this is some six times as much [tree units; 4e-8 m in scenes of size 0.1 m].
constexpr double kGrazing = 1.6e-4;
// Above this cosine of the angle between their normals, gaps in one place count as the same.
constexpr double kSameWay = 0.9;

// Searches for the deepest points of each mesh inside the other, by branch and bound over both
// hierarchies. A mesh that is not closed has no inside.
class DepthSearch {
 public:
  DepthSearch(const BvhPair& pair, int most_parts, std::vector<WayOut>& ways)
      : pair_(pair),
        sides_{{pair.a(), pair.b(), pair.pose().Inverse()}, {pair.b(), pair.a(), pair.pose()}},
        most_parts_(most_parts),
        ways_(ways) {}

  void Run() {
    for (const int side : {0, 1}) {
      if (sides_[side].in.closed()) parts_.push({.side = side});
    }
    for (int asked = 0; asked < most_parts_ && !parts_.empty();) {
      Part part = parts_.top();
      parts_.pop();
      const double deepest = std::max(deepest_[0], deepest_[1]);
      if (part.bound <= std::max(kNoDepth, kDeepEnough * deepest)) break;
      if (!part.asked) {
        ++asked;
        Ask(part);
        parts_.push(part);
      } else if (sides_[part.side].from.tree().IsLeaf(part.box)) {
        AskTriangle(part);
      } else {
        PushChildren(part);
      }
    }
  }

 private:
  // One direction of the search: points of the mesh `from` inside the mesh `in`. All points of a
  // Part are in the frame of `in`.
  struct Side {
    const TriangleBvh& from;
    const TriangleBvh& in;
    const RelativePose pose;  // from frame `from` to frame `in`

    // An upper bound of the distance from x to the points of a box of `from`.
    double Reach(int box, const Vector3d& x) const {
      const OrientedBox& shape = from.tree().BoxOf(box);
      const Vector3d away = pose * shape.Center().cast<double>() - x;
      const Vector3d local = shape.Along(pose.R.transpose() * away);
      return (local.cwiseAbs() + shape.half.cast<double>()).norm();
    }
  };
  // A box of one side's mesh, in the queue. Once it is `asked`, the depth of one of its vertices,
  // x, is known; until then x, nearest and winding are those of its parent.
  struct Part {
    double bound = std::numeric_limits<double>::infinity();  // of the depth of the box's points
    int side = 0;
    int box = BoxTree::kRoot;
    Vector3d x = Vector3d::Zero();
    SurfacePoint nearest = {};  // the other surface's nearest point to x
    int winding = 0;            // of the other surface round x; not 0: x is inside
    bool asked = false;

    bool Knows() const { return nearest.triangle >= 0; }
    double Depth() const { return winding != 0 ? nearest.distance : -nearest.distance; }
    bool operator<(const Part& other) const {
      return std::tuple(bound, asked, -box, -side) <
             std::tuple(other.bound, other.asked, -other.box, -other.side);
    }
  };

  // Sets the upper bound of the box's depths by two facts: a depth changes no faster than the point
  // moves, and no point is deeper than its distance from the surface point part.nearest.
  void Bound(Part& part) const {
    const Side& side = sides_[part.side];
    part.bound = std::min({part.bound, part.Depth() + side.Reach(part.box, part.x),
                           side.Reach(part.box, part.nearest.p)});
  }

  void Ask(Part& part) {
    const Side& side = sides_[part.side];
    const int triangle = side.from.tree().MiddleTriangle(part.box);
    const Vector3d x = side.pose * side.from.Corner(triangle, 0);
    part.winding = part.Knows() ? WindingBeside(part, x) : side.in.Winding(x);
    part.nearest = side.in.NearestFrom(part.nearest, x);
    part.x = x;
    Bound(part);
    part.asked = true;
    if (part.winding != 0) Record(part.side, part.nearest, x, triangle);
  }

  // The winding number of x, a point near part.x. It is that of part.x if x is nearer to part.x
  // than the surface; else crossings between the two are counted. Where part.x is on the surface
  // its own winding number means nothing, and that of x is computed anew.
  int WindingBeside(const Part& part, const Vector3d& x) const {
    const TriangleBvh& in = sides_[part.side].in;
    if ((x - part.x).norm() < part.nearest.distance) return part.winding;
    const bool on_surface = part.nearest.distance <= kNoDepth;
    return on_surface ? in.Winding(x) : in.WindingFrom(part.x, part.winding, x);
  }

  // Pushes the children that may have points inside the other mesh: those that may meet its root's
  // box.
  void PushChildren(const Part& parent) {
    const bool of_a = parent.side == 0;
    const BvhPair::Boxes boxes =
        of_a ? BvhPair::Boxes{.a = parent.box} : BvhPair::Boxes{.b = parent.box};
    for (const BoundedBox& near : pair_.ChildrenNear(boxes, of_a, 0.0)) {
      Part child = parent;
      child.box = near.box;
      child.asked = false;
      Bound(child);
      parts_.push(child);
    }
  }

  void AskTriangle(const Part& leaf) {
    const Side& side = sides_[leaf.side];
    const int triangle = side.from.tree().TriangleOf(leaf.box);
    Vector3d x[3];
    for (int k = 0; k < 3; ++k) x[k] = side.pose * side.from.Corner(triangle, k);
    for (const Vector3d& p : {x[1], x[2], Vector3d((x[0] + x[1] + x[2]) / 3.0)}) AskPoint(p, leaf);
    // If the other surface is farther from leaf.x than all of the triangle, no edge crosses it.
    if (leaf.nearest.distance > side.Reach(leaf.box, leaf.x)) return;
    for (int k = 0; k < 3; ++k) AskEdge(x[k], x[(k + 1) % 3], leaf);
  }

  void AskEdge(const Vector3d& p, const Vector3d& q, const Part& leaf) {
    sides_[leaf.side].in.Crossings(p, q, crossings_);
    if (crossings_.empty()) return;
    crossings_.insert(crossings_.begin(), 0.0);
    crossings_.push_back(1.0);
    for (std::size_t i = 0; i + 1 < crossings_.size(); ++i) {
      AskPoint(p + 0.5 * (crossings_[i] + crossings_[i + 1]) * (q - p), leaf);
    }
  }

  void AskPoint(const Vector3d& x, const Part& leaf) {
    const Side& side = sides_[leaf.side];
    const SurfacePoint nearest = side.in.NearestFrom(leaf.nearest, x);
    if (!WorthARow(leaf.side, nearest.distance) || WindingBeside(leaf, x) == 0) return;
    Record(leaf.side, nearest, x, side.from.tree().TriangleOf(leaf.box));
  }

  bool WorthARow(int of, double depth) const {
    return depth > std::max(kNoDepth, kWorthARow * deepest_[of]);
  }

  // Appends the way out of x, a point of `triangle` of the mesh sides_[of].from inside the other
  // mesh, if it is deep enough. `way_out` is the other surface's nearest point.
  void Record(int of, const SurfacePoint& way_out, const Vector3d& x, int triangle) {
    if (!WorthARow(of, way_out.distance)) return;
    deepest_[of] = std::max(deepest_[of], way_out.distance);
    const Side& side = sides_[of];
    const Vector3d out = (way_out.p - x) / way_out.distance;
    WayOut way{{-way_out.distance, way_out.p, x, out}};
    way.faces_apart =
        !side.from.closed() || out.dot(side.pose.R * side.from.Normal(triangle)) < 0.0;
    if (of == 0) {
      const RelativePose& b_in_a = sides_[1].pose;
      way.gap.p1 = b_in_a * x;
      way.gap.p2 = b_in_a * way_out.p;
      way.gap.n = b_in_a.R * -out;
    }
    ways_.push_back(way);
  }

  const BvhPair& pair_;
  const Side sides_[2];              // points of a in b, points of b in a
  const int most_parts_;             // the most boxes to be asked
  std::priority_queue<Part> parts_;  // the largest bound first
  std::vector<double> crossings_;    // scratch of AskEdge
  double deepest_[2] = {0.0, 0.0};   // the largest depth found on each side
  std::vector<WayOut>& ways_;        // the result, in the frame of a
};

// Where the two surfaces nearly coincide, no point of one is deep inside the other. This looks
// along the inward normal of a triangle of a that is nearest to b, for the point inside both meshes
// that is deepest in b, and appends its ways out of b.
void AppendCommonPoint(const BvhPair& pair, std::vector<WayOut>& ways) {
  if (!pair.a().closed() || !pair.b().closed()) return;
  const NearestTriangles near = pair.Nearest(std::numeric_limits<double>::infinity());
  const Vector3d middle =
      (pair.a().Corner(near.a, 0) + pair.a().Corner(near.a, 1) + pair.a().Corner(near.a, 2)) / 3.0;
  const RelativePose a_in_b = pair.pose().Inverse();
  double deepest = kNoDepth;
  for (double h = pair.a().radius(); h > kNoDepth; h *= 0.25) {
    const Vector3d x = middle - h * pair.a().Normal(near.a);
    if (!pair.a().Contains(x) || !pair.b().Contains(a_in_b * x)) continue;
    const SurfacePoint way_out = pair.b().Nearest(a_in_b * x);
    if (way_out.distance <= deepest) continue;
    deepest = way_out.distance;
    const Vector3d p = pair.pose() * way_out.p;
    ways.push_back({{-deepest, x, p, (x - p) / deepest}, true});
  }
}

// Where a mesh has many pieces, DepthSearch may end before it comes to one that is inside the other
// mesh. This appends the ways out of the points of pieces by which Contained finds them.
void AppendPieces(const BvhPair& pair, std::vector<WayOut>& ways) {
  const RelativePose &b_in_a = pair.pose(), a_in_b = b_in_a.Inverse();
  for (const Vector3d& x_b : pair.b().pieces()) {
    const Vector3d x = b_in_a * x_b;
    if (!pair.a().closed() || !pair.a().Contains(x)) continue;
    const SurfacePoint way_out = pair.a().Nearest(x);
    ways.push_back({{-way_out.distance, way_out.p, x, (way_out.p - x).normalized()}, true});
  }
  for (const Vector3d& x : pair.a().pieces()) {
    if (!pair.b().closed() || !pair.b().Contains(a_in_b * x)) continue;
    const SurfacePoint way_out = pair.b().Nearest(a_in_b * x);
    const Vector3d p = b_in_a * way_out.p;
    ways.push_back({{-way_out.distance, x, p, (x - p).normalized()}, true});
  }
}

}  // namespace

bool Contained(const BvhPair& pair) {
  auto some = [](const TriangleBvh& from, const TriangleBvh& in, const RelativePose& pose) {
    if (!in.closed()) return false;
    return std::any_of(from.pieces().begin(), from.pieces().end(),
                       [&](const Vector3d& x) { return in.Contains(pose * x); });
  };
  return some(pair.b(), pair.a(), pair.pose()) || some(pair.a(), pair.b(), pair.pose().Inverse());
}

void AppendDeepest(std::vector<WayOut>& ways, double patch, std::vector<SignedGap>& out) {
  std::stable_sort(ways.begin(), ways.end(), [](const WayOut& x, const WayOut& y) {
    if (x.faces_apart != y.faces_apart) return x.faces_apart;
    return x.gap.distance < y.gap.distance;
  });
  const std::size_t begin = out.size();
  for (const WayOut& way : ways) {
    if (out.size() - begin >= static_cast<std::size_t>(kMaxWays)) break;
    if (!way.faces_apart && out.size() > begin) break;
    auto same = [&](const SignedGap& gap) {
      return gap.n.dot(way.gap.n) > kSameWay && (gap.p1 - way.gap.p1).norm() < patch;
    };
    if (std::any_of(out.begin() + static_cast<std::ptrdiff_t>(begin), out.end(), same)) continue;
    out.push_back(way.gap);
  }
}

void AppendOverlaps(const BvhPair& pair, int most_parts, std::vector<SignedGap>& out) {
  std::vector<WayOut> ways;
  DepthSearch(pair, most_parts, ways).Run();
  const double size = std::min(pair.a().radius(), pair.b().radius());
  auto deep = [size](const WayOut& way) { return -way.gap.distance > kShallow * size; };
  if (std::none_of(ways.begin(), ways.end(), deep)) AppendCommonPoint(pair, ways);
  if (ways.empty()) {
    // What is roughly the nearest may be farther than kTouching where the nearest is not.
    const NearestTriangles crossing = pair.RoughlyNearest(2.0 * BvhPair::kTouching, nullptr);
    if (crossing.a >= 0) return out.push_back(TriangleGap(pair, crossing));
    AppendPieces(pair, ways);
  }
  AppendDeepest(ways, 0.25 * size, out);
}

std::optional<SignedGap> Graze(const BvhPair& pair, const NearestTriangles& crossing) {
  const SignedGap of_triangles = TriangleGap(pair, crossing);
  if (-of_triangles.distance > kGrazing) return std::nullopt;
  const Vector3d ways[] = {of_triangles.n, pair.a().Normal(crossing.a),
                           -(pair.pose().R * pair.b().Normal(crossing.b))};
  for (const Vector3d& n : ways) {
    const Vector3d move = kGrazing * n;
    const BvhPair moved(pair.a(), pair.b(), {pair.pose().R, pair.pose().t + move});
    if (moved.Nearest(BvhPair::kTouching, &crossing).a >= 0 || Contained(moved)) continue;
    return SignedGap{-kGrazing, of_triangles.p1, of_triangles.p1 - move, n};
  }
  return std::nullopt;
}

SignedGap TriangleGap(const BvhPair& pair, const NearestTriangles& crossing) {
  Vector3d first[3], second[3];
  for (int k = 0; k < 3; ++k) {
    first[k] = pair.a().Corner(crossing.a, k);
    second[k] = pair.pose() * pair.b().Corner(crossing.b, k);
  }
  SignedGap gap;
  const double depth = std::max(TriangleOverlap(first, second, gap.n), 0.0);
  const Vector3d middle =
      (first[0] + first[1] + first[2] + second[0] + second[1] + second[2]) / 6.0;
  gap.distance = -depth;
  gap.p1 = middle + 0.5 * depth * gap.n;
  gap.p2 = middle - 0.5 * depth * gap.n;
  return gap;
}

double TriangleOverlap(const Vector3d first[3], const Vector3d second[3], Vector3d& n) {
  double least = std::numeric_limits<double>::infinity();
  auto consider = [&](const Vector3d& axis, double smallest) {
    const double length = axis.norm();
    if (!(length > smallest)) return;
    const Vector3d u = axis / length;
    double low1 = u.dot(first[0]), high1 = low1, low2 = u.dot(second[0]), high2 = low2;
    for (int k = 1; k < 3; ++k) {
      low1 = std::min(low1, u.dot(first[k]));
      high1 = std::max(high1, u.dot(first[k]));
      low2 = std::min(low2, u.dot(second[k]));
      high2 = std::max(high2, u.dot(second[k]));
    }
    const double forward = high1 - low2, backward = high2 - low1;  // along u, along -u
    if (std::min(forward, backward) >= least) return;
    least = std::min(forward, backward);
    n = forward <= backward ? u : Vector3d(-u);
  };
  Vector3d e1[3], e2[3];
  for (int k = 0; k < 3; ++k) {
    e1[k] = first[(k + 1) % 3] - first[k];
    e2[k] = second[(k + 1) % 3] - second[k];
  }
  const Vector3d n1 = e1[0].cross(e1[1]), n2 = e2[0].cross(e2[1]);
  consider(n1, 0.0);
  consider(n2, 0.0);
  for (const Vector3d& a : e1) {
    for (const Vector3d& b : e2) consider(a.cross(b), 1e-9 * a.norm() * b.norm());
    consider(a.cross(n1), 0.0);
  }
  for (const Vector3d& b : e2) consider(b.cross(n2), 0.0);
  return least;
}

}  // namespace mjcf_pdg
