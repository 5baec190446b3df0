#include "gradient/sensitivity.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mjcf_pdg {
namespace {

// Active rows that depend on others are recognized by what is left of them [1].
constexpr double kRank = 1e-10;
// The optimum is one point if no direction along the active rows has a second derivative below this
// share of the largest one [1].
constexpr double kStiffness = 1e-10;
// A row whose slack changes by less than this per length of q_in's change belongs to a face that is
// held by other rows: it does not become active [1].
constexpr double kImplied = 1e-6;

}  // namespace

Sensitivity::Sensitivity(Workspace& work, const SceneTables& all, ConvergedOptimum& optimum)
    : work_(work), all_(all), optimum_(optimum), slides_(all.n) {
  for (const JointEntry& joint : all.joints) {
    for (int k = 0; k < joint.ndof; ++k) slides_[joint.col + k] = joint.Slides(k);
  }
}

double Sensitivity::Arm(int dof) const { return slides_[dof] ? 1.0 : all_.size; }

void Sensitivity::Sigma(const VectorXd& q) {
  const Problem& problem = work_.problem();
  sigma_.setZero(all_.n);
  mixed_.setZero(optimum_.unknowns(), all_.n);
  for (const JointEntry& joint : all_.joints) {
    for (int k = 0; k < joint.ndof; ++k) MoveInput(joint, k, q);
  }
  work_.norm.SetReference(problem.q_in, problem.mocap);
}

// The column of one entry of q_in, by central differences: σ₊ - σ₋ = (r₊ - r₋)·(r₊ + r₋) exactly,
// without the rounding of σ.
void Sensitivity::MoveInput(const JointEntry& joint, int k, const VectorXd& q) {
  const Problem& problem = work_.problem();
  const SceneTables& tables = problem.tables;
  const int dof = joint.col + k, n = tables.n;
  const bool frozen = tables.column_of_dof[dof] < 0;
  const VectorXd& lambda = optimum_.lambda();
  const double h = DifferenceStep(all_, joint, k);
  VectorXd dq = VectorXd::Zero(all_.n), q_in, at = q, r[2], by_q, by_plane;
  MatrixXd J;
  auto mixed = mixed_.col(dof);
  for (const int side : {0, 1}) {
    dq[dof] = side == 0 ? h : -h;
    const double weight = (side == 0 ? 0.5 : -0.5) / h;
    Integrate(all_, problem.q_in, dq, q_in);
    if (frozen) Integrate(all_, q, dq, at);
    work_.norm.SetReference(q_in, problem.mocap);
    work_.norm.Linearize(at, r[side], J);
    mixed.head(n).noalias() += weight * (J.transpose() * r[side]);
    if (!frozen || lambda.size() == 0) continue;
    optimum_.Forces(at, lambda, by_q, by_plane);
    for (int d = 0; d < all_.n; ++d) {
      if (tables.column_of_dof[d] >= 0) mixed[tables.column_of_dof[d]] -= weight * by_q[d];
    }
    mixed.tail(by_plane.size()) -= weight * by_plane;
  }
  sigma_[dof] = (r[0] - r[1]).dot(r[0] + r[1]) / (2.0 * h);
  if (!frozen || lambda.size() == 0) return;
  optimum_.Forces(q, lambda, by_q, by_plane);
  sigma_[dof] -= 2.0 * by_q[dof];
}

bool Sensitivity::Answer() {
  const VectorXd lambda = optimum_.lambda();
  MatrixXd second;
  optimum_.SecondDerivative(lambda, second);
  optimum_.Evaluate();
  std::vector<int> active;
  for (int k = 0; k < lambda.size(); ++k) {
    const bool equality = optimum_.constraints().rows()[k].kind == ConstraintRow::Kind::kEquality;
    if (lambda[k] != 0.0 || equality) active.push_back(k);
  }
  return Solve(active, second);
}

// In units in which turns are arcs at the scene's size, by the null space of the active rows.
bool Sensitivity::Solve(const std::vector<int>& active, const MatrixXd& second) {
  const SceneTables& tables = work_.problem().tables;
  const int unknowns = optimum_.unknowns(), m = static_cast<int>(active.size());
  VectorXd unit = VectorXd::Ones(unknowns);  // of each unknown, per metre
  for (int dof = 0; dof < all_.n; ++dof) {
    const int col = tables.column_of_dof[dof];
    if (col >= 0) unit[col] = 1.0 / Arm(dof);
  }
  for (int k = tables.n; k < unknowns; ++k) {
    if ((k - tables.n) % 3 < 2) unit[k] = 1.0 / all_.size;
  }
  MatrixXd H = unit.asDiagonal() * second * unit.asDiagonal();
  for (const PartingPlane& plane : optimum_.constraints().planes()) {
    // Nothing holds it: it stays.
    if (plane.Idle()) H.diagonal().segment<3>(tables.n + plane.col).setOnes();
  }
  const MatrixXd b = unit.asDiagonal() * mixed_;
  MatrixXd by_input = MatrixXd::Zero(m, all_.n), rows(unknowns, m);
  for (int k = 0; k < m; ++k) {
    rows.col(k) = unit.asDiagonal() * optimum_.RowByUnknowns(active[k]).transpose();
    by_input.row(k) = RowByInput(active[k]);
  }
  Eigen::ColPivHouseholderQR<MatrixXd> qr(unknowns, m);
  qr.setThreshold(kRank);
  if (m > 0) qr.compute(rows);
  const Eigen::Index rank = m > 0 ? qr.rank() : 0;
  MatrixXd Q = MatrixXd::Identity(unknowns, unknowns);
  if (m > 0) Q.applyOnTheLeft(qr.householderQ());
  const MatrixXd Y = Q.leftCols(rank), Z = Q.rightCols(unknowns - rank);
  MatrixXd dlambda = MatrixXd::Zero(m, all_.n);
  dy_.setZero(unknowns, all_.n);
  const MatrixXd R = m > 0 ? MatrixXd(qr.matrixR().topLeftCorner(rank, rank)) : MatrixXd();
  if (rank > 0) {
    const MatrixXd wanted = (qr.colsPermutation().transpose() * -by_input).topRows(rank);
    dy_ = Y * R.triangularView<Eigen::Upper>().transpose().solve(wanted);
  }
  if (Z.cols() > 0) {
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(Z.transpose() * H * Z);
    const VectorXd& stiffness = eigen.eigenvalues();
    if (!(stiffness[0] > kStiffness * std::abs(stiffness.tail<1>()[0]))) return false;
    const MatrixXd force = eigen.eigenvectors().transpose() * Z.transpose() * -(b + H * dy_);
    dy_ += Z * eigen.eigenvectors() * stiffness.cwiseInverse().asDiagonal() * force;
  }
  if (rank > 0) {
    MatrixXd held = MatrixXd::Zero(m, all_.n);
    held.topRows(rank) = R.triangularView<Eigen::Upper>().solve(Y.transpose() * (b + H * dy_));
    dlambda = qr.colsPermutation() * held;
  }
  dy_ = (unit.asDiagonal() * dy_).eval();
  answer_.setIdentity(all_.n, all_.n);
  for (int dof = 0; dof < all_.n; ++dof) {
    if (tables.column_of_dof[dof] >= 0) answer_.row(dof) = dy_.row(tables.column_of_dof[dof]);
  }
  MeasureRoom(active, dlambda);
  return answer_.allFinite();
}

// How a row changes with the frozen joints of q_in; with the others only by what y does.
Eigen::RowVectorXd Sensitivity::RowByInput(int row) const {
  Eigen::RowVectorXd by = optimum_.constraints().values().C.row(row);
  for (int dof = 0; dof < all_.n; ++dof) {
    if (work_.problem().tables.column_of_dof[dof] >= 0) by[dof] = 0.0;
  }
  return by;
}

void Sensitivity::MeasureRoom(const std::vector<int>& active, const MatrixXd& dlambda) {
  const PartedConstraints& constraints = optimum_.constraints();
  room_ = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < active.size(); ++k) {
    if (constraints.rows()[active[k]].kind == ConstraintRow::Kind::kEquality) continue;
    const double rate = PerMetre(dlambda.row(static_cast<Eigen::Index>(k)));
    room_ = std::min(room_, optimum_.lambda()[active[k]] / rate);
  }
  const auto closes = [this](double slack, double rate) {
    if (rate > kImplied) room_ = std::min(room_, std::max(0.0, slack) / rate);
  };
  for (int k = 0; k < constraints.size(); ++k) {
    const ConstraintRow& row = constraints.rows()[k];
    if (optimum_.lambda()[k] != 0.0 || row.kind == ConstraintRow::Kind::kEquality) continue;
    if (row.IsPiece() && constraints.planes()[row.of].Idle()) continue;
    closes(constraints.values().gap[k], PerMetre(optimum_.RowByUnknowns(k) * dy_ + RowByInput(k)));
  }
  // Of pairs that do not touch, whose planes are anywhere between.
  const Problem& problem = work_.problem();
  for (const NearPair& near : optimum_.IdlePairs()) {
    Eigen::RowVectorXd row(all_.n);
    ContactRow(all_, work_.finder.posed(), near.pair, near.p1_W, near.p2_W, near.n_W, row);
    closes(near.distance - problem.required[near.pair] + problem.tolerances.aim,
           PerMetre(row * answer_));
  }
}

// The largest change of a function with these derivatives by the entries of q_in, if each moves by
// an arc or length of one metre.
double Sensitivity::PerMetre(const Eigen::RowVectorXd& by_input) const {
  double sum = 0.0;
  for (int dof = 0; dof < all_.n; ++dof) sum += std::abs(by_input[dof]) / Arm(dof);
  return sum;
}

}  // namespace mjcf_pdg
