#include "collide/broad_phase.h"

#include <gtest/gtest.h>

#include "model/island.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

class BroadPhaseTest : public MujocoTest {
 protected:
  // Bodies of several sizes, some of two geoms, on a plane and beside a fixed post.
  static Scene Bodies(int count) {
    std::string xml = R"(<mujoco><worldbody><geom type="plane" size="0 0 1"/>
        <body name="post" pos="1 1 0"><geom size=".4"/></body>)";
    for (int k = 0; k < count; ++k) {
      xml += "<body><freejoint/><geom size=\"" + std::to_string(0.02 + 0.05 * (k % 4)) + "\"/>";
      if (k % 3 == 0) xml += R"(<geom size=".05" pos=".1 0 0"/>)";
      xml += "</body>";
    }
    return Scene::FromString(xml + "</worldbody></mujoco>");
  }
  // Moves the tables' free bodies: all about the place, or each by up to `step` [m] along each
  // axis.
  void Move(const SceneTables& tables, double step, VectorXd& q) {
    for (const JointEntry& joint : tables.joints) {
      for (int k = 0; k < 3; ++k) {
        double& x = q[joint.qadr + k];
        x = step > 0.0 ? x + rng_.Uniform(-step, step) : rng_.Uniform(0.0, 2.0);
      }
    }
  }
  static std::vector<int> Expected(const SceneTables& tables, const mjData& d, double margin) {
    std::vector<int> near;
    const auto center = [&](int b) -> Vector3d {
      return AsVector(d.xpos + 3 * b) + AsMatrix(d.xmat + 9 * b) * tables.body_spheres[b].center_B;
    };
    for (int k = 0; k < static_cast<int>(tables.body_pairs.size()); ++k) {
      const auto [body1, body2, begin, end] = tables.body_pairs[k];
      const double reach =
          tables.body_spheres[body1].radius + tables.body_spheres[body2].radius + margin;
      if ((center(body1) - center(body2)).squaredNorm() <= reach * reach) near.push_back(k);
    }
    return near;
  }
  // How many pairs of those compared were near. `tables`: of the scene, or of an island of it.
  int Compare(const Scene& scene, const SceneTables& tables, VectorXd q) {
    PosedModel posed(&tables.query_model, tables.moving_trees);
    BroadPhase broad(tables);
    int near = 0;
    for (int k = 0; k < 150; ++k) {
      // Mostly small steps, by which lists last a while; sometimes all begins anew.
      Move(tables, k % 40 == 20 ? 0.0 : k % 3 == 0 ? 0.05 : 0.002, q);
      const double margin = k % 5 == 0 ? 0.1 : 1e-6;
      const bool all = k % 52 == 0 || tables.moving_trees.empty();
      if (k % 52 == 0) {
        const VectorXd before = q;  // what does not move with the island may stand elsewhere
        Move(scene.tables(), 0.2, q);
        if (!tables.moving_trees.empty()) SetMovable(tables, before, q);
        posed.PoseAllNext();
      }
      posed.Pose(q);
      const std::vector<int> expected = Expected(tables, *posed.data(), margin);
      EXPECT_EQ(broad.Near(posed, margin, all), expected) << k;
      near += static_cast<int>(expected.size());
    }
    return near;
  }

  Random rng_{20261125};
};

TEST_F(BroadPhaseTest, FindsWhatAllPairsWouldTell) {
  for (const int count : {5, 20, 100}) {
    const Scene scene = Bodies(count);
    VectorXd q = ToEigen(scene.DefaultQpos());
    EXPECT_GT(Compare(scene, scene.tables(), q), 150 * count);
  }
}

TEST_F(BroadPhaseTest, FindsThemInAnIsland) {
  const Scene scene = Bodies(300);
  VectorXd q = ToEigen(scene.DefaultQpos());
  Move(scene.tables(), 0.0, q);
  const MovableTrees trees(scene.tables());
  const Island island(scene.tables(), trees, {3, 70, 200});
  EXPECT_GT(Compare(scene, island.tables, q), 1000);
}

}  // namespace
}  // namespace mjcf_pdg::test
