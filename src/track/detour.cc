#include "track/detour.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/tuning.h"

namespace mjcf_pdg {

namespace tune = tuning::detour;

double LargestStep(const SceneTables& tables, const VectorXd& dq) {
  double largest = 0.0;
  for (const JointEntry& joint : tables.joints) {
    if (joint.ndof == 1) {
      largest = std::max(largest, std::abs(dq[joint.col]));
      continue;
    }
    for (int k = 0; k < joint.ndof; k += 3) {
      largest = std::max(largest, dq.segment<3>(joint.col + k).norm());
    }
  }
  return largest;
}

Detour::Detour(Workspace& work, double max_step, bool proves)
    : problem_(work.problem()),
      work_(work),
      max_step_(max_step),
      proves_(proves),
      ccd_(work.problem().tables, work.finder),
      random_(work.problem().options.seed) {
  const int nq = problem_.tables.model->nq;
  for (Tree& tree : trees_) {
    tree.q.resize(nq, tune::kNodes);
    tree.parent.resize(tune::kNodes);
  }
  for (auto& trail : trails_) trail.assign(tune::kTrail, VectorXd(nq));
  way_.assign(tune::kPoints, VectorXd(nq));
  ccd_options_.tolerance = problem_.options.tolerance;
  ccd_options_.budget = &deadline_;
  dq_.resize(problem_.tables.n);
  for (VectorXd* q : {&target_, &q_, &node_q_}) q->resize(nq);
}

void Detour::Reset() {
  planted_ = found_ = false;
  fineness_ = 1.0;
}

void Detour::Blocked() {
  const double finer = 0.5 * fineness_;
  Reset();
  fineness_ = finer;
}

double Detour::Distance(const VectorXd& from, const VectorXd& to) {
  Difference(problem_.tables, from, to, dq_);
  return LargestStep(problem_.tables, dq_);
}

void Detour::Plant(int tree, const VectorXd& q) {
  trees_[tree].size = 0;
  Add(tree, q, -1);
  trails_[tree][0] = q;
  trail_sizes_[tree] = 1;
}

void Detour::Ends(const VectorXd& from, const VectorXd& to) {
  if (found_) {
    BeginAt(from);
    return EndAt(to);
  }
  const VectorXd* const ends[] = {&from, &to};
  for (int k = 0; k < 2 && planted_; ++k) {
    int& size = trail_sizes_[k];
    const double moved = Distance(trails_[k][size - 1], *ends[k]);
    if (moved > stride_ || size == tune::kTrail) planted_ = false;
    if (planted_ && moved > 0.5 * stride_) trails_[k][size++] = *ends[k];
  }
  if (planted_) return;
  const double apart = Distance(from, to);
  const double tick = std::min(max_step_, tune::kShare / tune::kTicks * apart);
  stride_ = std::max(fineness_ * std::max(tune::kTicks * tick, tune::kShare * apart),
                     tune::kFewestTicks * tick);
  for (int k = 0; k < 2; ++k) Plant(k, *ends[k]);
  planted_ = true;
  samples_ = 0;
  nearest_ = 0;
  nearest_sigma_ = std::numeric_limits<double>::infinity();
  connecting_ = true;
  other_ = 0;
  Aim(0, 0, to);
}

// A point that is far from the last one but one is one more.
void Detour::EndAt(const VectorXd& q) {
  if (partial_) return;
  if (end_ == tune::kPoints || Distance(way_[end_ - 1], q) > stride_) return Reset();
  const bool far = end_ - begin_ > 1 && Distance(way_[end_ - 2], q) > stride_;
  way_[far ? end_++ : end_ - 1] = q;
}

void Detour::BeginAt(const VectorXd& q) {
  if (begin_ == 0 || Distance(way_[begin_], q) > stride_) return Reset();
  const bool far = end_ - begin_ > 1 && Distance(way_[begin_ + 1], q) > stride_;
  way_[far ? --begin_ : begin_] = q;
}

int Detour::Add(int tree, const VectorXd& q, int parent) {
  Tree& t = trees_[tree];
  t.q.col(t.size) = q;
  t.parent[t.size] = parent;
  return t.size++;
}

int Detour::Nearest(int tree, const VectorXd& q) const {
  const Tree& t = trees_[tree];
  Eigen::Index nearest = 0;
  (t.q.leftCols(t.size).colwise() - q).colwise().squaredNorm().minCoeff(&nearest);
  return static_cast<int>(nearest);
}

void Detour::Aim(int tree, int node, const VectorXd& target) {
  tree_ = tree;
  node_ = node;
  target_ = target;
}

bool Detour::failed() const {
  return planted_ && !found_ && std::max(trees_[0].size, trees_[1].size) == tune::kNodes;
}

void Detour::Meet() {
  partial_ = false;
  Join(tree_ == 0 ? node_ : other_, tree_ == 0 ? other_ : node_);
}

// Whether it is free at dq_ from a configuration, q_, or, if that is to be proven, all the way
// there. One query; that of a proof is charged.
bool Detour::Leads(const VectorXd& from) {
  Integrate(problem_.tables, from, dq_, q_);
  if (work_.equality.any()) work_.equality.Project(q_);
  ++asked_;
  if (!proves_) return work_.Free(q_);
  work_.budget.Charge(1);
  deadline_ = work_.budget.Deadline();
  return ccd_.Move({from, dq_, &problem_.required}, ccd_options_).outcome == CcdOutcome::kFree;
}

// An edge more of the present growth, one query. False if it is over: blocked, or there.
bool Detour::Grow() {
  node_q_ = trees_[tree_].q.col(node_);
  const double left = Distance(node_q_, target_);
  const bool joins = left <= stride_ && connecting_;
  if (joins && !proves_) {
    Meet();
    return false;
  }
  const double share = std::min(1.0, stride_ / left);
  dq_ *= share;
  if (!Leads(node_q_)) return false;
  if (joins) {
    Meet();
    return false;
  }
  node_ = Add(tree_, q_, node_);
  if (tree_ == 0) {
    const double sigma = work_.norm.Sigma(q_);
    if (sigma < nearest_sigma_) {
      nearest_ = node_;
      nearest_sigma_ = sigma;
    }
  }
  return share < 1.0;
}

// A growth is over: the other tree goes to where it ended, or a tree goes to the next sample.
void Detour::AimNext() {
  if (!connecting_) {
    connecting_ = true;
    other_ = node_;
    node_q_ = trees_[tree_].q.col(node_);
    return Aim(1 - tree_, Nearest(1 - tree_, node_q_), node_q_);
  }
  connecting_ = false;
  Sample();
  const int tree = samples_ % 2;
  Aim(tree, Nearest(tree, q_), q_);
}

void Detour::Sample() {
  const int wider = 1 + samples_++ / tune::kSamplesPerWidth;
  const VectorXd& from = trails_[0][trail_sizes_[0] - 1];
  const double apart = Distance(from, trails_[1][trail_sizes_[1] - 1]);
  const double width = std::min(tune::kWidth * apart * wider, std::numbers::pi);
  for (Eigen::Index k = 0; k < dq_.size(); ++k) {
    const bool still = std::abs(dq_[k]) < tune::kStill * apart;
    dq_[k] *= 0.5;
    if (!still || random_.Uniform() < tune::kStillMoves) {
      dq_[k] += width * (2.0 * random_.Uniform() - 1.0);
    }
  }
  Integrate(problem_.tables, from, dq_, q_);
  ClampToLimits(problem_.tables, q_);
}

bool Detour::Search(int queries) {
  asked_ = 0;
  while (!found_ && !failed() && asked_ < queries && !work_.Spent()) {
    if (!Grow() && !found_) AimNext();
  }
  return found_;
}

void Detour::Append(const Eigen::Ref<const VectorXd>& q) { way_[end_++] = q; }

bool Detour::EndsNearer(double sigma) {
  if (nearest_ == 0 || nearest_sigma_ >= sigma) return false;
  node_q_ = trees_[0].q.col(nearest_);
  nearest_sigma_ = work_.norm.Sigma(node_q_);  // the command has moved since
  if (nearest_sigma_ >= sigma) return false;
  partial_ = true;
  Join(nearest_, -1);
  return true;
}

// The trees meet at two nodes, or the first one leads to `first` alone.
void Detour::Join(int first, int second) {
  begin_ = end_ = tune::kTrail;
  for (int k = trail_sizes_[0] - 1; k >= 1; --k) Append(trails_[0][k]);
  const int root = end_;
  for (int n = first; n >= 0; n = trees_[0].parent[n]) Append(trees_[0].q.col(n));
  std::reverse(way_.begin() + root, way_.begin() + end_);
  for (int n = second; n >= 0; n = trees_[1].parent[n]) Append(trees_[1].q.col(n));
  for (int k = 1; k < trail_sizes_[1] && !partial_; ++k) Append(trails_[1][k]);
  found_ = true;
  first_ = -1;
}

const VectorXd& Detour::Next(const VectorXd& at) {
  const double reach = std::isinf(max_step_) ? 0.0 : max_step_;
  while (end_ - begin_ > 1 && Distance(at, way_[begin_]) <= reach) ++begin_;
  return way_[begin_];
}

double Detour::Ticks(double& sigma) {
  double ticks = 0.0, sum = 0.0;
  for (int k = begin_ + 1; k < end_; ++k) {
    const double t = Distance(way_[k - 1], way_[k]) / max_step_;
    ticks += t;
    sum += t * 0.5 * (work_.norm.Sigma(way_[k - 1]) + work_.norm.Sigma(way_[k]));
  }
  sigma = ticks > 0.0 ? sum / ticks : 0.0;
  return ticks;
}

// The points between two of the way, chosen at random, are left out if the straight edge between
// the two is free, looked at once every stride.
void Detour::Shorten(int queries) {
  asked_ = 0;
  while (end_ - begin_ > 2 && asked_ < queries && !work_.Spent()) {
    if (first_ < begin_ || second_ >= end_) {
      const int points = end_ - begin_;
      const auto below = [this](int count) { return static_cast<int>(random_.Uniform() * count); };
      first_ = begin_ + below(points - 2);
      second_ = first_ + 2 + below(end_ - first_ - 2);
      looked_ = 0;
    }
    Distance(way_[first_], way_[second_]);
    const int pieces =
        std::max(1, static_cast<int>(std::ceil(LargestStep(problem_.tables, dq_) / stride_)));
    if (++looked_ < pieces || (proves_ && looked_ == pieces)) {
      dq_ *= static_cast<double>(looked_) / pieces;
      if (Leads(way_[first_])) continue;
    } else {
      const int gone = second_ - first_ - 1;
      for (int k = second_; k < end_; ++k) way_[k - gone].swap(way_[k]);
      end_ -= gone;
    }
    first_ = -1;
  }
}

}  // namespace mjcf_pdg
