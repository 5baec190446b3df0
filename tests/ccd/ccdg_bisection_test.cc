// What the bisection itself promises: proofs carried down, splits, sizes that do not matter.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "ccd/ccdg.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

class CcdgBisectionTest : public MujocoTest {};

CcdResult Move(const Scene& scene, const VectorXd& q0, const VectorXd& dq,
               const CcdOptions& options = {}) {
  ContactFinder finder(scene.tables());
  return Ccdg(scene.tables(), finder).Move({q0, dq}, options);
}

// Of the nearest of the pairs that a motion names, where it ends.
double Nearest(const Scene& scene, const CcdResult& result) {
  ContactFinder finder(scene.tables());
  finder.Pose(result.q);
  double nearest = 1.0;
  for (const int pair : result.pairs) {
    NearPair near;
    if (finder.Distance(pair, 1.0, near)) nearest = std::min(nearest, near.distance);
  }
  return nearest;
}

CcdResult MoveFromDefault(const std::string& xml, const VectorXd& dq, const CcdOptions& options) {
  const Scene scene = Scene::FromString(xml);
  return Move(scene, ToEigen(scene.DefaultQpos()), dq, options);
}

CcdOptions Halving(bool halve) {
  CcdOptions options;
  options.halve = halve;
  return options;
}

// ---- Proofs are carried down ----

std::string World(const std::string& inside) {
  return "<mujoco><worldbody>" + inside + "</worldbody></mujoco>";
}

// A ball that slides past another at a millimetre; with a slab at its side that slides over another
// slab, so near that no bounding volume proves anything, but its one distance proves all.
std::string Sliding(const std::string& slab, const std::string& other_slab) {
  return World("<geom size='.5'/>" + other_slab +
               "<body pos='-2 1.001 0'><joint type='slide' axis='1 0 0'/><geom size='.5'/>" + slab +
               "</body>");
}

TEST_F(CcdgBisectionTest, APairProvenOnAnIntervalIsNotAskedAgainInItsParts) {
  const VectorXd way = VectorXd::Constant(1, 4.0);
  for (const bool halve : {false, true}) {
    const CcdResult ball = MoveFromDefault(Sliding("", ""), way, Halving(halve));
    const CcdResult both =
        MoveFromDefault(Sliding("<geom type='box' size='1 1 .1' pos='0 49 .25'/>",
                                "<geom type='box' size='9 1 .1' pos='0 50 0'/>"),
                        way, Halving(halve));
    EXPECT_EQ(ball.outcome, CcdOutcome::kFree);
    EXPECT_EQ(both.outcome, CcdOutcome::kFree);
    EXPECT_GE(ball.poses, 3);  // several parts
    EXPECT_EQ(both.poses, ball.poses);
    EXPECT_EQ(both.distance_queries, ball.distance_queries + 1);
  }
}

// A rod that turns six times past a post at 1 cm.
constexpr char kRod[] = R"(<geom type="capsule" size=".01" fromto=".31 0 -1 .31 0 1"/>
    <body><joint axis="0 0 1"/><geom type="capsule" size=".01" fromto="0 0 0 .28 0 0"/></body>)";

TEST_F(CcdgBisectionTest, ProofsFromBothEndsSavePoses) {
  const VectorXd turns = VectorXd::Constant(1, 40.0);
  const CcdResult split = MoveFromDefault(World(kRod), turns, Halving(false));
  EXPECT_EQ(split.outcome, CcdOutcome::kFree);
  EXPECT_LE(split.poses, 35);  // 39 where a pose is asked only where the proofs end
  const CcdResult halved = MoveFromDefault(World(kRod), turns, Halving(true));
  EXPECT_EQ(halved.outcome, CcdOutcome::kFree);
  EXPECT_LE(halved.poses, 45);  // 59 where what an end proves is forgotten until it is asked again
}

// ---- Both ways of splitting ----

TEST_F(CcdgBisectionTest, HalvingFindsTheSameContacts) {
  Random rng(31);
  int contacts = 0, free = 0, more = 0;
  for (int model = 0; model < 6; ++model) {
    RobotOptions robot;
    robot.free_base = model % 2 == 1;
    const Scene scene = Scene::FromString(RandomRobotXml(rng, robot));
    for (int i = 0; i < 40; ++i) {
      const VectorXd q0 = RandomConfiguration(scene, rng);
      VectorXd dq;
      Difference(scene.tables(), q0, RandomConfiguration(scene, rng), dq);
      const CcdResult split = Move(scene, q0, dq), halved = Move(scene, q0, dq, Halving(true));
      EXPECT_EQ(split.outcome, halved.outcome) << Join(q0) << "\n" << Join(dq);
      contacts += split.outcome == CcdOutcome::kContact;
      free += split.outcome == CcdOutcome::kFree;
      more += halved.poses > split.poses;
      if (split.outcome != CcdOutcome::kContact) continue;
      for (const CcdResult* result : {&split, &halved}) {
        EXPECT_LE(Nearest(scene, *result), 1.01 * CcdOptions().Gap()) << Join(q0) << Join(dq);
      }
      // The band is crossed slowly where the approach is flat.
      EXPECT_NEAR(split.t, halved.t, 1e-3);
    }
  }
  EXPECT_GT(contacts, 50);
  EXPECT_GT(free, 5);
  EXPECT_GT(more, contacts / 2);
}

// At t = 1/2, which halving asks second, one ball is within the band of another: that is no contact
// before the other ball has passed its post at t = 1/4, a millimetre away.
TEST_F(CcdgBisectionTest, AContactAheadStopsNothingBeforeTheWayThereIsProven) {
  const CcdResult result = MoveFromDefault(
      World("<geom size='.1' pos='.1200018 .1600024 0'/><geom size='.5' pos='-1 51.001 0'/>"
            "<body pos='-2 0 0'><joint type='slide' axis='1 0 0'/><geom size='.1'/>"
            "<geom size='.5' pos='0 50 0'/></body>"),
      VectorXd::Constant(1, 4.0), Halving(true));
  EXPECT_EQ(result.outcome, CcdOutcome::kContact);
  EXPECT_NEAR(result.t, 0.5, 1e-6);
  EXPECT_EQ(result.pairs.size(), 1u);
}

// ---- Degenerate motions ----

TEST_F(CcdgBisectionTest, AMotionMayBeNothingOrNextToNothing) {
  Random rng(32);
  const Scene scene = Scene::FromString(RandomRobotXml(rng));
  const SceneTables& tables = scene.tables();
  int free = 0;
  for (int i = 0; i < 60; ++i) {
    const VectorXd q0 = RandomConfiguration(scene, rng);
    CcdOptions options = Halving(i % 2 == 0);
    const VectorXd direction = rng.Normals(tables.n);
    const CcdOutcome still = Move(scene, q0, 0.0 * direction, options).outcome;
    EXPECT_EQ(still, CcdOutcome::kFree);  // nothing moves, nothing is asked
    options.still_pairs = true;
    const CcdResult asked = Move(scene, q0, 0.0 * direction, options);
    EXPECT_EQ(asked.poses, 1);
    free += asked.outcome == CcdOutcome::kFree;
    for (const double size : {1e-300, 1e-20, 1e-15, 1e-12}) {
      const CcdResult tiny = Move(scene, q0, size * direction, options);
      EXPECT_EQ(tiny.outcome, asked.outcome) << size << "\n" << Join(q0);
      EXPECT_EQ(tiny.poses, 1);
    }
  }
  EXPECT_GT(free, 5);
  EXPECT_LT(free, 55);
}

TEST_F(CcdgBisectionTest, AThousandTurnsEndInFreedomContactOrTheBudget) {
  for (const double clearance : {10.0, 1e-3, -1e-3}) {  // between the rod's end and the post
    const std::string post = std::to_string(0.28 + 0.02 + clearance);
    const std::string xml =
        World("<geom type='capsule' size='.01' fromto='" + post + " 0 -1 " + post +
              " 0 1'/><body><joint axis='0 0 1' ref='180'/>"
              "<geom type='capsule' size='.01' fromto='0 0 0 -.28 0 0'/></body>");
    for (const bool halve : {false, true}) {
      CcdOptions options = Halving(halve);
      options.max_poses = 500;
      const CcdResult result = MoveFromDefault(xml, VectorXd::Constant(1, 2000.0 * M_PI), options);
      EXPECT_LE(result.poses, 500);
      if (clearance > 1.0) {
        EXPECT_EQ(result.outcome, CcdOutcome::kFree);
      }
      if (clearance == 1e-3) {
        EXPECT_EQ(result.outcome, CcdOutcome::kBudget);
      }
      if (clearance < 0.0 && !halve) {
        EXPECT_EQ(result.outcome, CcdOutcome::kContact);
        EXPECT_NEAR(result.t, 1.0 / 2000.0, 5e-5);
      }
    }
  }
}

TEST_F(CcdgBisectionTest, ASlidesLimitIsHeldToAShareOfTheTolerance) {
  const Scene scene =
      Scene::FromString(World("<body><joint type='slide' range='-1 1'/><geom size='.1'/></body>"));
  for (const double tolerance : {1e-6, 1e-9, 1e-3}) {
    CcdOptions options;
    options.tolerance = tolerance;
    const VectorXd q0 = VectorXd::Zero(1);
    const VectorXd within = VectorXd::Constant(1, 1.0 + 0.5e-3 * tolerance);
    const VectorXd beyond = VectorXd::Constant(1, 1.0 + 2e-3 * tolerance);
    EXPECT_EQ(Move(scene, q0, within, options).outcome, CcdOutcome::kFree);
    EXPECT_EQ(Move(scene, q0, beyond, options).outcome, CcdOutcome::kLimit);
  }
}

// ---- Sizes do not matter ----

// The same model with every length `scale` times as long; a power of two changes no digit.
void ScaleLengths(mjModel& m, double scale) {
  auto times = [scale](mjtNum* values, int n) { mju_scl(values, values, scale, n); };
  times(m.body_pos, 3 * m.nbody);
  times(m.body_ipos, 3 * m.nbody);
  times(m.jnt_pos, 3 * m.njnt);
  times(m.geom_pos, 3 * m.ngeom);
  times(m.geom_size, 3 * m.ngeom);
  times(m.geom_aabb, 6 * m.ngeom);
  times(m.geom_rbound, m.ngeom);
  for (int j = 0; j < m.njnt; ++j) {
    mjtNum* qpos0 = m.qpos0 + m.jnt_qposadr[j];
    if (m.jnt_type[j] == mjJNT_FREE) times(qpos0, 3);
    if (m.jnt_type[j] != mjJNT_SLIDE) continue;
    times(qpos0, 1);
    times(m.jnt_range + 2 * j, 2);
  }
  for (int k = 0; k < 3 * m.nmeshvert; ++k) m.mesh_vert[k] *= static_cast<float>(scale);
}

// A configuration or a tangent: its metres are multiplied.
void ScaleSlides(const SceneTables& tables, bool tangent, double scale, VectorXd& values) {
  for (const JointEntry& joint : tables.joints) {
    const int at = tangent ? joint.col : joint.qadr;
    if (joint.type == mjJNT_SLIDE) values[at] *= scale;
    if (joint.type == mjJNT_FREE) values.segment<3>(at) *= scale;
  }
}

bool Curved(int type) { return type == mjGEOM_ELLIPSOID || type == mjGEOM_CYLINDER; }
bool Round(int type) { return type <= mjGEOM_CAPSULE; }  // planes, spheres, capsules

// Distances of these pairs are the same to the last digit at any scale; iterations for the others
// end at absolute tolerances.
bool DistancesScale(int type1, int type2) {
  const bool curved = Curved(type1) || Curved(type2);
  return type1 == mjGEOM_PLANE || (!curved && (Round(type1) || Round(type2)));
}

Scene RandomPair(int type1, int type2, Random& rng, std::string& xml) {
  TwoGeoms geoms;
  geoms.first = RandomShape(type1, rng);
  geoms.second = RandomShape(type2, rng);
  geoms.joint1 = "";
  geoms.joint2 = "<joint type='slide' axis='1 2 0'/><joint type='ball' pos='.1 .2 0'/>";
  geoms.pose2 = "pos='.3 .6 .1'";
  xml = TwoGeomXml(geoms);
  return Scene::FromString(xml);
}

TEST_F(CcdgBisectionTest, ScenesATiny1024thOrAHuge1024TimesBehaveAlike) {
  Random rng(33);
  int contacts = 0, free = 0, motions = 0;
  for (const int type1 : ConvexTypes()) {
    for (const int type2 : ConvexTypes()) {
      if (type1 > type2 || type2 == mjGEOM_PLANE) continue;
      for (int i = 0; i < 40; ++i) {
        std::string xml;
        const Scene scene = RandomPair(type1, type2, rng, xml);
        const ModelPtr scaled_model = LoadModel(xml);
        const double scale = i % 2 == 0 ? 0x1p-10 : 0x1p10;
        ScaleLengths(*scaled_model, scale);
        const Scene scaled = Scene::FromModel(scaled_model.get());
        VectorXd q0 = RandomConfiguration(scene, rng, 2.0), dq;
        Difference(scene.tables(), q0, RandomConfiguration(scene, rng, 2.0), dq);
        CcdOptions options = Halving(i % 4 < 2);
        const CcdResult usual = Move(scene, q0, dq, options);
        ScaleSlides(scene.tables(), false, scale, q0);
        ScaleSlides(scene.tables(), true, scale, dq);
        options.tolerance *= scale;
        const CcdResult other = Move(scaled, q0, dq, options);
        EXPECT_EQ(usual.outcome, other.outcome) << TypeName(type1) << " " << TypeName(type2);
        EXPECT_NEAR(usual.t, other.t, 1e-4) << scale << "\n" << xml << Join(q0) << "\n" << Join(dq);
        ++motions;
        contacts += usual.outcome == CcdOutcome::kContact;
        free += usual.outcome == CcdOutcome::kFree;
        if (!DistancesScale(type1, type2)) continue;
        EXPECT_EQ(usual.t, other.t) << scale << "\n" << xml << Join(q0) << "\n" << Join(dq);
        EXPECT_EQ(usual.poses, other.poses);
        EXPECT_EQ(usual.distance_queries, other.distance_queries);
      }
    }
  }
  EXPECT_GT(contacts, motions / 4);
  EXPECT_GT(free, motions / 4);
}

}  // namespace
}  // namespace mjcf_pdg::test
