// Two convex geoms of any size at random poses, for tests of the parts of the lower bound.
#ifndef MJCF_PDG_TESTS_BOUND_POSED_GEOMS_H_
#define MJCF_PDG_TESTS_BOUND_POSED_GEOMS_H_

#include <limits>
#include <memory>
#include <string>

#include "bound/lower_bound_geom.h"
#include "tests/support/brute_distance.h"
#include "tests/support/test_support.h"

namespace mjcf_pdg::test {

struct PosedGeoms {
  // All lengths are times `scale`. The geoms' centres are within ±`spread` times that of the origin
  // along each axis; a plane lies at the origin.
  PosedGeoms(int type1, int type2, double spread, double scale, Random& rng) {
    TwoGeoms two;
    two.joint1.clear();
    int type = type1;
    for (Shape* shape : {&two.first, &two.second}) {
      *shape = RandomShape(type, rng);
      if (type != mjGEOM_PLANE) shape->size *= scale;
      for (Vector3d& v : shape->vertices) v *= scale;
      const Vector3d p = (type == mjGEOM_PLANE ? 0.0 : scale) * rng.InBox(spread);
      const Eigen::Quaterniond r = rng.UnitQuat();
      const double quat[] = {r.w(), r.x(), r.y(), r.z()};
      (shape == &two.first ? two.pose1 : two.pose2) =
          "pos='" + Join(p.data(), 3) + "' quat='" + Join(quat, 4) + "'";
      type = type2;
    }
    model = LoadModel(TwoGeomXml(two));
    posed = std::make_unique<PosedModel>(model.get());
    posed->Pose(VectorXd(0));
    const std::vector<KeptPair> pairs = {{.geom1 = 0, .geom2 = 1}};
    points = std::make_unique<SupportPoints>(*model, pairs);
  }

  ConvexGeom Filled(int geom) const {
    ConvexGeom filled;
    filled.Fill(*posed, *points, geom);
    return filled;
  }
  // max n · x over the points x of the geom, by its definition. A plane is a half-space, bounded
  // along its normal only.
  double Reach(int geom, const Vector3d& n) const {
    if (model->geom_type[geom] == mjGEOM_PLANE) {
      const Vector3d normal = AsMatrix(posed->data()->geom_xmat + 9 * geom).col(2);
      const bool along = n.cross(normal).norm() < 1e-12 && n.dot(normal) > 0.0;
      return along ? n.dot(AsVector(posed->data()->geom_xpos + 3 * geom))
                   : std::numeric_limits<double>::infinity();
    }
    return test::Support(model.get(), posed->data(), geom, n);
  }

  ModelPtr model;
  std::unique_ptr<PosedModel> posed;
  std::unique_ptr<SupportPoints> points;
};

}  // namespace mjcf_pdg::test

#endif  // MJCF_PDG_TESTS_BOUND_POSED_GEOMS_H_
