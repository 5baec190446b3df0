#include "gradient/converged_optimum.h"

#include <algorithm>
#include <cmath>

namespace mjcf_pdg {
namespace {

using Kind = ConstraintRow::Kind;

// Pairs that are nearer than this may become active [size].
constexpr double kMargin = 0.01;
// The most steps; two or three are usual, more where the active set changes on the way.
constexpr int kSteps = 30;
// A step this short ends it [√σ + size], if the planes turn by less than the second [rad].
constexpr double kShort = 1e-11, kStill = 1e-9;
// The longest step [√σ, with a hundredth of the size], and the largest turn of a joint or plane in
// a step [rad].
constexpr double kLongest = 0.3, kLargestTurn = 0.2;
// What holds a plane where no row does: its turns and moves cost this share of those of all mass
// at the scene's size [1]. It does not move the optimum, where planes stand still. In the first
// step, which finds the forces, those at round geoms do so: how strongly such a geom holds a plane
// depends on the force.
constexpr double kPlaneShare = 1e-6, kFirstPlaneShare = 1e6;
// Without second derivatives planes cost so many times as much, lest they turn far [1]. Of 110
// answers of hand and figure 105, 109 and 105 converge with 1, 1e3 and 1e5.
constexpr double kWithoutCurvature = 1e3;
// Weights of the squared active rows that make H positive definite without changing the step on
// them [1].
constexpr double kAugmented[] = {10.0, 1e3, 1e5};
// Multipliers below this share of the largest are the LCP's rounding [1].
constexpr double kNoForce = 1e-12;
constexpr double kMostForce = 1e6;       // μ of the elastic rows [size]
constexpr double kLcpTolerance = 1e-13;  // [size]

}  // namespace

double DifferenceStep(const SceneTables& all, const JointEntry& joint, int k) {
  return joint.Slides(k) ? kSlideStep * all.size : kTurnStep;
}

ConvergedOptimum::ConvergedOptimum(Workspace& work, const SceneTables& all)
    : work_(work), all_(all), constraints_(work.problem(), all) {}

ConvergedOptimum::Ending ConvergedOptimum::Run(const VectorXd& q) {
  const double size = work_.problem().size;
  q_ = q;
  moved_ = 0.0;
  known_.clear();
  lambda_.resize(0);
  work_.finder.ForgetConvex();
  constraints_.SetActive(work_.equality.active());
  const bool smooth = constraints_.Begin(q_, FindNear());
  if (!smooth) return Ending::kNotSmooth;
  for (int k = 0; k < kSteps; ++k) {
    const double length = Step();
    moved_ += length;
    const double turn = HeldTurn();
    if (!std::isfinite(length)) return Ending::kNotConverged;
    if (k == 0 || length > kShort * (std::sqrt(work_.norm.Sigma(q_)) + size) || turn > kStill)
      continue;
    constraints_.Evaluate(q_);
    constraints_.MarkHeld(lambda_);
    return Ending::kConverged;
  }
  return Ending::kNotConverged;
}

const std::vector<NearPair>& ConvergedOptimum::FindNear() {
  const Problem& problem = work_.problem();
  work_.finder.Pose(q_);
  return work_.finder.Find(problem.clearance + kMargin * problem.size, Depths::kSkipped);
}

const std::vector<NearPair>& ConvergedOptimum::IdlePairs() {
  idle_.clear();
  for (const NearPair& near : FindNear()) {
    const auto is_idle = [&near](const PartingPlane& plane) {
      return plane.pair == near.pair && plane.Idle();
    };
    const std::vector<PartingPlane>& planes = constraints_.planes();
    if (std::any_of(planes.begin(), planes.end(), is_idle)) idle_.push_back(near);
  }
  return idle_;
}

Eigen::RowVectorXd ConvergedOptimum::RowByUnknowns(int row) const {
  const SceneTables& tables = work_.problem().tables;
  Eigen::RowVectorXd by(unknowns());
  for (std::size_t dof = 0; dof < tables.column_of_dof.size(); ++dof) {
    const int col = tables.column_of_dof[dof];
    if (col >= 0) by[col] = constraints_.values().C(row, static_cast<Eigen::Index>(dof));
  }
  by.tail(constraints_.plane_unknowns()) = constraints_.by_plane().row(row);
  return by;
}

void ConvergedOptimum::Forces(const VectorXd& q, const VectorXd& lambda, VectorXd& by_q,
                              VectorXd& by_plane) {
  constraints_.Evaluate(q, &lambda);
  by_q = constraints_.values().C.topRows(constraints_.size()).transpose() * lambda;
  by_plane = constraints_.by_plane().transpose() * lambda;
}

// Differences of the gradient in frames that turn along are the second derivative at a stationary
// point; elsewhere their antisymmetric part is not, and is dropped.
void ConvergedOptimum::SecondDerivative(const VectorXd& lambda, MatrixXd& second) {
  const SceneTables& tables = work_.problem().tables;
  const int n = tables.n, planes = constraints_.plane_unknowns();
  second.setZero(n + planes, n + planes);
  VectorXd dq = VectorXd::Zero(n), q, r, by_q, by_plane;
  MatrixXd J;
  for (const JointEntry& joint : tables.joints) {
    for (int k = 0; k < joint.ndof; ++k) {
      const int col = joint.col + k;
      const double h = DifferenceStep(all_, joint, k);
      for (const double side : {1.0, -1.0}) {
        dq[col] = side * h;
        Integrate(tables, q_, dq, q);
        dq[col] = 0.0;
        const double weight = side / (2.0 * h);
        work_.norm.Linearize(q, r, J);
        Forces(q, lambda, by_q, by_plane);
        second.col(col).head(n).noalias() += weight * (J.transpose() * r);
        for (int dof = 0; dof < all_.n; ++dof) {
          if (tables.column_of_dof[dof] >= 0)
            second(tables.column_of_dof[dof], col) -= weight * by_q[dof];
        }
        second.col(col).tail(planes) -= weight * by_plane;
      }
    }
  }
  second.topRightCorner(n, planes) = second.bottomLeftCorner(planes, n).transpose();
  second.topLeftCorner(n, n) =
      (0.5 * (second.topLeftCorner(n, n) + second.topLeftCorner(n, n).transpose())).eval();
  constraints_.Evaluate(q_, &lambda);
  MatrixXd by_planes = MatrixXd::Zero(planes, planes);
  constraints_.AddPlaneCurvature(lambda, by_planes);
  second.bottomRightCorner(planes, planes) += by_planes;
}

// The largest turn or move of a held plane in the last step [rad or m].
double ConvergedOptimum::HeldTurn() {
  constraints_.MarkHeld(lambda_);
  double turn = 0.0;
  for (const PartingPlane& plane : constraints_.planes()) {
    if (plane.col < 0 || !plane.held) continue;
    const Eigen::Index at = work_.problem().tables.n + plane.col;
    turn = std::max(turn, step_.segment<3>(at).lpNorm<Eigen::Infinity>());
  }
  return turn;
}

// What the planes' unknowns cost beside what the rows' curvature holds of them.
VectorXd ConvergedOptimum::PlaneCost() const {
  VectorXd cost(constraints_.plane_unknowns());
  const double turn = all_.size * all_.size;
  for (const PartingPlane& plane : constraints_.planes()) {
    if (plane.col < 0) continue;
    const double share = known_.empty() && plane.AtRoundGeom() ? kFirstPlaneShare : kPlaneShare;
    cost.segment<3>(plane.col) << share * turn, share * turn, share;
  }
  return cost;
}

// λ of the last step, by the keys of the rows.
void ConvergedOptimum::RecallForces() {
  lambda_.setZero(constraints_.size());
  for (int k = 0; k < constraints_.size(); ++k) {
    const auto it = known_.find(constraints_.rows()[k].key);
    if (it != known_.end()) lambda_[k] = it->second;
  }
}

// The exact H in whitening_; false where it is not positive definite on the active rows.
bool ConvergedOptimum::FactorExact(const VectorXd& plane_cost) {
  MatrixXd exact;
  SecondDerivative(lambda_, exact);
  constraints_.Evaluate(q_);
  for (const double weight : kAugmented) {
    H_ = exact;
    for (int k = 0; k < constraints_.size(); ++k) {
      if (lambda_[k] == 0.0) continue;
      const Eigen::RowVectorXd row = RowByUnknowns(k);
      H_.noalias() += weight * row.transpose() * row;
    }
    H_.diagonal().tail(plane_cost.size()) += plane_cost;
    whitening_.compute(H_);
    if (whitening_.info() == Eigen::Success) return true;
  }
  return false;
}

// The H of the norm, and of round geoms that hold planes, in whitening_.
void ConvergedOptimum::FactorNorm(const VectorXd& plane_cost) {
  const Eigen::Index n = J_.cols(), planes = plane_cost.size();
  constraints_.Evaluate(q_);
  MatrixXd of_norm, of_planes = MatrixXd::Zero(planes, planes);
  work_.norm.InnerProduct(J_, of_norm);
  H_.setZero(n + planes, n + planes);
  for (const ColumnRange& block : work_.norm.blocks()) {
    H_.block(block.begin, block.begin, block.size, block.size) =
        of_norm.block(block.begin, block.begin, block.size, block.size);
  }
  constraints_.AddPlaneCurvature(lambda_, of_planes);
  H_.bottomRightCorner(planes, planes) = of_planes;
  H_.diagonal().tail(planes) += kWithoutCurvature * plane_cost;
  whitening_.compute(H_);
}

// step_ and lambda_ of the problem linearized at q_, where an equality is two rows.
void ConvergedOptimum::SolveRows() {
  std::vector<int> row_of;
  std::vector<double> sign;
  for (int k = 0; k < constraints_.size(); ++k) {
    row_of.push_back(k);
    sign.push_back(1.0);
    if (constraints_.rows()[k].kind != Kind::kEquality) continue;
    row_of.push_back(k);
    sign.push_back(-1.0);
  }
  const int m = static_cast<int>(row_of.size());
  G_.resize(unknowns(), m);
  VectorXd b(m), lambda(m);
  for (int k = 0; k < m; ++k) {
    G_.col(k) = sign[k] * RowByUnknowns(row_of[k]).transpose();
    b[k] = -sign[k] * constraints_.values().gap[row_of[k]];
  }
  whitening_.matrixL().solveInPlace(G_);
  y_.setZero(unknowns());
  y_.head(J_.cols()) = J_.transpose() * r_;
  whitening_.matrixL().solveInPlace(y_);
  b.noalias() += G_.transpose() * y_;
  const VectorXd bounds = VectorXd::Constant(m, kMostForce * all_.size);
  LcpOptions options{.max_steps = 20 * (unknowns() + m), .tolerance = kLcpTolerance * all_.size};
  lcp_.Reserve(unknowns(), m);
  lcp_.Solve(G_, b, bounds, options, lambda);
  step_ = G_ * lambda - y_;
  whitening_.matrixU().solveInPlace(step_);
  lambda_.setZero(constraints_.size());
  const double least = kNoForce * (m > 0 ? lambda.maxCoeff() : 0.0);
  for (int k = 0; k < m; ++k) {
    if (lambda[k] > least) lambda_[row_of[k]] += sign[k] * lambda[k];
  }
}

// The largest turn of a joint or plane in step_ [rad].
double ConvergedOptimum::LargestTurn() const {
  const SceneTables& tables = work_.problem().tables;
  double turn = 0.0;
  for (int k = 0; k < constraints_.plane_unknowns(); ++k) {
    if (k % 3 < 2) turn = std::max(turn, std::abs(step_[tables.n + k]));
  }
  for (const JointEntry& joint : tables.joints) {
    for (int k = 0; k < joint.ndof; ++k) {
      if (!joint.Slides(k)) turn = std::max(turn, std::abs(step_[joint.col + k]));
    }
  }
  return turn;
}

// One step of sequential quadratic programming, with the exact H where λ is known and it is
// positive definite on the active rows; returns its length [√σ, m].
double ConvergedOptimum::Step() {
  const SceneTables& tables = work_.problem().tables;
  constraints_.ChooseRows(q_);
  work_.norm.Linearize(q_, r_, J_);
  const VectorXd plane_cost = PlaneCost();
  RecallForces();
  if (known_.empty() || !FactorExact(plane_cost)) FactorNorm(plane_cost);
  SolveRows();
  known_.clear();
  for (int k = 0; k < constraints_.size(); ++k) {
    if (lambda_[k] != 0.0) known_[constraints_.rows()[k].key] = lambda_[k];
  }
  const double length = (J_ * step_.head(tables.n)).norm();
  const double longest = kLongest * (r_.norm() + 0.01 * tables.size);
  const double cut = std::min({1.0, longest / length, kLargestTurn / LargestTurn()});
  step_ *= cut;
  Integrate(tables, q_, step_.head(tables.n), q_);
  if (plane_cost.size() > 0) constraints_.MovePlanes(step_.tail(plane_cost.size()));
  return cut * length;
}

}  // namespace mjcf_pdg
