#include "bound/normals_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/grow.h"
#include "problem/effort.h"

namespace mjcf_pdg {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// No more is asked for, nor said, than this share of the √S that is known: σ is within 1 % of its
// bound then. The rest is left to those who call free what overlaps by a little more.
constexpr double kProven = 0.9955;
// Any weights, multipliers and rows prove something; how well they are chosen is decided here. On
// 120 problems √(bound/σ) rises by less than 0.001 with 12 sweeps, 4 looks or a second look for
// deeper rows, for up to a third more instructions. In the median it falls by 0.003 with one round
// (400 nodes per pair; none with 10), by 0.008 with 2 profiles, by 0.02 with 2 looks, and by 0.04
// without deeper rows.
constexpr int kSweeps = 6;            // of coordinate ascent over all rows; or until they change x
constexpr double kSteady = 1e-3;      // by no more than this [its length]
constexpr int kRounds = 2;            // weights and bends are fitted so often, with deeper rows
constexpr int kProfiles = 3;          // profiles that share out cross terms, in each
constexpr int kLooks = 3;             // multipliers, in each
constexpr double kDeeper = 0.02;      // a row is of points deeper by this [of the cap's overlap]
constexpr double kLeastShare = 0.02;  // of a mover in the profile [its length]
constexpr double kNoGain = 0.01;      // nodes are branched where that promises more [their root]

// Directions in which pairs are looked at that are not in a node.
constexpr int kMiddles = 1 + kFirstCells;

}  // namespace

void NormalsTree::Begin(std::span<const Mover> movers, double known) {
  known_ = known;
  rows_.Begin(movers, known, kMostTogether);
  const auto most = static_cast<Eigen::Index>(movers.size());
  for (Eigen::VectorXd* x : {&x_, &farthest_}) GrowTo(Coordinates::kMost * most, *x);
  for (Eigen::VectorXd* y : {&lengths_, &profile_, &shared_}) GrowTo(most, *y);
  GrowTo(most * most, crosses_);
  ease_.reserve(kMostTogether);
  first_caps_.reserve(kMostTogether);
  for (std::vector<int>* per_direction : {&middles_, &order_}) {
    per_direction->reserve(kMostTogether * kMiddles);
  }
  bends_.reserve(movers.size());
  caps_.clear();
  heap_.clear();
}

void NormalsTree::AddCap(int pair, const DirectionCell& cell, const Vector3d& n, double eps) {
  const PairProblem& problem = rows_.problem(pair);
  Cap cap{.cell = cell, .pair = pair, .n = n, .eps = eps};
  cap.root = problem.plane
                 ? 0.0
                 : problem.RootFor(n, eps,
                                   {.floor = cell.root,
                                    .enough = known_,
                                    .overlap = PairProblem::EnoughOverlap(ease_[pair], known_)});
  caps_.push_back(cap);
}

void NormalsTree::AddFirstRows(Cap& cap) {
  const PairProblem& problem = rows_.problem(cap.pair);
  const auto [a, b] = problem.FarthestOver(cap.n, cap.eps);
  cap.rows[cap.size++] = rows_.AddRow(cap.pair, cap.n, cap.eps, a, b);
  const auto [a0, b0] = problem.FarthestAlong(cap.n, cap.n, cap.n);
  if (a0 != a || b0 != b) cap.rows[cap.size++] = rows_.AddRow(cap.pair, cap.n, cap.eps, a0, b0);
}

void NormalsTree::AddFirstCaps(int pair) {
  first_caps_[pair] = static_cast<int>(caps_.size());
  const PairProblem& problem = rows_.problem(pair);
  ease_[pair] = problem.MostEase();
  if (problem.plane) {
    AddCap(pair, {}, problem.n_W, 0.0);
    return;
  }
  for (const FirstCell& first : FirstCells()) AddCap(pair, first.cell, first.n, first.radius);
}

void NormalsTree::Cut(int number) {
  if (caps_[number].parts >= 0) return;
  caps_[number].parts = static_cast<int>(caps_.size());
  const Cap whole = caps_[number];
  for (const double du : {-0.5, 0.5}) {
    for (const double dv : {-0.5, 0.5}) {
      const DirectionCell part{whole.root, whole.cell.face, whole.cell.u + du * whole.cell.half,
                               whole.cell.v + dv * whole.cell.half, 0.5 * whole.cell.half};
      const Vector3d n = part.Direction(0, 0);
      AddCap(whole.pair, part, n, part.Radius(n));
    }
  }
}

// Motions farther than what is to be proven are of no interest.
void NormalsTree::Push(const Node& node) {
  if (node.root >= kProven * known_) return;
  heap_.push_back(node);
  std::push_heap(heap_.begin(), heap_.end());
}

void NormalsTree::Collect(const Node& node) {
  terms_.clear();
  for (int k = 0; k < node.size; ++k) {
    Cap& cap = caps_[node.caps[k]];
    if (cap.size == 0) AddFirstRows(cap);
    for (int r = 0; r < cap.size; ++r) terms_.push_back({cap.pair, cap.rows[r], k});
  }
  x_.setZero();
}

// The weights of the nearest x with g_k·x >= t_k - e_k |x| - what bends, where |x| is `length`.
void NormalsTree::Weigh(double length) {
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    double most = 0.0;
    for (Term& term : terms_) {
      const PartingRow& row = rows_.row(term.row);
      if (!(row.gg > 0.0)) continue;
      const double asked = row.t - length * (row.e + length * term.bend);
      const double lambda =
          std::max(0.0, term.lambda + (asked - rows_.Dot(term.pair, row, x_)) / row.gg);
      const double step = lambda - term.lambda;
      if (step == 0.0) continue;
      term.lambda = lambda;
      rows_.AddTo(term.pair, row, step, x_);
      most = std::max(most, step * step * row.gg);
    }
    if (most <= kSteady * kSteady * x_.squaredNorm()) break;
  }
}

void NormalsTree::SetLengths() {
  for (std::size_t k = 0; k < rows_.coordinates().size(); ++k) {
    lengths_[k] = std::sqrt(rows_.coordinates()[k].SquaredNorm(farthest_));
  }
}

// Sets Q. A cross term k |x_i| |x_j| is at most ½ k (|x_i|² y_j / y_i + |x_j|² y_i / y_j) for any
// profile y > 0. Least is what that of the farthest x gives, which follows from Q: steps of the
// power method for (μ - Q) y = |g|.
void NormalsTree::Shape(double guess) {
  const std::vector<Coordinates>& coordinates = rows_.coordinates();
  const auto movers = static_cast<Eigen::Index>(coordinates.size());
  bends_.assign(coordinates.size(), BendBlock());
  Eigen::Map<Eigen::MatrixXd> crosses(crosses_.data(), movers, movers);
  crosses.setZero();
  const auto lengths = lengths_.head(movers);
  auto profile = profile_.head(movers), shared = shared_.head(movers);
  for (const Term& term : terms_) {
    if (term.lambda > 0.0) {
      rows_.AddBends(term.pair, rows_.row(term.row), term.lambda, bends_, crosses);
    }
  }
  for (int time = 1;; ++time) {
    SetLengths();
    profile = lengths.cwiseMax(kLeastShare * lengths.norm());
    shared.noalias() = crosses * profile;
    for (Eigen::Index k = 0; k < movers; ++k) bends_[k].d = shared[k] / profile[k];
    if (time == kProfiles) break;
    const double length = profile.norm();
    const double mu = x_.norm() / guess + shared.dot(profile) / (length * length);
    constexpr double kStiff = 0.3;  // of μ: where a mover bends almost as much
    for (std::size_t k = 0; k < coordinates.size(); ++k) {
      for (int c = 0; c < coordinates[k].size(); ++c) {
        const int turn = c - coordinates[k].slides;
        const double bend = turn < 0 ? 0.0 : bends_[k].B(turn, turn);
        double& y = farthest_[coordinates[k].at + c];
        y = (std::abs(x_[coordinates[k].at + c]) +
             bends_[k].d * std::max(kLeastShare * length, std::abs(y))) /
            std::max(mu - bend, kStiff * mu);
      }
    }
  }
}

// √S by (3). Leaves the weights, and x.
double NormalsTree::Prove(const Node& node, int rounds) {
  double root = node.root;
  for (int round = 1;; ++round) {
    Weigh(root);
    double T = 0.0, E = 0.0;
    for (const Term& term : terms_) {
      T += term.lambda * rows_.row(term.row).t;
      E += term.lambda * rows_.row(term.row).e;
    }
    if (round == 1) farthest_ = x_;
    if (!(T > 0.0) || !(farthest_.norm() > 0.0)) break;
    const double guess = std::max(root, T / (x_.norm() + E));
    Shape(guess);
    const Undoing undoing{rows_.coordinates(), bends_, x_, E};
    root = std::max(root, undoing.LeastLength(T, guess, kLooks, farthest_));
    const double squared = farthest_.squaredNorm();
    if (round == rounds || !(squared > 0.0)) break;
    SetLengths();
    for (Term& term : terms_) {
      term.bend = rows_.BendAlong(term.pair, rows_.row(term.row), lengths_, farthest_) / squared;
    }
  }
  return root;
}

// Adds rows of the points that x leaves deepest.
bool NormalsTree::AddDeepest(const Node& node) {
  bool added = false;
  for (int k = 0; k < node.size; ++k) {
    Cap& cap = caps_[node.caps[k]];
    if (cap.size == kMostRows) continue;
    double deepest = -kInfinity, overlap = 0.0;
    for (int r = 0; r < cap.size; ++r) {
      const PartingRow& row = rows_.row(cap.rows[r]);
      deepest = std::max(deepest, row.t_middle - rows_.Dot(cap.pair, row, x_));
      overlap = std::max(overlap, row.t_middle);
    }
    const auto [a, b] = rows_.Deepest(cap.pair, cap.n, x_);
    const int row = rows_.AddRow(cap.pair, cap.n, cap.eps, a, b);
    const double now = rows_.row(row).t_middle - rows_.Dot(cap.pair, rows_.row(row), x_);
    if (now <= deepest + kDeeper * overlap) {
      rows_.DropLast();
      continue;
    }
    cap.rows[cap.size++] = row;
    added = true;
  }
  return added;
}

// The row of the farthest points along one of kMiddles directions: the overlap's normal comes
// first.
const PartingRow& NormalsTree::Middle(int pair, int direction) {
  int& row = middles_[pair * kMiddles + direction];
  if (row < 0) {
    const PairProblem& problem = rows_.problem(pair);
    const Vector3d& n = direction == 0 ? problem.n_W : FirstCells()[direction - 1].n;
    const auto [a, b] = problem.FarthestAlong(n, n, n);
    row = rows_.AddMiddle(pair, n, a, b);
  }
  return rows_.row(row);
}

// How far a pair is from being parted by x, in all directions [√S]; exact if more than `enough`.
// The direction that parted it last is asked first.
double NormalsTree::Overlapping(int pair, double enough) {
  const int directions = rows_.problem(pair).plane ? 1 : kMiddles;
  const auto order = order_.begin() + pair * kMiddles;
  double least = kInfinity;
  for (int k = 0; k < directions && least > enough; ++k) {
    const PartingRow& row = Middle(pair, order[k]);
    if (!(row.gg > 0.0)) continue;
    least = std::min(least, (row.t_middle - rows_.Dot(pair, row, x_)) / std::sqrt(row.gg));
    if (least <= enough) std::swap(order[0], order[k]);
  }
  return least;
}

// If the caps were points; of the cap, counted in the node, with the largest part of it.
NormalsTree::Gain NormalsTree::ByCutting(const Node& node) const {
  std::array<double, kMostPairs> cost = {}, overlap = {};
  for (const Term& term : terms_) {
    const PartingRow& row = rows_.row(term.row);
    cost[term.at] += term.lambda * (row.t_middle - row.t + node.root * row.e);
    overlap[term.at] = std::max(overlap[term.at], row.t);
  }
  Gain best;
  const double length = x_.norm();
  for (int k = 0; k < node.size; ++k) {
    if (!(caps_[node.caps[k]].eps > 0.0)) continue;  // a plane's only direction
    const bool proves = overlap[k] > 0.0 && length > 0.0;
    const double by = proves ? cost[k] / length : kInfinity;
    if (by > best.by) best = {by, k};
  }
  return best;
}

// If one more pair were parted, of those that x leaves overlapping the one that is farthest from
// it; none if that gains no more than cutting does.
NormalsTree::Gain NormalsTree::ByAdding(const Node& node, double by_cutting) {
  if (node.size == kMostPairs) return {};
  Gain farthest{.by = std::sqrt(by_cutting * (2.0 * node.root + by_cutting))};
  for (int pair = 0; pair < rows_.num_pairs(); ++pair) {
    const auto has = [&](int cap) { return caps_[cap].pair == pair; };
    if (std::any_of(node.caps.begin(), node.caps.begin() + node.size, has)) continue;
    const double by = Overlapping(pair, farthest.by);
    if (by > farthest.by) farthest = {by, pair};
  }
  if (farthest.of < 0) return {};
  return {std::hypot(node.root, farthest.by) - node.root, farthest.of};
}

// Replaces a solved node, which is not in the heap any more. False if that promises too little.
bool NormalsTree::Branch(const Node& node) {
  const Gain cutting = ByCutting(node);
  const Gain adding = std::isfinite(cutting.by) ? ByAdding(node, cutting.by) : Gain();
  if (std::max(cutting.by, adding.by) <= kNoGain * node.root) return false;
  Node child = node;
  child.solved = false;
  const auto push = [&](int at, int cap) {
    child.caps[at] = cap;
    child.root = std::max(node.root, caps_[cap].root);
    Push(child);
  };
  if (cutting.by >= adding.by) {
    const int whole = node.caps[cutting.of];
    Cut(whole);
    for (int part = 0; part < 4; ++part) push(cutting.of, caps_[whole].parts + part);
    return true;
  }
  const int pair = adding.of;
  if (first_caps_[pair] < 0) AddFirstCaps(pair);
  const int caps = rows_.problem(pair).plane ? 1 : kFirstCells;
  ++child.size;
  for (int k = 0; k < caps; ++k) push(node.size, first_caps_[pair] + k);
  return true;
}

// Room for any search of default effort, which is to take nothing from the heap once warm: a node
// has one cap that others do not, which gets its first rows and those that are deeper.
void NormalsTree::Reserve() {
  constexpr int kNodes = EffortPlan{}.bound_nodes * kMostTogether;
  rows_.Reserve(kNodes * (2 + kMostPairs), kMiddles * kMostTogether);
  caps_.reserve(kFirstCells * kMostTogether + 4 * kNodes);
  heap_.reserve(kFirstCells * kNodes);
  terms_.reserve(kMostPairs * kMostRows);
}

double NormalsTree::Search(int nodes, const BudgetMeter* budget) {
  Reserve();
  ease_.resize(rows_.num_pairs());
  first_caps_.assign(rows_.num_pairs(), -1);
  middles_.assign(kMiddles * rows_.num_pairs(), -1);
  order_.resize(middles_.size());
  for (int k = 0; k < static_cast<int>(order_.size()); ++k) order_[k] = k % kMiddles;
  Push(Node());
  for (; nodes > 0 && !heap_.empty(); --nodes) {
    if (BoundIsLate(budget)) break;
    Node node = heap_.front();
    std::pop_heap(heap_.begin(), heap_.end());
    heap_.pop_back();
    const double others = heap_.empty() ? known_ : heap_.front().root;
    const bool solved = std::exchange(node.solved, true);
    Collect(node);
    node.root = Prove(node, 1);
    if (!solved && node.root > others) {
      Push(node);
      continue;
    }
    if (AddDeepest(node)) {
      Collect(node);
      node.root = Prove(node, kRounds);
    }
    if (node.root <= others && Branch(node)) continue;
    Push(node);
    if (node.root <= others) break;
  }
  return heap_.empty() ? kProven * known_ : heap_.front().root;
}

}  // namespace mjcf_pdg
