// Support points of convex geoms, by their definition.
#include "collide/convex/support_points.h"

#include <algorithm>
#include <cmath>

#include "tests/support/mesh_shapes.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {
namespace {

using Eigen::Vector3d;

class SupportPointsTest : public MujocoTest {
 protected:
  // Random ones, along the axes and the diagonals of two, a little beside an axis, none at all.
  std::vector<Vector3d> Directions(int random) {
    std::vector<Vector3d> directions{Vector3d::Zero()};
    for (int axis = 0; axis < 3; ++axis) {
      for (const double sign : {-1.0, 1.0}) {
        const Vector3d along = sign * Vector3d::Unit(axis);
        directions.push_back(along);
        directions.push_back(1e-9 * along);
        for (const double beside : {-1.0, -1e-12, 1e-12, 1.0}) {
          directions.push_back(along + beside * Vector3d::Unit((axis + 1) % 3));
        }
      }
    }
    for (int k = 0; k < random; ++k) directions.push_back(rng_.InBox(2.0));
    return directions;
  }
  Random rng_{3};
};

TEST_F(SupportPointsTest, OfAMeshNoVertexIsFarther) {
  const std::vector<std::pair<std::string, MeshShape>> shapes = {
      {"a tetrahedron's few", Globe(2, 3, [](const auto&) { return 0.1; })},
      {"round", Globe(40, 60, [](const auto&) { return 0.1; })},
      {"rugged", Globe(20, 30, [this](const auto&) { return 0.1 + 0.02 * rng_.Uniform(0, 1); })},
      {"flat faces of many vertices",
       Globe(30, 40, [](const Vector3d& u) { return 0.1 / u.cwiseAbs().maxCoeff(); })},
      {"a needle",
       Globe(30, 30, [](const Vector3d& u) { return 0.002 + 0.2 * std::pow(u.z(), 8); })},
  };
  for (const auto& [name, shape] : shapes) {
    SCOPED_TRACE(name);
    const Scene scene = Scene::FromString(MeshSceneXml(shape, "type='sphere' size='.01'"));
    const mjModel& m = *scene.tables().model;
    const int geom = mj_name2id(&m, mjOBJ_GEOM, "g2");
    ASSERT_TRUE(scene.tables().support->Knows(geom));
    const Eigen::Map<const Eigen::Matrix3Xf> vertices(m.mesh_vert, 3, m.nmeshvert);
    const double size = vertices.colwise().norm().maxCoeff();
    for (const Vector3d& u : Directions(2000)) {
      const Vector3d p = scene.tables().support->Support(geom, u);
      const double farthest = (u.transpose() * vertices.cast<double>()).maxCoeff();
      EXPECT_NEAR(u.dot(p), farthest, 1e-6 * size * u.norm()) << u.transpose();
      const double beside = (vertices.cast<double>().colwise() - p).colwise().norm().minCoeff();
      EXPECT_EQ(beside, 0.0) << "not a vertex, along " << u.transpose();
    }
  }
}

// How far x is inside the core of a geom, in shares of its size; negative outside.
double Inside(int type, const Vector3d& size, const Vector3d& x) {
  switch (type) {
    case mjGEOM_SPHERE:
      return -x.norm();
    case mjGEOM_CAPSULE:
      return std::min(-x.head<2>().norm(), 1.0 - std::abs(x.z()) / size[1]);
    case mjGEOM_ELLIPSOID:
      return 1.0 - x.cwiseQuotient(size).norm();
    case mjGEOM_CYLINDER:
      return 1.0 - std::max(x.head<2>().norm() / size[0], std::abs(x.z()) / size[1]);
    default:
      return 1.0 - x.cwiseAbs().cwiseQuotient(size).maxCoeff();
  }
}

TEST_F(SupportPointsTest, OfOtherGeomsNothingInsideIsFarther) {
  for (const int type : ConvexTypes()) {
    if (type == mjGEOM_PLANE || type == mjGEOM_MESH) continue;
    SCOPED_TRACE(TypeName(type));
    const Scene scene = Scene::FromString(
        TwoGeomXml({.first = RandomShape(type, rng_), .second = RandomShape(mjGEOM_BOX, rng_)}));
    const mjModel& m = *scene.tables().model;
    const int geom = mj_name2id(&m, mjOBJ_GEOM, "g1");
    const Vector3d size(m.geom_size + 3 * geom);
    const double thick = type == mjGEOM_SPHERE || type == mjGEOM_CAPSULE ? 0.0 : 1.0;
    std::vector<Vector3d> core{Vector3d::Zero()};
    for (int k = 0; k < 2000; ++k) {
      Vector3d x = rng_.InBox(size.maxCoeff());
      x.head<2>() *= thick;
      if (Inside(type, size, x) >= 0.0) core.push_back(x);
    }
    EXPECT_GT(core.size(), type == mjGEOM_SPHERE ? 0u : 50u);
    for (const Vector3d& u : Directions(200)) {
      const Vector3d p = scene.tables().support->Support(geom, u);
      EXPECT_GE(Inside(type, size, p), -1e-12);
      for (const Vector3d& x : core) EXPECT_LE(u.dot(x), u.dot(p) + 1e-12);
    }
  }
}

}  // namespace
}  // namespace mjcf_pdg::test
