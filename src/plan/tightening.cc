#include "plan/tightening.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace mjcf_pdg {
namespace {

// How far apart configurations are retracted, a share of a planner's step. With two and four times
// that a peg and slot.xml (models/passages) take less time, and hands of seven hinges up to twice
// as much.
constexpr double kSpacing = 0.1;
// How far bodies may be from where the path has them while it is followed, in radii of their own.
// Seconds per path of runs that begin with smaller bodies, of a flat hand of seven hinges in its
// hole, a mobile base at a window, and an L in its hole (bench/README.md, plan_bench): 8, 1.0 and
// 2.9 with 1, 17, 0.9 and 1.0 with 1.4. As far as a planner's step: none, none and 1.2.
constexpr double kLeash = 1.0;
// Of the samples that are left, the most for a search between two configurations; one that is not
// reached is left out. With a hundred samples, not a share, a C and an S in their holes take 1.9
// and 6.8 s per path instead of 1.2 and 1.4; arms and the mobile base take up to a quarter less.
constexpr double kShareOfSamples = 0.05;
// So many configurations in a row that are not reached end it: the wide path leads where what has
// grown does not fit, and another run is cheaper than what is left of the samples. Of 24 searches
// of arms, a gripper and a snake 12 find a path within 10 s without this rule, and 16 with it
// (bench/README.md, Passages).
constexpr int kMostMissed = 10;

}  // namespace

Tightening::Tightening(const TreeSearchInput& input)
    : input_(input),
      search_(input),
      along_contact_(MakeContactRetraction(
          {input.scene, input.options.options, input.space, search_.shared_prover(), input.slide})),
      travel_(input.space->tables()),
      solver_(input.scene, RetractingOptions(input.options.options, input.slide.clearance)) {}

// With configurations on the edges, kSpacing apart at most.
std::vector<VectorXd> Tightening::Densified(const std::vector<VectorXd>& path) const {
  const double spacing = kSpacing * search_.step();
  std::vector<VectorXd> dense = {path.front()};
  for (std::size_t k = 1; k < path.size(); ++k) {
    const double length = input_.space->Distance(path[k - 1], path[k]);
    const int parts = std::max(1, static_cast<int>(std::ceil(length / spacing)));
    for (int part = 1; part <= parts; ++part) {
      input_.space->Interpolate(path[k - 1], path[k], static_cast<double>(part) / parts,
                                dense.emplace_back());
    }
  }
  return dense;
}

// Goes from the path's end towards q, along contacts if need be. Returns whether all bodies are
// then within kLeash of where they are at q.
bool Tightening::Follow(const VectorXd& q, std::vector<VectorXd>& path) {
  if (search_.prover().IsFree(path.back(), q)) {
    path.push_back(q);
    return true;
  }
  const std::vector<VectorXd>& chain = along_contact_->Retract(path.back(), q);
  path.insert(path.end(), chain.begin(), chain.end());
  return travel_.InRadii(path.back(), q) < kLeash;
}

// Moves q to the nearest free configuration. Returns whether one was found near it where paths may
// go: a body that has come through a wall may leave it beyond its far edge.
bool Tightening::Free(VectorXd& q) {
  const Status status = solver_.Solve({q.data(), static_cast<std::size_t>(q.size())}, result_);
  queries_ += result_.stats.collision_queries;
  if (status == Status::kUnsolved) return false;
  const VectorXd blocked = std::exchange(q, ToEigen(result_.q));
  return input_.space->Covers(q) && travel_.InRadii(blocked, q) < kLeash;
}

// Joins path_ and q, which is free and stands for dense_[k]: from q the wide path is followed
// backwards until a free motion leads there from path_. Where that ends, a way between the two is
// looked for by so many samples at most. Returns whether they are joined.
bool Tightening::Join(std::size_t k, const VectorXd& q, std::int64_t samples) {
  nodes_.resize(k + 1, path_.size() - 1);
  std::vector<VectorXd> back = {q};
  bool met = search_.prover().IsFree(path_.back(), q);
  for (bool follows = true; !met && follows && k > 0 && !input_.ended();) {
    follows = Follow(dense_[--k], back);
    met = search_.prover().IsFree(path_[nodes_[k]], back.back());
  }
  std::vector<VectorXd> way = {path_[nodes_[k]], back.back()};
  if (!met) way = search_.FindNear(way.front(), way.back(), samples);
  if (way.empty()) return false;
  path_.resize(nodes_[k] + 1);
  path_.insert(path_.end(), way.begin() + 1, way.end());
  path_.insert(path_.end(), back.rbegin() + 1, back.rend());
  nodes_.resize(k + 1);
  return true;
}

std::vector<VectorXd> Tightening::Tighten(const std::vector<VectorXd>& wide, std::int64_t samples) {
  const std::int64_t most = input_.space->samples() + samples;
  dense_ = Densified(wide);
  path_ = {dense_.front()};
  nodes_.clear();
  int missed = 0;
  for (std::size_t k = 1; k < dense_.size(); ++k) {
    if (input_.ended()) return {};
    nodes_.resize(k, path_.size() - 1);
    const bool last = k + 1 == dense_.size();
    VectorXd q = dense_[k];
    if (Follow(q, path_) && (!last || path_.back() == q)) continue;
    if (!last && !Free(q)) continue;
    const std::int64_t left = most - input_.space->samples();
    const double most_here = (last ? 1.0 : kShareOfSamples) * static_cast<double>(left);
    const bool joined = Join(k, q, static_cast<std::int64_t>(std::ceil(most_here)));
    missed = joined ? 0 : missed + 1;
    if (!joined && (last || left <= 0 || missed == kMostMissed)) return {};
  }
  Straighten(search_.prover(), input_.ended, path_);
  return path_;
}

SearchCost Tightening::cost() const {
  SearchCost cost = search_.cost();
  cost.collision_queries += queries_ + along_contact_->queries();
  return cost;
}

}  // namespace mjcf_pdg
