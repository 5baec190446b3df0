// Repairing scenes of meshes that collide as their triangles.
#include <cmath>

#include "mesh_shapes.h"
#include "mjcf_pdg/pdg.h"
#include "test_support.h"

namespace mjcf_pdg {
namespace {

using Eigen::Vector3d;
using test::MeshShape;
using test::Random;

class ExactMeshSolveTest : public test::MujocoTest {};

SceneOptions Exact() {
  SceneOptions options;
  options.exact_mesh = true;
  return options;
}

// On convex meshes the answer is the hulls' one.
TEST_F(ExactMeshSolveTest, ConvexMeshesComeOutAsTheirHullsDo) {
  Random rng(21);
  int overlapping = 0, far = 0;
  for (const int type : test::ConvexTypes()) {
    for (int k = 0; k < 6; ++k) {
      test::TwoGeoms two;
      two.first = test::RandomShape(mjGEOM_MESH, rng);
      two.second = test::RandomShape(type, rng);
      const std::string xml = test::TwoGeomXml(two);
      const Scene hull = Scene::FromString(xml), exact = Scene::FromString(xml, Exact());
      Eigen::VectorXd q(7);
      const Eigen::Quaterniond turn = rng.UnitQuat();
      q << rng.InBox(0.15), turn.w(), turn.x(), turn.y(), turn.z();
      const Result expected = Solver(hull).Solve(test::ToVector(q));
      const Result result = Solver(exact).Solve(test::ToVector(q));
      ASSERT_NE(expected.status, Status::kUnsolved);
      EXPECT_EQ(result.status, expected.status) << test::TypeName(type) << " " << k << result.reason;
      if (result.status != Status::kSolved) continue;
      EXPECT_TRUE(Verify(hull, result.q).min_distance > -2e-6);
      ++overlapping;
      far += result.sigma > 1.05 * expected.sigma;
      if (result.sigma > 1.05 * expected.sigma) std::printf("%s %d: %g %g\n", test::TypeName(type).c_str(), k, result.sigma, expected.sigma);
    }
  }
  EXPECT_GT(overlapping, 25);
  EXPECT_LE(far, overlapping / 10);
}

}  // namespace
}  // namespace mjcf_pdg
