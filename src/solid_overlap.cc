#include "solid_overlap.h"

#include <algorithm>
#include <queue>
#include <tuple>
#include <utility>

namespace mjcf_pdg {
namespace {

constexpr double kNoDepth = 1e-7;    // depths below this have no direction (2e-11 m)
constexpr double kDeepEnough = 1.1;  // stop when nothing is deeper than this factor
constexpr double kWorthARow = 0.3;   // of the deepest found so far
constexpr double kShallow = 1e-3;    // of the smaller mesh's radius
constexpr int kMaxWays = 8;          // rows of one overlap
constexpr double kSameDirection = 0.9;

// Points of `from` inside `in`, by branch and bound on their depth.
class DepthSearch {
 public:
  // `pose`: from -> in.
  DepthSearch(const Solid& from, const Solid& in, const RelativePose& pose, int most_parts)
      : from_(from), in_(in), pose_(pose), most_parts_(most_parts) {}

  struct Point {
    double depth = 0.0;
    Vector3d x, p;  // in the frame of `in`: the point and its nearest one on the surface
    int triangle = -1;
  };

  std::vector<Point> Run() {
    parts_.push({});
    for (int asked = 0; asked < most_parts_ && !parts_.empty();) {
      Part part = parts_.top();
      parts_.pop();
      if (part.bound <= kDeepEnough * deepest_ || part.bound <= kNoDepth) break;
      if (!part.asked) {
        ++asked;
        Ask(part);
        parts_.push(part);
      } else if (from_.tree().IsLeaf(part.box)) {
        AskTriangle(part);
      } else {
        PushChildren(part);
      }
    }
    return std::move(points_);
  }

 private:
  // Asked: how deep some vertex x of it is. If not, x and what is known of it are its parent's.
  struct Part {
    double bound = std::numeric_limits<double>::infinity();  // no point of it is deeper
    int box = BoxTree::kRoot;
    Vector3d x;
    SurfacePoint nearest;  // to x
    bool inside = false, asked = false;

    double Depth() const { return inside ? nearest.distance : -nearest.distance; }
    bool operator<(const Part& other) const {
      return std::tuple(bound, asked, -box) < std::tuple(other.bound, other.asked, -other.box);
    }
  };

  // How far the box reaches from x.
  double Reach(int box, const Vector3d& x) const {
    const OrientedBox& shape = from_.tree().BoxOf(box);
    const Vector3d away = pose_ * shape.Center().cast<double>() - x;
    const Vector3d local = shape.Along(pose_.R.transpose() * away);
    return (local.cwiseAbs() + shape.half.cast<double>()).norm();
  }

  void Ask(Part& part) {
    const int triangle = from_.tree().MiddleTriangle(part.box);
    const Vector3d x = pose_ * from_.Corner(triangle, 0);
    // No surface between the two: the same side.
    const bool same_side =
        part.nearest.triangle >= 0 && (x - part.x).norm() < part.nearest.distance;
    part.nearest = in_.NearestFrom(part.nearest, x);
    if (!same_side) part.inside = in_.Contains(x);
    part.x = x;
    part.bound = std::min(part.bound, part.Depth() + Reach(part.box, x));
    part.asked = true;
    if (part.inside) Record(part.nearest, x, triangle);
  }

  void PushChildren(const Part& parent) {
    const int first = from_.tree().FirstChild(parent.box);
    for (int k = 0; k < from_.tree().NumChildren(parent.box); ++k) {
      Part child = parent;
      child.box = first + k;
      child.asked = false;
      child.bound = std::min(parent.bound, parent.Depth() + Reach(child.box, parent.x));
      parts_.push(child);
    }
  }

  void AskTriangle(const Part& leaf) {
    const int triangle = from_.tree().TriangleOf(leaf.box);
    // No surface within: its points are on one side, and its edges cross nothing.
    const bool one_side = leaf.nearest.distance > Reach(leaf.box, leaf.x);
    Vector3d x[3];
    for (int k = 0; k < 3; ++k) x[k] = pose_ * from_.Corner(triangle, k);
    for (const Vector3d& p : {x[1], x[2], Vector3d((x[0] + x[1] + x[2]) / 3.0)}) {
      AskPoint(p, leaf, one_side);
    }
    if (one_side) return;
    for (int k = 0; k < 3; ++k) AskEdge(x[k], x[(k + 1) % 3], leaf);
  }

  void AskEdge(const Vector3d& p, const Vector3d& q, const Part& leaf) {
    in_.Crossings(p, q, crossings_);
    if (crossings_.empty()) return;
    crossings_.insert(crossings_.begin(), 0.0);
    crossings_.push_back(1.0);
    for (std::size_t i = 0; i + 1 < crossings_.size(); ++i) {
      AskPoint(p + 0.5 * (crossings_[i] + crossings_[i + 1]) * (q - p), leaf, false);
    }
  }

  // `same_side`: as the leaf's vertex.
  void AskPoint(const Vector3d& x, const Part& leaf, bool same_side) {
    const SurfacePoint nearest = in_.NearestFrom(leaf.nearest, x);
    if (!WorthARow(nearest.distance)) return;
    if (same_side ? !leaf.inside : !in_.Contains(x)) return;
    Record(nearest, x, from_.tree().TriangleOf(leaf.box));
  }

  bool WorthARow(double depth) const { return depth > std::max(kNoDepth, kWorthARow * deepest_); }

  void Record(const SurfacePoint& way_out, const Vector3d& x, int triangle) {
    if (!WorthARow(way_out.distance)) return;
    points_.push_back({way_out.distance, x, way_out.p, triangle});
    deepest_ = std::max(deepest_, way_out.distance);
  }

  const Solid& from_;
  const Solid& in_;
  const RelativePose pose_;
  const int most_parts_;  // asked for the depth of some vertex
  std::priority_queue<Part> parts_;
  std::vector<Point> points_;
  std::vector<double> crossings_;
  double deepest_ = 0.0;
};

// Points of a inside b and the other way round, in the frame of a.
void AppendWays(const SolidPair& pair, bool of_a, int most_parts, std::vector<WayOut>& ways) {
  const Solid& from = of_a ? pair.a() : pair.b();
  const Solid& in = of_a ? pair.b() : pair.a();
  if (!in.closed()) return;
  const RelativePose pose = of_a ? pair.pose().Inverse() : pair.pose();
  for (const DepthSearch::Point& point : DepthSearch(from, in, pose, most_parts).Run()) {
    const Vector3d out = (point.p - point.x) / point.depth;  // the point's way, `in`'s frame
    WayOut way;
    way.faces_apart = !from.closed() || out.dot(pose.R * from.Normal(point.triangle)) < 0.0;
    way.gap.distance = -point.depth;
    if (of_a) {
      way.gap.p1 = pair.pose() * point.x;
      way.gap.p2 = pair.pose() * point.p;
      way.gap.n = pair.pose().R * -out;
    } else {
      way.gap.p1 = point.p;
      way.gap.p2 = point.x;
      way.gap.n = out;
    }
    ways.push_back(way);
  }
}

// Where the surfaces coincide, or nearly, their points say little: a point below one's surface may
// be deep inside both.
void AppendCommonPoint(const SolidPair& pair, std::vector<WayOut>& ways) {
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

}  // namespace

bool Contained(const SolidPair& pair) {
  auto some = [](const Solid& from, const Solid& in, const RelativePose& pose) {
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
      return gap.n.dot(way.gap.n) > kSameDirection && (gap.p1 - way.gap.p1).norm() < patch;
    };
    if (std::any_of(out.begin() + static_cast<std::ptrdiff_t>(begin), out.end(), same)) continue;
    out.push_back(way.gap);
  }
}

void AppendOverlaps(const SolidPair& pair, int most_parts, std::vector<SignedGap>& out) {
  std::vector<WayOut> ways;
  AppendWays(pair, true, most_parts, ways);
  AppendWays(pair, false, most_parts, ways);
  const double size = std::min(pair.a().radius(), pair.b().radius());
  auto deep = [size](const WayOut& way) { return -way.gap.distance > kShallow * size; };
  if (std::none_of(ways.begin(), ways.end(), deep)) AppendCommonPoint(pair, ways);
  if (ways.empty()) {
    const NearestTriangles crossing = pair.RoughlyNearest(SolidPair::kTouching, nullptr);
    out.push_back(crossing.a < 0 ? SignedGap() : TriangleGap(pair, crossing));
    return;
  }
  AppendDeepest(ways, 0.25 * size, out);
}

SignedGap TriangleGap(const SolidPair& pair, const NearestTriangles& crossing) {
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
    const double forward = high1 - low2, backward = high2 - low1;  // the second moves by ±u
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
