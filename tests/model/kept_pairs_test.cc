#include "model/kept_pairs.h"

#include <algorithm>
#include <set>
#include <utility>

#include "model/kinematics.h"
#include "model/scene_tables.h"
#include "tests/support/test_support.h"
#include "verify/verifier_model.h"

namespace mjcf_pdg::test {
namespace {

class KeptPairsTest : public MujocoTest {};

std::set<std::pair<int, int>> KeptPairs(const Scene& scene) {
  std::set<std::pair<int, int>> pairs;
  for (const KeptPair& pair : scene.tables().pairs) pairs.insert({pair.geom1, pair.geom2});
  EXPECT_EQ(pairs.size(), scene.tables().pairs.size()) << "a pair is listed twice";
  return pairs;
}

// The same as the verifier has them, which finds its own.
std::set<std::pair<int, int>> VerifiersPairs(const Scene& scene) {
  std::set<std::pair<int, int>> pairs;
  for (const verify::CheckedPair& pair : scene.verifier_model()->pairs) {
    pairs.insert({pair.geom1, pair.geom2});
  }
  return pairs;
}

// The pairs that MuJoCo reports, in its order of geoms.
std::set<std::pair<int, int>> CollidingPairs(const mjModel* m) {
  const DataPtr d(mj_makeData(m));
  mj_kinematics(m, d.get());
  mj_comPos(m, d.get());
  mj_collision(m, d.get());
  std::set<std::pair<int, int>> pairs;
  for (int c = 0; c < d->ncon; ++c) pairs.insert({d->contact[c].geom[0], d->contact[c].geom[1]});
  return pairs;
}

// Spheres, ellipsoids and boxes so large that every two of them overlap, on bodies that are welded,
// jointed, static or mocap, with random masks, excludes and explicit pairs.
std::string EverythingOverlaps(Random& rng) {
  constexpr int kBodies = 9;
  std::string world =
      "<geom name='p0' type='plane' size='0 0 1'/>"
      "<geom name='p1' type='plane' size='0 0 1'/><geom name='w' size='9'/>";
  std::vector<std::string> names = {"w", "p0"}, inside(kBodies);
  std::vector<int> parent(kBodies, -1);
  for (int b = 0; b < kBodies; ++b) {
    parent[b] = rng.Index(b + 1) - 1;
    const bool can_be_mocap = parent[b] < 0;
    inside[b] = can_be_mocap && rng.Chance(0.2) ? " mocap='true'>" : ">";
    if (inside[b] == ">" && rng.Chance(0.6)) inside[b] += "<joint type='hinge'/>";
    inside[b] += "<inertial mass='1' pos='0 0 0' diaginertia='1 1 1'/>";
    for (int g = rng.Index(3); g > 0; --g) {
      names.push_back("g" + std::to_string(b) + std::to_string(g));
      const Eigen::Vector3d pos = rng.InBox(1);
      const std::string type = rng.Chance(0.7) ? "sphere" : "ellipsoid";
      inside[b] += "<geom name='" + names.back() + "' type='" + type + "' size='9 9 9' pos='" +
                   Join(pos.data(), 3) + "' contype='" + std::to_string(rng.Index(4)) +
                   "' conaffinity='" + std::to_string(rng.Index(4)) + "'/>";
    }
  }
  for (int b = kBodies - 1; b >= 0; --b) {
    std::string& above = parent[b] < 0 ? world : inside[parent[b]];
    above += "<body name='b" + std::to_string(b) + "'" + inside[b] + "</body>";
  }
  std::string contact;
  for (int i = 0; i < 3; ++i) {
    const int b1 = rng.Index(kBodies), b2 = (b1 + 1 + rng.Index(kBodies - 1)) % kBodies;
    contact += "<exclude body1='b" + std::to_string(b1) + "' body2='b" + std::to_string(b2) + "'/>";
  }
  for (int i = 0; i < 3; ++i) {
    const int n = static_cast<int>(names.size()), g1 = rng.Index(n), g2 = (g1 + 1 + i) % n;
    contact += "<pair geom1='" + names[g1] + "' geom2='" + names[g2] + "'/>";
  }
  const std::string filter = rng.Chance(0.5) ? "disable" : "enable";
  return "<mujoco><option><flag filterparent='" + filter + "'/></option><worldbody>" + world +
         "<body name='last'><joint/><geom size='9'/></body></worldbody><contact>" + contact +
         "</contact></mujoco>";
}

TEST_F(KeptPairsTest, KeptPairsAreThoseThatMuJoCoFiltersKeep) {
  Random rng(11);
  std::size_t kept = 0, possible = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const std::string xml = EverythingOverlaps(rng);
    const Scene scene = Scene::FromString(xml);
    const auto expected = CollidingPairs(scene.model());
    ASSERT_EQ(KeptPairs(scene), expected) << "trial " << trial << "\n" << xml;
    ASSERT_EQ(VerifiersPairs(scene), expected) << "trial " << trial << "\n" << xml;
    kept += expected.size();
    possible += scene.model()->ngeom * (scene.model()->ngeom - 1) / 2;
  }
  // Filters keep some and drop some: the comparison is not vacuous.
  EXPECT_GT(kept, possible / 5);
  EXPECT_LT(kept, possible * 4 / 5);
}

TEST_F(KeptPairsTest, PairsOfTypesThatMujocoCannotCollideAreNotKept) {
  const std::string geoms[] = {"type='plane' size='0 0 1' pos='0 0 .05'",
                               "type='hfield' hfield='h'",
                               "size='.2'",
                               "type='capsule' size='.2 .2'",
                               "type='ellipsoid' size='.2 .2 .2'",
                               "type='cylinder' size='.2 .2'",
                               "type='box' size='.2 .2 .2'",
                               "type='mesh' mesh='t'",
                               "type='sdf' mesh='t'"};
  for (int first = 2; first < 9; ++first) {
    for (const std::string& second : geoms) {
      if (first == mjGEOM_SDF && second == geoms[mjGEOM_HFIELD]) continue;  // only warns
      const Scene scene = Scene::FromString(
          R"(<mujoco><asset><hfield name="h" nrow="2" ncol="2" size="1 1 .2 .2" elevation="0 1 1 1"/>
          <mesh name="t" vertex="-.3 -.3 -.3 .5 0 0 0 .5 0 0 0 .5"/></asset><worldbody><geom )" +
          second + "/><body pos='.01 .02 .03'><freejoint/><geom " + geoms[first] +
          "/></body></worldbody></mujoco>");
      EXPECT_EQ(KeptPairs(scene), CollidingPairs(scene.model())) << geoms[first] << second;
      EXPECT_EQ(VerifiersPairs(scene), CollidingPairs(scene.model())) << geoms[first] << second;
    }
  }
}

// A full arena drops contacts with no more than a warning, which fails this test.
TEST_F(KeptPairsTest, PrivateModelsHaveRoomForEveryContactWhateverTheUsersMemory) {
  std::string boxes;
  for (int i = 0; i < 40; ++i) {
    boxes += "<body><freejoint/><geom type='box' size='.1 .1 .1' pos='0 0 .00" + std::to_string(i) +
             "'/></body>";
  }
  const ModelPtr model = LoadModel("<mujoco><worldbody>" + boxes + "</worldbody></mujoco>");
  model->narena = 1 << 20;
  const Scene scene = Scene::FromModel(model.get());
  EXPECT_EQ(CollidingPairs(&scene.tables().query_model).size(), 40u * 39 / 2);
  EXPECT_EQ(CollidingPairs(&scene.tables().query_model).size(), 40u * 39 / 2);
  EXPECT_TRUE(TakeMessages().empty());
  CollidingPairs(model.get());
  EXPECT_FALSE(TakeMessages().empty()) << "the user's own memory was enough: nothing is shown";
}

TEST_F(KeptPairsTest, PairsAreGroupedByTheirTwoBodies) {
  Random rng(12);
  const Scene scene = Scene::FromString(RandomRobotXml(rng));
  int next = 0;
  for (const BodyPair& bodies : scene.tables().body_pairs) {
    EXPECT_EQ(bodies.begin, next);
    next = bodies.end;
    for (int i = bodies.begin; i < bodies.end; ++i) {
      const KeptPair& pair = scene.tables().pairs[i];
      EXPECT_EQ(std::minmax(scene.model()->geom_bodyid[pair.geom1],
                            scene.model()->geom_bodyid[pair.geom2]),
                std::minmax(bodies.body1, bodies.body2));
    }
  }
  EXPECT_EQ(next, scene.num_kept_pairs());
}

// Where geom 2 is, seen from geom 1.
Eigen::Vector3d Relative(const PosedModel& posed, const KeptPair& pair) {
  const mjData* d = posed.data();
  return AsMatrix(d->geom_xmat + 9 * pair.geom1).transpose() *
         (AsVector(d->geom_xpos + 3 * pair.geom2) - AsVector(d->geom_xpos + 3 * pair.geom1));
}

TEST_F(KeptPairsTest, PairsThatMoveAreThoseWhoseGeomsCanMoveRelativeToEachOther) {
  Random rng(12);
  int moving = 0, still = 0;
  for (int trial = 0; trial < 30; ++trial) {
    const ModelPtr model = LoadModel(RandomRobotXml(rng));
    const int body = model->jnt_bodyid[rng.Index(static_cast<int>(model->njnt))];
    const std::string name = mj_id2name(model.get(), mjOBJ_BODY, body);
    const Scene scene = Scene::FromModel(model.get(), {.movable = {name}, .root = {}});
    PosedModel before(&scene.tables().query_model), after(&scene.tables().query_model);
    before.Pose(RandomConfiguration(scene, rng));
    after.Pose(RandomConfiguration(scene, rng));
    for (const KeptPair& pair : scene.tables().pairs) {
      const double change = (Relative(before, pair) - Relative(after, pair)).norm();
      EXPECT_EQ(pair.moves, change > 1e-9) << change;
      ++(pair.moves ? moving : still);
    }
  }
  EXPECT_GT(moving, 300);
  EXPECT_GT(still, 300);
}

}  // namespace
}  // namespace mjcf_pdg::test
