#include "paper/free_configuration.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace mjcf_pdg {
namespace {

constexpr std::size_t kCacheSize = 64;
constexpr std::size_t kCoherentTries = 8;  // nearest cached configurations looked at
constexpr int kTranslations = 4;           // trees carried off one after the other
constexpr int kKeyframes = 32;             // looked at
constexpr int kClearLevels = 8;            // distances, each twice the one before
constexpr int kClearSamples = 16;          // per distance

}  // namespace

void ConfigurationCache::Add(const VectorXd& q) {
  if (entries_.size() < capacity_) {
    entries_.push_back(q);
    return;
  }
  entries_[next_] = q;
  next_ = (next_ + 1) % capacity_;
}

std::vector<VectorXd> ConfigurationCache::NearestFirst(Problem& problem) const {
  std::vector<VectorXd> poses;
  std::vector<double> sigma;
  for (const VectorXd& q : entries_) {
    poses.push_back(WithMovable(problem.tables, problem.q_in, q));
    sigma.push_back(problem.norm.Sigma(poses.back()));
  }
  std::vector<std::size_t> order(entries_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return sigma[a] < sigma[b]; });
  std::vector<VectorXd> sorted;
  for (const std::size_t k : order) sorted.push_back(std::move(poses[k]));
  return sorted;
}

FreeConfigurationSelection::FreeConfigurationSelection(Problem& problem)
    : problem_(problem),
      perturbation_(problem),
      starts_(problem),
      free_(kCacheSize),
      self_collision_free_(kCacheSize),
      random_(0) {}

const std::vector<FreeConfigurationSelection::Entry>& FreeConfigurationSelection::Table() {
  using Self = FreeConfigurationSelection;
  static const std::vector<Entry> table = {
      {"motion_coherence", &Self::MotionCoherence},
      {"centroid_difference", &Self::CentroidDifference},
      {"successive_perturbation", &Self::Perturbation},
      {"constrained_translation", &Self::Translation},
      {"user_pose", &Self::UserPose},
      {"maximally_clear", &Self::MaximallyClear},
  };
  return table;
}

std::vector<std::string> FreeConfigurationSelection::Names() {
  std::vector<std::string> names;
  for (const Entry& entry : Table()) names.push_back(entry.name);
  return names;
}

void FreeConfigurationSelection::Begin(const std::optional<VectorXd>& hint, std::uint64_t seed) {
  hint_ = hint;
  random_ = Random(seed);
  tried_ = 0;
}

std::optional<FreeConfiguration> FreeConfigurationSelection::SelectInPaperOrder() {
  for (const Entry& entry : Table()) {
    if (problem_.Expired()) break;
    if (!problem_.Uses(entry.name)) continue;
    ++tried_;
    Selected q = (this->*entry.select)();
    if (q) return FreeConfiguration{*std::move(q), entry.name};
  }
  return std::nullopt;
}

void FreeConfigurationSelection::Remember(const VectorXd& q) {
  if (LimitExcess(problem_.tables, q) > 0.0) return;
  if (problem_.Free(q)) {
    RememberFree(q);
  } else if (perturbation_.SelfCollisionFree(q)) {
    self_collision_free_.Add(q);
  }
}

void FreeConfigurationSelection::RememberFree(const VectorXd& q) {
  free_.Add(q);
  self_collision_free_.Add(q);
}

std::optional<VectorXd> FreeConfigurationSelection::NearestRemembered() {
  return free_.empty() ? Selected() : free_.NearestFirst(problem_).front();
}

// Cached configurations may no longer be free: obstacles (mocap bodies) move too.
std::optional<VectorXd> FreeConfigurationSelection::MotionCoherence() {
  std::vector<VectorXd> nearest = free_.NearestFirst(problem_);
  nearest.resize(std::min(nearest.size(), kCoherentTries));
  return FirstFree(nearest);
}

std::optional<VectorXd> FreeConfigurationSelection::CentroidDifference() {
  return IsRigid() ? TranslateFrom(problem_.q_in) : std::nullopt;
}

std::optional<VectorXd> FreeConfigurationSelection::Perturbation() {
  PerturbationResult result = perturbation_.Run();
  return result.free ? Selected(std::move(result.q)) : std::nullopt;
}

// Eq. 20. A that collides with itself first takes on a pose that does not: from motion coherence,
// or the user's.
std::optional<VectorXd> FreeConfigurationSelection::Translation() {
  if (IsRigid()) return std::nullopt;  // centroid difference is the same
  if (perturbation_.SelfCollisionFree(problem_.q_in)) return TranslateFrom(problem_.q_in);
  std::vector<VectorXd> poses = self_collision_free_.NearestFirst(problem_);
  poses.resize(std::min(poses.size(), kCoherentTries));
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
  for (int level = 0; level < kClearLevels; ++level, reach *= 2.0) {
    Selected clearest;
    double largest = 0.0;
    for (int k = 0; k < kClearSamples && !problem_.Expired(); ++k) {
      VectorXd q;
      starts_.Gaussian(problem_.q_in, reach * reach, 1.0, random_, q);
      if (!problem_.Free(q)) continue;
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
    if (LimitExcess(problem_.tables, q) == 0.0 && problem_.Free(q)) return q;
  }
  return std::nullopt;
}

// Where no candidate is free, the first tree stays where the paper's own direction takes it, and
// the next one is carried off.
std::optional<VectorXd> FreeConfigurationSelection::TranslateFrom(VectorXd q) {
  ClampToLimits(problem_.tables, q);
  for (int k = 0; k < kTranslations; ++k) {
    if (problem_.Free(q)) return q;
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
  problem_.finder.Pose(q);
  for (const NearPair& near : problem_.finder.Find(problem_.options.clearance, Depths::kSkipped)) {
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
  ConfigurationCache cache(kKeyframes + 1);
  const std::size_t first = poses.size();
  add(Eigen::Map<const VectorXd>(m.qpos0, m.nq));
  for (int key = 0; key < std::min<int>(kKeyframes, m.nkey); ++key) {
    add(Eigen::Map<const VectorXd>(m.key_qpos + static_cast<std::size_t>(key) * m.nq, m.nq));
  }
  for (std::size_t k = first; k < poses.size(); ++k) cache.Add(poses[k]);
  poses.resize(first);
  for (VectorXd& pose : cache.NearestFirst(problem_)) poses.push_back(std::move(pose));
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
  problem_.finder.Pose(q);
  for (const NearPair& near : problem_.finder.Find(problem_.options.clearance + reach)) {
    if (!problem_.tables.pairs[near.pair].moves) continue;
    clearance = std::min(clearance, near.distance - problem_.required[near.pair]);
  }
  return clearance;
}

}  // namespace mjcf_pdg
