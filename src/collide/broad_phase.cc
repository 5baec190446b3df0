#include "collide/broad_phase.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>

namespace mjcf_pdg {
namespace {

// So few pairs of bodies are all looked at: robots have no more, and take as long as before.
constexpr std::size_t kFew = 256;
// A sweep is made where there are so many pairs of a body; an island of a few trees has two to
// four.
constexpr std::size_t kPairsOfBody = 8;
// A list also has pairs that come near when both bodies move half as far as this [scene's size],
// unless some body has just moved farther: then it is likely to do so again. The size is about a
// body's radius, so that a list is at most a few times as long as what is near.
constexpr double kSpare = 1.0;
// What rounding may take from a distance between centers [scene's size].
constexpr double kRounding = 1e-9;

}  // namespace

BroadPhase::BroadPhase(const SceneTables& tables)
    : tables_(tables), centers_W_(tables.body_spheres.size(), Vector3d::Zero()) {
  const int bodies = static_cast<int>(tables.body_spheres.size());
  for (int b = 0; b < bodies; ++b) {
    if (tables.moving_trees.empty() || tables.body_moves[b]) moving_bodies_.push_back(b);
  }
  near_.reserve(tables.body_pairs.size());
  lists_ = tables.body_pairs.size() > kFew;
  sweeps_ = lists_ && tables.body_pairs.size() > kPairsOfBody * bodies;
  if (!sweeps_) return;
  std::vector<char> swept(bodies, 0);
  begin_.assign(bodies + 1, 0);
  for (int k = 0; k < static_cast<int>(tables.body_pairs.size()); ++k) {
    const BodyPair& pair = tables.body_pairs[k];
    ++begin_[pair.body1 + 1];
    if (std::isinf(tables.body_spheres[pair.body1].radius) ||
        std::isinf(tables.body_spheres[pair.body2].radius)) {
      of_all_.push_back(k);
    } else {
      swept[pair.body1] = swept[pair.body2] = 1;
    }
  }
  for (int b = 0; b < bodies; ++b) {
    begin_[b + 1] += begin_[b];
    if (swept[b]) swept_.push_back({.body = b});
  }
}

const std::vector<int>& BroadPhase::Near(const PosedModel& posed, double margin, bool all_moved) {
  MoveCenters(*posed.data(), all_moved);
  if (all_moved && !tables_.moving_trees.empty()) listed_W_.clear();
  near_.clear();
  if (!lists_) {
    for (int k = 0; k < static_cast<int>(tables_.body_pairs.size()); ++k) {
      if (AreNear(k, margin)) near_.push_back(k);
    }
    return near_;
  }
  if (!ListHolds(margin)) {
    const double spare = kSpare * tables_.size;
    MakeList(margin + (moved_ <= spare ? spare : 0.0));
  }
  std::copy_if(listed_.begin(), listed_.end(), std::back_inserter(near_),
               [&](int pair) { return AreNear(pair, margin); });
  return near_;
}

void BroadPhase::MoveCenters(const mjData& data, bool all_moved) {
  const auto move = [&](int b) {
    centers_W_[b] = AsVector(data.xpos + 3 * b) +
                    AsMatrix(data.xmat + 9 * b) * tables_.body_spheres[b].center_B;
  };
  if (!all_moved) {
    std::for_each(moving_bodies_.begin(), moving_bodies_.end(), move);
    return;
  }
  for (int b = 0; b < static_cast<int>(centers_W_.size()); ++b) move(b);
}

bool BroadPhase::AreNear(int pair, double margin) const {
  const BodyPair& bodies = tables_.body_pairs[pair];
  const double reach = tables_.body_spheres[bodies.body1].radius +
                       tables_.body_spheres[bodies.body2].radius + margin;
  return (centers_W_[bodies.body1] - centers_W_[bodies.body2]).squaredNorm() <= reach * reach;
}

// Whether the list has all pairs that are near now. Sets moved_.
bool BroadPhase::ListHolds(double margin) {
  moved_ = mjMAXVAL;
  if (listed_W_.empty()) return false;
  double farthest = 0.0;
  for (const int b : moving_bodies_) {
    const double moved = (centers_W_[b] - listed_W_[b]).squaredNorm();
    if (!(moved <= mjMAXVAL)) return false;
    farthest = std::max(farthest, moved);
  }
  moved_ = std::sqrt(farthest);
  return margin + 2.0 * moved_ <= listed_reach_;
}

void BroadPhase::MakeList(double reach) {
  listed_W_ = centers_W_;
  // Two centers that come nearer by as much as the list allows, rounded, are still listed.
  listed_reach_ = reach;
  const double with_rounding = reach + kRounding * tables_.size;
  listed_.clear();
  if (sweeps_) {
    Sweep(with_rounding);
    return;
  }
  for (int k = 0; k < static_cast<int>(tables_.body_pairs.size()); ++k) {
    if (AreNear(k, with_rounding)) listed_.push_back(k);
  }
}

void BroadPhase::Sweep(double reach) {
  Eigen::AlignedBox3d box;
  for (const Swept& swept : swept_) box.extend(centers_W_[swept.body]);
  int axis = 0;
  box.sizes().maxCoeff(&axis);
  for (Swept& swept : swept_) {
    const double radius = tables_.body_spheres[swept.body].radius + 0.5 * reach;
    swept.low = centers_W_[swept.body][axis] - radius;
    swept.high = centers_W_[swept.body][axis] + radius;
  }
  const auto lower = [](const Swept& a, const Swept& b) { return a.low < b.low; };
  if (!std::is_sorted(swept_.begin(), swept_.end(), lower)) {
    std::sort(swept_.begin(), swept_.end(), lower);
  }
  found_.clear();
  for (std::size_t i = 0; i < swept_.size(); ++i) {
    for (std::size_t k = i + 1; k < swept_.size() && swept_[k].low <= swept_[i].high; ++k) {
      const int one = swept_[i].body, other = swept_[k].body;
      const double nearest =
          tables_.body_spheres[one].radius + tables_.body_spheres[other].radius + reach;
      if ((centers_W_[one] - centers_W_[other]).squaredNorm() > nearest * nearest) continue;
      const int pair = PairOf(std::min(one, other), std::max(one, other));
      if (pair >= 0) found_.push_back(pair);
    }
  }
  std::sort(found_.begin(), found_.end());
  std::merge(found_.begin(), found_.end(), of_all_.begin(), of_all_.end(),
             std::back_inserter(listed_));
}

// SceneTables::body_pairs are sorted by both bodies.
int BroadPhase::PairOf(int body1, int body2) const {
  const auto begin = tables_.body_pairs.begin() + begin_[body1];
  const auto end = tables_.body_pairs.begin() + begin_[body1 + 1];
  const auto it = std::lower_bound(
      begin, end, body2, [](const BodyPair& pair, int body) { return pair.body2 < body; });
  if (it == end || it->body2 != body2) return -1;
  return static_cast<int>(it - tables_.body_pairs.begin());
}

}  // namespace mjcf_pdg
