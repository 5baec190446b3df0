#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include "library/fcl_family.h"
#include "model/kinematics.h"

namespace mjcf_pdg::bench {
namespace {

// FCL's types and requests. For convex distances FCL uses its own tests for some pairs of
// primitives, and libccd's GJK and EPA for all others.
struct FclTraits {
  using Geometry = fcl::CollisionGeometry<double>;
  using Sphere = fcl::Sphere<double>;
  using Capsule = fcl::Capsule<double>;
  using Ellipsoid = fcl::Ellipsoid<double>;
  using Cylinder = fcl::Cylinder<double>;
  using Box = fcl::Box<double>;
  using Tree = fcl::BVHModel<fcl::OBBRSS<double>>;
  using Triangle = fcl::Triangle;
  using DistanceRequest = fcl::DistanceRequest<double>;
  using DistanceResult = fcl::DistanceResult<double>;
  using CollisionRequest = fcl::CollisionRequest<double>;
  using CollisionResult = fcl::CollisionResult<double>;
  static constexpr char kName[] = "FCL";

  static std::unique_ptr<Geometry> MakeHull(const MeshArrays& mesh) {
    auto faces = std::make_shared<std::vector<int>>();
    for (const std::array<int, 3>& t : mesh.corners)
      faces->insert(faces->end(), {3, t[0], t[1], t[2]});
    auto vertices = std::make_shared<const std::vector<Eigen::Vector3d>>(mesh.vertices);
    return std::make_unique<fcl::Convex<double>>(vertices, static_cast<int>(mesh.corners.size()),
                                                 faces);
  }
  static fcl::Transform3<double> Pose(const mjData& d, int geom) {
    fcl::Transform3<double> pose = fcl::Transform3<double>::Identity();
    pose.linear() = AsMatrix(d.geom_xmat + 9 * geom);
    pose.translation() = AsVector(d.geom_xpos + 3 * geom);
    return pose;
  }
  static DistanceRequest SignedRequest() { return DistanceRequest(true, true); }
  static Eigen::Vector3d Normal(const DistanceResult& nearest) {
    const Eigen::Vector3d between = nearest.nearest_points[1] - nearest.nearest_points[0];
    return (nearest.min_distance < 0.0 ? -1.0 : 1.0) * between.normalized();
  }
  static DistanceRequest TriangleRequest() { return DistanceRequest(true); }
  static CollisionRequest FirstContact() { return CollisionRequest(1); }
};

}  // namespace

std::unique_ptr<Library> MakeFcl(const mjModel& m, bool triangles) {
  return std::make_unique<FclFamily<FclTraits>>(m, triangles);
}

}  // namespace mjcf_pdg::bench
