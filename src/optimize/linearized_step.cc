#include "optimize/linearized_step.h"

#include <algorithm>
#include <cmath>

#include "base/grow.h"
#include "base/tuning.h"

namespace mjcf_pdg {

namespace tune = tuning::step;

// Rooms for the most rows there can be, so that no later step needs more.
LinearizedStep::LinearizedStep(Workspace& work)
    : problem_(work.problem()),
      work_(work),
      contacts_(static_cast<std::size_t>(std::max(tune::kContacts, work.problem().tables.n))) {
  const SceneTables& tables = problem_.tables;
  const auto tendons = std::count(tables.held_tendons.begin(), tables.held_tendons.end(), 1);
  const int n = tables.n;
  const int limits = 2 * static_cast<int>(tables.joints.size()) + 2 * static_cast<int>(tendons);
  const int rows = static_cast<int>(contacts_) * (1 + WitnessMemory::kPerPair) + limits;
  rows_.Reserve(rows, n);
  lcp_.Reserve(n, rows);
  forces_.Reserve(static_cast<std::size_t>(rows), tables.pairs.size(),
                  static_cast<std::size_t>(tables.model->njnt));
  GrowTo(static_cast<Eigen::Index>(FindTrees()) * rows, whitened_);
  supports_.reserve(static_cast<std::size_t>(rows));
  for (VectorXd* per_row : {&lambda_, &b_, &bounds_, &slack_}) GrowTo(rows, *per_row);
  nearest_.reserve(tables.pairs.size());
  moved_.resize(work.norm.rows());
}

// trees_ is left empty where there is one tree only, where equality constraints may join them, or
// where H is not block-diagonal by trees. Returns for how many entries of a row in G room is to be
// made.
int LinearizedStep::FindTrees() {
  const SceneTables& tables = problem_.tables;
  const mjModel& m = *tables.model;
  if (work_.norm.blocks().size() != tables.joints.size() || work_.equality.any()) return tables.n;
  packs_ = tables.n > tune::kPackingCost;
  tree_of_.assign(static_cast<std::size_t>(m.ntree), -1);
  int largest = 0;
  for (const JointEntry& joint : tables.joints) {
    int& tree = tree_of_[m.body_treeid[joint.body]];
    if (tree < 0) {
      tree = static_cast<int>(trees_.size());
      trees_.push_back({.columns = {.begin = joint.col}});
    }
    trees_[tree].columns.size += joint.ndof;
    largest = std::max(largest, trees_[tree].columns.size);
  }
  if (trees_.size() == 1 && tables.outside_mass == 0.0) trees_.clear();
  for (int body = 1; body < m.nbody && !trees_.empty(); ++body) {
    if (!tables.body_moves[body]) continue;
    trees_[tree_of_[m.body_treeid[body]]].mass += m.body_mass[body] / work_.norm.total_mass();
  }
  const auto& tendons = tables.held_tendons;
  const bool packs_all = 2 * largest + tune::kPackingCost < tables.n &&
                         std::find(tendons.begin(), tendons.end(), 1) == tendons.end();
  return packs_all ? 2 * largest : tables.n;
}

void LinearizedStep::Linearize(const VectorXd& q, const std::vector<NearPair>& near,
                               const RowOptions& options) {
  const SceneTables& tables = problem_.tables;
  nearest_.clear();
  for (const NearPair& pair : near) nearest_.push_back(&pair);
  if (nearest_.size() > contacts_) {
    const auto slack = [this](const NearPair* pair) {
      return pair->distance - problem_.required[pair->pair];
    };
    std::nth_element(nearest_.begin(), nearest_.begin() + static_cast<std::ptrdiff_t>(contacts_),
                     nearest_.end(),
                     [&](const NearPair* a, const NearPair* b) { return slack(a) < slack(b); });
    nearest_.resize(contacts_);
  }
  if (packs_) forces_.Keep(rows_, lambda_);
  rows_.Clear(tables.n);
  for (const NearPair* pair : nearest_) AppendContactRows(*pair, options);
  contact_rows_ = rows_.m;
  AppendLimitRows(tables, q, {tune::kLimitReach, tune::kSlideReach * problem_.size, problem_.size},
                  rows_);
  work_.equality.Linearize(q);
  AppendTendonRows();
  GrowTo(rows_.m, lambda_);
  lambda_.head(rows_.m).setZero();
  work_.norm.Linearize(q, r_, J_);
}

// Those of tendon limits that are as near as limits of turning joints.
void LinearizedStep::AppendTendonRows() {
  const TendonLimits& limits = work_.equality.tendon_limits();
  for (Eigen::Index k = 0; k < limits.slack().size(); ++k) {
    const double scale = limits.scale()[k], gap = scale * limits.slack()[k];
    if (!(scale > 0.0) || gap >= tune::kLimitReach * problem_.size) continue;
    rows_.C.row(rows_.Append(gap)) = scale * limits.jacobian().row(k);
  }
}

// The row of the pair's witness points, then those of witness points that it had at earlier steps.
void LinearizedStep::AppendContactRows(const NearPair& near, const RowOptions& options) {
  const SceneTables& tables = problem_.tables;
  const PosedModel& posed = work_.finder.posed();
  const double merge = tune::kSamePoint * problem_.size;
  double offset = options.aim - problem_.required[near.pair];
  if (NeedsGap(near.kind)) offset -= options.safety_margin;
  const int row = rows_.Append(near.distance + offset, {.pair = near.pair});
  ContactRow(tables, posed, near.pair, near.p1_W, near.p2_W, near.n_W, rows_.C.row(row));
  // Of exact meshes and height fields every feature nearby is a NearPair of its own.
  if (!PartedByOnePlane(near.kind) || !problem_.Uses(Component::kWitnessMemory)) return;
  const auto append_remembered = [&](const Vector3d& p1_W, const Vector3d& p2_W) {
    const double distance = near.n_W.dot(p2_W - p1_W);
    if (distance > options.margin + problem_.clearance) return;
    const int extra = rows_.Append(distance + offset, {.pair = near.pair});
    ContactRow(tables, posed, near.pair, p1_W, p2_W, near.n_W, rows_.C.row(extra));
  };
  memory_.ForEach(tables, posed, near, merge, append_remembered);
  memory_.Add(tables, posed, near, merge);
}

double LinearizedStep::Solve(const StepOptions& options) {
  // H = JᵀJ = L Lᵀ; z = Lᵀ dq; y = L⁻¹ Jᵀ r; G = L⁻¹ Cᵀ.
  work_.norm.InnerProduct(J_, H_);
  damping_ = problem_.Uses(Component::kDamping) ? options.damping : 0.0;
  AddDamping();
  whitening_.Factor(H_, work_.norm.blocks());
  y_.noalias() = J_.transpose() * r_;
  whitening_.SolveLower(y_);
  SolveLcp(options);
  dq_ = z_;
  whitening_.SolveUpper(dq_);
  moved_.noalias() = J_ * dq_;
  uncut_sigma_ = (r_ + moved_).squaredNorm();
  const double length = moved_.norm();
  const double cut =
      std::min({1.0, options.trust_radius / length, tune::kLargestTurn / LargestTurn()});
  dq_ *= cut;
  moved_ *= cut;
  Predict();
  return cut * length;
}

// The norm hardly sees light links: without damping, small gains turn them far and the
// linearization is lost. Rotations count as translations of the scene's size.
void LinearizedStep::AddDamping() {
  for (const JointEntry& joint : problem_.tables.joints) {
    for (int k = 0; k < joint.ndof; ++k) {
      H_(joint.col + k, joint.col + k) += DampingOf(joint, k);
    }
  }
}

double LinearizedStep::DampingOf(const JointEntry& joint, int k) const {
  return joint.Slides(k) ? damping_ : damping_ * problem_.size * problem_.size;
}

double LinearizedStep::DampingShare() const {
  double cost = 0.0;
  for (const JointEntry& joint : problem_.tables.joints) {
    for (int k = 0; k < joint.ndof; ++k) {
      cost += DampingOf(joint, k) * dq_[joint.col + k] * dq_[joint.col + k];
    }
  }
  return cost > 0.0 ? cost / squared_length_ : 0.0;
}

// Of the rows of C, where packing them is worth its loops; else there are none. Returns the most
// entries of a column of G. Of a tendon's row, any entry may be other than 0.
int LinearizedStep::FindSupports() {
  supports_.clear();
  const int n = problem_.tables.n;
  int largest = 0, cost = 0;
  if (!packs_) return n;
  for (int k = 0; k < rows_.m; ++k) {
    const RowSource& source = rows_.sources[k];
    const bool again = k > 0 && source.pair >= 0 && source.pair == rows_.sources[k - 1].pair;
    supports_.push_back(again ? supports_.back() : RowSupport(problem_.tables, source));
    largest = std::max(largest, supports_.back().size());
    cost += supports_.back().size() + tune::kPackingCost;
  }
  if (cost < n * rows_.m) return largest;
  supports_.clear();
  return n;
}

// G = L⁻¹ Cᵀ, packed where supports are known.
void LinearizedStep::FillWhitened(Eigen::Ref<MatrixXd> G) {
  if (supports_.empty()) {
    G = rows_.C.topRows(rows_.m).transpose();
    whitening_.SolveLower(G);
    return;
  }
  for (int k = 0; k < rows_.m; ++k) {
    double* packed = G.col(k).data();
    for (const ColumnRange& columns : {supports_[k].first, supports_[k].second}) {
      const double* of_row = rows_.C.row(k).data() + columns.begin;
      std::copy(of_row, of_row + columns.size, packed);
      whitening_.SolveLower(columns, packed);
      packed += columns.size;
    }
  }
}

// λ and the whitened step z = G λ - y.
void LinearizedStep::SolveLcp(const StepOptions& options) {
  const int n = problem_.tables.n, m = rows_.m;
  const int entries = FindSupports();
  const bool packed = !supports_.empty();
  GrowTo(static_cast<Eigen::Index>(entries) * m, whitened_);
  Eigen::Map<MatrixXd> G(whitened_.data(), entries, m);
  for (VectorXd* per_row : {&lambda_, &b_, &bounds_}) GrowTo(m, *per_row);
  auto lambda = lambda_.head(m), b = b_.head(m), bounds = bounds_.head(m);
  FillWhitened(G);
  b = -rows_.gap.head(m);
  if (work_.equality.any()) HoldEqualities(G, b);
  if (packed) {
    for (int k = 0; k < m; ++k) b[k] += Dot(supports_[k], G.col(k).data(), y_);
  } else {
    b.noalias() += G.transpose() * y_;
  }
  bounds.setConstant(options.penalty);
  bounds.tail(m - contact_rows_).setConstant(tune::kLimitPenalty * options.scale);
  LcpOptions lcp;
  lcp.max_steps = tune::kLcpStepsPerVariable * (n + m);
  lcp.tolerance = tune::kLcpTolerance * problem_.tolerances.user;
  lambda.setZero();
  if (packed) forces_.Recall(rows_, lambda);  // smaller problems end as soon from nothing
  lcp_steps_ += lcp_.SolveFrom(G, b, bounds, lcp, lambda, {n, supports_}).steps;
  z_ = -y_;
  if (packed) {
    for (int k = 0; k < m; ++k) AddMultiple(lambda[k], supports_[k], G.col(k).data(), z_);
  } else {
    z_.noalias() += G * lambda;
  }
  if (work_.equality.any()) z_ += held_;
}

// The constraints are E dq + e = 0, or Kᵀz + e = 0 in whitened coordinates with K = L⁻¹Eᵀ. Of all
// such z = z_e + w, z_e is the shortest and w is orthogonal to the columns of K: G and y lose their
// parts along these, and b gets what z_e does to the gaps. Constraints that depend on each other
// differ by rank.
void LinearizedStep::HoldEqualities(Eigen::Ref<MatrixXd> G, Eigen::Ref<VectorXd> b) {
  K_ = work_.equality.jacobian().transpose();
  held_.setZero(problem_.tables.n);
  if (K_.cols() == 0) return;
  whitening_.SolveLower(K_);
  range_of_K_.setThreshold(tuning::equality::kRank);
  range_of_K_.compute(K_);
  const Eigen::Index rank = range_of_K_.rank();
  range_ = MatrixXd::Identity(K_.rows(), rank);
  range_.applyOnTheLeft(range_of_K_.householderQ());
  // K P = Q R: z_e = Q a with RᵀQᵀz_e = -Pᵀe, of which the first `rank` rows decide.
  const auto R = range_of_K_.matrixR().topLeftCorner(rank, rank).triangularView<Eigen::Upper>();
  const VectorXd e = range_of_K_.colsPermutation().transpose() * work_.equality.residual();
  held_ = range_ * R.transpose().solve(-e.head(rank));
  b -= G.transpose() * held_;
  G -= range_ * (range_.transpose() * G);
  y_ -= range_ * (range_.transpose() * y_);
}

double LinearizedStep::LargestTurn() const {
  double largest = 0.0;
  for (const JointEntry& joint : problem_.tables.joints) {
    for (int k = 0; k < joint.ndof; ++k) {
      if (!joint.Slides(k)) largest = std::max(largest, std::abs(dq_[joint.col + k]));
    }
  }
  return largest;
}

void LinearizedStep::Predict() {
  sigma_ = (r_ + moved_).squaredNorm();
  squared_length_ = moved_.squaredNorm();
  GrowTo(contact_rows_, slack_);
  auto slack = slack_.head(contact_rows_);
  slack = rows_.gap.head(contact_rows_);
  if (supports_.empty()) {
    slack.noalias() += rows_.C.topRows(contact_rows_) * dq_;
  } else {
    for (int k = 0; k < contact_rows_; ++k) {
      for (const ColumnRange& columns : {supports_[k].first, supports_[k].second}) {
        slack[k] += rows_.C.row(k)
                        .segment(columns.begin, columns.size)
                        .dot(dq_.segment(columns.begin, columns.size));
      }
    }
  }
  violation_ = -slack.cwiseMin(0.0).sum();
}

double LinearizedStep::LargestLength() const {
  if (trees_.empty()) return std::sqrt(squared_length_);
  double largest = 0.0;
  for (const Tree& tree : trees_) {
    double squared = 0.0;
    for (Eigen::Index row = tree.columns.begin; row < moved_.size(); row += problem_.tables.n) {
      squared += moved_.segment(row, tree.columns.size).squaredNorm();
    }
    largest = std::max(largest, squared / tree.mass);
  }
  return std::sqrt(largest);
}

double LinearizedStep::LargestForce() const {
  return contact_rows_ == 0 ? 0.0 : lambda_.head(contact_rows_).maxCoeff();
}

double LinearizedStep::SquaredLength(const VectorXd& dq) {
  moved_.noalias() = J_ * dq;
  return moved_.squaredNorm();
}

}  // namespace mjcf_pdg
