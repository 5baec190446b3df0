#include "model/island.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "collide/contacts.h"
#include "mjcf_pdg/pdg.h"
#include "model/kinematics.h"
#include "norm/norm_evaluator.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

// Trees of all kinds of joints: an arm that stands on a mocap body, a pendulum on a ball, a chain
// under a free body, boxes, and a body that nothing moves.
const std::string kTrees = R"(<mujoco><worldbody>
  <geom name="floor" type="plane" size="0 0 1" pos="0 0 -1"/>
  <body name="post" pos="2 0 0"><geom size=".1"/></body>
  <body name="base" mocap="true" pos=".1 0 0"><geom type="box" size=".05 .05 .05"/>
    <body name="upper" pos="0 0 .2"><joint axis="0 1 0"/><geom type="capsule" size=".03 .1"/>
      <body name="lower" pos="0 0 .2"><joint axis="1 0 1"/><joint type="slide" axis="0 0 1"/>
        <geom type="capsule" size=".03 .1" pos=".1 0 0"/></body></body></body>
  <body name="bob" pos="0 .5 0"><joint type="ball"/><geom size=".1" pos="0 .1 .2"/></body>
  <body name="train" pos="0 1 0"><freejoint/><geom type="box" size=".1 .05 .05"/>
    <body pos=".25 0 0"><joint axis="0 0 1"/><geom type="box" size=".1 .05 .05"/></body></body>
  <body name="one" pos="1 1 0"><freejoint/><geom type="ellipsoid" size=".1 .05 .05"/></body>
  <body name="two" pos="1 1 1"><freejoint/><geom type="box" size=".1 .05 .05"/></body>
  </worldbody></mujoco>)";

class IslandTest : public MujocoTest {
 protected:
  // A random set of trees that is not empty.
  std::vector<int> RandomTrees() {
    std::vector<int> trees;
    while (trees.empty()) {
      const double share = rng_.Chance(0.3) ? 1.0 : 0.4;
      for (int tree = 0; tree < trees_.count(); ++tree) {
        if (rng_.Chance(share)) trees.push_back(tree);
      }
    }
    return trees;
  }
  // q with the joints of the island at random.
  VectorXd Moved(const Island& island, const VectorXd& q) {
    return WithMovable(island.tables, q, RandomConfiguration(scene_, rng_));
  }

  const Scene scene_ = Scene::FromString(kTrees);
  const MovableTrees trees_{scene_.tables()};
  Random rng_{20261124};
};

TEST_F(IslandTest, TreesAreThoseThatJointsMove) {
  EXPECT_EQ(trees_.count(), 5);
  const auto of = [this](const char* name) {
    return trees_.OfBody(mj_name2id(scene_.model(), mjOBJ_BODY, name));
  };
  EXPECT_EQ(of("post"), -1);
  EXPECT_EQ(of("base"), -1);
  EXPECT_EQ(of("upper"), 0);
  EXPECT_EQ(of("lower"), 0);
  EXPECT_EQ(of("two"), 4);
  const Scene some = Scene::FromModel(scene_.model(), {.movable = {"lower", "two"}});
  EXPECT_EQ(MovableTrees(some.tables()).count(), 2);
}

// What an island leaves asleep, MuJoCo must leave where it was; all else it must pose as ever.
TEST_F(IslandTest, IsPosedAsTheWholeModelIs) {
  for (int trial = 0; trial < 40; ++trial) {
    const Island island(scene_.tables(), trees_, RandomTrees());
    PosedModel part(&island.tables.query_model, island.tables.moving_trees);
    PosedModel whole(&scene_.tables().query_model);
    MocapPoses mocap{{.3, rng_.Uniform(), .1}, {1, 0, 0, 0}};
    part.SetMocap(mocap);
    whole.SetMocap(mocap);
    const VectorXd q_in = RandomConfiguration(scene_, rng_);
    part.Pose(q_in);
    for (int k = 0; k < 3; ++k) {
      const VectorXd q = Moved(island, q_in);
      part.Pose(q);
      whole.Pose(q);
      const mjModel& m = *scene_.model();
      const auto expect_same = [&](const mjtNum* a, const mjtNum* b, mjtSize count) {
        EXPECT_EQ(std::vector<double>(a, a + count), std::vector<double>(b, b + count));
      };
      const mjData &a = *part.data(), &b = *whole.data();
      expect_same(a.xpos, b.xpos, 3 * m.nbody);
      expect_same(a.xmat, b.xmat, 9 * m.nbody);
      expect_same(a.xipos, b.xipos, 3 * m.nbody);
      expect_same(a.geom_xpos, b.geom_xpos, 3 * m.ngeom);
      expect_same(a.geom_xmat, b.geom_xmat, 9 * m.ngeom);
      expect_same(a.xanchor, b.xanchor, 3 * m.njnt);
      expect_same(a.xaxis, b.xaxis, 3 * m.njnt);
      for (const JointEntry& joint : island.tables.joints) {
        expect_same(a.cdof + 6 * joint.vadr, b.cdof + 6 * joint.vadr, 6 * joint.ndof);
      }
    }
  }
}

// Else an island would cost what the scene does. MuJoCo must not wake what stays.
TEST_F(IslandTest, LeavesOtherTreesUnposed) {
  int left = 0;
  for (int trial = 0; trial < 20; ++trial) {
    const Island island(scene_.tables(), trees_, RandomTrees());
    if (island.tables.moving_trees.empty()) continue;
    PosedModel part(&island.tables.query_model, island.tables.moving_trees);
    for (int k = 0; k < 3; ++k) {
      part.PoseAllNext();
      part.Pose(RandomConfiguration(scene_, rng_));
      const mjModel& m = *scene_.model();
      const mjData& d = *part.data();
      const std::vector<double> before(d.xpos, d.xpos + 3 * m.nbody);
      const std::vector<double> turned(d.xmat, d.xmat + 9 * m.nbody);
      part.Pose(RandomConfiguration(scene_, rng_));  // of all trees
      for (int body = 1; body < m.nbody; ++body) {
        const bool same = AsVector(d.xpos + 3 * body) == AsVector(&before[3 * body]) &&
                          AsMatrix(d.xmat + 9 * body) == AsMatrix(&turned[9 * body]);
        EXPECT_EQ(same, !island.tables.body_moves[body]);
        left += same;
      }
    }
  }
  EXPECT_GT(left, 100);
}

// As islands of one solver are: each begins with a pose of all.
TEST_F(IslandTest, IslandsAndTheSceneTakeTurnsWithTheSameData) {
  ContactFinder whole(scene_.tables()), alone(scene_.tables());
  const Island one(scene_.tables(), trees_, {0, 3}), other(scene_.tables(), trees_, {1, 2});
  ContactFinder of_one(one.tables, 0.0, whole.posed().shared_data());
  ContactFinder of_other(other.tables, 0.0, whole.posed().shared_data());
  const auto distances = [](ContactFinder& finder, const SceneTables& tables) {
    std::map<std::pair<int, int>, double> found;
    for (const NearPair& near : finder.Find(0.5)) {
      found[{tables.pairs[near.pair].geom1, tables.pairs[near.pair].geom2}] = near.distance;
    }
    return found;
  };
  int compared = 0;
  for (int trial = 0; trial < 20; ++trial) {
    const VectorXd q_in = RandomConfiguration(scene_, rng_);
    for (int turn = 0; turn < 4; ++turn) {
      const Island& island = turn % 2 == 0 ? one : other;
      ContactFinder& finder = turn % 2 == 0 ? of_one : of_other;
      for (ContactFinder* each : {&finder, &whole, &alone}) each->Forget();
      finder.Pose(q_in);
      const VectorXd q = Moved(island, q_in);
      finder.Pose(q);
      const auto found = distances(finder, island.tables);
      whole.Pose(q);
      alone.Pose(q);
      const auto expected = distances(alone, scene_.tables());
      EXPECT_EQ(distances(whole, scene_.tables()).size(), expected.size());
      for (const auto& [geoms, distance] : found) {
        ASSERT_TRUE(expected.contains(geoms));
        EXPECT_NEAR(distance, expected.at(geoms), 1e-6);
        ++compared;
      }
    }
  }
  EXPECT_GT(compared, 50);
}

TEST_F(IslandTest, KeepsThePairsThatItsTreesCanPart) {
  for (int trial = 0; trial < 20; ++trial) {
    const Island island(scene_.tables(), trees_, RandomTrees());
    const std::set<int> mine(island.trees.begin(), island.trees.end());
    std::vector<int> expected;
    const std::vector<KeptPair>& pairs = scene_.tables().pairs;
    for (int k = 0; k < static_cast<int>(pairs.size()); ++k) {
      if (mine.count(trees_.OfGeom(pairs[k].geom1)) || mine.count(trees_.OfGeom(pairs[k].geom2))) {
        expected.push_back(k);
      }
    }
    ASSERT_FALSE(expected.empty());
    EXPECT_EQ(island.scene_pairs, expected);
    for (const KeptPair& pair : island.tables.pairs) EXPECT_TRUE(pair.moves);
  }
}

TEST_F(IslandTest, FindsTheDistancesThatTheSceneFinds) {
  int compared = 0;
  for (int trial = 0; trial < 20; ++trial) {
    const Island island(scene_.tables(), trees_, RandomTrees());
    ContactFinder part(island.tables), whole(scene_.tables());
    const VectorXd q_in = RandomConfiguration(scene_, rng_);
    part.Pose(q_in);
    part.Find(0.1);
    const VectorXd q = Moved(island, q_in);
    part.Pose(q);
    whole.Pose(q);
    std::vector<std::pair<int, double>> expected, found;
    const std::set<int> mine(island.scene_pairs.begin(), island.scene_pairs.end());
    for (const NearPair& near : whole.Find(0.5)) {
      if (mine.count(near.pair)) expected.emplace_back(near.pair, near.distance);
    }
    for (const NearPair& near : part.Find(0.5)) {
      found.emplace_back(island.scene_pairs[near.pair], near.distance);
    }
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t k = 0; k < found.size(); ++k, ++compared) {
      EXPECT_EQ(found[k].first, expected[k].first);
      EXPECT_NEAR(found[k].second, expected[k].second, 1e-9);
    }
  }
  EXPECT_GT(compared, 50);
}

TEST_F(IslandTest, MeasuresSigmaAsTheSceneDoes) {
  for (const Metric metric : {Metric::kSequential, Metric::kDisplacement}) {
    NormEvaluator whole(scene_.tables(), metric);
    for (int trial = 0; trial < 20; ++trial) {
      const Island island(scene_.tables(), trees_, RandomTrees());
      NormEvaluator part(island.tables, metric);
      const VectorXd q_in = RandomConfiguration(scene_, rng_);
      whole.SetReference(q_in);
      part.SetReference(q_in);
      const VectorXd q = Moved(island, q_in);
      EXPECT_NEAR(part.Sigma(q), whole.Sigma(q), 1e-12 + 1e-9 * whole.Sigma(q));
    }
  }
}

}  // namespace
}  // namespace mjcf_pdg::test
