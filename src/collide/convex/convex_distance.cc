#include "collide/convex/convex_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mjcf_pdg {
namespace {

constexpr int kMaxGrowth = 250;  // the most corners that Overlap adds to a polytope
// The upper and the lower bound of a distance (or depth) agree if they differ by at most kMeet
// [scene's size] plus kMeetShare of that distance (or depth).
constexpr double kMeet = 1e-8, kMeetShare = 1e-6;
// Cores closer than this have no certain normal, and a Minkowski difference thinner than this in
// some direction counts as flat [scene's size].
constexpr double kTooThin = 1e-6;
// SearchTouching shifts geom 2 by kAside [scene's size]. There the bounds of the distance must
// agree to kAsideShare of it (to kLastShare in the last step): the angle by which the normal errs
// is about the square root of twice that share [rad].
constexpr double kAside = 1e-4;
constexpr double kAsideShare = 1e-7, kLastShare = 1e-4;

// Room is made for so many memories at first: few robots have more pairs that come near.
constexpr std::size_t kMemories = 256;

}  // namespace

ConvexDistance::ConvexDistance(const SceneTables& tables)
    : tables_(tables), knows_(tables.pairs.size()), memory_of_(tables.pairs.size(), -1) {
  memories_.reserve(std::min(tables.pairs.size(), kMemories));
  polytope_.Reserve(4 + kMaxGrowth);
  for (std::size_t k = 0; k < knows_.size(); ++k) {
    const KeptPair& pair = tables.pairs[k];
    const bool plane = tables.model->geom_type[pair.geom1] == mjGEOM_PLANE;
    knows_[k] = (plane || tables.support->Knows(pair.geom1)) && tables.support->Knows(pair.geom2);
  }
}

void ConvexDistance::Forget() {
  for (const Memory& memory : memories_) memory_of_[memory.pair] = -1;
  memories_.clear();
}

ConvexDistance::Corner ConvexDistance::CornerOf(const RelativePose& pose, const Points& points) {
  const Vector3d p2 = pose * points.p2_G;
  return {points.p1_G - p2, points.p1_G, p2};
}

ConvexDistance::Points ConvexDistance::PointsOf(const RelativePose& pose, const Corner& corner) {
  return {corner.p1, pose.R.transpose() * (corner.p2 - pose.t)};
}

ConvexDistance::Answer ConvexDistance::AskPlane(const PosedModel& posed, const KeptPair& pair,
                                                double cutoff, SignedGap& gap) const {
  const mjData& d = *posed.data();
  gap.n = AsMatrix(d.geom_xmat + 9 * pair.geom1).col(2);
  const Matrix3d R2 = AsMatrix(d.geom_xmat + 9 * pair.geom2);
  const Vector3d lowest = tables_.support->Support(pair.geom2, -(R2.transpose() * gap.n));
  gap.p2 = AsVector(d.geom_xpos + 3 * pair.geom2) + R2 * lowest -
           CoreRadius(*posed.model(), pair.geom2) * gap.n;
  gap.distance = gap.n.dot(gap.p2 - AsVector(d.geom_xpos + 3 * pair.geom1));
  gap.p1 = gap.p2 - gap.distance * gap.n;
  return gap.distance < cutoff ? Answer::kNear : Answer::kBeyond;
}

ConvexDistance::Corner ConvexDistance::Support(const KeptPair& pair, const RelativePose& pose,
                                               const Vector3d& n) const {
  const SupportPoints& support = *tables_.support;
  return CornerOf(pose, {support.Support(pair.geom1, n),
                         support.Support(pair.geom2, -(pose.R.transpose() * n))});
}

void ConvexDistance::RecallSimplex(const RelativePose& pose, int pair) {
  simplex_.Clear();
  if (memory_of_[pair] < 0) return;
  const Memory& memory = memories_[memory_of_[pair]];
  for (int k = 0; k < memory.size; ++k) simplex_.Add(CornerOf(pose, memory.corners[k]));
}

void ConvexDistance::RememberSimplex(const RelativePose& pose, int pair) {
  if (memory_of_[pair] < 0) {
    memory_of_[pair] = static_cast<int>(memories_.size());
    memories_.emplace_back().pair = pair;
  }
  Memory& memory = memories_[memory_of_[pair]];
  memory.size = simplex_.size();
  for (int k = 0; k < memory.size; ++k) memory.corners[k] = PointsOf(pose, simplex_[k]);
}

bool ConvexDistance::Overlap(const RelativePose& pose, const KeptPair& pair, Found& found) {
  if (!polytope_.Start(simplex_)) return false;
  double least = std::numeric_limits<double>::infinity();
  for (int step = 0; step < kMaxGrowth; ++step) {
    const ExpandingPolytope::Face face = polytope_.Nearest();
    const Corner farthest = Support(pair, pose, face.n);
    // Translating geom 2 by this length along face.n separates the cores: an upper bound.
    const double parts = farthest.x.dot(face.n);
    if (parts < least) {
      least = parts;
      found.corner = polytope_.Foot(face);
      found.n = face.n;
    }
    found.distance = -face.distance;
    const double enough = kMeet * tables_.size + kMeetShare * face.distance;
    if (least - face.distance <= enough || !polytope_.Add(farthest)) break;
  }
  found.corner.p2 = found.corner.p1 + found.distance * found.n;
  return true;
}

ConvexDistance::Ending ConvexDistance::Search(const RelativePose& pose, const KeptPair& pair,
                                              double cutoff, const GjkAccuracy& accuracy,
                                              Found& found) {
  const auto support = [&](const Vector3d& n) { return Support(pair, pose, n); };
  if (simplex_.size() == 0) simplex_.Add(support(pose.t));
  const double too_thin = kTooThin * tables_.size;
  switch (Gjk(support, too_thin, cutoff, accuracy, simplex_, found)) {
    case GjkEnding::kApart:
      return Ending::kFound;
    case GjkEnding::kBeyond:
      return Ending::kBeyond;
    case GjkEnding::kEnclosed:
      return Overlap(pose, pair, found) ? Ending::kFound : Ending::kUnknown;
    case GjkEnding::kTouching:
      return Enclose(pose, pair) && Overlap(pose, pair, found) ? Ending::kFound : Ending::kTouching;
    case GjkEnding::kUnknown:
      break;
  }
  return Ending::kUnknown;
}

bool ConvexDistance::Enclose(const RelativePose& pose, const KeptPair& pair) {
  // Adds the support point along n, unless the Minkowski difference ends there at the simplex.
  const auto add_beyond = [&](const Vector3d& n) {
    const Corner corner = Support(pair, pose, n);
    if (n.dot(corner.x - simplex_[0].x) <= kTooThin * tables_.size) return false;
    simplex_.Add(corner);
    return true;
  };
  const auto add_aside = [&](const Vector3d& n) { return add_beyond(n) || add_beyond(-n); };
  if (simplex_.size() == 1 && !add_aside(Vector3d::UnitX()) && !add_aside(Vector3d::UnitY()) &&
      !add_aside(Vector3d::UnitZ())) {
    return false;
  }
  if (simplex_.size() == 2) {
    const Vector3d along = (simplex_[1].x - simplex_[0].x).stableNormalized();
    const Vector3d across = along.unitOrthogonal();
    if (!add_aside(across) && !add_aside(along.cross(across))) return false;
  }
  const Vector3d n =
      (simplex_[1].x - simplex_[0].x).cross(simplex_[2].x - simplex_[0].x).stableNormalized();
  // The side of the triangle on which the origin is comes first.
  return add_aside(n.dot(simplex_[0].x) > 0.0 ? Vector3d(-n) : n);
}

// The direction is normal to the simplex, taking that for a piece of the Minkowski difference's
// boundary; the simplex may as well lie inside, so the direction is only a first guess. The caller
// chooses the sign.
Vector3d ConvexDistance::Aside(const RelativePose& pose) const {
  Vector3d out = pose.t;
  if (simplex_.size() == 3) {
    out = (simplex_[1].x - simplex_[0].x).cross(simplex_[2].x - simplex_[0].x);
  } else if (simplex_.size() == 2) {
    const Vector3d along = (simplex_[1].x - simplex_[0].x).stableNormalized();
    out -= along.dot(out) * along;
    if (out.norm() < kTooThin * tables_.size) out = along.unitOrthogonal();
  }
  return out.norm() > 0.0 ? Vector3d(out.stableNormalized()) : Vector3d::UnitZ();
}

ConvexDistance::Ending ConvexDistance::SearchTouching(const RelativePose& pose,
                                                      const KeptPair& pair, Found& found) {
  const GjkAccuracy accuracy{.gap = 0.0, .share = kAsideShare, .zero = 0.0, .last = kLastShare};
  // Directions in which to shift geom 2. The last three are oblique to the edges and faces that
  // geoms usually have along their own axes: such a shift takes deeply overlapping cores out of a
  // pose in which only flat simplices contain the origin, so that Overlap can measure the depth.
  const Vector3d ways[] = {Aside(pose), {0.48, 0.6, 0.64}, {0.6, 0.64, -0.48}, {0.64, -0.48, 0.6}};
  for (int k = 0; k < 4; ++k) {
    const Vector3d& way = ways[k];
    RelativePose aside = pose;
    aside.t += (way.dot(pose.t) < 0.0 ? -kAside : kAside) * tables_.size * way;
    simplex_.Clear();
    // The first corner is sought in another direction than the shift: were all of them in a plane
    // of symmetry, the simplex would stay in that plane.
    simplex_.Add(Support(pair, aside, ways[(k + 1) % 4]));
    const double anywhere = std::numeric_limits<double>::infinity();
    if (Search(aside, pair, anywhere, accuracy, found) != Ending::kFound) continue;
    // `here` is the signed gap of the cores along the normal at the real pose. If the cores overlap
    // at the shifted pose by more than the shift, the real depth is at least the depth there less
    // the shift; of this lower bound and the upper bound -here, the smaller depth is taken.
    const double here = -Support(pair, pose, found.n).x.dot(found.n);
    const double way_there = kAside * tables_.size;
    found.distance =
        std::max(here, found.distance < -way_there ? found.distance + way_there : here);
    found.corner.p2 = found.corner.p1 + found.distance * found.n;
    return Ending::kFound;
  }
  return Ending::kUnknown;
}

ConvexDistance::Answer ConvexDistance::Ask(const PosedModel& posed, int pair, double cutoff,
                                           SignedGap& gap) {
  if (!knows_[pair]) return Answer::kUnknown;
  const KeptPair& kept = tables_.pairs[pair];
  const mjModel& m = *posed.model();
  const mjData& d = *posed.data();
  if (m.geom_type[kept.geom1] == mjGEOM_PLANE) return AskPlane(posed, kept, cutoff, gap);
  const Matrix3d R1 = AsMatrix(d.geom_xmat + 9 * kept.geom1);
  const Vector3d x1 = AsVector(d.geom_xpos + 3 * kept.geom1);
  const RelativePose pose{R1.transpose() * AsMatrix(d.geom_xmat + 9 * kept.geom2),
                          R1.transpose() * (AsVector(d.geom_xpos + 3 * kept.geom2) - x1)};
  const double radius1 = CoreRadius(m, kept.geom1), radius2 = CoreRadius(m, kept.geom2);
  const double radii = radius1 + radius2;
  RecallSimplex(pose, pair);
  const GjkAccuracy accuracy{
      .gap = kMeet * tables_.size, .share = kMeetShare, .zero = radii, .last = 0.0};
  Found found;
  Ending ending = Search(pose, kept, cutoff + radii, accuracy, found);
  if (ending != Ending::kUnknown || simplex_.size() == 4) RememberSimplex(pose, pair);
  if (ending == Ending::kTouching || ending == Ending::kUnknown) {
    ending = SearchTouching(pose, kept, found);
  }
  if (ending == Ending::kUnknown) return Answer::kUnknown;
  gap.distance = found.distance - radii;
  if (ending == Ending::kBeyond || gap.distance >= cutoff) return Answer::kBeyond;
  gap.n = R1 * found.n;
  gap.p1 = x1 + R1 * (found.corner.p1 + radius1 * found.n);
  gap.p2 = x1 + R1 * (found.corner.p2 - radius2 * found.n);
  return Answer::kNear;
}

}  // namespace mjcf_pdg
