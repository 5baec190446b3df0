#include "convex_distance.h"

#include <cmath>

#include "motion_bound.h"

namespace mjcf_pdg {
namespace {

constexpr int kMaxSteps = 30;
// Where the two bounds of a distance meet: [m], and as a share of it.
constexpr double kMeet = 1e-9, kMeetShare = 1e-6;
constexpr double kTouching = 1e-7;  // the direction between nearer cores is not certain [m]

}  // namespace

ConvexDistance::ConvexDistance(const SceneTables& tables)
    : tables_(tables), knows_(tables.pairs.size()), memories_(tables.pairs.size()) {
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

// The points of the two that are farthest towards each other, along ∓n.
void ConvexDistance::AddFarthest(const KeptPair& pair, const RelativePose& pose,
                                 const Vector3d& n) {
  const Vector3d p1 = tables_.support->Farthest(pair.geom1, -n);
  const Vector3d p2 = tables_.support->Farthest(pair.geom2, pose.R.transpose() * n);
  simplex_.Add(p1, pose.R * p2 + pose.t);
}

bool ConvexDistance::Recall(const RelativePose& pose, const Memory& memory) {
  simplex_.Clear();
  for (int k = 0; k < memory.size; ++k) {
    simplex_.Add(memory.p1_G[k], pose.R * memory.p2_G[k] + pose.t);
  }
  return memory.size > 0;
}

void ConvexDistance::Remember(const RelativePose& pose, int pair) {
  Memory& memory = memories_[pair];
  if (memory.size == 0) remembered_.push_back(pair);
  memory.size = simplex_.size();
  for (int k = 0; k < memory.size; ++k) {
    memory.p1_G[k] = simplex_[k].p1;
    memory.p2_G[k] = pose.R.transpose() * (simplex_[k].p2 - pose.t);
  }
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
  if (!Recall(pose, memories_[pair])) AddFarthest(kept, pose, -pose.t);
  for (int step = 0; step < kMaxSteps; ++step) {
    simplex_.Reduce();
    const Vector3d nearest = simplex_.Nearest();
    const double between = nearest.norm();
    if (simplex_.size() == 4 || between < kTouching) {
      Remember(pose, pair);
      return Answer::kUnknown;
    }
    AddFarthest(kept, pose, nearest);
    const double at_least = simplex_.Last().dot(nearest) / between;
    const bool beyond = at_least - radius1 - radius2 >= cutoff;
    gap.distance = between - radius1 - radius2;
    const bool meet = between - at_least <= kMeet + kMeetShare * std::abs(gap.distance);
    if (!beyond && !meet) continue;
    simplex_.DropLast();
    Remember(pose, pair);
    if (beyond || gap.distance >= cutoff) return Answer::kBeyond;
    const Vector3d n = -nearest / between;
    gap.n = R1 * n;
    gap.p1 = x1 + R1 * (simplex_.Nearest1() + radius1 * n);
    gap.p2 = x1 + R1 * (simplex_.Nearest2() - radius2 * n);
    return Answer::kNear;
  }
  return Answer::kUnknown;
}

}  // namespace mjcf_pdg
