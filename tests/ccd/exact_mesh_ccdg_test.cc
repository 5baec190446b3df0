// Continuous collision detection with meshes that collide as their triangles.
#include <cmath>

#include "ccd/ccdg.h"
#include "tests/support/mesh_shapes.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg {
namespace {

using test::MeshShape;
using test::Random;

class ExactMeshCcdgTest : public test::MujocoTest {};

using test::MeshScene;

VectorXd At(const Vector3d& p, const Eigen::Quaterniond& turn = {1, 0, 0, 0}) {
  VectorXd q(7);
  q << p, turn.w(), turn.x(), turn.y(), turn.z();
  return q;
}

double Distance(const Scene& scene, ContactFinder& finder, const VectorXd& q0, const VectorXd& dq,
                double t) {
  VectorXd q;
  Integrate(scene.tables(), q0, t * dq, q);
  finder.Pose(q);
  NearPair near;
  return finder.Distance(0, 1.0, near) ? near.distance : 1.0;
}

TEST_F(ExactMeshCcdgTest, StopsEarlyNeverLate) {
  Random rng(41);
  const MeshShape knot = test::TorusKnot(0.1, 0.03, 60, 8), ring = test::Torus(0.1, 0.02, 24, 8);
  const std::string geoms[] = {"type='mesh' mesh='moving'", "type='sphere' size='0.03'",
                               "type='box' size='0.02 0.03 0.05'",
                               "type='cylinder' size='0.02 0.05'"};
  int contacts = 0, free = 0, poses = 0;
  for (const std::string& geom : geoms) {
    const Scene scene = MeshScene(knot, geom, ring);
    ContactFinder finder(scene.tables());
    Ccdg ccd(scene.tables(), finder);
    for (int i = 0; i < 25; ++i) {
      const VectorXd q0 = At(0.4 * rng.UnitVector(), rng.UnitQuat());
      VectorXd dq(6);
      dq << -1.8 * q0.head<3>() + rng.InBox(0.35), rng.InBox(2.0);
      if (Distance(scene, finder, q0, dq, 0.0) < 1e-3) continue;
      const CcdResult result = ccd.Move({q0, dq});
      ASSERT_TRUE(result.outcome == CcdOutcome::kFree || result.outcome == CcdOutcome::kContact);
      EXPECT_TRUE(result.certified);
      poses += result.poses;
      const int samples = 300;
      for (int k = 0; k <= samples; ++k) {
        ASSERT_GT(Distance(scene, finder, q0, dq, result.t * k / samples), 0.0) << geom << i;
      }
      if (result.outcome == CcdOutcome::kContact) {
        ++contacts;
        EXPECT_LT(Distance(scene, finder, q0, dq, result.t), 4.1e-6);
      } else {
        ++free;
      }
    }
  }
  EXPECT_GT(contacts, 20);
  EXPECT_GT(free, 5);
  RecordProperty("poses_per_motion", poses / (contacts + free));
  EXPECT_LT(poses, 60 * (contacts + free));
}

TEST_F(ExactMeshCcdgTest, ARingGoesOverAPostItsHullWouldHit) {
  const MeshShape ring = test::Torus(0.1, 0.02, 48, 16);
  const Scene scene = MeshScene(ring, "type='capsule' size='0.05 0.2'");
  ContactFinder finder(scene.tables());
  Ccdg ccd(scene.tables(), finder);
  VectorXd dq = VectorXd::Zero(6);
  dq[2] = -1.0;
  const CcdResult result = ccd.Move({At({0.0, 0.0, 0.5}), dq});
  EXPECT_EQ(result.outcome, CcdOutcome::kFree);
  EXPECT_TRUE(result.certified);
  dq[0] = 0.06;
  EXPECT_EQ(ccd.Move({At({0.0, 0.0, 0.5}), dq}).outcome, CcdOutcome::kContact);
}

// From contact, along the surface and away: pairs inside the band do not stop the motion.
TEST_F(ExactMeshCcdgTest, GlidesAlongASurface) {
  const Scene scene = MeshScene(test::BoxMesh({0.5, 0.5, 0.1}), "type='mesh' mesh='moving'",
                                test::BoxMesh({0.05, 0.05, 0.05}));
  ContactFinder finder(scene.tables());
  Ccdg ccd(scene.tables(), finder);
  VectorXd dq = VectorXd::Zero(6);
  dq[0] = 0.2;
  const CcdResult result = ccd.Move({At({0.0, 0.0, 0.150001}), dq});
  EXPECT_EQ(result.outcome, CcdOutcome::kFree);
  RecordProperty("poses", result.poses);
}

}  // namespace
}  // namespace mjcf_pdg
