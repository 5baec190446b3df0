#include "paper/free_configuration.h"

#include <algorithm>
#include <cmath>

#include "base/tuning.h"
#include "start/selection.h"

namespace mjcf_pdg {

namespace tune = tuning::paper;

FreeConfigurationSelection::FreeConfigurationSelection(Workspace& work,
                                                       const MotionCoherence& coherence)
    : problem_(work.problem()),
      work_(work),
      perturbation_(work),
      starts_(work),
      coherence_(coherence),
      random_(0) {}

const std::vector<FreeConfigurationSelection::Entry>& FreeConfigurationSelection::Table() {
  using Self = FreeConfigurationSelection;
  static const std::vector<Entry> table = {
      {Component::kMotionCoherence, &Self::Coherence},
      {Component::kCentroidDifference, &Self::CentroidDifference},
      {Component::kSuccessivePerturbation, &Self::Perturbation},
      {Component::kConstrainedTranslation, &Self::Translation},
      {Component::kUserPose, &Self::UserPose},
      {Component::kMaximallyClear, &Self::MaximallyClear},
  };
  return table;
}

void FreeConfigurationSelection::Begin(const VectorXd* hint, std::uint64_t seed) {
  hint_ = hint;
  random_ = Random(seed);
  tried_ = 0;
}

std::optional<FreeConfiguration> FreeConfigurationSelection::SelectInPaperOrder() {
  for (const Entry& entry : Table()) {
    if (work_.Spent()) break;
    if (!problem_.Uses(entry.component)) continue;
    ++tried_;
    Selected q = (this->*entry.select)();
    if (q) return FreeConfiguration{*std::move(q), entry.component};
  }
  return std::nullopt;
}

std::optional<VectorXd> FreeConfigurationSelection::Coherence() {
  return FirstFree(coherence_.NearestFree(work_));
}

std::optional<VectorXd> FreeConfigurationSelection::CentroidDifference() {
  return IsRigid() ? TranslateFrom(problem_.q_in) : std::nullopt;
}

std::optional<VectorXd> FreeConfigurationSelection::Perturbation() {
  PerturbationResult result = perturbation_.Run();
  return result.free ? Selected(std::move(result.q)) : std::nullopt;
}

// Eq. 20. If the articulated model A collides with itself, it first takes on a pose that does not:
// from motion coherence, or the user's.
std::optional<VectorXd> FreeConfigurationSelection::Translation() {
  if (IsRigid()) return std::nullopt;  // centroid difference is the same
  if (perturbation_.SelfCollisionFree(problem_.q_in)) return TranslateFrom(problem_.q_in);
  std::vector<VectorXd> poses = coherence_.NearestSelfCollisionFree(work_);
  for (VectorXd& pose : UserPoses()) poses.push_back(std::move(pose));
  for (const VectorXd& pose : poses) {
    const VectorXd q = AtBaseOfInput(pose);
    if (!perturbation_.SelfCollisionFree(q)) continue;
    if (Selected translated = TranslateFrom(q)) return translated;
  }
  return std::nullopt;
}

std::optional<VectorXd> FreeConfigurationSelection::UserPose() { return FirstFree(UserPoses()); }

std::optional<VectorXd> FreeConfigurationSelection::MaximallyClear() {
  double reach = 0.25 * problem_.size;  // √σ units [m]
  for (int level = 0; level < tune::kClearLevels; ++level, reach *= 2.0) {
    Selected clearest;
    double largest = 0.0;
    for (int k = 0; k < tune::kClearSamples && !work_.Spent(); ++k) {
      VectorXd q;
      starts_.Gaussian(problem_.q_in, reach * reach, 1.0, random_, q);
      if (!work_.Free(q)) continue;
      const double clearance = Clearance(q, reach);
      if (clearest && clearance <= largest) continue;
      clearest = q;
      largest = clearance;
    }
    if (clearest) return clearest;
  }
  return std::nullopt;
}

bool FreeConfigurationSelection::IsRigid() const {
  const LinkTree& tree = perturbation_.tree();
  return tree.links.size() == 1 &&
         problem_.tables.joints[tree.links[0].joints.front()].type == mjJNT_FREE;
}

std::optional<VectorXd> FreeConfigurationSelection::FirstFree(
    std::span<const VectorXd> configurations) {
  for (const VectorXd& q : configurations) {
    if (LimitExcess(problem_.tables, q) == 0.0 && work_.Free(q)) return q;
  }
  return std::nullopt;
}

// Where no candidate is free, the first tree stays where the paper's own direction takes it, and
// the next one is carried off.
std::optional<VectorXd> FreeConfigurationSelection::TranslateFrom(VectorXd q) {
  ClampToLimits(problem_.tables, q);
  for (int k = 0; k < tune::kTranslations; ++k) {
    if (work_.Free(q)) return q;
    const auto candidates = starts_.ConstrainedTranslation(Overlaps(q), q);
    if (candidates.empty()) return std::nullopt;
    if (Selected translated = FirstFree(candidates)) return translated;
    q = candidates.front();
  }
  return std::nullopt;
}

// Those too that are accepted in an answer.
std::vector<NearPair> FreeConfigurationSelection::Overlaps(const VectorXd& q) {
  std::vector<NearPair> overlaps;
  work_.finder.Pose(q);
  for (const NearPair& near : work_.finder.Find(problem_.clearance, Depths::kSkipped)) {
    if (problem_.Overlaps(near, 0.0)) overlaps.push_back(near);
  }
  return overlaps;
}

std::vector<VectorXd> FreeConfigurationSelection::UserPoses() {
  const mjModel& m = *problem_.tables.model;
  std::vector<VectorXd> poses;
  auto add = [&](const VectorXd& pose) {
    poses.push_back(WithMovable(problem_.tables, problem_.q_in, pose));
    ClampToLimits(problem_.tables, poses.back());
  };
  if (hint_) add(*hint_);
  ConfigurationCache cache(tune::kKeyframes + 1);
  const std::size_t first = poses.size();
  add(Eigen::Map<const VectorXd>(m.qpos0, m.nq));
  for (int key = 0; key < std::min<int>(tune::kKeyframes, m.nkey); ++key) {
    add(Eigen::Map<const VectorXd>(m.key_qpos + static_cast<std::size_t>(key) * m.nq, m.nq));
  }
  for (std::size_t k = first; k < poses.size(); ++k) cache.Add(poses[k]);
  poses.resize(first);
  for (VectorXd& pose : cache.NearestFirst(work_, tune::kKeyframes + 1))
    poses.push_back(std::move(pose));
  return poses;
}

VectorXd FreeConfigurationSelection::AtBaseOfInput(const VectorXd& pose) const {
  VectorXd q = pose;
  for (const LinkTree::Link& link : perturbation_.tree().links) {
    if (link.parent >= 0) continue;
    for (const int j : link.joints) {
      const JointEntry& joint = problem_.tables.joints[j];
      const int entries = QposEntries(joint);
      q.segment(joint.qadr, entries) = problem_.q_in.segment(joint.qadr, entries);
    }
  }
  return q;
}

// Smallest distance beyond what is required, at most `reach` [m].
double FreeConfigurationSelection::Clearance(const VectorXd& q, double reach) {
  double clearance = reach;
  work_.finder.Pose(q);
  for (const NearPair& near : work_.finder.Find(problem_.clearance + reach)) {
    if (!problem_.tables.pairs[near.pair].moves) continue;
    clearance = std::min(clearance, near.distance - problem_.required[near.pair]);
  }
  return clearance;
}

}  // namespace mjcf_pdg
