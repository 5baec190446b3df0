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
// The longest step [√σ + size], and the largest turn of a joint or plane in a step [rad].
constexpr double kLongest = 0.3, kLargestTurn = 0.2;
// What holds a plane where no row does: its turns and moves cost this share of those of all mass
// at the scene's size [1]. It does not move the optimum, where planes stand still. In the first
// step, which finds the forces, those at round geoms do so: how strongly such a geom holds a plane
// depends on the force.
constexpr double kPlaneShare = 1e-6, kFirstPlaneShare = 1e6;
// Weights of the squared active rows that make H positive definite without changing the step on
// them [1].
constexpr double kAugmented[] = {10.0, 1e3};
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
    const double turn = constraints_.plane_unknowns()
                            ? step_.tail(constraints_.plane_unknowns()).lpNorm<Eigen::Infinity>()
                            : 0.0;
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

// H of the step in whitening_: the exact one where λ is known and it is positive definite on the
// active rows; else that of the norm alone.
bool ConvergedOptimum::FactorHessian() {
  const int n = work_.problem().tables.n, planes = constraints_.plane_unknowns();
  VectorXd plane_cost(planes);
  for (const PartingPlane& plane : constraints_.planes()) {
    if (plane.col < 0) continue;
    const double share = known_.empty() && plane.AtRoundGeom() ? kFirstPlaneShare : kPlaneShare;
    plane_cost.segment<3>(plane.col) << share * all_.size * all_.size * Eigen::Vector2d::Ones(),
        share;
  }
  lambda_.setZero(constraints_.size());
  for (int k = 0; k < constraints_.size(); ++k) {
    const auto it = known_.find(constraints_.rows()[k].key);
    if (it != known_.end()) lambda_[k] = it->second;
  }
  if (!known_.empty()) {
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
      H_.diagonal().tail(planes) += plane_cost;
      whitening_.compute(H_);
      if (whitening_.info() == Eigen::Success) return true;
    }
  }
  constraints_.Evaluate(q_);
  MatrixXd of_norm;
  work_.norm.InnerProduct(J_, of_norm);
  H_.setZero(n + planes, n + planes);
  for (const ColumnRange& block : work_.norm.blocks()) {
    H_.block(block.begin, block.begin, block.size, block.size) =
        of_norm.block(block.begin, block.begin, block.size, block.size);
  }
  MatrixXd of_planes = MatrixXd::Zero(planes, planes);
  constraints_.AddPlaneCurvature(lambda_, of_planes);
  H_.bottomRightCorner(planes, planes) = of_planes;
  H_.diagonal().tail(planes) += plane_cost;
  whitening_.compute(H_);
  return false;
}

// One step of sequential quadratic programming; returns its length [√σ, m].
double ConvergedOptimum::Step() {
  const Problem& problem = work_.problem();
  const int n = problem.tables.n, planes = constraints_.plane_unknowns();
  constraints_.ChooseRows(q_);
  work_.norm.Linearize(q_, r_, J_);
  FactorHessian();
  const int rows = constraints_.size();
  // Equalities are two rows each.
  std::vector<int> row_of;
  std::vector<double> sign;
  for (int k = 0; k < rows; ++k) {
    row_of.push_back(k);
    sign.push_back(1.0);
    if (constraints_.rows()[k].kind != Kind::kEquality) continue;
    row_of.push_back(k);
    sign.push_back(-1.0);
  }
  const int m = static_cast<int>(row_of.size());
  G_.resize(n + planes, m);
  VectorXd b(m), lambda(m);
  for (int k = 0; k < m; ++k) {
    G_.col(k) = sign[k] * RowByUnknowns(row_of[k]).transpose();
    b[k] = -sign[k] * constraints_.values().gap[row_of[k]];
  }
  whitening_.matrixL().solveInPlace(G_);
  y_.setZero(n + planes);
  y_.head(n) = J_.transpose() * r_;
  whitening_.matrixL().solveInPlace(y_);
  b.noalias() += G_.transpose() * y_;
  const VectorXd bounds = VectorXd::Constant(m, kMostForce * problem.size);
  lcp_.Reserve(n + planes, m);
  lcp_.Solve(G_, b, bounds,
             {.max_steps = 20 * (n + planes + m), .tolerance = kLcpTolerance * problem.size},
             lambda);
  step_ = G_ * lambda - y_;
  whitening_.matrixU().solveInPlace(step_);
  lambda_.setZero(rows);
  const double least = kNoForce * (m > 0 ? lambda.maxCoeff() : 0.0);
  for (int k = 0; k < m; ++k) {
    if (lambda[k] > least) lambda_[row_of[k]] += sign[k] * lambda[k];
  }
  known_.clear();
  for (int k = 0; k < rows; ++k) {
    if (lambda_[k] != 0.0) known_[constraints_.rows()[k].key] = lambda_[k];
  }
  const double length = (J_ * step_.head(n)).norm();
  double turn = 0.0;
  for (int k = 0; k < planes; ++k) {
    if (k % 3 < 2) turn = std::max(turn, std::abs(step_[n + k]));
  }
  for (const JointEntry& joint : problem.tables.joints) {
    for (int k = 0; k < joint.ndof; ++k) {
      if (!joint.Slides(k)) turn = std::max(turn, std::abs(step_[joint.col + k]));
    }
  }
  const double longest = kLongest * (r_.norm() + 0.01 * problem.size);
  const double cut = std::min({1.0, longest / length, kLargestTurn / turn});
  step_ *= cut;
  Integrate(problem.tables, q_, step_.head(n), q_);
  if (planes) constraints_.MovePlanes(step_.tail(planes));
  return cut * length;
}

}  // namespace mjcf_pdg
