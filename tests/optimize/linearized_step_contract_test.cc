// What a linearized step promises, each by its definition: its rows, the optimum by the conditions
// of Karush, Kuhn and Tucker, and what it says of where the step leads.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/tuning.h"
#include "tests/equality/equality_models.h"
#include "tests/optimize/stepper.h"
#include "tests/support/mesh_shapes.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

namespace tune = tuning::step;

class LinearizedStepTest : public MujocoTest {
 protected:
  Random rng_{11};
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
