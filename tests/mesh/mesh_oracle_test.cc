// The second opinion itself, on poses with known answers.
#include "tests/support/mesh_oracle.h"

#include <cmath>

#include "collide/contacts.h"
#include "mjcf_pdg/pdg.h"
#include "tests/support/brute_mesh.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

using Eigen::Vector3d;

class MeshOracleTest : public MujocoTest {};

struct Answer {
  bool overlap = false, contained = false;
  double depth = 0.0;
};

Answer Ask(MeshOracle& oracle, const Vector3d& at, const Eigen::Quaterniond& turn = {1, 0, 0, 0}) {
  const auto overlaps = oracle.Overlaps(FreePose(at, turn));
  if (overlaps.empty()) return {};
  return {true, overlaps.front().contained, overlaps.front().depth};
}

TEST_F(MeshOracleTest, EveryKindOfGeomIsWhereMujocoHasIt) {
  const struct {
    const char* geom;
    double below;  // how far it reaches below its middle
  } kGeoms[] = {{"type='sphere' size='0.04'", 0.04},
                {"type='capsule' size='0.02 0.05'", 0.07},
                {"type='ellipsoid' size='0.02 0.03 0.06'", 0.06},
                {"type='cylinder' size='0.03 0.04'", 0.04},
                {"type='box' size='0.02 0.03 0.05'", 0.05},
                {"type='mesh' mesh='moving'", 0.01}};
  for (const auto& [geom, below] : kGeoms) {
    const Scene scene = MeshScene(BoxMesh({0.5, 0.5, 0.1}), geom);
    MeshOracle oracle(scene);
    EXPECT_FALSE(Ask(oracle, {0.2, 0.1, 0.1 + below + 1e-6}).overlap) << geom;
    const Answer shallow = Ask(oracle, {0.2, 0.1, 0.1 + below - 1e-3});
    EXPECT_TRUE(shallow.overlap && !shallow.contained) << geom;
    EXPECT_NEAR(shallow.depth, 1e-3, 1e-5) << geom;
    const Answer within = Ask(oracle, {0.2, 0.1, 0.0});
    EXPECT_TRUE(within.overlap && within.contained) << geom;
    EXPECT_LE(within.depth, 0.1) << geom;
    EXPECT_GE(within.depth, 0.03) << geom;
  }
}

TEST_F(MeshOracleTest, AnOverlapMayBeTolerated) {
  const Scene scene = MeshScene(BoxMesh({0.1, 0.1, 0.1}), "type='mesh' mesh='moving'");
  MeshOracle oracle(scene);
  EXPECT_TRUE(oracle.Free(FreePose({0.02, 0.03, 0.11 - 1e-6}), 1.1e-6));
  EXPECT_FALSE(oracle.Free(FreePose({0.02, 0.03, 0.11 - 1e-6}), 0.9e-6));
  EXPECT_TRUE(oracle.Overlaps(FreePose({0.02, 0.03, 0.11 + 2e-7})).empty());
}

// No vertex of either is inside the other.
TEST_F(MeshOracleTest, CrossedEdgesHaveADepth) {
  const MeshShape bar = BoxMesh({0.3, 0.02, 0.02});
  const Scene scene = MeshScene(bar, "type='mesh' mesh='moving'", bar);
  MeshOracle oracle(scene);
  const Eigen::Quaterniond across(Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitZ()));
  EXPECT_NEAR(Ask(oracle, {0, 0, 0.035}, across).depth, 0.005, 1e-9);
  EXPECT_FALSE(Ask(oracle, {0, 0, 0.0401}, across).overlap);
}

TEST_F(MeshOracleTest, HollowsAreFreeAndLinkedRingsToo) {
  MeshShape shell = BoxMesh({0.4, 0.4, 0.4}), inner = BoxMesh({0.3, 0.3, 0.3});
  shell.Append(inner.TurnInsideOut());
  const Scene hollow = MeshScene(shell, "type='sphere' size='0.02'");
  MeshOracle in_shell(hollow);
  EXPECT_FALSE(Ask(in_shell, {0.1, 0.05, 0.02}).overlap);
  const Answer in_wall = Ask(in_shell, {0.35, 0.05, 0.02});
  EXPECT_TRUE(in_wall.contained);
  EXPECT_NEAR(in_wall.depth, 0.05, 1e-3);
  EXPECT_FALSE(Ask(in_shell, {0.5, 0.05, 0.02}).overlap);

  const MeshShape ring = Torus(0.1, 0.02, 48, 16);
  const Scene rings = MeshScene(ring, "type='mesh' mesh='moving'", ring);
  MeshOracle oracle(rings);
  const Eigen::Quaterniond upright(Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitX()));
  EXPECT_FALSE(Ask(oracle, {0.1, 0, 0}, upright).overlap);
  EXPECT_TRUE(Ask(oracle, {0.17, 0, 0}, upright).overlap);
}

TEST_F(MeshOracleTest, AgreesWithTheSolversQueries) {
  Random rng(41);
  const MeshShape shapes[] = {TorusKnot(0.1, 0.03, 60, 8), Cup(0.12, 0.2, 0.03, 16)};
  int free = 0, overlapping = 0;
  for (const MeshShape& shape : shapes) {
    const Scene scene = MeshScene(shape, "type='mesh' mesh='moving'", Torus(0.08, 0.02, 20, 8));
    MeshOracle oracle(scene);
    ContactFinder finder(scene.tables());
    for (int i = 0; i < 100; ++i) {
      const std::vector<double> q = FreePose(rng.InBox(0.2), rng.UnitQuat());
      finder.Pose(ToEigen(q));
      NearPair near;
      ASSERT_TRUE(finder.Distance(0, 10.0, near));
      if (std::abs(near.distance) < 1e-8) continue;
      EXPECT_EQ(oracle.Overlaps(q).empty(), near.distance > 0.0) << near.distance;
      ++(near.distance > 0.0 ? free : overlapping);
    }
  }
  EXPECT_GT(free, 30);
  EXPECT_GT(overlapping, 30);
}

// From first contact on, ever deeper.
TEST_F(MeshOracleTest, TheVerifierSeesEveryShallowOverlap) {
  Random rng(43);
  int overlapping = 0, touching = 0;
  for (const MeshShape& fixed : SmallShapes()) {
    for (const MeshShape& moving : SmallShapes()) {
      const Scene scene = MeshScene(fixed, "type='mesh' mesh='moving'", moving);
      MeshOracle oracle(scene);
      ContactFinder finder(scene.tables());
      for (int i = 0; i < 6; ++i) {
        const Vector3d start = 0.6 * rng.UnitVector();
        const Eigen::Quaterniond turn = rng.UnitQuat();
        double share = 1.0;  // of the way from the middle
        NearPair near;
        for (int step = 0; step < 500; ++step) {
          finder.Pose(ToEigen(FreePose(share * start, turn)));
          if (!finder.Distance(0, 10.0, near) || near.distance < 1e-9) break;
          share -= near.distance / start.norm();
        }
        for (double deep = 1e-6; deep < 2e-3; deep *= 3.0) {
          const std::vector<double> q = FreePose((share - deep / start.norm()) * start, turn);
          double depth = 0.0;
          for (const OracleOverlap& o : oracle.Overlaps(q)) depth = std::max(depth, o.depth);
          ++(depth > 1e-6 ? overlapping : touching);
          if (depth > 1e-6) {
            EXPECT_FALSE(Verify(scene, q).free) << depth << " at " << deep << ", pose " << i;
          }
        }
      }
    }
  }
  EXPECT_GT(overlapping, 100);
  EXPECT_GT(touching, 20);
}

}  // namespace
}  // namespace mjcf_pdg::test
