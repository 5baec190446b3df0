// What the verifier says of height fields, against brute force over prisms and closed forms, and
// that it refuses what is wrong.
#include "verify/terrain_pair.h"

#include <gmock/gmock.h>

#include <cmath>

#include "mjcf_pdg/pdg.h"
#include "model/scene_tables.h"
#include "tests/support/terrain.h"

namespace mjcf_pdg::test {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using ::testing::HasSubstr;

class TerrainPairTest : public MujocoTest {};

std::vector<double> At(const Vector3d& p, const Quaterniond& turn = Quaterniond::Identity()) {
  return {p.x(), p.y(), p.z(), turn.w(), turn.x(), turn.y(), turn.z()};
}

TEST_F(TerrainPairTest, RandomPosesAreJudgedAsByBruteForce) {
  Random rng(4);
  int free = 0, overlapping = 0;
  for (int trial = 0; trial < 90; ++trial) {
    const int type = std::array{mjGEOM_SPHERE,   mjGEOM_CAPSULE, mjGEOM_ELLIPSOID,
                                mjGEOM_CYLINDER, mjGEOM_BOX,     mjGEOM_MESH}[trial % 6];
    Field field = NoisyField(5, 4, 0.5, 0.4, 0.25, rng);
    const Quaterniond turn = rng.UnitQuat();
    const double quat[] = {turn.w(), turn.x(), turn.y(), turn.z()};
    field.pose = "quat='" + Join(quat, 4) + "'";
    const Shape shape = RandomShape(type, rng);
    const std::vector<double> q =
        At(turn * Vector3d(rng.Uniform(-0.6, 0.6), rng.Uniform(-0.5, 0.5), rng.Uniform(-0.4, 0.5)),
           rng.UnitQuat());
    SCOPED_TRACE(TypeName(type) + " at " + Join(ToEigen(q)));
    PrismOracle oracle(FieldWithPrismsXml(field, shape));
    oracle.Pose(ToEigen(q));
    const double brute = oracle.Distance();
    if (std::abs(brute) < 1e-4) continue;
    const Scene scene = Scene::FromString(FieldXml(field, shape));
    const Verdict verdict = Verify(scene, q);
    EXPECT_TRUE(verdict.certified);
    EXPECT_EQ(verdict.free, brute > 0.0);
    EXPECT_EQ(Solver(scene).IsFree(q), brute > 0.0);
    if (brute > 0.0) {
      ++free;
      EXPECT_NEAR(verdict.min_distance, std::min(brute, 1.0), 2e-5);
      Options options;
      options.clearance = brute - 2e-5;
      EXPECT_TRUE(Verify(scene, q, options).free);
      options.clearance = brute + 2e-5;
      EXPECT_FALSE(Verify(scene, q, options).free);
      continue;
    }
    ++overlapping;
    ASSERT_EQ(verdict.contacts.size(), 1u);
    const Contact& contact = verdict.contacts[0];
    const Vector3d n(contact.normal_W[0], contact.normal_W[1], contact.normal_W[2]);
    EXPECT_LT(contact.distance, brute + 2e-5);
    EXPECT_NEAR(contact.distance, verdict.min_distance, 1e-12);
    // Moved by its depth it is free, moved by less it is not.
    EXPECT_TRUE(Verify(scene, At(Vector3d(ToEigen(q).head<3>()) + 1e-7 * n - contact.distance * n,
                                 Quaterniond(q[3], q[4], q[5], q[6])))
                    .free);
    EXPECT_FALSE(Verify(scene, At(Vector3d(ToEigen(q).head<3>()) - 1e-5 * n - contact.distance * n,
                                  Quaterniond(q[3], q[4], q[5], q[6])))
                     .free);
  }
  EXPECT_GT(free, 20);
  EXPECT_GT(overlapping, 30);
}

TEST_F(TerrainPairTest, TheToleranceIsATranslationOutOfTheWholeField) {
  const Field valley = MakeField(5, 5, 1, 1, [](double x, double) { return 3 * std::abs(x); });
  const Scene scene = Scene::FromString(FieldXml(valley, {mjGEOM_SPHERE, {0.1, 0, 0}}));
  const double touching = 0.1 * std::sqrt(10.0);
  EXPECT_TRUE(Verify(scene, At({0, 0.1, touching - 0.9e-6})).free);
  // Each side is overlapped by a third of this, but the way out is as long as it is.
  EXPECT_FALSE(Verify(scene, At({0, 0.1, touching - 1.1e-6})).free);
  EXPECT_NEAR(Verify(scene, At({0, 0.1, touching - 1e-3})).min_distance, -1e-3, 1e-9);
}

TEST_F(TerrainPairTest, SidesAndBaseHaveTheTolerance) {
  const Field field = MakeField(3, 3, 1, 1, [](double x, double) { return x == 0 ? 0.2 : 0.0; });
  const Scene scene = Scene::FromString(FieldXml(field, {mjGEOM_BOX, {0.1, 0.1, 0.01}}));
  for (const double e : {0.9e-6, 1.1e-6}) {
    EXPECT_EQ(Verify(scene, At({1.1 - e, 0, -0.05})).free, e < 1e-6) << "in its side";
    EXPECT_EQ(Verify(scene, At({0.3, -1.1 + e, -0.05})).free, e < 1e-6) << "in another";
    EXPECT_EQ(Verify(scene, At({0, 0, -0.11 + e})).free, e < 1e-6) << "in its base";
    EXPECT_EQ(Verify(scene, At({0, 0, 0.21 - e})).free, e < 1e-6) << "on the ridge";
  }
}

// The verifier reads the model by itself: heights that are wrong by 50 µm for the solver alone must
// not pass.
TEST_F(TerrainPairTest, AnAnswerForAnotherFieldIsRefused) {
  Random rng(9);
  Field field = NoisyField(9, 9, 0.5, 0.5, 0.1, rng);
  field.base = 2.0;  // so that all go up
  Field higher = field;
  higher.base = field.base - 5e-5;
  higher.pose = "pos='0 0 5e-5'";
  int refused = 0;
  for (int trial = 0; trial < 12; ++trial) {
    const Shape shape = RandomShape(trial % 2 ? mjGEOM_BOX : mjGEOM_CAPSULE, rng);
    const Scene scene = Scene::FromString(FieldXml(field, shape));
    const Result result = Solver(scene).Solve(
        At({rng.Uniform(-0.3, 0.3), rng.Uniform(-0.3, 0.3), 0.05}, rng.UnitQuat()));
    ASSERT_EQ(result.status, Status::kSolved) << result.reason;
    EXPECT_TRUE(Verify(scene, result.q).free);
    refused += !Verify(Scene::FromString(FieldXml(higher, shape)), result.q).free;
  }
  EXPECT_EQ(refused, 12);
}

TEST_F(TerrainPairTest, AMeshThatIsAskedForAsTrianglesIsItsHullOnTerrain) {
  Random rng(3);
  SceneOptions options;
  options.exact_mesh = true;
  const Scene scene = Scene::FromString(
      FieldXml(NoisyField(4, 4, 1, 1, 0.1, rng), RandomShape(mjGEOM_MESH, rng)), options);
  EXPECT_EQ(scene.tables().pairs.at(0).kind, PairKind::kTerrain);
  EXPECT_FALSE(Verify(scene, At({0, 0, 0})).free);
  EXPECT_TRUE(Verify(scene, At({0, 0, 0})).certified);
}

}  // namespace
}  // namespace mjcf_pdg::test
