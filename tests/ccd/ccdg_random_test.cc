// Random motions against brute force: never late.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>

#include "ccd/ccdg.h"
#include "tests/support/test_support.h"
#include "tests/support/trials.h"
#include "verify/verifier.h"

namespace mjcf_pdg::test {
namespace {

class CcdgRandomTest : public MujocoTest {};

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
bool Overlaps(ContactFinder& finder, const VectorXd& q) {
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
  ContactFinder finder(tables);
  auto pose = [&](bool overlap) {  // overlapping or not, if a few tries find one
    VectorXd q;
    for (int i = 0; i < 8; ++i) {
      Integrate(tables, ToEigen(random.scene.DefaultQpos()), 0.5 * rng.Normals(tables.n), q);
      if (Overlaps(finder, q) == overlap) break;
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
  constexpr double kSample = 1e-3, kError = 1e-7, kFar = 1e-4;
  const mjModel& m = random.scene.tables().query_model;
  const KeptPair& pair = random.scene.tables().pairs[0];
  const DataPtr d(mj_makeData(&m));
  VectorXd q;
  auto distance = [&](double s) {
    Integrate(random.scene.tables(), random.q0, s * random.dq, q);
    mju_copy(d->qpos, q.data(), static_cast<int>(q.size()));
    mj_kinematics(&m, d.get());
    return IndependentDistance(m, d.get(), pair.geom1, pair.geom2, kFar);
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
    tally.phantom += at_end > options.Gap() + kError;
    late |= start > options.Gap() && at_end < 0.25 * options.Gap();
  }
  tally.late += late;
  EXPECT_FALSE(late) << TypeName(m.geom_type[pair.geom1]) << "-"
                     << TypeName(m.geom_type[pair.geom2]) << " t " << result.t << "\nq0 "
                     << Join(random.q0) << "\ndq " << Join(random.dq);
}

Tally RandomMotions(int per_pair, std::uint64_t seed, const CcdOptions& options = {}) {
  Random rng(seed);
  Tally tally;
  const std::vector<int>& types = ConvexTypes();
  for (std::size_t i = 0; i < types.size(); ++i) {
    for (std::size_t j = std::max<std::size_t>(i, 1); j < types.size(); ++j) {
      for (int k = 0; k < per_pair; ++k) {
        const Case random = RandomCase(types[i], types[j], rng);
        ContactFinder finder(random.scene.tables());
        Ccdg ccdg(random.scene.tables(), finder);
        const auto begin = std::chrono::steady_clock::now();
        const CcdResult& result = ccdg.Move({random.q0, random.dq}, options);
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

// `poses`: a motion takes no more of them in the mean.
void ExpectGood(const Tally& tally, double poses) {
  EXPECT_EQ(tally.late, 0);
  EXPECT_EQ(tally.phantom, 0);
  EXPECT_EQ(tally.certified, tally.motions);
  EXPECT_LT(tally.poses, poses * tally.motions);
  Tally copy = tally;  // not empty: all outcomes happen
  EXPECT_GT(copy.outcomes[CcdOutcome::kFree], tally.motions / 10);
  EXPECT_GT(copy.outcomes[CcdOutcome::kContact], tally.motions / 10);
  EXPECT_GT(copy.outcomes[CcdOutcome::kStartInCollision], tally.motions / 50);
}

TEST_F(CcdgRandomTest, NoneOf20000MotionsOfTwoGeomsEndsLate) {
  const Tally tally = RandomMotions(Trials(744), 12);
  ExpectGood(tally, 2.8);
  EXPECT_GE(tally.motions, Trials(20000));
}

TEST_F(CcdgRandomTest, NoneOf2000MotionsOfTwoGeomsEndsLateWhenHalved) {
  CcdOptions options;
  options.halve = true;
  ExpectGood(RandomMotions(75, 11, options), 6.0);
}

// Whole robots: no kept pair overlaps on the way; asked of the independent check at 1/500 of it.
TEST_F(CcdgRandomTest, NoMotionOfARobotAmongObstaclesEndsLate) {
  Random rng(8);
  long poses = 0, motions = 0, contacts = 0, free = 0;
  for (int model = 0; model < 8; ++model) {
    RobotOptions robot;
    robot.free_base = model % 2 == 1;
    const Scene scene = Scene::FromString(RandomRobotXml(rng, robot));
    const SceneTables& tables = scene.tables();
    ContactFinder finder(tables);
    Ccdg ccdg(tables, finder);
    Verifier verifier(scene.verifier_model(), {});
    for (int i = 0; i < 40; ++i) {
      const VectorXd q0 = RandomConfiguration(scene, rng);
      const VectorXd q1 = RandomConfiguration(scene, rng);
      VectorXd q, dq;
      Difference(tables, q0, q1, dq);
      const CcdResult result = ccdg.Move({q0, dq});
      if (result.outcome == CcdOutcome::kStartInCollision) continue;
      ++motions;
      poses += result.poses;
      contacts += result.outcome == CcdOutcome::kContact;
      free += result.outcome == CcdOutcome::kFree;
      EXPECT_TRUE(result.certified);
      EXPECT_LE(LimitExcess(tables, result.q), 1.1e-9);
      for (int k = 0; k <= 500; ++k) {
        Integrate(tables, q0, dq * (result.t * k / 500), q);
        EXPECT_GE(verifier.Check(ToVector(q)).min_distance, -1.1e-6) << Join(q0) << "\n"
                                                                     << Join(dq) << "\n"
                                                                     << k;
      }
    }
  }
  std::printf("  %ld motions, %ld contacts, %ld free, %.1f poses each\n", motions, contacts, free,
              double(poses) / motions);
  EXPECT_GT(contacts, 30);
  EXPECT_LT(poses, 6 * motions);
}

}  // namespace
}  // namespace mjcf_pdg::test
