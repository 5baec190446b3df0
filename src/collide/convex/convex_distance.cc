#include "collide/convex/convex_distance.h"

#include <cmath>

namespace mjcf_pdg {
namespace {

constexpr int kMaxSteps = 30;
constexpr int kMaxGrowth = 60;  // of a polytope [corners]
// Where the two bounds of a distance or depth meet: [scene's size], and as a share of it.
constexpr double kMeet = 1e-8, kMeetShare = 1e-6;
constexpr double kTouching = 1e-6;  // the direction between nearer cores is not certain [size]

}  // namespace

ConvexDistance::ConvexDistance(const SceneTables& tables)
    : tables_(tables), knows_(tables.pairs.size()), memories_(tables.pairs.size()) {
  remembered_.reserve(tables.pairs.size());
  polytope_.Reserve(4 + kMaxGrowth);
  for (std::size_t k = 0; k < knows_.size(); ++k) {
    const KeptPair& pair = tables.pairs[k];
    const bool plane = tables.model->geom_type[pair.geom1] == mjGEOM_PLANE;
    knows_[k] = (plane || tables.support->Knows(pair.geom1)) && tables.support->Knows(pair.geom2);
  }
}

void ConvexDistance::Forget() {
  for (const int pair : remembered_) memories_[pair].size = 0;
  remembered_.clear();
}

ConvexDistance::Corner ConvexDistance::RelativePose::CornerOf(const Points& points) const {
  const Vector3d p2 = R * points.p2_G + t;
  return {points.p1_G - p2, points.p1_G, p2};
}

ConvexDistance::Points ConvexDistance::RelativePose::PointsOf(const Corner& corner) const {
  return {corner.p1, R.transpose() * (corner.p2 - t)};
}

ConvexDistance::Answer ConvexDistance::AskPlane(const PosedModel& posed, const KeptPair& pair,
                                                double cutoff, SignedGap& gap) const {
  const mjData& d = *posed.data();
  gap.n = AsMatrix(d.geom_xmat + 9 * pair.geom1).col(2);
  const Matrix3d R2 = AsMatrix(d.geom_xmat + 9 * pair.geom2);
  const Vector3d lowest = tables_.support->Farthest(pair.geom2, -(R2.transpose() * gap.n));
  gap.p2 = AsVector(d.geom_xpos + 3 * pair.geom2) + R2 * lowest -
           CoreRadius(*posed.model(), pair.geom2) * gap.n;
  gap.distance = gap.n.dot(gap.p2 - AsVector(d.geom_xpos + 3 * pair.geom1));
  gap.p1 = gap.p2 - gap.distance * gap.n;
  return gap.distance < cutoff ? Answer::kNear : Answer::kBeyond;
}

ConvexDistance::Corner ConvexDistance::Farthest(const KeptPair& pair, const RelativePose& pose,
                                                const Vector3d& n) const {
  const SupportPoints& support = *tables_.support;
  return pose.CornerOf(
      {support.Farthest(pair.geom1, n), support.Farthest(pair.geom2, -(pose.R.transpose() * n))});
}

void ConvexDistance::RecallSimplex(const RelativePose& pose, const Memory& memory) {
  simplex_.Clear();
  for (int k = 0; k < memory.size; ++k) simplex_.Add(pose.CornerOf(memory.corners[k]));
}

void ConvexDistance::RememberSimplex(const RelativePose& pose, int pair) {
  Memory& memory = memories_[pair];
  if (memory.size == 0) remembered_.push_back(pair);
  memory.size = simplex_.size();
  for (int k = 0; k < memory.size; ++k) memory.corners[k] = pose.PointsOf(simplex_[k]);
}

std::optional<ExpandingPolytope::Face> ConvexDistance::Overlap(const RelativePose& pose,
                                                               const KeptPair& pair) {
  bool sound = polytope_.Start(simplex_);
  for (int step = 0; sound && step < kMaxGrowth; ++step) {
    const ExpandingPolytope::Face face = polytope_.Nearest();
    const Corner farthest = Farthest(pair, pose, face.n);
    const double beyond = farthest.x.dot(face.n) - face.distance;
    if (beyond <= kMeet * tables_.size + kMeetShare * face.distance) return face;
    sound = polytope_.Add(farthest);
  }
  return std::nullopt;
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
  auto answer = [&](const Corner& nearest, const Vector3d& n, double core_distance) {
    gap.distance = core_distance - radii;
    if (gap.distance >= cutoff) return Answer::kBeyond;
    gap.n = R1 * n;
    gap.p1 = x1 + R1 * (nearest.p1 + radius1 * n);
    gap.p2 = x1 + R1 * (nearest.p2 - radius2 * n);
    return Answer::kNear;
  };
  RecallSimplex(pose, memories_[pair]);
  if (simplex_.size() == 0) simplex_.Add(Farthest(kept, pose, pose.t));
  for (int step = 0; step < kMaxSteps; ++step) {
    simplex_.Reduce();
    if (simplex_.size() == 4) {
      RememberSimplex(pose, pair);
      const std::optional<ExpandingPolytope::Face> face = Overlap(pose, kept);
      return face ? answer(polytope_.Foot(*face), face->n, -face->distance) : Answer::kUnknown;
    }
    const Corner nearest = simplex_.Nearest();
    const double between = nearest.x.norm();
    if (between < kTouching * tables_.size) {
      RememberSimplex(pose, pair);
      return Answer::kUnknown;
    }
    simplex_.Add(Farthest(kept, pose, -nearest.x));
    const double at_least = simplex_.Last().dot(nearest.x) / between;
    const bool beyond = at_least - radii >= cutoff;
    const bool meet =
        between - at_least <= kMeet * tables_.size + kMeetShare * std::abs(between - radii);
    if (!beyond && !meet) continue;
    simplex_.DropLast();
    RememberSimplex(pose, pair);
    return beyond ? Answer::kBeyond : answer(nearest, -nearest.x / between, between);
  }
  return Answer::kUnknown;
}

}  // namespace mjcf_pdg
