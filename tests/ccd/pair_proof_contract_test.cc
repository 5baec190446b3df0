// What pair_proof.h promises: times within which distances, sampled, keep what is proven, both
// later and earlier, and no less than the closing rate alone proves.
#include <algorithm>
#include <cmath>

#include "ccd/pair_proof.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

class PairProofContractTest : public MujocoTest {};

std::vector<Scene> Scenes(Random& rng) {
  std::vector<Scene> scenes;
  for (const std::string& xml : {ArmXml(), BallChainXml(false), TwoTreesXml(), OffCentreXml()}) {
    scenes.push_back(Scene::FromString(xml));
  }
  for (int i = 0; i < 4; ++i) {
    RobotOptions options;
    options.free_base = i % 2 == 0;
    scenes.push_back(Scene::FromString(RandomRobotXml(rng, options)));
  }
  return scenes;
}

// A random motion of a scene, posed at a random time, and another finder to sample distances.
struct Trial {
  Trial(const Scene& scene, Random& rng)
      : tables(scene.tables()),
        finder(tables),
        sampler(tables),
        proof(tables, finder),
        q0(RandomConfiguration(scene, rng)),
        dq(rng.Uniform(0.02, 1.0) * rng.Normals(tables.n)),
        required(tables.pairs.size()),
        t(rng.Uniform(0.1, 0.9)),
        horizon(rng.Uniform(0.01, std::min(t, 1.0 - t))) {
    for (double& least : required) least = rng.Uniform(-0.02, 0.05);
    for (const JointEntry& joint : tables.joints) {
      if (rng.Chance(0.3)) dq.segment(joint.col, joint.ndof).setZero();
    }
    proof.SetMotion({q0, dq, &required}, 1e-6);
    proof.PoseAt(t);
  }
  Trial(const Trial&) = delete;

  double DistanceAt(double time, int pair) {
    VectorXd q;
    Integrate(tables, q0, time * dq, q);
    sampler.Pose(q);
    NearPair near;
    return sampler.Distance(pair, 100.0, near) ? near.distance : 100.0;
  }
  // The least distance of a pair from now on for `length`, which is negative towards earlier times.
  double LeastOf(int pair, double length) {
    double least = 100.0;
    for (int k = 0; k <= 12; ++k) least = std::min(least, DistanceAt(t + length * k / 12, pair));
    return least;
  }

  const SceneTables& tables;
  ContactFinder finder, sampler;
  PairProof proof;
  VectorXd q0, dq, required;
  double t, horizon;
};

TEST_F(PairProofContractTest, PosesAreThoseOfTheMotion) {
  Random rng(1);
  for (const Scene& scene : Scenes(rng)) {
    Trial trial(scene, rng);
    for (const JointEntry& joint : trial.tables.joints) {
      if (joint.type == mjJNT_BALL) trial.q0.segment<4>(joint.qadr) *= 3.0;
    }
    trial.proof.SetMotion({trial.q0, trial.dq}, 1e-6);
    const VectorXd copy = trial.q0;
    trial.q0.setZero();  // it has been copied
    VectorXd q, expected;
    trial.proof.At(0.0, q);
    EXPECT_EQ(q, copy);
    trial.proof.At(0.7, q);
    Integrate(trial.tables, copy, 0.7 * trial.dq, expected);
    EXPECT_LT((q - expected).norm(), 1e-14);
    trial.proof.PoseAt(0.7);
    for (int pair = 0; pair < static_cast<int>(trial.tables.pairs.size()); ++pair) {
      EXPECT_EQ(trial.proof.Required(pair), -trial.tables.pairs[pair].allowed);
    }
    const mjModel& m = *trial.finder.posed().model();
    const DataPtr d(mj_makeData(&m));
    mju_copy(d->qpos, expected.data(), expected.size());
    mj_kinematics(&m, d.get());
    for (int k = 0; k < 3 * m.ngeom; ++k) {
      EXPECT_NEAR(trial.finder.posed().data()->geom_xpos[k], d->geom_xpos[k], 1e-12);
    }
  }
}

TEST_F(PairProofContractTest, BoundingVolumesProveWhatIsKeptBothWays) {
  Random rng(2);
  int bodies_proven = 0, pairs_proven = 0, none = 0;
  for (const Scene& scene : Scenes(rng)) {
    for (int k = 0; k < 60; ++k) {
      Trial trial(scene, rng);
      const int body_pair = rng.Index(static_cast<int>(trial.tables.body_pairs.size()));
      if (!trial.proof.Moves(body_pair)) continue;
      const BodyPair& bodies = trial.tables.body_pairs[body_pair];
      const double distance = rng.Uniform(0.0, 0.3), floor = rng.Uniform(-0.01, 0.2);
      const double reach = trial.proof.BodiesReach(body_pair, distance, trial.horizon);
      none += reach <= 0.0;
      for (int pair = bodies.begin; pair < bodies.end; ++pair) {
        if (reach > 0.0) {
          ++bodies_proven;
          const double way = std::min(reach, trial.horizon);
          EXPECT_GE(trial.LeastOf(pair, way), distance - 1e-7) << pair;
          EXPECT_GE(trial.LeastOf(pair, -way), distance - 1e-7) << pair;
        }
        const Reach bound = trial.proof.BoundsReach(body_pair, pair, floor, trial.horizon);
        const double least = floor + trial.required[pair];
        if (!(bound.length > 0.0)) continue;
        ++pairs_proven;
        const double way = std::min(bound.length, trial.horizon);
        EXPECT_GE(trial.LeastOf(pair, way), least - 1e-7) << pair;
        EXPECT_GE(trial.LeastOf(pair, -way), least - 1e-7) << pair;
      }
    }
  }
  EXPECT_GT(bodies_proven, 200);
  EXPECT_GT(pairs_proven, 200);
  EXPECT_GT(none, 30);
}

// A sphere that a slide moves straight towards another: every bound is the distance over the speed.
TEST_F(PairProofContractTest, BoundsOfSpheresHeadOnAreExact) {
  const Scene scene = Scene::FromString(R"(<mujoco><worldbody>
    <geom type="sphere" size=".3" pos="0 0 9" contype="0" conaffinity="0"/>
    <body pos="2 0 0"><geom type="sphere" size=".1"/></body>
    <body pos=".5 0 0"><joint type="slide" axis="0 1 0"/><joint type="slide" axis="1 0 0"/>
      <geom type="sphere" size=".2"/></body></worldbody></mujoco>)");
  ContactFinder finder(scene.tables());
  PairProof proof(scene.tables(), finder);
  const VectorXd q0 = VectorXd::Zero(2), dq = Eigen::Vector2d(0.0, 2.0);
  const VectorXd required = VectorXd::Constant(1, 0.05);
  proof.SetMotion({q0, dq, &required}, 1e-6);
  proof.PoseAt(0.1);  // 1 m apart
  EXPECT_NEAR(proof.BodiesReach(0, 0.4, 0.5), 0.3, 1e-9);
  EXPECT_NEAR(proof.BoundsReach(0, 0, 0.35, 0.5).length, 0.3, 1e-9);
  EXPECT_NEAR(proof.BoundsReach(0, 0, 0.35, 0.5).lambda, 2.0, 1e-12);
  const Margin margin = proof.Measure(0, 10.0);
  EXPECT_TRUE(margin.measured);
  EXPECT_NEAR(margin.value, 0.95, 1e-9);
  const Reach later = proof.Prove(0, 0, margin, 0.35, Direction::kLater, 0.5);
  EXPECT_NEAR(later.length, 0.3, 1e-6);
  EXPECT_NEAR(later.rate, -2.0, 1e-9);
  EXPECT_NEAR(later.lambda, 2.0, 1e-9);
  const Reach earlier = proof.Prove(0, 0, margin, 0.35, Direction::kEarlier, 0.1);
  EXPECT_NEAR(earlier.length, 0.1, 1e-9);
  EXPECT_NEAR(earlier.rate, 2.0, 1e-9);
}

TEST_F(PairProofContractTest, AMarginIsTheDistanceLessTheRequiredOne) {
  Random rng(3);
  int measured = 0, bounded = 0;
  for (const Scene& scene : Scenes(rng)) {
    for (int k = 0; k < 60; ++k) {
      Trial trial(scene, rng);
      const int pair = rng.Index(static_cast<int>(trial.tables.pairs.size()));
      const KeptPair& kept = trial.tables.pairs[pair];
      const double true_margin = trial.DistanceAt(trial.t, pair) - trial.required[pair];
      const double enough = rng.Uniform(-0.05, 0.6);
      const Margin margin = trial.proof.Measure(pair, enough);
      EXPECT_LE(margin.value, true_margin + 1e-7);
      EXPECT_GE(margin.value, std::min(true_margin, enough) - 1e-3 - 0.1 * std::abs(true_margin));
      if (std::abs(true_margin - enough) > 1e-6) {
        EXPECT_EQ(margin.measured, true_margin < enough);
      }
      ++(margin.measured ? measured : bounded);
      NearPair near;
      if (!margin.measured || !trial.finder.Distance(pair, 100.0, near)) continue;
      if (near.distance > 0.0) {
        EXPECT_NEAR(margin.value, true_margin, 1e-7);
      }
      const mjData& d = *trial.finder.posed().data();
      const bool plane = trial.tables.model->geom_type[kept.geom1] == mjGEOM_PLANE;
      const Vector3d n_W = plane ? AsMatrix(d.geom_xmat + 9 * kept.geom1).col(2) : near.n_W;
      EXPECT_LT((margin.n_W - n_W).norm(), 1e-3);
      EXPECT_LT((margin.p1_W - near.p1_W).norm(), 1e-3);
    }
  }
  EXPECT_GT(measured, 100);
  EXPECT_GT(bounded, 50);
}

TEST_F(PairProofContractTest, ProofsHoldInTheirDirectionAndGoAsFarAsTheClosingRate) {
  Random rng(4);
  int proven = 0, by_plane = 0;
  for (const Scene& scene : Scenes(rng)) {
    MotionBound bound(scene.tables());
    for (int k = 0; k < 120; ++k) {
      Trial trial(scene, rng);
      const int body_pair = rng.Index(static_cast<int>(trial.tables.body_pairs.size()));
      const int pair = trial.tables.body_pairs[body_pair].begin;
      const Margin margin = trial.proof.Measure(pair, 1.0);
      if (!trial.proof.Moves(body_pair) || !margin.measured) continue;
      const double before = trial.DistanceAt(trial.t - 1e-6, pair);
      const double rate = (trial.DistanceAt(trial.t + 1e-6, pair) - before) / 2e-6;
      const double floor = margin.value - rng.Uniform(0.0, 0.1);
      bound.SetPath(trial.dq);
      bound.SetPose(trial.finder.posed());
      const double lambda =
          bound.Geoms(trial.finder.posed(), body_pair, pair, trial.horizon).closing;
      for (const Direction direction : {Direction::kLater, Direction::kEarlier}) {
        const double sign = direction == Direction::kLater ? 1.0 : -1.0;
        const Reach reach =
            trial.proof.Prove(body_pair, pair, margin, floor, direction, trial.horizon);
        EXPECT_GE(reach.length, std::min(trial.horizon, (margin.value - floor) / lambda) - 1e-12);
        EXPECT_LE(reach.length, trial.horizon);
        EXPECT_LE(reach.lambda, lambda + 1e-12);
        EXPECT_LE(std::abs(reach.rate), lambda + 1e-9);
        by_plane += reach.length > 1.01 * (margin.value - floor) / lambda;
        proven += reach.length > 0.0;
        EXPECT_GE(trial.LeastOf(pair, sign * reach.length), floor + trial.required[pair] - 1e-6);
        if (before > 0.01 && trial.required[pair] + margin.value > 0.01) {
          EXPECT_NEAR(reach.rate, sign * rate, 0.02 * lambda);
        }
      }
    }
  }
  EXPECT_GT(proven, 300);
  EXPECT_GT(by_plane, 100);
}

}  // namespace
}  // namespace mjcf_pdg::test
