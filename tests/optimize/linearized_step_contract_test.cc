// What a linearized step promises, each by its definition: its rows, the optimum by the conditions
// of Karush, Kuhn and Tucker, and what it says of where the step leads.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/tuning.h"
#include "optimize/linearized_step.h"
#include "tests/equality/equality_models.h"
#include "tests/support/mesh_shapes.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

namespace tune = tuning::step;

class LinearizedStepTest : public MujocoTest {
 protected:
  Random rng_{11};
};

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
      const double reach = slides ? tune::kSlideReach * size : tune::kLimitReach;
      const double arm = slides ? 1.0 : size, x = q[joint.qadr];
      Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(scene.dof());
      row[joint.col] = arm;
      if (x - joint.lo < reach) AddRow(row, arm * (x - joint.lo));
      if (joint.hi - x < reach) AddRow(-row, arm * (joint.hi - x));
    }
    const TendonLimits& tendons = work.equality.tendon_limits();
    for (Eigen::Index k = 0; k < tendons.slack().size(); ++k) {
      const double scale = tendons.scale()[k];
      if (scale == 0.0 || scale * tendons.slack()[k] >= tune::kLimitReach * size) continue;
      AddRow(scale * tendons.jacobian().row(k), scale * tendons.slack()[k]);
    }
  }

  // The angle grows along its axis, the shorter way round.
  void AddBallRow(const JointEntry& joint) {
    const Eigen::AngleAxisd turn(QuatAt(q, joint.qadr));
    const bool whole = turn.angle() > M_PI;
    const double angle = whole ? 2 * M_PI - turn.angle() : turn.angle();
    if (joint.hi - angle >= tune::kLimitReach) return;
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

// Solves at random configurations near random references.
void SolveAtRandom(Stepper& p, int trials, double reach, Random& rng) {
  int cuts = 0;
  for (int k = 0; k < trials; ++k) {
    VectorXd q_in = RandomConfiguration(p.scene, rng, 0.2), q;
    p.work.Begin(q_in);
    p.work.equality.Project(q_in);
    Integrate(p.scene.tables(), q_in, 0.05 * rng.Normals(p.scene.dof()), q);
    p.work.Begin(q_in);
    p.step.Clear();
    p.Linearize(q, reach, {.margin = reach, .aim = 1e-4, .safety_margin = 3e-3});
    const StepOptions how = {.scale = rng.Uniform(0.5, 2.0),
                             .penalty = rng.Chance(0.5) ? 0.05 : 100.0,
                             .damping = rng.Chance(0.5) ? 0.0 : 0.3,
                             .trust_radius = 100.0};
    const std::int64_t before = p.step.lcp_steps();
    const double length = p.step.Solve(how);
    const auto rows = static_cast<std::int64_t>(p.gap.size());
    EXPECT_LE(p.step.lcp_steps() - before, 10 * (rows + p.scene.dof()));
    if (p.LargestTurn() >= 1.0 - 1e-12) {
      EXPECT_NEAR(p.LargestTurn(), tune::kLargestTurn, 1e-12);
      EXPECT_NEAR(length, (p.J * p.step.dq()).norm(), 1e-12);
      continue;
    }
    const int active = p.active + p.broken;
    p.ExpectOptimum(how, length);
    EXPECT_GE(p.step.lcp_steps() - before, p.active + p.broken - active) << "a pivot each";
    if (length < 1e-6) continue;
    ++cuts;
    p.ExpectCut(how, length);
  }
  EXPECT_GT(cuts, trials / 3);
}

TEST_F(LinearizedStepTest, StepsOfRobotsAreOptimaOfTheirRows) {
  int active = 0, broken = 0, limits = 0;
  for (int k = 0; k < 8; ++k) {
    Options options;
    options.clearance = k % 2 ? 0.01 : 0.0;
    options.without = {"witness_memory"};
    Stepper p(RandomRobotXml(rng_, {.bodies = 6, .free_base = k % 3 == 0}), {}, options);
    SolveAtRandom(p, 40, 0.1, rng_);
    active += p.active, broken += p.broken, limits += p.limits;
  }
  EXPECT_TRUE(active > 100 && broken > 15 && limits > 10) << active << " " << broken;
}

TEST_F(LinearizedStepTest, StepsHoldEqualitiesAndTendonLimits) {
  SceneOptions holding;
  holding.hold_tendon_limits = true;
  int held = 0, active = 0;
  for (const char* xml : {kParallelJaw, kTwoArms, kCoupledFingers}) {
    Stepper p(xml, holding);
    SolveAtRandom(p, 60, 0.1, rng_);
    held += p.held, active += p.active;
  }
  EXPECT_GT(held, 50);
  EXPECT_GT(active, 20);
  Stepper string(R"(<mujoco><worldbody><site name="post" pos=".1 .2 0"/>
      <geom size=".2" pos=".7 .3 0"/><geom size=".1" pos="-.6 .2 0"/>
      <body pos=".1 0 .01"><joint type="slide" axis="1 0 0"/><joint axis="0 0 1" pos="0 .1 0"/>
        <joint type="slide" axis="0 1 0" range="-.3 .9"/><geom type="box" size=".1 .05 .1"/>
        <site name="end" pos=".1 .02 0"/></body></worldbody>
      <tendon><spatial limited="true" range=".1 .5"><site site="post"/><site site="end"/></spatial>
      </tendon></mujoco>)",
                 holding);
  SolveAtRandom(string, 120, 0.2, rng_);
  EXPECT_GT(string.limits, 8);
  // A string too short for its slide: neither limit gives way, as hard as they may pull.
  Stepper torn(R"(<mujoco><worldbody><site name="post"/><geom size=".1" pos="9 9 9"/>
      <body><joint type="slide" axis="1 0 0" range=".2 .9"/><geom size=".1"/><site name="end"/>
      </body></worldbody><tendon><spatial limited="true" range="0 .1"><site site="post"/>
      <site site="end"/></spatial></tendon></mujoco>)",
               holding);
  torn.work.Begin(VectorXd::Constant(1, 0.15));
  torn.Linearize(torn.work.problem().q_in, 0.1, {.margin = 0.1});
  const StepOptions twice = {.scale = 2.0, .penalty = 10.0, .trust_radius = 10.0};
  const double length = torn.step.Solve(twice);
  torn.ExpectOptimum(twice, length);
  EXPECT_EQ(torn.broken, 2);
}

TEST_F(LinearizedStepTest, WithoutDampingAStepIsThatOfTheNormAlone) {
  Options options;
  options.without = {"damping"};
  Stepper p(RandomRobotXml(rng_, {.bodies = 4}), {}, options);
  p.work.Begin(RandomConfiguration(p.scene, rng_));
  p.Linearize(RandomConfiguration(p.scene, rng_), 0.1, {.margin = 0.1});
  p.step.Solve({.penalty = 10.0, .damping = 5.0, .trust_radius = 10.0});
  const VectorXd dq = p.step.dq();
  EXPECT_EQ(p.step.DampingShare(), 0.0);
  p.step.Solve({.penalty = 10.0, .damping = 0.0, .trust_radius = 10.0});
  EXPECT_EQ(p.step.dq(), dq);
}

// Three boxes tilted into a floor, far from each other and of the same mass: each makes the step
// that it makes alone. A row concerns one of them, and a step of several trees looks at no more.
TEST_F(LinearizedStepTest, TreesThatDoNotMeetStepAsTheyDoAlone) {
  const std::string floor = "<mujoco><worldbody><geom type='plane' size='9 9 1'/>";
  const std::string box = "<body><freejoint/><geom type='box' size='.1 .07 .05'/></body>";
  Stepper all(floor + box + box + box + "</worldbody></mujoco>");
  VectorXd q(21), at(21);
  for (int k = 0; k < 3; ++k) {
    const Eigen::Quaterniond turn = rng_.UnitQuat();
    q.segment<7>(7 * k) << 2.0 * k, 0, 0.02, turn.w(), turn.x(), turn.y(), turn.z();
    at.segment<7>(7 * k) = q.segment<7>(7 * k);
    at[7 * k + 2] += 0.01 * (k + 1);
  }
  all.work.Begin(q);
  all.Linearize(at, 0.1, {.margin = 0.1});
  all.step.Solve({.penalty = 10.0, .trust_radius = 10.0});
  const VectorXd dq = all.step.dq();
  const double violation = all.step.violation();
  EXPECT_LT(violation, 1e-9);
  double longest = 0.0;
  for (int k = 0; k < 3; ++k) {
    Stepper alone(floor + box + "</worldbody></mujoco>");
    alone.work.Begin(q.segment<7>(7 * k));
    alone.Linearize(at.segment<7>(7 * k), 0.1, {.margin = 0.1});
    const double length = alone.step.Solve({.penalty = 10.0, .trust_radius = 10.0});
    EXPECT_GT(length, 1e-3);
    EXPECT_LT((dq.segment<6>(6 * k) - alone.step.dq()).norm(), 1e-6 * length);
    EXPECT_NEAR(alone.step.LargestLength(), length, 1e-12);
    longest = std::max(longest, length);
  }
  EXPECT_NEAR(all.step.LargestLength(), longest, 1e-6 * longest);
}

// A chain of 60 links in random poses, with a ball that it meets: rows are packed, and each step's
// LCP begins with the forces of the one before.
TEST_F(LinearizedStepTest, StepsOfALongChainAreOptimaOneAfterTheOther) {
  std::string xml = "<mujoco><compiler angle='degree'/><worldbody>", end;
  for (int k = 0; k < 60; ++k) {
    xml += std::string("<body pos='0 0 .1'><joint range='-120 120' axis='") +
           (k % 2 == 0 ? "1 0 0" : "0 1 0") +
           "'/><geom type='capsule' size='.02' fromto='0 0 0 0 0 .1'/>";
    end += "</body>";
  }
  xml += end + "<body><freejoint/><geom type='sphere' size='.2'/></body></worldbody></mujoco>";
  Options options;
  options.without = {"witness_memory"};  // which would add rows
  Stepper p(xml, {}, options);
  for (int trial = 0; trial < 30; ++trial) {
    const VectorXd q_in = RandomConfiguration(p.scene, rng_);
    VectorXd q, next;
    Integrate(p.scene.tables(), q_in, 0.2 * rng_.Normals(p.scene.dof()), q);
    ClampToLimits(p.scene.tables(), q);
    p.work.Begin(q_in);
    p.step.Clear();
    for (int k = 0; k < 6; ++k) {
      p.Linearize(q, 0.01, {.margin = 0.01});
      const StepOptions how = {.penalty = 10.0, .trust_radius = 1e3};
      const double length = p.step.Solve(how);
      if (p.LargestTurn() < 1.0 - 1e-12) p.ExpectOptimum(how, length);
      Integrate(p.scene.tables(), q, 0.5 * p.step.dq(), next);
      std::swap(q, next);
    }
  }
  EXPECT_GT(p.active, 300);
  EXPECT_GT(p.limits, 5);
}

// Fourteen boxes in one another and in a floor: 105 pairs, 84 degrees of freedom.
TEST_F(LinearizedStepTest, AsManyPairsGetRowsAsThereAreDegreesOfFreedom) {
  std::string xml = "<geom type='plane' size='9 9 1'/>";
  for (int k = 0; k < 14; ++k) {
    xml += "<body pos='" + Join(rng_.InBox(0.01)) +
           "'><freejoint/><geom type='box' size='.1 .1 .1'/></body>";
  }
  Stepper p("<mujoco><worldbody>" + xml + "</worldbody></mujoco>");
  p.work.Begin(ToEigen(p.scene.DefaultQpos()));
  p.Linearize(p.work.problem().q_in, 0.1, {.margin = 0.1});
  ASSERT_EQ(p.gap.size(), 105u);
  p.step.Solve({.penalty = 10.0, .trust_radius = 1.0});
  EXPECT_EQ(p.Observed().size(), 84u);
}

// Spheres of different heights and allowed overlaps above a plate that tilts.
TEST_F(LinearizedStepTest, OfMorePairsThanRowsTheLeastSlacksGetRows) {
  std::string xml = "<geom size='.1' pos='9 9 9'/>";
  for (int k = 0; k < 90; ++k) {
    const double margin = -rng_.Uniform(0.0, 0.05);
    const Vector3d p_W(rng_.Uniform(-1, 1), rng_.Uniform(-1, 1), rng_.Uniform(0.15, 0.25));
    xml += "<geom size='.05' margin='" + Join(&margin, 1) + "' pos='" + Join(p_W) + "'/>";
  }
  xml += "<body pos='0 0 .05'><freejoint/><geom type='box' size='1.1 1.1 .05'/></body>";
  Stepper p("<mujoco><worldbody>" + xml + "</worldbody></mujoco>");
  p.work.Begin(ToEigen(p.scene.DefaultQpos()));
  p.Linearize(p.work.problem().q_in, 0.5, {.margin = 0.5, .aim = 0.001});
  p.step.Solve({.penalty = 10.0, .trust_radius = 1.0});
  const std::vector<ObservedRow> rows = p.Observed();
  ASSERT_EQ(rows.size(), static_cast<std::size_t>(tune::kContacts));
  std::vector<double> least = p.gap, kept;  // of all 90, of those with rows
  for (const ObservedRow& row : rows) kept.push_back(row.gap);
  std::sort(least.begin(), least.end());
  std::sort(kept.begin(), kept.end());
  for (std::size_t k = 0; k < kept.size(); ++k) EXPECT_NEAR(kept[k], least[k], 1e-12);
}

// A ring about a post with a sphere beside it: of the pairs those of triangles keep the margin.
TEST_F(LinearizedStepTest, RowsOfExactMeshesKeepTheSafetyMarginAndOthersDoNot) {
  const MeshShape ring = Revolution({{0.04, -0.01}, {0.06, -0.01}, {0.06, 0.01}, {0.04, 0.01}}, 24);
  Stepper p("<mujoco><asset>" + MeshXml("ring", ring) +
                "</asset><worldbody><geom type='cylinder' size='.02 .1'/>"
                "<geom size='.03' pos='-.12 0 .01'/><body><freejoint/>"
                "<geom size='.01' pos='-.07 0 0'/><geom type='mesh' mesh='ring'/></body>"
                "</worldbody></mujoco>",
            Exact());
  VectorXd q = ToEigen(p.scene.DefaultQpos());
  q[0] = 0.012;
  p.work.Begin(q);
  p.Linearize(q, 0.04, {.margin = 0.04, .aim = 1e-4, .safety_margin = 2e-3});
  const double length = p.step.Solve({.penalty = 10.0, .damping = 0.1, .trust_radius = 10.0});
  p.ExpectOptimum({.penalty = 10.0, .damping = 0.1}, length);
  const auto exact = std::count_if(p.near.begin(), p.near.end(), [](const NearPair& near) {
    return near.kind == PairKind::kExact;
  });
  EXPECT_TRUE(exact > 0 && exact < p.contacts);
}

// A box rocks on a plane beside a wall, so that its lowest corner is now this one and now that.
TEST_F(LinearizedStepTest, WitnessPointsOfEarlierStepsAddRowsWithinTheMargin) {
  Options options;
  options.clearance = 0.02;
  Stepper p(
      "<mujoco><worldbody><geom size='.1' pos='9 9 9'/><geom type='plane' size='0 0 1'/>"
      "<body pos='.3 .2 .1'><freejoint/><geom size='.01' pos='0 0 .5'/>"
      "<geom type='box' pos='0 0 .05' size='.2 .1 .1'/></body></worldbody></mujoco>",
      {}, options);
  VectorXd q = ToEigen(p.scene.DefaultQpos()), moved;
  p.work.Begin(q);
  struct Seen {
    Vector3d p1_W, p2_B;
  };
  std::vector<Seen> seen;
  int extra = 0, far = 0;
  for (int k = 0; k < 80; ++k) {
    if (k % 2) {  // about as far as points may be that count as the same
      moved.head(2).array() += std::pow(10.0, rng_.Uniform(-5.0, -2.5));
    } else {
      VectorXd dq = VectorXd::Zero(6);
      dq.tail(3) = 0.15 * rng_.UnitVector();
      Integrate(p.scene.tables(), q, dq, moved);
      moved[2] += rng_.Uniform(-0.01, 0.03);
    }
    if (k % 4 == 0) {
      p.step.Clear();
      seen.clear();
    }
    const double margin = rng_.Uniform(0.005, 0.05);
    p.Linearize(moved, 0.2, {.margin = margin, .aim = 1e-4});
    p.step.Solve({.penalty = 10.0, .trust_radius = 10.0});
    ASSERT_EQ(p.near.size(), 1u);
    const NearPair& near = p.near[0];
    const Matrix3d R = QuatAt(moved, 3).toRotationMatrix();
    std::vector<double> expected = {p.gap[0]};
    bool known = false;
    for (const Seen& one : seen) {
      const Vector3d p2_W = moved.head<3>() + R * one.p2_B;
      const double distance = near.n_W.dot(p2_W - one.p1_W);
      const double merge = tune::kSamePoint * p.scene.tables().size;
      const bool same = (p2_W - near.p2_W).norm() < merge && (one.p1_W - near.p1_W).norm() < merge;
      known |= same;
      far += !same && distance > margin + options.clearance;
      if (same || distance > margin + options.clearance) continue;
      expected.push_back(distance - options.clearance + 1e-4);
    }
    if (!known) seen.push_back({near.p1_W, R.transpose() * (near.p2_W - moved.head<3>())});
    const std::vector<ObservedRow> rows = p.Observed();
    ASSERT_EQ(rows.size(), expected.size()) << k;
    for (std::size_t i = 0; i < rows.size(); ++i) EXPECT_NEAR(rows[i].gap, expected[i], 1e-12);
    extra += static_cast<int>(rows.size()) - 1;
  }
  EXPECT_TRUE(extra > 15 && far > 3) << extra << " " << far;
}

}  // namespace
}  // namespace mjcf_pdg::test
