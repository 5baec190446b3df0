#include "collide/terrain/way_out.h"

#include <algorithm>
#include <limits>

namespace mjcf_pdg {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Normals whose cosine is above this count as one; of the others so many at most are tried. Stairs
// have two, rough ground any number.
constexpr double kSameNormal = 0.9;
constexpr std::size_t kMostNormals = 4;
// For a rough way: so many, of the parts that are steeper than this cosine.
constexpr std::size_t kFewNormals = 2;
constexpr double kSteep = 0.7;
// The best way is turned towards the normal of its last contact so often, while that makes it
// shorter by this share.
constexpr int kMostTurns = 3;
constexpr double kShorter = 1e-6;
// How exactly the way out of one prism is found [share of it, and scene's size], and for a rough
// way: a longer one leads only to contacts that are measured from a little farther above the
// ground, and a tenth takes a third less than a millionth; the length is as exact as it ends apart.
constexpr double kLengthShare = 1e-6, kLengthGap = 1e-9;
constexpr double kRoughShare = 0.1, kRoughGap = 1.1e-4;
// A rough way that is longer than this by planes alone is taken as so long [scene's size].
constexpr double kRoughFar = 0.2;
constexpr int kMostPlanes = 30;
// Where the search for that begins beyond the last touch, so that there is a normal [scene's size].
constexpr double kAside = 1e-4;
// A plane whose normal is nearly across a way bounds its length by nothing useful.
constexpr double kGrazing = 0.05;

// How far the geom must move along u to leave one prism, which is no farther than `exit`. Each
// plane that parts the two at the present end of the way tells how far the way would have to go to
// reach it: less far.
Way LeaveOne(const OnTerrain& on, const Prism& prism, const Vector3d& u, double exit,
             const WayOut::Accuracy& accuracy) {
  Way way{u, exit, u};
  double at = exit + kAside * on.size();
  const GjkAccuracy of_distance{.share = 0.1 * accuracy.share, .last = 1.0};
  GjkNearest found;
  for (int plane = 0; plane < kMostPlanes; ++plane) {
    if (on.Ask(prism, at * u, kInfinity, of_distance, found) != GjkEnding::kApart) break;
    const double along = found.n.dot(u);
    if (!(along > kLengthShare)) break;
    const double parts = prism.Farthest(found.n) - on.Support(-found.n).dot(found.n);
    const double needed = (parts + on.radius()) / along;
    const double gained = at - needed;
    if (needed < way.length || plane == 0) way.n = found.n;
    way.length = std::min(way.length, needed);
    at = std::min(at, needed);
    if (gained < accuracy.share * std::abs(way.length) + accuracy.gap * on.size()) break;
  }
  return way;
}

// Out of the field's box: past its sides, or below its base.
Way LeaveBox(const OnTerrain& on) {
  const Eigen::AlignedBox3d field = on.FieldBox(), &core = on.core_box();
  Way best{Vector3d::UnitZ(), field.max().z() - core.min().z()};
  const auto consider = [&best](const Vector3d& u, double length) {
    if (length < best.length) best = {u, length, u};
  };
  for (int axis = 0; axis < 2; ++axis) {
    consider(Vector3d::Unit(axis), field.max()[axis] - core.min()[axis]);
    consider(-Vector3d::Unit(axis), core.max()[axis] - field.min()[axis]);
  }
  consider(-Vector3d::UnitZ(), core.max().z() - field.min().z());
  best.length += on.radius();
  return best;
}

}  // namespace

Way WayOut::Find(const OnTerrain& on, Effort effort, std::vector<NearPrism>& near) {
  const auto collect = [&](double reach) {
    on.CollectPrisms(on.CellsNear(Vector3d::Zero(), reach), Vector3d::Zero(), reach, near);
  };
  Way best = LeaveBox(on);
  accuracy_ = effort == Effort::kShortest ? Accuracy{kLengthShare, kLengthGap, kInfinity}
                                          : Accuracy{kRoughShare, kRoughGap, kRoughFar};
  // Straight up it meets only what it overlaps, unless it comes from below.
  const bool from_below = on.core_box().min().z() < on.FieldBox().min().z();
  if (from_below) collect(on.radius() + best.length);
  Shorten(on, Vector3d::UnitZ(), from_below ? kInfinity : on.radius(), near, best);
  CollectNormals(effort, near);
  const bool shortest = effort == Effort::kShortest;
  if (shortest || !normals_.empty()) collect(best.length + on.radius());
  for (const Vector3d& n : normals_) Shorten(on, n, kInfinity, near, best);
  for (int turn = 0; shortest && turn < kMostTurns; ++turn) {
    if (!Shorten(on, Vector3d(best.n), kInfinity, near, best)) break;
  }
  return best;
}

// The normals of the tops that the geom seems to overlap least come first.
void WayOut::CollectNormals(Effort effort, const std::vector<NearPrism>& near) {
  normals_.clear();
  const bool shortest = effort == Effort::kShortest;
  const std::size_t most = shortest ? kMostNormals : kFewNormals;
  const double steep = shortest ? kSameNormal : kSteep;
  while (normals_.size() < most) {
    const NearPrism* least = nullptr;
    for (const NearPrism& other : near) {
      if (other.at_least >= 0.0 || (least && other.at_least <= least->at_least)) continue;
      const Vector3d n = other.prism.Normal();
      const auto same = [&n](const Vector3d& known) { return known.dot(n) > kSameNormal; };
      if (n.z() > steep || std::any_of(normals_.begin(), normals_.end(), same)) continue;
      least = &other;
    }
    if (!least) return;
    normals_.push_back(least->prism.Normal());
  }
}

// Replaces `best` by the way along the unit vector u, if that is shorter; returns whether it is.
// `near` must be all prisms that the geom can meet on it; those farther than `met` it does not.
bool WayOut::Shorten(const OnTerrain& on, const Vector3d& u, double met,
                     std::vector<NearPrism>& near, Way& best) {
  const double limit = best.length * (1.0 - kShorter);
  const double begin = on.Support(-u).dot(u) - on.radius();
  for (NearPrism& one : near) {
    one.exit = one.at_least > met ? -kInfinity : one.prism.Farthest(u) - begin;
    one.asked = one.passed = false;
  }
  const OnTerrain::WayPlanes planes = on.PlanesOf(u);
  Way way{u, 0.0, u};
  while (NearPrism* last = LeftLast(on, planes, (1.0 + accuracy_.share) * way.length, near)) {
    if (last->exit <= (1.0 + accuracy_.share) * way.length) {
      way.length = std::max(way.length, last->exit);
      break;
    }
    if (way.length >= limit) return false;
    if (last->exit > accuracy_.far * on.size()) {
      way.length = last->exit;
      break;
    }
    LeaveIfMet(on, planes, *last, near, way);
  }
  if (way.length >= limit) return false;
  best = way;
  return true;
}

// The one that seems to be left last, by all planes that are known if that is later than `enough`.
// Null if the way leads past all of them.
NearPrism* WayOut::LeftLast(const OnTerrain& on, const OnTerrain::WayPlanes& planes, double enough,
                            std::vector<NearPrism>& near) {
  NearPrism* last = nullptr;
  for (NearPrism& one : near) {
    if (one.passed || (last && one.exit <= last->exit)) continue;
    if (one.exit > enough && !one.asked) {
      one.exit = std::min(one.exit, on.ExitBound(one.prism, planes));
      one.asked = true;
    }
    if (!last || one.exit > last->exit) last = &one;
  }
  return last;
}

// If the geom overlaps `one` at the end of the way, lengthens the way so that it leads out of it.
void WayOut::LeaveIfMet(const OnTerrain& on, const OnTerrain::WayPlanes& planes, NearPrism& one,
                        std::vector<NearPrism>& near, Way& way) {
  Way out = way;
  OnTerrain::Stretch of_box;
  if (on.OverlapOfBox(one.prism, way.u, of_box, way.length)) {
    one.passed = !(of_box.begin < way.length && way.length < of_box.end);
    if (one.passed) return;
    out = {way.u, of_box.end, of_box.n};
  } else {
    one.passed = !on.Overlap(one.prism, way.length * way.u);
    if (one.passed) return;
    if (!one.asked) one.exit = std::min(one.exit, on.ExitBound(one.prism, planes));
    out = LeaveOne(on, one.prism, way.u, one.exit, accuracy_);
  }
  one.asked = true;
  one.exit = out.length;
  if (out.length <= way.length) return;
  way = out;
  // The plane at its end tells of the other prisms, too, how far they are left at most.
  const double along = out.n.dot(out.u), nearest = on.Support(-out.n).dot(out.n) - on.radius();
  for (NearPrism& other : near) {
    other.passed = false;
    if (!(along > kGrazing)) continue;
    other.exit = std::min(other.exit, (other.prism.Farthest(out.n) - nearest) / along);
  }
}

}  // namespace mjcf_pdg
