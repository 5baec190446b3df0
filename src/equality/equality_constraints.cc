#include "equality/equality_constraints.h"

#include <algorithm>
#include <cmath>

#include "base/tuning.h"
#include "mjcf_pdg/types.h"

namespace mjcf_pdg {
namespace {

namespace tune = tuning::equality;

// Pivots below this share of the largest are taken for 0: a Gram matrix has squared singular
// values, and errs by about its size times the rounding.
constexpr double kGramRank = 1e-13;
// A change that leaves no more than this share of what is broken mends it: the next step of
// Newton's method does the rest.
constexpr double kMended = 1e-6;

// A copy of the model's struct for which MuJoCo makes rows of equality constraints alone, as a
// dense matrix.
mjModel WithEqualitiesAlone(const mjModel& query_model) {
  mjModel m = query_model;
  m.opt.disableflags |= mjDSBL_CONTACT | mjDSBL_LIMIT | mjDSBL_FRICTIONLOSS | mjDSBL_ISLAND;
  m.opt.disableflags &= ~(mjDSBL_CONSTRAINT | mjDSBL_EQUALITY);
  m.opt.jacobian = mjJAC_DENSE;
  return m;
}

}  // namespace

EqualityConstraints::EqualityConstraints(const SceneTables& tables)
    : tables_(tables), model_(WithEqualitiesAlone(tables.query_model)), tendon_limits_(tables) {
  const std::vector<char>& held = tables.held_equalities;
  if (std::find(held.begin(), held.end(), 1) == held.end() && !tendon_limits_.any()) return;
  posed_ = std::make_unique<PosedModel>(&model_);
  weight_.resize(tables.n);
  for (const JointEntry& joint : tables.joints) {
    for (int k = 0; k < joint.ndof; ++k) {
      weight_[joint.col + k] = joint.Slides(k) ? 1.0 : 1.0 / tables.size;
    }
  }
  SetActive({});
}

void EqualityConstraints::SetMocap(const MocapPoses& poses) {
  if (posed_) posed_->SetMocap(poses);
  linearized_at_.resize(0);
}

void EqualityConstraints::SetActive(std::span<const mjtBool> active) {
  if (!posed_) return;
  linearized_at_.resize(0);
  const mjModel& m = *tables_.model;
  equalities_ = false;
  tendons_ = tendon_limits_.any();
  for (int e = 0; e < m.neq; ++e) {
    const bool on = (active.empty() ? m.eq_active0[e] : active[e]) && tables_.held_equalities[e];
    posed_->data()->eq_active[e] = on;
    equalities_ |= on;
    tendons_ |= on && m.eq_type[e] == mjEQ_TENDON;
  }
  any_ = equalities_ || tendon_limits_.any();
}

std::span<const mjtBool> EqualityConstraints::active() const {
  if (!posed_) return {};
  return {posed_->data()->eq_active, static_cast<std::size_t>(model_.neq)};
}

void EqualityConstraints::Linearize(const VectorXd& q) {
  if (!any_ || (linearized_at_.size() == q.size() && linearized_at_ == q)) return;
  linearized_at_ = q;
  posed_->Pose(q);
  mjData* d = posed_->data();
  if (tendons_) mj_tendon(&model_, d);
  tendon_limits_.Linearize(*d);
  if (equalities_) mj_makeConstraint(&model_, d);
  const int rows = equalities_ ? d->ne : 0;
  residual_.resize(rows);
  jacobian_.resize(rows, tables_.n);
  const int nv = static_cast<int>(model_.nv);
  for (int row = 0; row < rows; ++row) {
    residual_[row] = d->efc_pos[row];
    for (int dof = 0; dof < nv; ++dof) {
      const int col = tables_.column_of_dof[dof];
      if (col >= 0) jacobian_(row, col) = d->efc_J[static_cast<std::ptrdiff_t>(row) * nv + dof];
    }
  }
  ScaleRows();
}

// The last three rows of a weld are the vector part of a quaternion times its torquescale, which
// is half the angle for small ones: made radians here.
void EqualityConstraints::ScaleRows() {
  const mjData* d = posed_->data();
  for (int row = 0; row < residual_.size(); ++row) {
    const int id = d->efc_id[row];
    if (model_.eq_type[id] != mjEQ_WELD) continue;
    const bool turns = row >= 3 && d->efc_id[row - 3] == id;
    const double scale = model_.eq_data[mjNEQDATA * id + 10];
    if (!turns || !(scale > 0.0)) continue;
    residual_[row] *= 2.0 / scale;
    jacobian_.row(row) *= 2.0 / scale;
  }
}

double EqualityConstraints::Largest() const {
  const double residual = residual_.size() ? residual_.lpNorm<Eigen::Infinity>() : 0.0;
  return std::max(residual, tendon_limits_.Excess());
}

void EqualityConstraints::CollectBroken() {
  const VectorXd& slack = tendon_limits_.slack();
  const Eigen::Index equalities = residual_.size();
  const Eigen::Index exceeded = (slack.array() < 0.0).count();
  broken_.resize(equalities + exceeded);
  broken_jacobian_.resize(equalities + exceeded, tables_.n);
  broken_.head(equalities) = residual_;
  broken_jacobian_.topRows(equalities) = jacobian_;
  Eigen::Index row = equalities;
  for (Eigen::Index k = 0; k < slack.size(); ++k) {
    if (!(slack[k] < 0.0)) continue;
    broken_[row] = slack[k];
    broken_jacobian_.row(row++) = tendon_limits_.jacobian().row(k);
  }
}

double EqualityConstraints::Violation(const VectorXd& q) {
  if (!any_) return 0.0;
  Linearize(q);
  return Largest();
}

// Sets step_ to the least change, by the weights, that mends what is broken as it is linearized.
void EqualityConstraints::Mend(const VectorXd& weight) {
  weighted_.noalias() = broken_jacobian_ * weight.asDiagonal();
  if (!MendByGram()) {
    solver_.setThreshold(tune::kRank);
    solver_.compute(weighted_);
    step_ = solver_.solve(-broken_);
  }
  step_ = weight.cwiseProduct(step_).eval();
}

// With A the weighted Jacobian and b what is broken: Aᵀy with A Aᵀ y = -b, which is several times
// cheaper than a decomposition of A. Constraints that depend on each other leave y some freedom,
// but not Aᵀy. Returns false where that does not mend what is broken: constraints that conflict, or
// nearly depend on each other, need the decomposition.
bool EqualityConstraints::MendByGram() {
  gram_.noalias() = weighted_ * weighted_.transpose();
  of_gram_.compute(gram_);
  const auto pivots = of_gram_.vectorD();
  const double least = kGramRank * pivots.cwiseAbs().maxCoeff();
  forces_ = of_gram_.transpositionsP() * -broken_;
  of_gram_.matrixL().solveInPlace(forces_);
  for (Eigen::Index k = 0; k < pivots.size(); ++k) {
    forces_[k] = pivots[k] > least ? forces_[k] / pivots[k] : 0.0;
  }
  of_gram_.matrixU().solveInPlace(forces_);
  forces_ = of_gram_.transpositionsP().transpose() * forces_;
  step_.noalias() = weighted_.transpose() * forces_;
  forces_ = broken_;
  forces_.noalias() += weighted_ * step_;
  return forces_.squaredNorm() <= kMended * kMended * broken_.squaredNorm();
}

// Sets step_ to the least change that mends what is broken, without joints that are at a limit and
// would leave it. Returns false if nothing can change.
bool EqualityConstraints::Correct(const VectorXd& q) {
  CollectBroken();
  VectorXd weight = weight_;
  for (std::size_t round = 0; round <= tables_.joints.size(); ++round) {
    Mend(weight);
    bool blocked = false;
    for (const JointEntry& joint : tables_.joints) {
      if (!joint.limited || joint.type == mjJNT_BALL) continue;
      const double to = q[joint.qadr] + step_[joint.col];
      const bool at_limit = (q[joint.qadr] >= joint.hi && to > joint.hi) ||
                            (q[joint.qadr] <= joint.lo && to < joint.lo);
      if (!at_limit || weight[joint.col] == 0.0) continue;
      weight[joint.col] = 0.0;
      blocked = true;
    }
    if (!blocked) break;
  }
  const double largest = step_.lpNorm<Eigen::Infinity>();
  return std::isfinite(largest) && largest > 0.0;
}

bool EqualityConstraints::Project(VectorXd& q) {
  if (!any_) return true;
  Linearize(q);
  double reached = Largest(), least = reached;
  nearest_ = q;
  for (int k = 0; k < tune::kProjectionSteps && reached > tune::kAim; ++k) {
    if (!Correct(q)) break;
    double turn = 0.0;
    for (const JointEntry& joint : tables_.joints) {
      for (int i = 0; i < joint.ndof; ++i) {
        if (!joint.Slides(i)) turn = std::max(turn, std::abs(step_[joint.col + i]));
      }
    }
    if (turn > tune::kLargestTurn) step_ *= tune::kLargestTurn / turn;
    Integrate(tables_, q, step_, q);
    ClampToLimits(tables_, q);
    Linearize(q);
    reached = Largest();
    if (reached >= least) continue;
    least = reached;
    nearest_ = q;
  }
  q = nearest_;  // not the last where constraints contradict each other or limits
  return least <= kEqualityTolerance;
}

}  // namespace mjcf_pdg
