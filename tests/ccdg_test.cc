#include "ccdg.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>

#include "test_support.h"

namespace mjcf_pdg::test {
namespace {

using Eigen::Quaterniond;

class CcdgTest : public MujocoTest {};
class CcdgRandomTest : public MujocoTest {};

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
    return ccdg.Move(q0, dq, options, required);
  }
  // From qpos0 along a tangent.
  const CcdResult& Along(const VectorXd& dq) {
    return ccdg.Move(ToEigen(scene.DefaultQpos()), dq, options);
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

// ---- Independent distances: mj_geomDistance, a ternary search for the pair it gets wrong ----

double PointBox(const Vector3d& p, const Vector3d& half) {
  return (p.cwiseAbs() - half).cwiseMax(0.0).norm();
}

double CapsuleBoxByTernarySearch(const mjModel& m, const mjData& d, int capsule, int box) {
  const Matrix3d R = AsMatrix(d.geom_xmat + 9 * box);
  const Vector3d c =
      R.transpose() * (AsVector(d.geom_xpos + 3 * capsule) - AsVector(d.geom_xpos + 3 * box));
  const Vector3d axis = R.transpose() * AsMatrix(d.geom_xmat + 9 * capsule).col(2);
  const Vector3d half = AsVector(m.geom_size + 3 * box);
  double lo = -m.geom_size[3 * capsule + 1], hi = -lo;
  for (int i = 0; i < 90; ++i) {
    const double a = lo + (hi - lo) / 3, b = hi - (hi - lo) / 3;
    (PointBox(c + a * axis, half) < PointBox(c + b * axis, half) ? hi : lo) =
        PointBox(c + a * axis, half) < PointBox(c + b * axis, half) ? b : a;
  }
  return PointBox(c + lo * axis, half) - m.geom_size[3 * capsule];
}

// Signed as far as the sign goes; the depth is not used.
double IndependentDistance(const mjModel& m, mjData* d, int geom1, int geom2, double cutoff) {
  if (m.geom_type[geom1] > m.geom_type[geom2]) std::swap(geom1, geom2);
  if (m.geom_type[geom1] == mjGEOM_CAPSULE && m.geom_type[geom2] == mjGEOM_BOX) {
    return CapsuleBoxByTernarySearch(m, *d, geom1, geom2);
  }
  mjtNum fromto[6];
  return mj_geomDistance(&m, d, geom1, geom2, cutoff, fromto);
}

// ---- Random motions of every two types ----

struct Case {
  Scene scene;
  VectorXd q0, dq;
};

// Whether the scene's only pair overlaps at q; good enough to choose cases.
bool Overlaps(const Scene& scene, const VectorXd& q) {
  ContactFinder finder(scene.tables());
  finder.Pose(q);
  return !finder.Find(0.0).empty();
}

std::string RandomJoints(Random& rng) {
  auto attributes = [&rng] {
    const Vector3d pos = rng.InBox(0.4), axis = rng.UnitVector();
    return "pos='" + Join(pos.data(), 3) + "' axis='" + Join(axis.data(), 3) + "'/>";
  };
  switch (rng.Index(4)) {
    case 0:
      return "<joint " + attributes() + "<joint type='slide' " + attributes() + "<joint " +
             attributes();
    case 1: {
      const Vector3d pos = rng.InBox(0.4);
      return "<joint type='slide' " + attributes() + "<joint type='ball' pos='" +
             Join(pos.data(), 3) + "'/>";
    }
    default:
      return "<freejoint/>";
  }
}

Case RandomCase(int type1, int type2, Random& rng) {
  TwoGeoms geoms;
  geoms.first = RandomShape(type1, rng);
  geoms.second = RandomShape(type2, rng);
  if (rng.Chance(0.3)) geoms.second.size *= 0.1;  // thin and small things
  geoms.joint1 = type1 == mjGEOM_PLANE ? "" : RandomJoints(rng);
  geoms.joint2 = type1 == mjGEOM_PLANE || rng.Chance(0.3) ? RandomJoints(rng) : "";
  const Vector3d where = 0.6 * rng.UnitVector();
  if (type1 != mjGEOM_PLANE) geoms.pose1 = "pos='" + Join(where.data(), 3) + "'";
  Case random{Scene::FromString(TwoGeomXml(geoms)), {}, {}};
  const SceneTables& tables = random.scene.tables();
  auto pose = [&](bool overlap) {  // overlapping or not, if a few tries find one
    VectorXd q;
    for (int i = 0; i < 8; ++i) {
      Integrate(tables, ToEigen(random.scene.DefaultQpos()), 0.5 * rng.Normals(tables.n), q);
      if (Overlaps(random.scene, q) == overlap) break;
    }
    return q;
  };
  random.q0 = pose(rng.Chance(0.05));
  Difference(tables, random.q0, pose(rng.Chance(0.5)), random.dq);
  if (rng.Chance(0.2)) random.dq *= 3.0;  // turns of several times π
  return random;
}

struct Tally {
  int motions = 0, certified = 0, late = 0, phantom = 0;
  std::map<CcdOutcome, int> outcomes;
  long poses = 0, distances = 0, most_poses = 0;
  double seconds = 0.0;
};

// Walks the motion at 1e-3 and compares. Late: an overlap before the answer's t.
void Judge(const Case& random, const CcdResult& result, const CcdOptions& options, Tally& tally) {
  constexpr double kSample = 1e-3, kError = 1e-7;
  const mjModel& m = random.scene.tables().query_model;
  const KeptPair& pair = random.scene.tables().pairs[0];
  const DataPtr d(mj_makeData(&m));
  VectorXd q;
  auto distance = [&](double s) {
    Integrate(random.scene.tables(), random.q0, s * random.dq, q);
    mju_copy(d->qpos, q.data(), static_cast<int>(q.size()));
    mj_kinematics(&m, d.get());
    return IndependentDistance(m, d.get(), pair.geom1, pair.geom2, 1.0);
  };
  ++tally.motions;
  ++tally.outcomes[result.outcome];
  tally.certified += result.certified;
  tally.poses += result.poses;
  tally.distances += result.distance_queries;
  tally.most_poses = std::max<long>(tally.most_poses, result.poses);
  const double start = distance(0.0);
  if (result.outcome == CcdOutcome::kStartInCollision) {
    tally.phantom += start > kError;
    return;
  }
  bool late = false;
  for (double s = 0.0; s < result.t; s += kSample) {
    late |= distance(s) < -options.tolerance - kError;
  }
  const double at_end = distance(result.t);
  late |= at_end < -options.tolerance - kError;
  // A contact is one: nearer than the gap, and not touching yet if the start was clear.
  if (result.outcome == CcdOutcome::kContact) {
    tally.phantom += at_end > options.gap + kError;
    late |= start > options.gap && at_end < 0.25 * options.gap;
  }
  tally.late += late;
  EXPECT_FALSE(late) << TypeName(m.geom_type[pair.geom1]) << "-"
                     << TypeName(m.geom_type[pair.geom2]) << " t " << result.t << "\nq0 "
                     << Join(random.q0) << "\ndq " << Join(random.dq);
}

Tally RandomMotions(int per_pair, std::uint64_t seed) {
  Random rng(seed);
  Tally tally;
  const std::vector<int>& types = ConvexTypes();
  for (std::size_t i = 0; i < types.size(); ++i) {
    for (std::size_t j = std::max<std::size_t>(i, 1); j < types.size(); ++j) {
      for (int k = 0; k < per_pair; ++k) {
        const Case random = RandomCase(types[i], types[j], rng);
        ContactFinder finder(random.scene.tables());
        Ccdg ccdg(random.scene.tables(), finder);
        const CcdOptions options;
        const auto begin = std::chrono::steady_clock::now();
        const CcdResult& result = ccdg.Move(random.q0, random.dq, options);
        tally.seconds +=
            std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
        Judge(random, result, options, tally);
      }
    }
  }
  auto share = [&tally](CcdOutcome outcome) {
    return 100.0 * tally.outcomes[outcome] / tally.motions;
  };
  std::printf(
      "  %d motions: %.1f %% certified, %.1f %% free, %.1f %% contact, %.1f %% start in "
      "collision; %.1f poses and %.1f distances each (most poses %ld), %.1f us each; "
      "late %d, phantom %d\n",
      tally.motions, 100.0 * tally.certified / tally.motions, share(CcdOutcome::kFree),
      share(CcdOutcome::kContact), share(CcdOutcome::kStartInCollision),
      double(tally.poses) / tally.motions, double(tally.distances) / tally.motions,
      tally.most_poses, 1e6 * tally.seconds / tally.motions, tally.late, tally.phantom);
  return tally;
}

void ExpectGood(const Tally& tally) {
  EXPECT_EQ(tally.late, 0);
  EXPECT_EQ(tally.phantom, 0);
  EXPECT_EQ(tally.certified, tally.motions);
  EXPECT_LT(tally.poses, 40L * tally.motions);
  Tally copy = tally;  // not empty: all outcomes happen
  EXPECT_GT(copy.outcomes[CcdOutcome::kFree], tally.motions / 10);
  EXPECT_GT(copy.outcomes[CcdOutcome::kContact], tally.motions / 10);
  EXPECT_GT(copy.outcomes[CcdOutcome::kStartInCollision], tally.motions / 50);
}

TEST_F(CcdgRandomTest, NoMotionOfTwoGeomsEndsLate) { ExpectGood(RandomMotions(40, 11)); }

// The 20,000 of the specification; minutes. MJCF_PDG_LONG_TESTS=1 runs it.
TEST_F(CcdgRandomTest, NoneOf20000MotionsOfTwoGeomsEndsLate) {
  if (!std::getenv("MJCF_PDG_LONG_TESTS")) GTEST_SKIP() << "long: set MJCF_PDG_LONG_TESTS=1";
  ExpectGood(RandomMotions(741, 12));
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
  EXPECT_GT(result.q[0], -0.00105 - mover.options.gap);
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
  EXPECT_LE(near.distance, mover.options.gap);
}

TEST_F(CcdgTest, ACapsuleIsStoppedByABoxThatMuJoCoLetsItPierce) {
  // See capsule_box.h: to MuJoCo many of the targets look free.
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
    if (CapsuleBoxByTernarySearch(*posed.model(), *posed.data(), 0, 1) > -1e-4) continue;
    EXPECT_EQ(mover.Move(q0, q1).outcome, CcdOutcome::kContact);
    mj_collision(posed.model(), posed.data());
    missed += posed.data()->ncon == 0;
    ++overlapping;
  }
  std::printf("  %d of %d overlapping targets have no contact in MuJoCo\n", missed, overlapping);
  EXPECT_GT(missed, overlapping / 100);
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
  q0[2] += 0.5 * mover.options.gap;
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
    const CcdResult& result = mover.ccdg.Move(q0, dq, mover.options);
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

TEST_F(CcdgTest, AHeightFieldStopsAMotionButCertifiesNothing) {
  Mover mover(World(R"(<geom type="hfield" hfield="hills"/>
      <body pos="0 0 1"><freejoint/><geom size=".1"/></body>)",
                    R"(<asset><hfield name="hills" nrow="3" ncol="3" size="1 1 .2 .1"
      elevation="0 0 0 0 1 0 0 0 0"/></asset>)"));
  VectorXd q0 = ToEigen(mover.scene.DefaultQpos()), q1 = q0;
  q1[2] = -0.5;
  const CcdResult& result = mover.Move(q0, q1);
  EXPECT_EQ(result.outcome, CcdOutcome::kContact);
  EXPECT_FALSE(result.certified);
  EXPECT_NEAR(result.q[2], 0.3, 2e-3);
  EXPECT_GT(result.contact_queries, 0);
  q1[2] = 2.0;  // away from it: a sphere is proof enough... once it is far
  EXPECT_EQ(mover.Move(q0, q1).outcome, CcdOutcome::kFree);
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

// Whole robots: no kept pair overlaps on the way; asked of ContactFinder at 1/500 of it.
TEST_F(CcdgRandomTest, NoMotionOfARobotAmongObstaclesEndsLate) {
  Random rng(8);
  long poses = 0, motions = 0, contacts = 0, free = 0;
  for (int model = 0; model < 8; ++model) {
    RobotOptions robot;
    robot.free_base = model % 2 == 1;
    Mover mover(RandomRobotXml(rng, robot));
    const SceneTables& tables = mover.scene.tables();
    for (int i = 0; i < 40; ++i) {
      const VectorXd q0 = RandomConfiguration(mover.scene, rng);
      const VectorXd q1 = RandomConfiguration(mover.scene, rng);
      VectorXd q, dq;
      Difference(tables, q0, q1, dq);
      const CcdResult result = mover.ccdg.Move(q0, dq, mover.options);
      if (result.outcome == CcdOutcome::kStartInCollision) continue;
      ++motions;
      poses += result.poses;
      contacts += result.outcome == CcdOutcome::kContact;
      free += result.outcome == CcdOutcome::kFree;
      EXPECT_TRUE(result.certified);
      EXPECT_LE(LimitExcess(tables, result.q), 1.1e-9);
      for (int k = 0; k <= 500; ++k) {
        Integrate(tables, q0, dq * (result.t * k / 500), q);
        mover.finder.Pose(q);
        for (const NearPair& near : mover.finder.Find(0.0)) {
          if (!tables.pairs[near.pair].moves) continue;
          EXPECT_GE(near.distance, -1.1e-6) << Join(q0) << "\n" << Join(dq) << "\n" << k;
        }
      }
    }
  }
  std::printf("  %ld motions, %ld contacts, %ld free, %.1f poses each\n", motions, contacts, free,
              double(poses) / motions);
  EXPECT_GT(contacts, 30);
  EXPECT_LT(poses, 60 * motions);
}

}  // namespace
}  // namespace mjcf_pdg::test
