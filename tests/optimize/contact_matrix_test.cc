#include "optimize/contact_matrix.h"

#include <cmath>

#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

class ContactMatrixTest : public MujocoTest {
 protected:
  Random rng_{71};
};

double DistanceAt(ContactFinder& finder, const VectorXd& q) {
  finder.Pose(q);
  const std::vector<NearPair>& near = finder.Find(1.0);
  return near.empty() ? 1.0 : near[0].distance;
}

// Central difference of the only pair's distance along each degree of freedom.
VectorXd DistanceGradient(const Scene& scene, ContactFinder& finder, const VectorXd& q,
                          double step) {
  VectorXd gradient(scene.dof()), moved;
  for (int i = 0; i < scene.dof(); ++i) {
    Integrate(scene.tables(), q, step * VectorXd::Unit(scene.dof(), i), moved);
    const double plus = DistanceAt(finder, moved);
    Integrate(scene.tables(), q, -step * VectorXd::Unit(scene.dof(), i), moved);
    gradient[i] = (plus - DistanceAt(finder, moved)) / (2 * step);
  }
  return gradient;
}

struct Tally {
  int compared = 0, overlapping = 0, kinks = 0;
};

// MuJoCo's depth of an overlapping ellipsoid is rough, and so are its differences.
double Tolerance(const Scene& scene, double distance) {
  const int* type = scene.model()->geom_type;
  const bool ellipsoid = type[0] == mjGEOM_ELLIPSOID || type[1] == mjGEOM_ELLIPSOID;
  return ellipsoid && distance < 0 ? 5e-2 : 4e-3;
}

// Compares one row with differences of the distance unless that has a kink at q.
void CompareRow(const Scene& scene, const VectorXd& q, Tally& tally) {
  ContactFinder finder(scene.tables());
  const double distance = DistanceAt(finder, q);
  if (std::abs(distance) < 1e-3 || distance == 1.0) return;
  const VectorXd coarse = DistanceGradient(scene, finder, q, 4e-4);
  const VectorXd fine = DistanceGradient(scene, finder, q, 1e-4);
  if ((coarse - fine).lpNorm<Eigen::Infinity>() > 2e-3) {
    ++tally.kinks;
    return;
  }
  finder.Pose(q);
  const NearPair near = finder.Find(1.0)[0];
  Eigen::RowVectorXd row(scene.dof());
  ContactRow(scene.tables(), finder.posed(), near.pair, near.p1_W, near.p2_W, near.n_W, row);
  EXPECT_LT((row.transpose() - fine).lpNorm<Eigen::Infinity>(), Tolerance(scene, distance))
      << "row " << Join(row) << "\nfd  " << Join(fine) << "\nq   " << Join(q) << "\nd   "
      << distance;
  ++tally.compared;
  tally.overlapping += distance < 0;
}

TEST_F(ContactMatrixTest, RowsAreTheRateOfTheDistanceForAllTypesAndJoints) {
  const std::string ball = "<joint type='ball' pos='.1 .05 -.1'/>";
  const std::string hinge = "<joint axis='.2 1 .4' pos='-.1 .1 .02'/>";
  const std::string slides =
      "<joint type='slide' axis='1 .3 0'/><joint axis='0 .2 1' pos='.1 0 0'/>";
  const std::string joints[][2] = {{"<freejoint/>", ""}, {ball, hinge}, {slides, ball}};
  int all = 0;
  Tally total;
  for (const int type1 : ConvexTypes()) {
    for (const int type2 : ConvexTypes()) {
      if (type1 == mjGEOM_PLANE) continue;
      SCOPED_TRACE(TypeName(type1) + " and " + TypeName(type2));
      Tally tally;
      for (int trial = 0; trial < 60; ++trial) {
        TwoGeoms scene;
        scene.first = RandomShape(type1, rng_);
        scene.second = RandomShape(type2, rng_);
        scene.joint1 = joints[trial % 3][0];
        scene.joint2 = type2 == mjGEOM_PLANE ? "" : joints[trial % 3][1];
        const Vector3d apart = rng_.InBox(0.3);
        scene.pose1 = "pos='" + Join(apart.data(), 3) + "'";
        const Scene posed = Scene::FromString(TwoGeomXml(scene));
        CompareRow(posed, RandomConfiguration(posed, rng_, 0.2), tally);
        ++all;
      }
      EXPECT_GE(tally.compared, 40);
      total.compared += tally.compared;
      total.overlapping += tally.overlapping;
      total.kinks += tally.kinks;
    }
  }
  EXPECT_GT(total.compared, all * 7 / 10);
  EXPECT_GT(total.overlapping, all / 5);
  RecordProperty("compared", total.compared);
  RecordProperty("kinks", total.kinks);
}

// A long thin capsule through a box: faces and crossed edges.
TEST_F(ContactMatrixTest, RowsOfPiercingCapsulesAreTheRateOfTheDepth) {
  Tally tally;
  for (int trial = 0; trial < 200; ++trial) {
    const Scene scene = Scene::FromString(
        TwoGeomXml({.first = {mjGEOM_CAPSULE, {0.02, rng_.Uniform(0.1, 0.6), 0}},
                    .second = {mjGEOM_BOX, Vector3d::Constant(0.15) + rng_.InBox(0.1)},
                    .joint2 = "<joint type='ball' pos='.1 .05 -.1'/>"}));
    CompareRow(scene, RandomConfiguration(scene, rng_, 0.15), tally);
  }
  EXPECT_GT(tally.compared, 150);
  EXPECT_GT(tally.overlapping, 60);
}

// What `row` has outside of `support` is 0, and each range begins and ends with another entry, so
// that none is wider than it has to be.
void ExpectSupport(const Eigen::RowVectorXd& row, const Support& support) {
  Eigen::RowVectorXd rest = row;
  for (const ColumnRange& range : {support.first, support.second}) {
    if (range.size == 0) continue;
    EXPECT_NE(rest[range.begin], 0.0);  // also: the ranges do not overlap
    EXPECT_NE(rest[range.begin + range.size - 1], 0.0);
    rest.segment(range.begin, range.size).setZero();
  }
  EXPECT_TRUE(rest.isZero(0.0)) << Join(row);
}

bool Above(const mjModel& m, int dof, int body) {
  while (body > m.dof_bodyid[dof]) body = m.body_parentid[body];
  return body == m.dof_bodyid[dof];
}

TEST_F(ContactMatrixTest, RowsAreJacobianDifferencesAndExactlyZeroAboveBothBodies) {
  int common = 0;
  for (int robot = 0; robot < 20; ++robot) {
    const Scene all = Scene::FromString(RandomRobotXml(rng_, {.free_base = robot % 2 == 0}));
    const Scene some = Scene::FromModel(all.model(), {.movable = {"b0"}, .root = {}});
    for (const Scene* scene : {&all, &some}) {
      const mjModel& m = *scene->model();
      PosedModel posed(&scene->tables().query_model);
      posed.Pose(RandomConfiguration(*scene, rng_));
      for (int i = 0; i < scene->num_kept_pairs(); ++i) {
        const int body1 = m.geom_bodyid[scene->tables().pairs[i].geom1];
        const int body2 = m.geom_bodyid[scene->tables().pairs[i].geom2];
        const Vector3d p1 = rng_.InBox(1), p2 = rng_.InBox(1), n = rng_.UnitVector();
        BodyJacobians jac1, jac2;
        jac1.Fill(scene->tables(), posed, body1, p1);
        jac2.Fill(scene->tables(), posed, body2, p2);
        Eigen::RowVectorXd row = Eigen::RowVectorXd::Constant(scene->dof(), 7.0);
        ContactRow(scene->tables(), posed, i, p1, p2, n, row);
        ExpectSupport(row, RowSupport(scene->tables(), {.pair = i}));
        for (int dof = 0; dof < m.nv; ++dof) {
          const int col = scene->tables().column_of_dof[dof];
          if (col < 0) continue;
          if (Above(m, dof, body1) && Above(m, dof, body2)) {
            EXPECT_EQ(row[col], 0.0);
            ++common;
          } else {
            EXPECT_NEAR(row[col], n.dot(jac2.point.col(col) - jac1.point.col(col)), 1e-13);
          }
        }
      }
    }
  }
  EXPECT_GT(common, 500);
}

TEST_F(ContactMatrixTest, FrozenJointsHaveNoColumns) {
  const Scene all = Scene::FromString(ArmXml());
  const Scene some = Scene::FromModel(all.model(), {.movable = {"fore"}, .root = {}});
  PosedModel posed(&all.tables().query_model);
  posed.Pose(RandomConfiguration(all, rng_));
  ASSERT_EQ(some.dof(), 2);
  for (int i = 0; i < all.num_kept_pairs(); ++i) {
    const Vector3d p = rng_.InBox(1), n = rng_.UnitVector();
    Eigen::RowVectorXd full(4), part(2);
    ContactRow(all.tables(), posed, i, p, p, n, full);
    ContactRow(some.tables(), posed, i, p, p, n, part);
    EXPECT_EQ(full.tail(2), part);
  }
}

// The slack of a limit as AppendLimitRows means it, from one joint's rows.
double Slack(const Scene& scene, const VectorXd& q, int row) {
  ContactRows rows;
  rows.Clear(scene.dof());
  AppendLimitRows(scene.tables(), q, {100.0, 100.0, 1.0}, rows);
  return rows.gap[row];
}

TEST_F(ContactMatrixTest, LimitRowsAreTheRateOfTheSlack) {
  for (const std::string& xml : {ArmXml(), BallChainXml(true)}) {
    const Scene scene = Scene::FromString(xml);
    for (int trial = 0; trial < 20; ++trial) {
      VectorXd q = RandomConfiguration(scene, rng_);
      if (trial % 2) Integrate(scene.tables(), q, 0.3 * rng_.Normals(scene.dof()), q);
      if (trial % 3 == 0 && scene.nq() > 4) q.segment<4>(4) *= -1.0;
      ContactRows rows;
      rows.Clear(scene.dof());
      AppendLimitRows(scene.tables(), q, {100.0, 100.0, 1.0}, rows);
      ASSERT_EQ(rows.m, scene.nq() > 4 ? 3 : 6);
      EXPECT_NEAR(-rows.gap.head(rows.m).minCoeff() > 0 ? -rows.gap.head(rows.m).minCoeff() : 0.0,
                  LimitExcess(scene.tables(), q), 1e-12);
      for (int i = 0; i < rows.m; ++i) {
        for (int k = 0; k < scene.dof(); ++k) {
          constexpr double kStep = 1e-6;
          VectorXd plus, minus;
          Integrate(scene.tables(), q, kStep * VectorXd::Unit(scene.dof(), k), plus);
          Integrate(scene.tables(), q, -kStep * VectorXd::Unit(scene.dof(), k), minus);
          const double rate = (Slack(scene, plus, i) - Slack(scene, minus, i)) / (2 * kStep);
          EXPECT_NEAR(rows.C(i, k), rate, 1e-7) << Join(q);
        }
      }
    }
  }
}

TEST_F(ContactMatrixTest, OnlyLimitsWithinReachAppear) {
  const Scene arm = Scene::FromString(ArmXml());  // reach: -.05 .2
  VectorXd q = VectorXd::Zero(4);
  ContactRows rows;
  rows.Clear(4);
  AppendLimitRows(arm.tables(), q, {0.1, 0.1, 1.0}, rows);
  ASSERT_EQ(rows.m, 1);
  EXPECT_NEAR(rows.gap[0], 0.05, 1e-15);
  EXPECT_EQ(rows.C.row(0), Eigen::RowVector4d(0, 0, 1, 0));
  rows.Clear(4);
  q[2] = 0.19;
  AppendLimitRows(arm.tables(), q, {0.1, 0.1, 1.0}, rows);
  ASSERT_EQ(rows.m, 1);
  EXPECT_NEAR(rows.gap[0], 0.01, 1e-15);
  EXPECT_EQ(rows.C.row(0), Eigen::RowVector4d(0, 0, -1, 0));
}

TEST_F(ContactMatrixTest, AnUnturnedBallHasNoLimitRow) {
  const Scene chain = Scene::FromString(BallChainXml(true));
  ContactRows rows;
  rows.Clear(chain.dof());
  AppendLimitRows(chain.tables(), ToEigen(chain.DefaultQpos()), {100.0, 100.0, 1.0}, rows);
  EXPECT_EQ(rows.m, 0);
}

TEST_F(ContactMatrixTest, RowsGrowKeepTheirContentsAndStartOverAtZero) {
  ContactRows rows;
  for (const int n : {3, 5, 5, 2}) {
    rows.Clear(n);
    EXPECT_EQ(rows.m, 0);
    for (int i = 0; i < 100; ++i) {
      const int row = rows.Append(0.5 * i);
      ASSERT_EQ(row, i);
      EXPECT_EQ(rows.C.row(row).norm(), 0.0) << "left over from before";
      rows.C.row(row).setConstant(i + 1);
    }
    for (int i = 0; i < 100; ++i) {
      EXPECT_EQ(rows.C(i, n - 1), i + 1);
      EXPECT_EQ(rows.gap[i], 0.5 * i);
    }
  }
}

}  // namespace
}  // namespace mjcf_pdg::test
