// An error planted in a step of the solver's side makes it call overlaps free; the verifier
// refuses every one of them.
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "collide/contacts.h"
#include "collide/convex/support_points.h"
#include "mjcf_pdg/pdg.h"
#include "tests/support/mesh_shapes.h"
#include "tests/support/test_support.h"
#include "verify/verifier.h"

namespace mjcf_pdg::test {
namespace {

constexpr double kSpread = 0.15, kTolerance = 1e-6, kClearlyTrue = 1e-5;  // [m]

class IndependenceTest : public MujocoTest {};

Scene TwoGeomScene(const std::string& first, const std::string& second,
                   const std::string& assets = "") {
  return Scene::FromString("<mujoco><asset>" + assets + "</asset><worldbody><geom " + first +
                           "/><body><freejoint/><geom " + second +
                           "/></body></worldbody></mujoco>");
}

// The solver's side of a scene, to plant an error in, and what it calls the least distance.
struct SolverSide {
  explicit SolverSide(const Scene& scene) : tables(scene.tables()) {}

  double Least(const std::vector<double>& q) {
    if (!finder) finder = std::make_unique<ContactFinder>(tables);
    finder->Pose(test::ToEigen(q));
    double least = 1.0;
    for (const NearPair& near : finder->Find(0.1)) least = std::min(least, near.distance);
    return least;
  }

  SceneTables tables;
  std::unique_ptr<ContactFinder> finder;
};

// Random poses: what a sound solver calls an overlap and the sabotaged one, reading through
// `reading`, calls free must be refused.
void ExpectRefusals(const Scene& scene, SolverSide& sabotaged,
                    const std::function<double(double)>& reading = {}) {
  SolverSide sound(scene);
  Verifier verifier(scene.verifier_model(), {});
  Random rng(71);
  int fooled = 0;
  for (int i = 0; i < 1500; ++i) {
    const std::vector<double> q = FreePose(rng.InBox(kSpread), rng.UnitQuat());
    const double told = sabotaged.Least(q);
    if ((reading ? reading(told) : told) < -kTolerance) continue;
    if (sound.Least(q) > -kClearlyTrue) continue;
    ++fooled;
    EXPECT_FALSE(verifier.IsFree(q)) << Join(test::ToEigen(q));
    EXPECT_FALSE(verifier.Check(q).free) << Join(test::ToEigen(q));
  }
  EXPECT_GT(fooled, 20) << "the planted error does no harm";
}

TEST_F(IndependenceTest, APairThatTheSolverHasLost) {
  const Scene scene = TwoGeomScene("type='box' size='.1 .1 .1'", "type='sphere' size='.08'");
  SolverSide sabotaged(scene);
  sabotaged.tables.pairs.clear();
  sabotaged.tables.body_pairs.clear();
  ExpectRefusals(scene, sabotaged);
}

TEST_F(IndependenceTest, APairThatTheSolverTakesForFrozen) {
  const Scene scene = TwoGeomScene("type='box' size='.1 .1 .1'", "type='sphere' size='.08'");
  SolverSide sabotaged(scene);
  for (KeptPair& pair : sabotaged.tables.pairs) pair.moves = false;
  Verifier verifier(scene.verifier_model(), {});
  EXPECT_FALSE(verifier.Check(FreePose({0.1, 0, 0}, Eigen::Quaterniond::Identity())).free);
  EXPECT_TRUE(verifier.violations().separable);
  EXPECT_FALSE(verifier.violations().frozen);
}

TEST_F(IndependenceTest, AnAllowedOverlapThatTheSolverMadeUp) {
  const Scene scene = TwoGeomScene("type='box' size='.1 .1 .1'", "type='sphere' size='.08'");
  SolverSide sabotaged(scene);
  ExpectRefusals(scene, sabotaged, [](double told) { return told + 0.05; });
}

TEST_F(IndependenceTest, ACapsuleBoxGapOfTheWrongSign) {
  const Scene scene = TwoGeomScene("type='box' size='.1 .05 .02'", "type='capsule' size='.02 .15'");
  SolverSide sabotaged(scene);
  ExpectRefusals(scene, sabotaged, [](double told) { return std::abs(told); });
}

TEST_F(IndependenceTest, AnEllipsoidThatTheSolverTakesForSmaller) {
  const Scene scene =
      TwoGeomScene("type='ellipsoid' size='.1 .05 .02'", "type='ellipsoid' size='.03 .08 .12'");
  const ModelPtr smaller(mj_copyModel(nullptr, scene.model()));
  for (int k = 0; k < 6; ++k) smaller->geom_size[k] *= 0.9;
  SolverSide sabotaged(scene);
  sabotaged.tables.query_model.geom_size = smaller->geom_size;
  sabotaged.tables.support =
      std::make_shared<const SupportPoints>(*smaller, sabotaged.tables.pairs);
  ExpectRefusals(scene, sabotaged);
}

TEST_F(IndependenceTest, AnEllipsoidDepthThatIsHalved) {
  const Scene scene = TwoGeomScene("type='ellipsoid' size='.1 .05 .02' margin='-.01'",
                                   "type='ellipsoid' size='.03 .08 .12'");
  SolverSide sabotaged(scene);
  SolverSide sound(scene);
  Verifier verifier(scene.verifier_model(), {});
  Random rng(72);
  int fooled = 0;
  for (int i = 0; i < 3000; ++i) {
    const std::vector<double> q = FreePose(rng.InBox(kSpread), rng.UnitQuat());
    const double told = sabotaged.Least(q);
    if (told >= -0.01 - kClearlyTrue || 0.5 * told < -0.01) continue;
    ++fooled;
    EXPECT_FALSE(verifier.IsFree(q)) << Join(test::ToEigen(q));
  }
  EXPECT_GT(fooled, 20);
}

TEST_F(IndependenceTest, AHullWhoseSupportPointsAreOff) {
  const std::string cube =
      "<mesh name='m' vertex='.1 .1 .1 -.1 .1 .1 .1 -.1 .1 .1 .1 -.1 -.1 -.1 .1 -.1 .1 -.1 "
      ".1 -.1 -.1 -.1 -.1 -.1'/>";
  const Scene scene = TwoGeomScene("type='box' size='.05 .08 .02'", "type='mesh' mesh='m'", cube);
  const ModelPtr smaller(mj_copyModel(nullptr, scene.model()));
  for (int k = 0; k < 3 * smaller->nmeshvert; ++k) smaller->mesh_vert[k] *= 0.9F;
  SolverSide sabotaged(scene);
  sabotaged.tables.support =
      std::make_shared<const SupportPoints>(*smaller, sabotaged.tables.pairs);
  sabotaged.tables.query_model.mesh_vert = smaller->mesh_vert;
  ExpectRefusals(scene, sabotaged);
}

}  // namespace
}  // namespace mjcf_pdg::test
