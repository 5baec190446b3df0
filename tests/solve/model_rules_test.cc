// What of a model counts: the contacts and limits that its flags disable, the margins within which
// MuJoCo pushes, and its flexes.
#include <gmock/gmock.h>
#include <mujoco/mujoco.h>

#include "mjcf_pdg/motion.h"
#include "mjcf_pdg/pdg.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Q = std::vector<double>;

// A ball on a slide, over a floor, that may go no higher than its limit.
std::string Ball(const std::string& flag, const std::string& geom = "") {
  return "<mujoco><option>" + flag + R"(</option><worldbody>
    <geom name="floor" type="plane" size="1 1 1"/>
    <body name="ball"><joint type="slide" axis="0 0 1" range="0 1" limited="true"/>
      <geom name="ball" size=".1" )" +
         geom + "/></body></worldbody></mujoco>";
}

class ModelRules : public MujocoTest {};

TEST_F(ModelRules, DisabledContactsCountUnlessTheModelIsHonoured) {
  for (const char* flag : {"<flag contact='disable'/>", "<flag constraint='disable'/>"}) {
    const Scene counts = Scene::FromString(Ball(flag));
    EXPECT_THAT(counts.Warnings(), ElementsAre(HasSubstr("count all the same")));
    EXPECT_FALSE(Verify(counts, Q{0.05}).free);
    const Result result = Solver(counts).Solve(Q{0.05});
    ASSERT_EQ(result.status, Status::kSolved);
    EXPECT_NEAR(result.q[0], 0.1, 1e-5);

    const Scene honours = Scene::FromString(Ball(flag), {.model_flags = true});
    EXPECT_THAT(honours.Warnings(), ElementsAre(HasSubstr("do not count")));
    EXPECT_EQ(honours.num_kept_pairs(), 0);
    EXPECT_TRUE(Verify(honours, Q{0.05}).free);
    EXPECT_TRUE(Solver(honours).IsFree(Q{0.05}));
    EXPECT_EQ(Solver(honours).Solve(Q{0.05}).status, Status::kAlreadyFree);
  }
  EXPECT_THAT(Scene::FromString(Ball("")).Warnings(), IsEmpty());
}

TEST_F(ModelRules, DisabledLimitsCountUnlessTheModelIsHonoured) {
  const std::string xml = Ball("<flag limit='disable'/>");
  const Scene counts = Scene::FromString(xml);
  EXPECT_THAT(counts.Warnings(), ElementsAre(HasSubstr("joint limits")));
  EXPECT_FALSE(Verify(counts, Q{2.0}).free);
  EXPECT_NEAR(Verify(counts, Q{2.0}).limit_excess, 1.0, 1e-12);
  EXPECT_NEAR(Solver(counts).Solve(Q{2.0}).q[0], 1.0, 1e-5);

  const Scene honours = Scene::FromString(xml, {.model_flags = true});
  EXPECT_TRUE(Verify(honours, Q{2.0}).free);
  EXPECT_EQ(Verify(honours, Q{2.0}).limit_excess, 0.0);
  EXPECT_EQ(Solver(honours).Solve(Q{2.0}).status, Status::kAlreadyFree);
  EXPECT_FALSE(Verify(honours, Q{0.05}).free) << "contacts still count";
  EXPECT_EQ(CheckMotion(honours, Q{0.5}, Q{2.0}).outcome, MotionOutcome::kFree);
  EXPECT_EQ(CheckMotion(counts, Q{0.5}, Q{2.0}).outcome, MotionOutcome::kLimit);
}

TEST_F(ModelRules, EqualitiesHoldUnlessAllConstraintsAreDisabledAndHonoured) {
  const std::string xml = R"(<mujoco><option><flag constraint="disable"/></option><worldbody>
    <body><joint name="a" type="slide"/><geom size=".1"/></body>
    <body pos="1 0 0"><joint name="b" type="slide"/><geom size=".1"/></body></worldbody>
    <equality><joint joint1="a" joint2="b"/></equality></mujoco>)";
  EXPECT_FALSE(Verify(Scene::FromString(xml), Q{0.0, 0.1}).free);
  const Scene honours = Scene::FromString(xml, {.model_flags = true});
  EXPECT_TRUE(Verify(honours, Q{0.0, 0.1}).free);
  EXPECT_TRUE(Solver(honours).IsFree(Q{0.0, 0.1}));
}

// Whether MuJoCo pushes: the ball, without gravity, is accelerated.
bool Pushes(const mjModel& m, double z) {
  std::unique_ptr<mjData, void (*)(mjData*)> d(mj_makeData(&m), mj_deleteData);
  d->qpos[0] = z;
  mj_forward(&m, d.get());
  return std::abs(d->qacc[0]) > 1e-9;
}

// A gap does not move where the push begins, a negative margin does, and pairs have their own.
TEST_F(ModelRules, PushedPairsAreThoseThatMujocoPushesOn) {
  const std::string still = "<flag gravity='disable'/>";
  int pushed = 0, apart = 0;
  for (const char* geom : {"", "margin='.01'", "margin='.01' gap='.02'", "gap='.02'"}) {
    const Scene scene = Scene::FromString(Ball(still, geom));
    for (const double z : {0.1001, 0.105, 0.1099, 0.1101, 0.119, 0.125, 0.14}) {
      const Verdict verdict = Verify(scene, Q{z});
      EXPECT_TRUE(verdict.free);
      EXPECT_EQ(verdict.pushed_pairs, Pushes(*scene.model(), z)) << geom << " " << z;
      ++(verdict.pushed_pairs ? pushed : apart);
    }
  }
  EXPECT_EQ(pushed, 6);
  EXPECT_EQ(apart, 22);
}

TEST_F(ModelRules, AResultSaysWhatIsStillPushed) {
  const Scene scene = Scene::FromString(Ball("", "margin='.01'"));
  Options asks;
  asks.report_contacts = true;
  const Result result = Solver(scene, asks).Solve(Q{0.05});
  ASSERT_EQ(result.status, Status::kSolved);
  EXPECT_NEAR(result.q[0], 0.1, 1e-5);
  EXPECT_EQ(result.pushed_pairs, 1);
  EXPECT_EQ(Solver(scene, asks).Solve(Q{0.105}).pushed_pairs, 1) << "already free";
  EXPECT_EQ(Solver(scene, asks).Solve(Q{0.2}).pushed_pairs, 0);
}

TEST_F(ModelRules, MarginsAreKeptWhenAsked) {
  for (const char* geom : {"margin='.01'", "margin='.01' gap='.02'"}) {
    const Scene scene = Scene::FromString(Ball("", geom), {.keep_margins = true});
    Solver solver(scene);
    EXPECT_FALSE(solver.IsFree(Q{0.105}));
    EXPECT_FALSE(Verify(scene, Q{0.105}).free);
    const Result result = solver.Solve(Q{0.105});
    ASSERT_EQ(result.status, Status::kSolved);
    EXPECT_NEAR(result.q[0], 0.11, 1e-5);
    EXPECT_NEAR(result.sigma, 0.005 * 0.005, 1e-6 * 0.005);
    EXPECT_TRUE(Verify(scene, result.q).free);
    EXPECT_FALSE(Verify(scene, Q{result.q[0] - 1e-4}).free) << "the fix cannot be smaller";
    const Motion motion = CheckMotion(scene, Q{0.5}, Q{0.0});
    EXPECT_EQ(motion.outcome, MotionOutcome::kContact);
    EXPECT_NEAR(motion.q[0], 0.11, 1e-4);
    Options larger;
    larger.clearance = 0.03;
    EXPECT_NEAR(Solver(scene, larger).Solve(Q{0.05}).q[0], 0.13, 1e-5);
    Options paper;
    paper.method = Method::kPaper;
    EXPECT_NEAR(Solver(scene, paper).Solve(Q{0.05}).q[0], 0.11, 1e-4);
  }
}

// Robots with random margins, some of whose pairs have more than others: afterwards MuJoCo pushes
// on nothing.
TEST_F(ModelRules, NothingPushesOnRobotsThatKeepTheirMargins) {
  Random rng(2505);
  int solved = 0;
  for (int robot = 0; robot < 12; ++robot) {
    std::string xml = RandomRobotXml(rng, {.free_base = rng.Chance(0.5)});
    mjSpec* spec = mj_parseXMLString(xml.c_str(), nullptr, nullptr, 0);
    ASSERT_NE(spec, nullptr);
    for (mjsElement* e = mjs_firstElement(spec, mjOBJ_GEOM); e; e = mjs_nextElement(spec, e)) {
      mjs_asGeom(e)->margin = rng.Chance(0.5) ? 0.01 * rng.Uniform() : 0.0;
    }
    const std::unique_ptr<mjModel, void (*)(mjModel*)> model(mj_compile(spec, nullptr),
                                                             mj_deleteModel);
    mj_deleteSpec(spec);
    ASSERT_NE(model, nullptr);
    const Scene scene = Scene::FromModel(model.get(), {.keep_margins = true});
    Options asks;
    asks.report_contacts = true;
    Solver solver(scene, asks);
    for (int k = 0; k < 10; ++k) {
      const Result result = solver.Solve(ToVector(RandomConfiguration(scene, rng)));
      if (result.status != Status::kSolved) continue;
      ++solved;
      EXPECT_EQ(Verify(Scene::FromModel(model.get()), result.q).pushed_pairs, 0);
      std::unique_ptr<mjData, void (*)(mjData*)> d(mj_makeData(model.get()), mj_deleteData);
      std::copy(result.q.begin(), result.q.end(), d->qpos);
      mj_fwdPosition(model.get(), d.get());
      for (int c = 0; c < d->ncon; ++c) {
        const mjContact& contact = d->contact[c];
        EXPECT_GE(contact.dist, contact.includemargin - 2e-5) << robot << " " << k;
      }
    }
  }
  EXPECT_GT(solved, 60);
}

constexpr char kCloth[] = R"(<mujoco><worldbody>
    <geom name="floor" type="plane" size="1 1 1"/>
    <body name="ball"><joint name="z" type="slide" axis="0 0 1"/><geom size=".1"/></body>
    <flexcomp name="cloth" type="grid" count="4 4 1" spacing=".1 .1 .1" dim="2" mass="1">
      <edge equality="true"/></flexcomp></worldbody></mujoco>)";

TEST_F(ModelRules, FlexesAreRefusedOrLeftOut) {
  EXPECT_THAT(ErrorOf([] { Scene::FromString(kCloth); }),
              AllOf(HasSubstr("'cloth'"), HasSubstr("--flex ignore")));
  const Scene scene = Scene::FromString(kCloth, {.ignore_flexes = true});
  EXPECT_THAT(scene.Warnings(), ElementsAre(HasSubstr("'cloth' is left out")));
  EXPECT_EQ(scene.dof(), 1) << "the vertices stay";
  Q q = scene.DefaultQpos();
  ASSERT_GT(q.size(), 1u);
  const Result result = Solver(scene).Solve(q);
  ASSERT_EQ(result.status, Status::kSolved);
  EXPECT_NEAR(result.q[0], 0.1, 1e-5);
  q[0] = result.q[0];
  EXPECT_EQ(result.q, q);
  EXPECT_TRUE(Verify(scene, result.q).free);
}

}  // namespace
}  // namespace mjcf_pdg::test
