// What the independent check says: distances, tolerances, limits, rest, words. For what MuJoCo
// alone overlooks, see hidden_overlap_test.cc.
#include "verify/verifier.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "mjcf_pdg/pdg.h"
#include "tests/support/allocation_counter.h"
#include "tests/support/brute_distance.h"
#include "tests/support/mesh_shapes.h"
#include "tests/support/test_support.h"
#include "tests/support/verify_scenes.h"

namespace mjcf_pdg::test {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class VerifierTest : public MujocoTest {};

TEST_F(VerifierTest, TwoBoxesOverlapByTheDepthOfTheirSlide) {
  const Scene scene = Scene::FromString(TwoBoxes());
  const Verdict apart = Verify(scene, {0.25});
  EXPECT_TRUE(apart.free);
  EXPECT_TRUE(apart.certified);
  EXPECT_NEAR(apart.min_distance, 0.05, 1e-9);
  EXPECT_EQ(apart.reason, "");
  EXPECT_TRUE(apart.contacts.empty());
  const Verdict overlap = Verify(scene, {0.1988});
  EXPECT_FALSE(overlap.free);
  EXPECT_EQ(overlap.reason, "geom 'wall' and geom 'block' overlap by 1.2 mm");
  ASSERT_EQ(overlap.contacts.size(), 1u);  // four of MuJoCo's, merged
  EXPECT_NEAR(overlap.contacts[0].normal_W[0], 1.0, 1e-9);
  EXPECT_NEAR(overlap.contacts[0].position_W[0], 0.0994, 1e-6);
  EXPECT_NEAR(overlap.contacts[0].distance, -0.0012, 1e-9);
}

TEST_F(VerifierTest, OverlapsUpToTheToleranceAreFree) {
  const Scene scene = Scene::FromString(TwoBoxes());
  EXPECT_TRUE(Verify(scene, {0.2 - 0.9e-6}).free);
  EXPECT_FALSE(Verify(scene, {0.2 - 1.1e-6}).free);
  Options loose;
  loose.tolerance = 1e-4;
  EXPECT_TRUE(Verify(scene, {0.2 - 0.9e-4}, loose).free);
  EXPECT_EQ(Verify(scene, {0.2 - 0.9e-4}, loose).contacts.size(), 1u);
  EXPECT_FALSE(Verify(scene, {0.2 - 1.1e-4}, loose).free);
}

TEST_F(VerifierTest, ANegativeMarginAndGapIsAnOverlapTheModelAllows) {
  const Scene scene = Scene::FromString(TwoBoxes("", "margin='-.01' gap='.004'"));
  EXPECT_TRUE(Verify(scene, {0.195}).free);
  EXPECT_TRUE(Verify(scene, {0.194}).free);
  const Verdict verdict = Verify(scene, {0.1939});
  EXPECT_FALSE(verdict.free);
  EXPECT_EQ(verdict.reason, "geom 'wall' and geom 'block' overlap by 6.1 mm (6 mm allowed)");
}

TEST_F(VerifierTest, DistancesAreCutOffWhereTheRangeEnds) {
  const Scene scene = Scene::FromString(TwoBoxes());
  EXPECT_EQ(Verify(scene, {9.0}).min_distance, 1.0);
  Options options;
  options.clearance = 0.002;
  for (const double range : {0.0, 0.05}) {
    Verifier verifier(scene.verifier_model(), options, range);
    EXPECT_EQ(verifier.Check(std::vector<double>{9.0}).min_distance, 0.002 + range);
    EXPECT_EQ(verifier.Check(std::vector<double>{0.3}).min_distance, 0.002 + range);
    EXPECT_NEAR(verifier.Check(std::vector<double>{0.201}).min_distance, 0.001, 1e-12);
  }
}

TEST_F(VerifierTest, SignedDistancesAreThoseOfTheSlowOracle) {
  Random rng(2);
  int overlaps = 0, cases = 0;
  for (const auto& [type1, type2] :
       {std::pair(mjGEOM_CAPSULE, mjGEOM_BOX), std::pair(mjGEOM_BOX, mjGEOM_BOX),
        std::pair(mjGEOM_CYLINDER, mjGEOM_MESH)}) {
    for (int i = 0; i < 25; ++i) {
      TwoGeoms geoms;
      geoms.first = RandomShape(type1, rng);
      geoms.second = RandomShape(type2, rng);
      const Scene scene = Scene::FromString(TwoGeomXml(geoms));
      const std::vector<double> q = FreePose(rng.InBox(0.25), rng.UnitQuat());
      const DataPtr d(mj_makeData(scene.model()));
      mju_copy(d->qpos, q.data(), 7);
      mj_kinematics(scene.model(), d.get());
      const double brute = BruteDistance(scene.model(), d.get(), 0, 1).distance;
      const Verdict verdict = Verify(scene, q);
      EXPECT_NEAR(verdict.min_distance, brute, 2e-6) << TwoGeomXml(geoms) << Join(ToEigen(q));
      EXPECT_EQ(verdict.free, brute > -1e-6) << TwoGeomXml(geoms) << Join(ToEigen(q));
      overlaps += brute < 0.0;
      ++cases;
    }
  }
  EXPECT_GT(overlaps, cases / 4);
  EXPECT_LT(overlaps, cases);
}

// Whatever clearance is asked for: a tracker that finds nothing free has no time for depths.
TEST_F(VerifierTest, RoughDepthsAreNotTooSmallAndDistancesAreTheSame) {
  Random rng(8);
  Options options;
  options.clearance = 0.01;
  int apart = 0, deeper = 0;
  for (int i = 0; i < 400; ++i) {
    TwoGeoms geoms;
    geoms.first = RandomShape(mjGEOM_MESH, rng);
    geoms.second = RandomShape(mjGEOM_MESH, rng);
    const Scene scene = Scene::FromString(TwoGeomXml(geoms));
    Verifier verifier(scene.verifier_model(), options);
    const std::vector<double> q = FreePose(rng.InBox(0.25), rng.UnitQuat());
    const Verdict measured = verifier.Check(q);
    const Verdict& rough = verifier.Check(q, {}, verify::Depths::kRough);
    EXPECT_EQ(rough.free, measured.free);
    EXPECT_LE(rough.min_distance, measured.min_distance + 1e-9);
    if (measured.min_distance >= 0.0) {
      EXPECT_NEAR(rough.min_distance, measured.min_distance, 1e-9);
      ++apart;
    }
    deeper += rough.min_distance < measured.min_distance - 1e-6;
  }
  EXPECT_GT(apart, 50);
  EXPECT_GT(deeper, 0);
}

TEST_F(VerifierTest, NumbersThatAreNoNumbersAreErrors) {
  const Scene scene = Scene::FromString(TwoBoxes());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(ErrorOf([&] { Verify(scene, {nan}); }), HasSubstr("qpos[0]"));
  EXPECT_THAT(ErrorOf([&] { Verify(scene, {}); }), HasSubstr("0 values"));
  const std::vector<double> bad_q_in = {nan};
  EXPECT_THAT(ErrorOf([&] { Verify(scene, {0.3}, {}, &bad_q_in); }), HasSubstr("qpos[0]"));
  Options options;
  options.tolerance = nan;
  EXPECT_THAT(ErrorOf([&] { Verify(scene, {0.3}, options); }), HasSubstr("tolerance"));
  options = {};
  options.mocap_pos = {0, 0, 0};
  EXPECT_THAT(ErrorOf([&] { Verify(scene, {0.3}, options); }), HasSubstr("mocap_pos"));
  Verifier verifier(scene.verifier_model(),
                    {});  // a solver's own doubtful numbers: no throw, not free
  EXPECT_FALSE(verifier.Check(std::vector<double>{nan}).free);
  EXPECT_THAT(verifier.Check(std::vector<double>{nan}).reason, HasSubstr("not a number"));
  EXPECT_TRUE(verifier.Check(std::vector<double>{0.3}).free);
}

// MuJoCo's contacts know nothing of limits.
TEST_F(VerifierTest, JointLimitsHold) {
  const Scene scene = Scene::FromString(R"(<mujoco><compiler angle="radian"/><worldbody>
    <body name="a"><joint name="x" type="slide" range="-.1 .2"/><geom size=".1"/>
    <body pos="1 0 0"><joint name="h" range="-.5 .5"/><geom size=".1"/></body></body>
    </worldbody></mujoco>)");
  EXPECT_TRUE(Verify(scene, {0.2 + 0.9e-6, -0.5}).free);
  const Verdict slide = Verify(scene, {0.2001, 0.0});
  EXPECT_FALSE(slide.free);
  EXPECT_NEAR(slide.limit_excess, 1e-4, 1e-12);
  EXPECT_EQ(slide.reason, "joint 'x' is 0.0001 m outside its range");
  const Verdict hinge = Verify(scene, {0.0, -0.7});
  EXPECT_FALSE(hinge.free);
  EXPECT_EQ(hinge.reason, "joint 'h' is 0.2 rad outside its range");
}

TEST_F(VerifierTest, TheTwistOfALimitedBallJointCounts) {
  const Scene scene = Scene::FromString(R"(<mujoco><compiler angle="radian"/><worldbody><body>
    <joint name="j" type="ball" range="0 .5"/><geom type="capsule" size=".01 .1"/></body>
    </worldbody></mujoco>)");
  auto turned = [](const Vector3d& axis, double angle, double scale) {
    const Eigen::Quaterniond r(Eigen::AngleAxisd(angle, axis.normalized()));
    return std::vector<double>{scale * r.w(), scale * r.x(), scale * r.y(), scale * r.z()};
  };
  for (const Vector3d& axis : {Vector3d(0, 0, 1), Vector3d(1, 0, 0), Vector3d(1, -2, 3)}) {
    EXPECT_TRUE(Verify(scene, turned(axis, 0.5, 1.0)).free);
    EXPECT_TRUE(Verify(scene, turned(axis, 0.5, -3.0)).free);  // the same rotation
    EXPECT_FALSE(Verify(scene, turned(axis, 0.5001, 1.0)).free);
    EXPECT_FALSE(Verify(scene, turned(axis, -0.5001, -2.0)).free);
    EXPECT_NEAR(Verify(scene, turned(axis, 0.7, 1.0)).limit_excess, 0.2, 1e-12);
  }
}

TEST_F(VerifierTest, AContactAtRestMayKeepItsDepthButNotExceedIt) {
  const Scene scene = Scene::FromString(TwoBoxes());
  Options options;
  options.rest = 1e-3;
  const std::vector<double> q_in = {0.1993}, deeper_q_in = {0.1989};
  EXPECT_TRUE(Verify(scene, q_in, options, &q_in).free);
  EXPECT_TRUE(Verify(scene, {0.1996}, options, &q_in).free);
  const Verdict deeper = Verify(scene, {0.1992}, options, &q_in);
  EXPECT_FALSE(deeper.free);
  EXPECT_EQ(deeper.reason, "geom 'wall' and geom 'block' overlap by 0.8 mm (0.7 mm allowed)");
  EXPECT_FALSE(Verify(scene, q_in, options).free) << "rests on nothing without q_in";
  EXPECT_FALSE(Verify(scene, q_in, {}, &q_in).free) << "rest is off";
  EXPECT_FALSE(Verify(scene, {0.1995}, options, &deeper_q_in).free) << "too deep to rest";
  const std::vector<double> exactly = {0.2 - 1e-3};
  EXPECT_TRUE(Verify(scene, exactly, options, &exactly).free);
  Verifier verifier(scene.verifier_model(), options);  // another q_in, or none, forgets the last
  EXPECT_TRUE(verifier.Check(std::vector<double>{0.1993}, q_in).free);
  EXPECT_FALSE(verifier.Check(std::vector<double>{0.1993}, deeper_q_in).free);
  EXPECT_TRUE(verifier.Check(std::vector<double>{0.1993}, q_in).free);
  EXPECT_FALSE(verifier.Check(std::vector<double>{0.1993}).free);
}

TEST_F(VerifierTest, ClearanceIsAskedOfPairsThatMove) {
  const Scene scene = Scene::FromString(TwoBoxes());
  Options options;
  options.clearance = 5e-3;
  EXPECT_TRUE(Verify(scene, {0.205}, options).free);
  const Verdict near = Verify(scene, {0.2038}, options);
  EXPECT_FALSE(near.free);
  EXPECT_EQ(near.reason, "geom 'wall' and geom 'block' are 3.8 mm apart (5 mm required)");
  EXPECT_NEAR(near.min_distance, 3.8e-3, 1e-9);
}

TEST_F(VerifierTest, FrozenGeomsThatOverlapAreNamedAndNeedNoClearance) {
  const std::string xml = R"(<mujoco><worldbody><geom name="wall" type="box" size=".1 .1 .1"/>
    <body name="a" pos=".205 0 0"><joint name="ja" type="slide" axis="1 0 0"/>
      <geom name="a" type="box" size=".1 .1 .1"/></body>
    <body name="b" pos="0 0 1"><joint type="slide" axis="0 0 1"/>
      <geom name="b" size=".1"/></body></worldbody></mujoco>)";
  SceneOptions scene_options;
  scene_options.movable = {"b"};
  const Scene scene = Scene::FromString(xml, scene_options);
  Options options;
  options.clearance = 0.01;
  EXPECT_TRUE(Verify(scene, {0.0, 0.0}, options).free);
  const Verdict verdict = Verify(scene, {-0.015, -0.81});
  EXPECT_FALSE(verdict.free);
  EXPECT_THAT(verdict.reason, ::testing::StartsWith("geom 'wall' and geom 'a' overlap by 10 mm and "
                                                    "no movable joint can part them; "));
  EXPECT_THAT(verdict.reason, HasSubstr("overlap by 10 mm"));
  EXPECT_EQ(verdict.contacts.size(), 2u);
}

TEST_F(VerifierTest, AnExplicitPairCountsAndAnExcludedOneDoesNot) {
  const auto xml = [](const std::string& contact) {
    return "<mujoco><contact>" + contact + R"(</contact><worldbody>
      <body name="a"><joint type="slide" axis="1 0 0"/><geom name="a" size=".1"/>
      <body name="b" pos=".15 0 0"><joint type="slide" axis="1 0 0"/><geom name="b" size=".1"/>
      <body name="c" pos="0 .15 0"><joint type="slide" axis="1 0 0"/><geom name="c" size=".1"/>
      </body></body></body></worldbody></mujoco>)";
  };
  const std::vector<double> q = {0, 0, -0.15};  // b and c, c and a, a and b overlap
  EXPECT_THAT(Verify(Scene::FromString(xml("")), q).reason,
              AllOf(HasSubstr("'a' and geom 'c'"), Not(HasSubstr("'b'"))));
  EXPECT_TRUE(Verify(Scene::FromString(xml("<exclude body1='a' body2='c'/>")), q).free);
  const Scene paired =
      Scene::FromString(xml("<exclude body1='a' body2='c'/><pair geom1='b' geom2='a'/>"));
  EXPECT_EQ(Verify(paired, q).reason, "geom 'a' and geom 'b' overlap by 50 mm");
  EXPECT_EQ(Verify(paired, {0, 0.06, -0.15}).free, true);
}

TEST_F(VerifierTest, IfItsOwnArenaIsFullNothingIsCalledFree) {
  std::string xml = "<mujoco><worldbody><geom type='plane' size='1 1 1'/>";
  for (int i = 0; i < 30; ++i) {
    xml += "<body pos='" + std::to_string(0.3 * i) +
           " 0 .1'><joint type='slide' axis='0 0 1'/><geom type='box' size='.1 .1 .1'/></body>";
  }
  const Scene scene = Scene::FromString(xml + "</worldbody></mujoco>");
  const std::vector<double> q(30, -0.5e-6);
  Verifier sound(scene.verifier_model(), {});
  EXPECT_TRUE(sound.Check(q).free);
  auto cramped = std::make_shared<VerifierModel>(*scene.verifier_model());
  cramped->unblinded.narena = 20 << 10;
  Verifier verifier(cramped, {});
  const Verdict verdict = verifier.Check(q);
  EXPECT_FALSE(verdict.free);
  EXPECT_THAT(verdict.reason, HasSubstr("memory for contacts is full"));
  EXPECT_EQ(TakeMessages().size(), 1u);
}

// The two witnesses do not share the table of pairs.
TEST_F(VerifierTest, MujocosContactsCountWhereOurTableLacksThePair) {
  for (const char* margin : {"", "margin='-.25'"}) {
    const Scene scene = Scene::FromString(TwoBoxes("", margin));
    auto lacking = std::make_shared<VerifierModel>(*scene.verifier_model());
    lacking->pairs.clear();
    Verifier verifier(lacking, {});
    EXPECT_TRUE(verifier.Check(std::vector<double>{0.21}).free);
    const Verdict verdict = verifier.Check(std::vector<double>{0.17});
    EXPECT_FALSE(verdict.free);
    EXPECT_EQ(verdict.reason, "geom 'wall' and geom 'block' overlap by 30 mm");
    EXPECT_EQ(verdict.contacts.size(), 1u);
  }
}

TEST_F(VerifierTest, HeightFieldsAreJudgedByCertificates) {
  const Scene scene = Scene::FromString(R"(<mujoco><asset>
    <hfield name="h" nrow="3" ncol="3" size="1 1 .1 .1" elevation="0 0 0 0 1 0 0 0 0"/></asset>
    <worldbody><geom name="ground" type="hfield" hfield="h"/><body><freejoint/>
    <geom name="ball" size=".1"/></body></worldbody></mujoco>)");
  auto at = [](double z) { return std::vector<double>{0, 0, z, 1, 0, 0, 0}; };
  EXPECT_TRUE(Verify(scene, at(0.25)).free);
  EXPECT_TRUE(Verify(scene, at(0.25)).certified);
  const Verdict overlap = Verify(scene, at(0.17));
  EXPECT_FALSE(overlap.free);
  EXPECT_THAT(overlap.reason, HasSubstr("geom 'ground' and geom 'ball' overlap by"));
  ASSERT_EQ(overlap.contacts.size(), 1u);
  EXPECT_NEAR(overlap.contacts[0].normal_W[2], 1.0, 1e-9);
  EXPECT_NEAR(overlap.min_distance, -0.03, 1e-8);
  Options options;
  options.clearance = 0.1;
  EXPECT_FALSE(Verify(scene, at(0.25), options).free);
  EXPECT_TRUE(Verify(scene, at(0.35), options).free);
}

TEST_F(VerifierTest, MocapBodiesStandWhereTheOptionsPutThem) {
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody>
    <body name="post" mocap="true"><geom name="post" type="box" size=".1 .1 .1"/></body>
    <body><joint type="slide" axis="1 0 0"/><geom name="ball" size=".1"/></body>
    </worldbody></mujoco>)");
  Options options;
  EXPECT_TRUE(Verify(scene, {0.25}, options).free);
  options.mocap_pos = {0.1, 0, 0};
  EXPECT_FALSE(Verify(scene, {0.25}, options).free);
  options.mocap_quat = {1, 0, 0, 1};
  EXPECT_FALSE(Verify(scene, {0.25}, options).free);
  Verifier verifier(scene.verifier_model(), {});
  verifier.SetMocap(options.mocap_pos, {});
  EXPECT_FALSE(verifier.Check(std::vector<double>{0.25}).free);
  verifier.SetMocap({}, {});
  EXPECT_TRUE(verifier.Check(std::vector<double>{0.25}).free);
}

TEST_F(VerifierTest, NeitherTheUsersModelNorTheOrderOfChecksMatters) {
  const Scene scene = Scene::FromString(ArmXml());
  const std::vector<char> before = ModelBytes(scene.model());
  Random rng(5);
  Verifier verifier(scene.verifier_model(), {});
  std::vector<std::vector<double>> configurations;
  std::vector<double> distances;
  int free = 0;
  for (int i = 0; i < 100; ++i) {
    configurations.push_back(ToVector(RandomConfiguration(scene, rng)));
    const Verdict once = Verify(scene, configurations.back());
    distances.push_back(once.min_distance);
    free += once.free;
  }
  for (int i = 99; i >= 0; --i) {
    EXPECT_EQ(verifier.Check(configurations[i]).min_distance, distances[i]);
  }
  EXPECT_GT(free, 5);
  EXPECT_LT(free, 95);
  EXPECT_EQ(ModelBytes(scene.model()), before);
}

TEST_F(VerifierTest, IsFreeSaysWhatCheckSaysWhateverWasAskedBefore) {
  Random rng(6);
  const Scene scene = Scene::FromString(RandomRobotXml(rng));
  Verifier verifier(scene.verifier_model(), {});
  int free = 0;
  for (int i = 0; i < 500; ++i) {
    const std::vector<double> q = ToVector(RandomConfiguration(scene, rng));
    const bool is_free = verifier.IsFree(q);
    EXPECT_EQ(Verifier(scene.verifier_model(), {}).IsFree(q), is_free);
    EXPECT_EQ(verifier.Check(q).free, is_free) << verifier.verdict().reason;
    free += is_free;
  }
  EXPECT_GT(free, 10);
  EXPECT_LT(free, 490);
}

TEST_F(VerifierTest, WarmChecksOfFreeConfigurationsAllocateNothing) {
  if (!AllocationCounter::Works()) GTEST_SKIP() << "no allocation is seen here";
  Random rng(7);
  const Scene scene = Scene::FromString(RandomRobotXml(rng));
  Verifier verifier(scene.verifier_model(), {});
  std::vector<std::vector<double>> free, colliding;
  while (free.size() < 20 || colliding.size() < 20) {
    const std::vector<double> q = ToVector(RandomConfiguration(scene, rng));
    (verifier.Check(q).free ? free : colliding).push_back(q);
  }
  const AllocationCounter counter;
  for (const std::vector<double>& q : free) EXPECT_TRUE(verifier.IsFree(q));
  for (const std::vector<double>& q : colliding) EXPECT_FALSE(verifier.IsFree(q));
  for (const std::vector<double>& q : free) EXPECT_TRUE(verifier.Check(q).free);
  EXPECT_EQ(counter.count(), 0);
}

TEST_F(VerifierTest, ViolationsAreToldApartByCode) {
  const std::string xml = R"(<mujoco><worldbody><geom name="wall" type="box" size=".1 .1 .1"/>
    <body pos=".205 0 0"><joint type="slide" axis="1 0 0" range="-1 1"/>
      <geom type="box" size=".1 .1 .1"/></body>
    <body name="b" pos="0 0 1"><joint type="slide" axis="0 0 1"/>
      <geom size=".1"/></body></worldbody></mujoco>)";
  SceneOptions only_b;
  only_b.movable = {"b"};
  const Scene scene = Scene::FromString(xml, only_b);
  Verifier verifier(scene.verifier_model(), {});
  const auto violations = [&](const std::vector<double>& q) {
    verifier.Check(q);
    const Verifier::Violations& v = verifier.violations();
    EXPECT_FALSE(v.uncertified || v.arena_full || v.not_a_number);
    return std::vector<bool>{v.separable, v.frozen, v.limits};
  };
  EXPECT_EQ(violations({0.0, 0.0}), (std::vector<bool>{false, false, false}));
  EXPECT_EQ(violations({0.0, -0.85}), (std::vector<bool>{true, false, false}));
  EXPECT_EQ(violations({-0.02, 0.0}), (std::vector<bool>{false, true, false}));
  EXPECT_EQ(violations({1.1, 0.0}), (std::vector<bool>{false, false, true}));
  verifier.Check(std::vector<double>{NAN, 0.0});
  EXPECT_TRUE(verifier.violations().not_a_number);
}

}  // namespace
}  // namespace mjcf_pdg::test
