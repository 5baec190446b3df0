// A linearized step of a scene, and what it must be by definition: its rows, the conditions of
// Karush, Kuhn and Tucker, where the step leads.
#ifndef MJCF_PDG_TESTS_OPTIMIZE_STEPPER_H_
#define MJCF_PDG_TESTS_OPTIMIZE_STEPPER_H_

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/tuning.h"
#include "optimize/linearized_step.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {

// A step of a scene, and the same linearization by definition.
struct Stepper {
  explicit Stepper(const std::string& xml, const SceneOptions& scene_options = {},
                   const Options& user_options = {})
      : scene(Scene::FromString(xml, scene_options)),
        options(user_options),
        work(scene.tables(), options),
        step(work) {
    step.Clear();
  }

  void Linearize(const VectorXd& at, double reach, const RowOptions& rows) {
    q = at;
    row_options = rows;
    work.finder.Pose(q);
    near = work.finder.Find(reach);
    std::erase_if(near, [this](const NearPair& n) { return !scene.tables().pairs[n.pair].moves; });
    step.Linearize(q, near, rows);
    ContactRowsByDefinition();
    contacts = static_cast<int>(gap.size());
    LimitRowsByDefinition();
    work.norm.Linearize(q, r, J);
  }

  void AddRow(const Eigen::RowVectorXd& row, double row_gap) {
    C.conservativeResize(C.rows() + 1, scene.dof());
    C.row(C.rows() - 1) = row;
    gap.push_back(row_gap);
  }
  // The rate of n · (p2 - p1) by the Jacobians of the two points.
  void ContactRowsByDefinition() {
    C.resize(0, scene.dof());
    gap.clear();
    const SceneTables& tables = scene.tables();
    for (const NearPair& one : near) {
      const KeptPair& pair = tables.pairs[one.pair];
      BodyJacobians on1, on2;
      const int* body = tables.model->geom_bodyid;
      on1.Fill(tables, work.finder.posed(), body[pair.geom1], one.p1_W);
      on2.Fill(tables, work.finder.posed(), body[pair.geom2], one.p2_W);
      const double safety = pair.kind == PairKind::kExact ? row_options.safety_margin : 0.0;
      AddRow(one.n_W.transpose() * (on2.point - on1.point),
             one.distance - work.problem().required[one.pair] + row_options.aim - safety);
    }
  }
  void LimitRowsByDefinition() {
    const double size = scene.tables().size;
    for (const JointEntry& joint : scene.tables().joints) {
      if (!joint.limited) continue;
      if (joint.type == mjJNT_BALL) {
        AddBallRow(joint);
        continue;
      }
      const bool slides = joint.type == mjJNT_SLIDE;
      const double reach = slides ? tuning::step::kSlideReach * size : tuning::step::kLimitReach;
      const double arm = slides ? 1.0 : size, x = q[joint.qadr];
      Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(scene.dof());
      row[joint.col] = arm;
      if (x - joint.lo < reach) AddRow(row, arm * (x - joint.lo));
      if (joint.hi - x < reach) AddRow(-row, arm * (joint.hi - x));
    }
    const TendonLimits& tendons = work.equality.tendon_limits();
    for (Eigen::Index k = 0; k < tendons.slack().size(); ++k) {
      const double scale = tendons.scale()[k];
      if (scale == 0.0 || scale * tendons.slack()[k] >= tuning::step::kLimitReach * size) continue;
      AddRow(scale * tendons.jacobian().row(k), scale * tendons.slack()[k]);
    }
  }

  // The angle grows along its axis, the shorter way round.
  void AddBallRow(const JointEntry& joint) {
    const Eigen::AngleAxisd turn(QuatAt(q, joint.qadr));
    const bool whole = turn.angle() > M_PI;
    const double angle = whole ? 2 * M_PI - turn.angle() : turn.angle();
    if (joint.hi - angle >= tuning::step::kLimitReach) return;
    Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(scene.dof());
    row.segment<3>(joint.col) = (whole ? 1.0 : -1.0) * scene.tables().size * turn.axis();
    AddRow(row, scene.tables().size * (joint.hi - angle));
  }

  MatrixXd Damping(double damping) const {
    const double size = scene.tables().size;
    VectorXd D(scene.dof());
    for (const JointEntry& joint : scene.tables().joints) {
      for (int k = 0; k < joint.ndof; ++k) {
        D[joint.col + k] = joint.Slides(k) ? damping : damping * size * size;
      }
    }
    return D.asDiagonal();
  }
  std::vector<ObservedRow> Observed() const {
    std::vector<ObservedRow> rows;
    step.AppendObserved(rows);
    return rows;
  }
  double LargestTurn() const {
    double largest = 0.0;
    for (const JointEntry& joint : scene.tables().joints) {
      for (int k = 0; k < joint.ndof; ++k) {
        if (!joint.Slides(k)) largest = std::max(largest, std::abs(step.dq()[joint.col + k]));
      }
    }
    return largest;
  }
  double SlackAfter(int row, const VectorXd& dq) const { return gap[row] + C.row(row).dot(dq); }
  // What an uncut Solve promises.
  void ExpectOptimum(const StepOptions& how, double length) {
    const VectorXd& dq = step.dq();
    const auto rows = Observed();
    ASSERT_EQ(rows.size(), gap.size());
    VectorXd gradient = J.transpose() * (r + J * dq) + Damping(how.damping) * dq;
    const double small = 1e-7 * (1.0 + gradient.norm());
    double largest = 0.0, violation = 0.0;
    for (int k = 0; k < static_cast<int>(rows.size()); ++k) {
      const double lambda = rows[k].multiplier, slack = SlackAfter(k, dq);
      const double most = k < contacts ? how.penalty : 1e6 * how.scale;
      EXPECT_NEAR(rows[k].gap, gap[k], 1e-12) << k;
      EXPECT_EQ(rows[k].geom[0] >= 0, k < contacts);
      EXPECT_GE(lambda, 0.0);
      EXPECT_LE(lambda, most);
      EXPECT_TRUE(lambda == most || slack >= -3e-8) << slack << " of row " << k;
      EXPECT_TRUE(lambda == 0.0 || slack <= 3e-8) << slack << " of row " << k;
      active += lambda > 0.0 && lambda < most;
      broken += lambda == most;
      limits += k >= contacts && lambda > 0.0;
      gradient -= lambda * C.row(k).transpose();
      if (k >= contacts) continue;
      largest = std::max(largest, lambda);
      violation += std::max(0.0, -slack);
    }
    const MatrixXd& E = work.equality.jacobian();
    if (work.equality.any() && E.rows() > 0) {
      // Off the constraints, those that depend on each other may have no common solution.
      const VectorXd& e = work.equality.residual();
      const VectorXd nearest = E.completeOrthogonalDecomposition().solve(-e);
      const bool solvable = (E * nearest + e).norm() < 1e-10;
      EXPECT_TRUE(!solvable || (E * dq + e).norm() < 1e-9);
      gradient -= E.transpose() * E.transpose().completeOrthogonalDecomposition().solve(gradient);
      held += solvable && e.norm() > 1e-4;
    }
    EXPECT_LT(gradient.norm(), std::max(small, 1e-9 * how.penalty));
    EXPECT_EQ(step.LargestForce(), largest);
    EXPECT_NEAR(step.violation(), violation, 1e-10);
    EXPECT_NEAR(step.sigma(), (r + J * dq).squaredNorm(), 1e-12);
    EXPECT_EQ(step.sigma(), step.uncut_sigma());
    EXPECT_NEAR(length, (J * dq).norm(), 1e-12);
    const double damped = dq.dot(Damping(how.damping) * dq);
    EXPECT_NEAR(step.DampingShare() * (J * dq).squaredNorm(), damped, 1e-9 * (1.0 + damped));
  }

  // The same linearization solved with a shorter trust radius: the same way, not so far.
  void ExpectCut(StepOptions how, double length) {
    const VectorXd whole = step.dq();
    const double uncut = step.sigma(), share = how.damping > 0.0 ? step.DampingShare() : 0.0;
    how.trust_radius = 0.4 * length;
    EXPECT_NEAR(step.Solve(how), 0.4 * length, 1e-9 * length);
    EXPECT_LT((step.dq() - 0.4 * whole).norm(), 1e-6 * (1.0 + whole.norm()));
    EXPECT_NEAR(step.uncut_sigma(), uncut, 1e-9 * (1.0 + uncut));
    EXPECT_NEAR(step.sigma(), (r + J * step.dq()).squaredNorm(), 1e-12);
    EXPECT_NEAR(step.DampingShare(), share, 1e-6 * (1.0 + share));
    double violation = 0.0;
    for (int k = 0; k < contacts; ++k) violation += std::max(0.0, -SlackAfter(k, step.dq()));
    EXPECT_NEAR(step.violation(), violation, 1e-10);
    EXPECT_NEAR(step.SquaredLength(whole), length * length, 1e-9 * (1.0 + length * length));
  }

  Scene scene;
  Options options;
  Workspace work;
  LinearizedStep step;
  VectorXd q;
  RowOptions row_options;
  std::vector<NearPair> near;
  MatrixXd C, J;
  std::vector<double> gap;
  VectorXd r;
  int contacts = 0;
  int active = 0, broken = 0, limits = 0, held = 0;  // rows seen, over all solves
};

}  // namespace mjcf_pdg::test

#endif  // MJCF_PDG_TESTS_OPTIMIZE_STEPPER_H_
