// One test for each way in which MuJoCo 4.0 alone calls an overlapping configuration free. Settings
// hide contacts by design; where it is a flaw of MuJoCo, the test holds without that, too, and only
// says how often it was met.
#include <gmock/gmock.h>

#include <algorithm>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "mjcf_pdg/pdg.h"
#include "tests/support/brute_distance.h"
#include "tests/support/mesh_shapes.h"
#include "tests/support/shallow_depths.h"
#include "tests/support/test_support.h"
#include "tests/support/verify_scenes.h"

namespace mjcf_pdg::test {
namespace {

using Eigen::Vector3d;
using ::testing::AllOf;
using ::testing::HasSubstr;

class HiddenOverlapTest : public MujocoTest {};

struct MujocoSays {
  double deepest = 0.0;  // smallest contact dist; 0 when none is negative [m]
  int warnings = 0;
};

// What a program sees that asks MuJoCo with the user's own model and settings.
MujocoSays AskMujoco(const mjModel* m, const std::vector<double>& q) {
  const DataPtr d(mj_makeData(m));
  mju_copy(d->qpos, q.data(), static_cast<int>(q.size()));
  mj_kinematics(m, d.get());
  mj_comPos(m, d.get());
  mj_collision(m, d.get());
  MujocoSays says;
  says.warnings = d->warning[mjWARN_CONTACTFULL].number;
  for (int c = 0; c < d->ncon; ++c) says.deepest = std::min(says.deepest, d->contact[c].dist);
  return says;
}

void TellMissed(int missed, int all) {
  std::printf("  MuJoCo misses or misreads %d of %d\n", missed, all);
}

// An overlap of that depth at q is named.
void ExpectSeen(const std::string& xml, const std::vector<double>& q, double depth) {
  const Scene scene = Scene::FromString(xml);
  const Verdict verdict = Verify(scene, q);
  EXPECT_FALSE(verdict.free);
  EXPECT_NEAR(verdict.min_distance, -depth, 1e-6);
  EXPECT_THAT(verdict.reason, HasSubstr("overlap by"));
}

// The same, and the model's settings hide it from MuJoCo alone.
void ExpectHole(const std::string& xml, const std::vector<double>& q, double depth) {
  EXPECT_EQ(AskMujoco(Scene::FromString(xml).model(), q).deepest, 0.0) << "MuJoCo sees it: no hole";
  ExpectSeen(xml, q, depth);
}

TEST_F(HiddenOverlapTest, ACapsuleThatPiercesABoxIsNotFree) {
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody>
    <geom name="box" type="box" size=".1 .3 .05"/><body name="rod"><freejoint/>
    <geom name="rod" type="capsule" size=".01 .3"/></body></worldbody></mujoco>)");
  const Vector3d half(0.1, 0.3, 0.05);
  Random rng(1);
  int piercing = 0, missed = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vector3d p = rng.InBox(0.3);
    const Eigen::Quaterniond r = rng.UnitQuat();
    bool inside = false;  // some point of the capsule's axis is in the box
    for (int k = -100; k <= 100; ++k) {
      const Vector3d x = p + r * Vector3d(0, 0, 0.003 * k);
      inside |= (x.cwiseAbs() - half).maxCoeff() < 0.0;
    }
    const std::vector<double> q = FreePose(p, r);
    const Verdict verdict = Verify(scene, q);
    if (!inside) continue;
    ++piercing;
    EXPECT_FALSE(verdict.free) << Join(ToEigen(q));
    EXPECT_LE(verdict.min_distance, -0.01) << Join(ToEigen(q));  // at least the radius
    missed += AskMujoco(scene.model(), q).deepest == 0.0;
  }
  EXPECT_GT(piercing, 300);
  TellMissed(missed, piercing);
}

TEST_F(HiddenOverlapTest, ContactsDisabledByAFlagHideNothing) {
  ExpectHole(TwoBoxes("<option><flag contact='disable'/></option>"), {0.17}, 0.03);
}

TEST_F(HiddenOverlapTest, ConstraintsDisabledByAFlagHideNothing) {
  ExpectHole(TwoBoxes("<option><flag constraint='disable'/></option>"), {0.17}, 0.03);
}

TEST_F(HiddenOverlapTest, TwoSleepingTreesAreNotFree) {
  ExpectHole(R"(<mujoco><option><flag sleep="enable"/></option><worldbody>
    <body sleep="init"><freejoint/><geom type="box" size=".1 .1 .1"/></body>
    <body sleep="init" pos=".17 0 0"><freejoint/><geom type="box" size=".1 .1 .1"/></body>
    </worldbody></mujoco>)",
             {0, 0, 0, 1, 0, 0, 0, 0.17, 0, 0, 1, 0, 0, 0}, 0.03);
}

// Contacts within the tolerance leave no room in the arena for that of the last two boxes.
TEST_F(HiddenOverlapTest, AFullArenaHidesNothing) {
  std::string xml = "<mujoco><size memory='20K'/><worldbody>";
  std::vector<double> q;
  for (int i = 0; i < 30; ++i) {
    const std::string pos = std::to_string(0.3 * i) + " 0 0";
    xml += "<geom type='box' size='.1 .1 .1' pos='" + pos + "'/>";
    xml += "<body name='b" + std::to_string(i) + "' pos='" + pos +
           "'><joint type='slide' axis='0 0 1'/><geom type='box' size='.1 .1 .1'/></body>";
    q.push_back(0.2 + (i == 29 ? -0.03 : -0.5e-6));  // all but the last are within the tolerance
  }
  const Scene scene = Scene::FromString(xml + "</worldbody></mujoco>");
  const MujocoSays says = AskMujoco(scene.model(), q);
  EXPECT_GT(says.deepest, -1e-6) << "MuJoCo sees it: no hole";
  EXPECT_GT(says.warnings, 0);
  const Verdict verdict = Verify(scene, q);
  EXPECT_FALSE(verdict.free);
  EXPECT_THAT(verdict.reason, AllOf(HasSubstr("overlap by 30 mm"), HasSubstr("b29/geom0")));
  EXPECT_EQ(TakeMessages().size(), 1u);  // MuJoCo's warning above; none from Verify
}

// MuJoCo shrinks its broad-phase boxes by a negative margin; a small geom's turns inside out, and
// overlaps of any depth are lost.
TEST_F(HiddenOverlapTest, ANegativeMarginHidesNoMoreThanItAllows) {
  ExpectSeen(R"(<mujoco><worldbody><geom name="block" type="box" size=".1 .1 .1"/>
    <body><freejoint/><geom name="bead" type="sphere" size=".001" margin="-.01"/></body>
    </worldbody></mujoco>)",
             {0, 0, 0.07, 1, 0, 0, 0}, 0.031);
}

TEST_F(HiddenOverlapTest, NativeConvexCollisionDisabledHidesNothing) {
  const Scene scene = Scene::FromString(R"(<mujoco>
    <option ccd_iterations="3" ccd_tolerance="1e-3"><flag nativeccd="disable"/></option>
    <worldbody><geom name="ball" type="sphere" size=".07"/><body name="egg"><freejoint/>
    <geom name="egg" type="ellipsoid" size=".1 .06 .04"/></body></worldbody></mujoco>)");
  const DataPtr d(mj_makeData(scene.model()));
  auto pose = [&](const std::vector<double>& q) {
    mju_copy(d->qpos, q.data(), 7);
    mj_kinematics(scene.model(), d.get());
  };
  Random rng(3);
  int missed = 0;
  for (int i = 0; i < 300; ++i) {
    const Vector3d p = rng.InBox(0.12);
    const Eigen::Quaterniond r = rng.UnitQuat();
    pose(FreePose(p, r));
    const BruteGap gap = BruteDistance(scene.model(), d.get(), 0, 1);
    const std::vector<double> q = FreePose(p - (gap.distance + 3e-4) * gap.n_W, r);
    const double depth = AskMujoco(scene.model(), q).deepest;  // 0.3 mm, in truth
    EXPECT_FALSE(Verify(scene, q).free) << Join(ToEigen(q));
    missed += depth == 0.0;
  }
  TellMissed(missed, 300);
}

constexpr int kPoses = 20000;  // of each pair
// MuJoCo's depth is wrong if it is shallower than the true one by that [m].
constexpr double kWrong = 2e-5;
const struct {
  CurvedPair pair;
  double spread;  // of the middles [m]
} kCurved[] = {
    {{"type='cylinder' size='.05 .004'", "type='ellipsoid' size='.04 .03 .005'"}, 0.05},
    {{"type='ellipsoid' size='.02 .03 .1'", "type='ellipsoid' size='.03 .08 .006'"}, 0.05},
    {{"type='sphere' size='.05'", "type='ellipsoid' size='.02 .1 .005'"}, 0.05},
    {{"type='capsule' size='.03 .06'", "type='cylinder' size='.06 .05'"}, 1e-4}};

TEST_F(HiddenOverlapTest, ATooShallowDepthHidesNoMoreThanANegativeMarginAllows) {
  int right = 0, wrong = 0;
  for (const auto& [pair, spread] : kCurved) {
    for (const Overlap& overlap : RandomOverlaps(pair.Make(), kPoses, spread)) {
      auto free = [&](double allowed) { return Verify(pair.Make(allowed), overlap.q).free; };
      const std::string where = pair.second + Join(ToEigen(overlap.q));
      EXPECT_FALSE(free(-overlap.truth - kWrong)) << where;
      EXPECT_TRUE(free(-overlap.truth + kWrong)) << where;
      ++(overlap.hidden() < kWrong ? right : wrong);
      if (overlap.hidden() < kWrong) continue;
      for (const double share : {0.0, 0.2, 0.4, 0.6, 0.8}) {
        EXPECT_FALSE(free(-overlap.told + share * overlap.hidden())) << share << " " << where;
      }
    }
  }
  EXPECT_GT(right + wrong, 130);
  TellMissed(wrong, right + wrong);
}

// What a contact at rest may keep is its true depth, however shallow MuJoCo says that it is.
TEST_F(HiddenOverlapTest, ATooShallowDepthDoesNotRestWhereTheTrueOneIsTooDeep) {
  int right = 0, wrong = 0;
  for (const auto& [pair, spread] : kCurved) {
    const Scene scene = pair.Make();
    for (const Overlap& overlap : RandomOverlaps(scene, kPoses, spread)) {
      auto free = [&](double rest) {
        Options options;
        options.rest = rest;
        return Verify(scene, overlap.q, options, &overlap.q).free;
      };
      const std::string where = pair.second + Join(ToEigen(overlap.q));
      EXPECT_FALSE(free(-overlap.truth - kWrong)) << where;
      EXPECT_TRUE(free(-overlap.truth + kWrong)) << where;
      EXPECT_TRUE(free(1.0)) << where;
      ++(overlap.hidden() < kWrong ? right : wrong);
    }
  }
  EXPECT_GT(right + wrong, 130);
  TellMissed(wrong, right + wrong);
}

TEST_F(HiddenOverlapTest, AnOverriddenMarginHidesNothing) {
  ExpectHole(TwoBoxes("<option o_margin='-.05'><flag override='enable'/></option>"), {0.17}, 0.03);
}

// With a positive margin MuJoCo's contacts of overlapping geoms can be absent or far off.
TEST_F(HiddenOverlapTest, APositiveMarginHidesNothing) {
  Random rng(4);
  int missed = 0, overlaps = 0;
  for (const auto& [type1, type2] :
       {std::pair("box", "cylinder"), std::pair("ellipsoid", "box"), std::pair("box", "box")}) {
    const auto xml = [first = type1, second = type2](const std::string& margin) {
      return std::string("<mujoco><worldbody><geom name='a' type='") + first +
             "' size='.1 .07 .05'" + margin + "/><body><freejoint/><geom name='b' type='" + second +
             "' size='.06 .1 .05'" + margin + "/></body></worldbody></mujoco>";
    };
    const Scene scene = Scene::FromString(xml(" margin='.5'"));
    const ModelPtr plain = LoadModel(xml(""));
    const DataPtr d(mj_makeData(plain.get()));
    for (int i = 0; i < 400; ++i) {
      const std::vector<double> q = FreePose(rng.InBox(0.15), rng.UnitQuat());
      mju_copy(d->qpos, q.data(), 7);
      mj_kinematics(plain.get(), d.get());
      if (BruteDistance(plain.get(), d.get(), 0, 1).distance > -1e-3) continue;
      ++overlaps;
      EXPECT_FALSE(Verify(scene, q).free) << xml("") << Join(ToEigen(q));
      missed += AskMujoco(scene.model(), q).deepest == 0.0;
    }
  }
  EXPECT_GT(overlaps, 300);
  TellMissed(missed, overlaps);
}

// mj_collision finds nothing and mj_geomDistance says exactly 0, with any number of iterations and
// any tolerance; a ball of 4.16 m lies in both.
TEST_F(HiddenOverlapTest, ConvexMeshesOfTensOfMetresThatOverlapAreNotFree) {
  const std::vector<double> q = {-15, -144.09, 153.39, .483, .825, -.203, .212};
  const std::string xml = R"(<mujoco><asset><mesh name="m" inertia="convex"
    vertex="100 100 100 -100 -100 100 -100 100 -100 100 -100 -100"/></asset>
    <worldbody><geom type="box" size="100 100 100"/><body><freejoint/>
    <geom type="mesh" mesh="m"/></body></worldbody></mujoco>)";
  const Scene scene = Scene::FromString(xml);
  const Verdict verdict = Verify(scene, q);
  EXPECT_FALSE(verdict.free);
  EXPECT_LT(verdict.min_distance, -2.0 * 4.16 + 0.01);
  SceneOptions exact;
  exact.exact_mesh = true;
  EXPECT_FALSE(Verify(Scene::FromString(xml, exact), q).free);
}

}  // namespace
}  // namespace mjcf_pdg::test
