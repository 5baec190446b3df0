#include "ccd/ccdg.h"

#include <cmath>
#include <cstdio>

#include "tests/support/brute_distance.h"
#include "tests/support/shallow_depths.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

using Eigen::Quaterniond;

class CcdgTest : public MujocoTest {};

// A scene with its own finder, so that a motion is one line of a test.
struct Mover {
  explicit Mover(const std::string& xml, const SceneOptions& scene_options = {})
      : scene(Scene::FromString(xml, scene_options)),
        finder(scene.tables()),
        ccdg(scene.tables(), finder) {}
  const CcdResult& Move(const VectorXd& q0, const VectorXd& q1,
                        const VectorXd* required = nullptr) {
    VectorXd dq;
    Difference(scene.tables(), q0, q1, dq);
    return ccdg.Move({q0, dq, required}, options);
  }
  // From qpos0 along a tangent.
  const CcdResult& Along(const VectorXd& dq) {
    const VectorXd q0 = ToEigen(scene.DefaultQpos());
    return ccdg.Move({q0, dq}, options);
  }

  Scene scene;
  ContactFinder finder;
  Ccdg ccdg;
  CcdOptions options;
};

std::string World(const std::string& inside, const std::string& extra = "") {
  return "<mujoco><compiler boundmass='1e-3' boundinertia='1e-6'/>" + extra + "<worldbody>" +
         inside + "</worldbody></mujoco>";
}

VectorXd Values(std::initializer_list<double> values) {
  return Eigen::Map<const VectorXd>(values.begin(), static_cast<Eigen::Index>(values.size()));
}

// ---- Motions with a known answer ----

constexpr const char* kSheet = "<geom name='sheet' type='box' size='.00005 1 1'/>";  // 0.1 mm

TEST_F(CcdgTest, ABulletDoesNotTunnelThroughASheet) {
  Mover mover(World(std::string(kSheet) + R"(<body pos="-5 0 0"><freejoint/>
      <geom type="sphere" size=".001"/></body>)"));
  VectorXd dq = VectorXd::Zero(6);
  dq[0] = 1000.0;
  const CcdResult& result = mover.Along(dq);
  EXPECT_EQ(result.outcome, CcdOutcome::kContact);
  EXPECT_TRUE(result.certified);
  EXPECT_NEAR(result.t, (5.0 - 0.00005 - 0.001) / 1000.0, 1e-8);
  EXPECT_LT(result.q[0], -0.00105);
  EXPECT_GT(result.q[0], -0.00105 - mover.options.Gap());
  EXPECT_LE(result.poses, 4);
}

TEST_F(CcdgTest, ASpinningThinRodDoesNotTunnelThroughASheet) {
  // At both ends of the motion the rod lies beside the sheet; half way round it pierces it.
  Mover mover(World(std::string(kSheet) + R"(<body pos="-.3 0 0"><joint axis="0 0 1"/>
      <geom type="capsule" size=".0005" fromto="0 0 0 0 -.5 0"/></body>)"));
  const CcdResult& result = mover.Along(Values({M_PI}));
  EXPECT_EQ(result.outcome, CcdOutcome::kContact);
  EXPECT_TRUE(result.certified);
  const double angle = std::asin((0.3 - 0.00005 - 0.0005) / 0.5);
  EXPECT_NEAR(result.t * M_PI, angle, 2e-5);
  EXPECT_LE(result.t * M_PI, angle);
  EXPECT_LE(result.poses, 15);
}

TEST_F(CcdgTest, AFastWristDoesNotSkipAWire) {
  // Many whole turns in one motion; the tool passes the wire in 1/3000 of it.
  Mover mover(World(R"(<geom name="wire" type="capsule" size=".0005" fromto="-.45 -1 .1 -.45 1 .1"/>
      <body pos="0 0 0"><joint axis="0 1 0"/><geom type="box" size=".15 .01 .01" pos=".15 0 0"
      contype="0" conaffinity="0"/><body pos=".3 0 0"><joint axis="0 1 0"/>
      <geom type="box" size=".1 .01 .002" pos=".1 0 0"/></body></body>)"));
  const CcdResult& result = mover.Along(Values({M_PI, 200.0}));
  EXPECT_EQ(result.outcome, CcdOutcome::kContact);
  EXPECT_TRUE(result.certified);
  EXPECT_LE(result.poses, 400);
  NearPair near;
  mover.finder.Pose(result.q);
  ASSERT_TRUE(mover.finder.Distance(0, 1.0, near));
  EXPECT_GT(near.distance, 0.0);
  EXPECT_LE(near.distance, mover.options.Gap());
}

TEST_F(CcdgTest, ACapsuleIsStoppedByABoxThatMuJoCoMayLetItPierce) {
  // See capsule_box.h: to MuJoCo 4.0 many of the targets look free.
  Random rng(5);
  int missed = 0, overlapping = 0;
  for (int i = 0; i < 300; ++i) {
    TwoGeoms geoms;
    geoms.first = RandomShape(mjGEOM_CAPSULE, rng);
    geoms.first.size = Vector3d(0.02, 0.6, 0.0);  // both ends stick out
    geoms.second = RandomShape(mjGEOM_BOX, rng);
    geoms.pose1 = "pos='0 0 1.5'";
    Mover mover(TwoGeomXml(geoms));
    VectorXd q0 = ToEigen(mover.scene.DefaultQpos());
    const Quaterniond quat = rng.UnitQuat();
    q0.segment<4>(3) << quat.w(), quat.x(), quat.y(), quat.z();
    VectorXd q1 = q0;
    q1.head<3>() = rng.InBox(0.2);
    PosedModel posed(&mover.scene.tables().query_model);
    posed.Pose(q1);
    if (BruteDistance(posed.model(), posed.data(), 0, 1).distance > -1e-4) continue;
    EXPECT_EQ(mover.Move(q0, q1).outcome, CcdOutcome::kContact);
    mj_collision(posed.model(), posed.data());
    missed += posed.data()->ncon == 0;
    ++overlapping;
  }
  std::printf("  %d of %d overlapping targets have no contact in MuJoCo\n", missed, overlapping);
  EXPECT_GT(overlapping, 50);
}

TEST_F(CcdgTest, AClearMotionIsFreeAndCostsOnePose) {
  Mover mover(World(std::string(kSheet) + R"(<body pos="-5 0 0"><freejoint/>
      <geom type="box" size=".1 .1 .1"/></body>)"));
  const CcdResult& result = mover.Along(Values({4.5, 0.0, 0.0, 0.0, 0.0, 1.0}));
  EXPECT_EQ(result.outcome, CcdOutcome::kFree);
  EXPECT_EQ(result.t, 1.0);
  EXPECT_TRUE(result.certified);
  EXPECT_EQ(result.poses, 1);
  EXPECT_TRUE(result.pairs.empty());
}

constexpr const char* kBallOnFloor = R"(<geom type="plane" size="0 0 1"/>
    <body pos="0 0 .1"><freejoint/><geom type="sphere" size=".1"/></body>)";

TEST_F(CcdgTest, AStartInCollisionIsSaidAndStaysPut) {
  Mover mover(World(kBallOnFloor));
  VectorXd q0 = ToEigen(mover.scene.DefaultQpos()), q1 = q0;
  q0[2] -= 2e-6;
  q1[2] += 1.0;
  const CcdResult& result = mover.Move(q0, q1);
  EXPECT_EQ(result.outcome, CcdOutcome::kStartInCollision);
  EXPECT_EQ(result.t, 0.0);
  EXPECT_EQ(result.q, q0);
  EXPECT_EQ(result.pairs, std::vector<int>{0});
}

TEST_F(CcdgTest, ATouchingPairMayGlideAndPart) {
  Mover mover(World(kBallOnFloor));
  const VectorXd q0 = ToEigen(mover.scene.DefaultQpos());
  VectorXd q1 = q0;
  q1[0] = 3.0;  // along the floor
  EXPECT_EQ(mover.Move(q0, q1).outcome, CcdOutcome::kFree);
  EXPECT_LE(mover.Move(q0, q1).poses, 3);
  q1.segment<4>(3) << 0.0, 1.0, 0.0, 0.0;  // rolling half a turn on the way
  EXPECT_EQ(mover.Move(q0, q1).outcome, CcdOutcome::kFree);
  q1[2] += 0.5;  // and up
  EXPECT_EQ(mover.Move(q0, q1).outcome, CcdOutcome::kFree);
  EXPECT_LE(mover.Move(q0, q1).poses, 3);
}

TEST_F(CcdgTest, AGlidingPairThatIsPushedStopsAtOnce) {
  Mover mover(World(kBallOnFloor));
  VectorXd q0 = ToEigen(mover.scene.DefaultQpos());
  q0[2] += 0.5 * mover.options.Gap();
  VectorXd q1 = q0;
  q1[0] = 1.0;
  q1[2] -= 0.01;
  const CcdResult& result = mover.Move(q0, q1);
  EXPECT_EQ(result.outcome, CcdOutcome::kContact);
  EXPECT_LT(result.t, 1e-3);
  EXPECT_GT(result.q[2], 0.1);  // half of the gap is left
  EXPECT_EQ(result.pairs, std::vector<int>{0});
}

TEST_F(CcdgTest, ABoxRockingOnItsEdgeStopsWhenItLiesFlat) {
  Mover mover(World(R"(<geom type="plane" size="0 0 1"/><body pos="0 0 1e-6">
      <joint axis="0 1 0"/><geom type="box" size=".1 .1 .1" pos=".1 0 .1"/></body>)"));
  VectorXd q0 = Values({-0.5});
  const CcdResult& flat = mover.Move(q0, Values({0.5}));
  EXPECT_EQ(flat.outcome, CcdOutcome::kContact);
  EXPECT_NEAR(flat.q[0], 0.0, 1e-5);
  EXPECT_LE(flat.poses, 400);
}

TEST_F(CcdgTest, OverlapThatTheModelAllowsIsHonoured) {
  const std::string sunk = R"(<geom type="plane" size="0 0 1" margin="-.02"/>
      <body pos="0 0 .09"><freejoint/><geom type="sphere" size=".1"/></body>)";
  Mover mover(World(sunk));
  VectorXd q0 = ToEigen(mover.scene.DefaultQpos()), q1 = q0;
  q1[2] -= 0.05;
  const CcdResult& result = mover.Move(q0, q1);
  EXPECT_EQ(result.outcome, CcdOutcome::kContact);
  EXPECT_NEAR(result.q[2], 0.08, 5e-6);
  EXPECT_GT(result.q[2], 0.08);
}

TEST_F(CcdgTest, ARequiredDistanceIsKept) {
  Mover mover(World(kBallOnFloor));
  VectorXd q0 = ToEigen(mover.scene.DefaultQpos()), q1 = q0;
  q0[2] += 1.0;
  const VectorXd clearance = Values({0.05}), rest = Values({-0.01});
  EXPECT_NEAR(mover.Move(q0, q1, &clearance).q[2], 0.15, 5e-6);
  EXPECT_EQ(mover.Move(q1, q0, &clearance).outcome, CcdOutcome::kStartInCollision);
  q1[2] -= 0.05;
  EXPECT_NEAR(mover.Move(q0, q1, &rest).q[2], 0.09, 5e-6);
}

TEST_F(CcdgTest, AClearanceStopsAMotionThatPassesTooNear) {
  Mover mover(World(R"(<geom size=".1"/><body pos="-5 .23 0"><joint type="slide" axis="1 0 0"/>
      <geom size=".1"/></body>)"));
  const VectorXd small = Values({0.02}), large = Values({0.05});
  EXPECT_EQ(mover.Move(Values({0.0}), Values({10.0}), &small).outcome, CcdOutcome::kFree);
  const CcdResult& result = mover.Move(Values({0.0}), Values({10.0}), &large);
  EXPECT_EQ(result.outcome, CcdOutcome::kContact);
  EXPECT_NEAR(result.q[0], 5.0 - std::sqrt(0.25 * 0.25 - 0.23 * 0.23), 2e-5);
  const VectorXd huge = Values({4.5});  // the motion ends long before the bodies' spheres meet
  EXPECT_NEAR(mover.Move(Values({0.0}), Values({2.0}), &huge).q[0],
              5.0 - std::sqrt(4.7 * 4.7 - 0.23 * 0.23), 2e-5);
}

TEST_F(CcdgTest, ABallJointThatWouldLeaveItsLimitOnTheWayStopsThere) {
  // Two turns of 50° about axes at right angles keep a limit of 60°; the geodesic between them and
  // a turn the other way round need not.
  Mover mover(World(R"(<body><joint type="ball" range="0 60"/><geom size=".1"/></body>
      <geom size=".1" pos="9 0 0"/>)"));
  const double hi = 60.0 * M_PI / 180.0;
  Random rng(6);
  int stopped = 0;
  for (int i = 0; i < 300; ++i) {
    const VectorXd q0 = RandomConfiguration(mover.scene, rng);
    const VectorXd dq = 2.0 * rng.Normals(3);
    const CcdResult& result = mover.ccdg.Move({q0, dq}, mover.options);
    double first = 1.0;  // by brute force
    for (int k = 1; k <= 1000 && first == 1.0; ++k) {
      VectorXd q;
      Integrate(mover.scene.tables(), q0, dq * k / 1000.0, q);
      if (BallAngle(q.data()) > hi + 1e-9) first = (k - 1) / 1000.0;
    }
    EXPECT_EQ(result.outcome == CcdOutcome::kLimit, first < 1.0);
    EXPECT_GE(result.t, first - 1e-9);
    EXPECT_LE(result.t, first + 1.001e-3);
    EXPECT_LE(BallAngle(result.q.data()), hi + 1.1e-9);
    stopped += result.outcome == CcdOutcome::kLimit;
  }
  EXPECT_GT(stopped, 100);
  EXPECT_LT(stopped, 300);
}

TEST_F(CcdgTest, AHingeStopsAtItsLimit) {
  Mover mover(World(R"(<body><joint axis="0 0 1" range="-30 30"/><geom size=".1"/></body>
      <geom size=".1" pos="9 0 0"/>)"));
  const CcdResult& result = mover.Along(Values({-2.0}));
  EXPECT_EQ(result.outcome, CcdOutcome::kLimit);
  EXPECT_EQ(result.joint, 0);
  EXPECT_NEAR(result.q[0], -30.0 * M_PI / 180.0, 1e-12);
  EXPECT_EQ(mover.Move(Values({0.3}), Values({-0.3})).outcome, CcdOutcome::kFree);
  EXPECT_EQ(mover.Move(Values({0.3}), Values({-0.3})).joint, -1);
}

TEST_F(CcdgTest, AnEmptyBudgetSaysSoAndKeepsWhatIsProven) {
  Mover mover(World(R"(<geom name="wire" type="capsule" size=".0005" fromto="-.65 -1 .3 -.65 1 .3"/>
      <body><joint axis="0 1 0"/><joint axis="1 0 0"/><geom type="box" size=".3 .1 .01"
      pos=".3 0 0"/></body>)"));
  mover.options.max_poses = 5;
  const CcdResult& result = mover.Along(Values({30.0, 50.0}));
  EXPECT_EQ(result.outcome, CcdOutcome::kBudget);
  EXPECT_EQ(result.poses, 5);
  EXPECT_GT(result.t, 0.0);
  EXPECT_LT(result.t, 1.0);
}

TEST_F(CcdgTest, PairsThatTheMotionDoesNotMoveAreNotLookedAt) {
  Mover mover(World(R"(<body><joint axis="0 0 1"/><geom size=".1"/></body>
      <body pos="5 0 0"><joint axis="0 0 1"/><geom size=".1"/></body>
      <geom name="inside" size=".1" pos="5 .05 0"/>)"));
  EXPECT_EQ(mover.Along(Values({1.0, 0.0})).outcome, CcdOutcome::kFree);
  EXPECT_EQ(mover.Along(Values({0.0, 1.0})).outcome, CcdOutcome::kStartInCollision);
  EXPECT_EQ(mover.Along(Values({0.0, 0.0})).outcome, CcdOutcome::kFree);
  EXPECT_EQ(mover.Along(Values({0.0, 0.0})).poses, 0);
}

TEST_F(CcdgTest, AHeightFieldStopsAMotionAndTheWayThereIsProven) {
  Mover mover(World(R"(<geom type="hfield" hfield="hills"/>
      <body pos="0 0 1"><freejoint/><geom size=".1"/></body>)",
                    R"(<asset><hfield name="hills" nrow="3" ncol="3" size="1 1 .2 .1"
      elevation="0 0 0 0 1 0 0 0 0"/></asset>)"));
  VectorXd q0 = ToEigen(mover.scene.DefaultQpos()), q1 = q0;
  q1[2] = -0.5;
  const CcdResult& result = mover.Move(q0, q1);
  EXPECT_EQ(result.outcome, CcdOutcome::kContact);
  EXPECT_TRUE(result.certified);
  EXPECT_NEAR(result.q[2], 0.3, 1e-5);
  EXPECT_GT(result.q[2], 0.3 - 1e-6);
  EXPECT_EQ(result.contact_queries, 0);
  q1[2] = 2.0;  // away from it
  EXPECT_EQ(mover.Move(q0, q1).outcome, CcdOutcome::kFree);
}

TEST_F(CcdgTest, ABriefOverlapWithAHeightFieldIsNotMissed) {
  // The ball's lowest point passes 0.1 mm below the peak: 9 mm of a metre's way overlap.
  Mover mover(World(R"(<geom type="hfield" hfield="hills"/>
      <body pos="0 0 1"><freejoint/><geom size=".1"/></body>)",
                    R"(<asset><hfield name="hills" nrow="3" ncol="3" size="1 1 .2 .1"
      elevation="0 0 0 0 1 0 0 0 0"/></asset>)"));
  VectorXd q0 = ToEigen(mover.scene.DefaultQpos()), q1;
  q0.head<3>() << -0.55, 0.0, 0.3 - 1e-4;
  q1 = q0;
  q1[0] = 0.5;
  const CcdResult& result = mover.Move(q0, q1);
  EXPECT_EQ(result.outcome, CcdOutcome::kContact);
  EXPECT_NEAR(result.q[0], -std::sqrt(2 * 0.1 * 1e-4), 1e-3);
}

TEST_F(CcdgTest, AResultDoesNotDependOnWhatWasAskedBefore) {
  Random rng(7);
  Mover used(ArmXml());
  for (int i = 0; i < 20; ++i) {
    const VectorXd q0 = RandomConfiguration(used.scene, rng);
    const VectorXd q1 = RandomConfiguration(used.scene, rng);
    used.Move(RandomConfiguration(used.scene, rng), RandomConfiguration(used.scene, rng));
    const CcdResult& a = used.Move(q0, q1);
    Mover fresh(ArmXml());
    EXPECT_EQ(a.t, fresh.Move(q0, q1).t);
  }
}

// MuJoCo's depth of them is too shallow; what may be kept lies between that and the truth.
TEST_F(CcdgTest, TooDeepAnOverlapOfCurvedGeomsIsACollisionAtTheStart) {
  for (const CurvedPair& pair :
       {CurvedPair{"type='cylinder' size='.06 .05'", "type='cylinder' size='.04 .08'"},
        CurvedPair{"type='capsule' size='.03 .06'", "type='cylinder' size='.06 .05'"},
        CurvedPair{"type='sphere' size='.05'", "type='ellipsoid' size='.02 .1 .005'"}}) {
    const Scene scene = pair.Make();
    ContactFinder finder(scene.tables());
    Ccdg ccdg(scene.tables(), finder);
    int fooled = 0;
    for (const Overlap& overlap : RandomOverlaps(scene, 2000, 1e-4)) {
      if (overlap.hidden() < 1e-5) continue;
      ++fooled;
      const VectorXd required = VectorXd::Constant(1, 0.5 * (overlap.told + overlap.truth));
      const VectorXd dq = VectorXd::Constant(6, 1e-3);
      const VectorXd q = ToEigen(overlap.q);
      EXPECT_EQ(ccdg.Move({q, dq, &required}).outcome, CcdOutcome::kStartInCollision)
          << pair.second << Join(ToEigen(overlap.q));
    }
    EXPECT_GT(fooled, 0) << pair.first << pair.second;
  }
}

}  // namespace
}  // namespace mjcf_pdg::test
