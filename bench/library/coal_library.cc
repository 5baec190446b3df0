#include "library/library.h"

#ifdef MJCF_PDG_HAVE_COAL

#include <coal/BVH/BVH_model.h>
#include <coal/collision.h>
#include <coal/distance.h>
#include <coal/shape/convex.h>
#include <coal/shape/geometric_shapes.h>

#include "library/fcl_family.h"
#include "model/kinematics.h"

namespace mjcf_pdg::bench {
namespace {

struct CoalTraits {
  using Geometry = coal::CollisionGeometry;
  using Sphere = coal::Sphere;
  using Capsule = coal::Capsule;
  using Ellipsoid = coal::Ellipsoid;
  using Cylinder = coal::Cylinder;
  using Box = coal::Box;
  using Tree = coal::BVHModel<coal::OBBRSS>;
  using Triangle = coal::Triangle;
  using DistanceRequest = coal::DistanceRequest;
  using DistanceResult = coal::DistanceResult;
  using CollisionRequest = coal::CollisionRequest;
  using CollisionResult = coal::CollisionResult;
  static constexpr char kName[] = "Coal";

  static std::unique_ptr<Geometry> MakeHull(const MeshArrays& mesh) {
    auto vertices = std::make_shared<std::vector<coal::Vec3s>>(mesh.vertices);
    auto triangles = std::make_shared<std::vector<coal::Triangle>>();
    for (const std::array<int, 3>& t : mesh.corners) triangles->emplace_back(t[0], t[1], t[2]);
    return std::make_unique<coal::Convex<coal::Triangle>>(
        vertices, static_cast<unsigned>(vertices->size()), triangles,
        static_cast<unsigned>(triangles->size()));
  }
  static coal::Transform3s Pose(const mjData& d, int geom) {
    return {AsMatrix(d.geom_xmat + 9 * geom), AsVector(d.geom_xpos + 3 * geom)};
  }
  static const DistanceRequest& SignedRequest() {
    static const DistanceRequest request;
    return request;
  }
  static Eigen::Vector3d Normal(const DistanceResult& nearest) { return nearest.normal; }
  static const DistanceRequest& TriangleRequest() { return SignedRequest(); }
  static CollisionRequest FirstContact() { return {coal::CONTACT, 1}; }
};

}  // namespace

std::unique_ptr<Library> MakeCoal(const mjModel& m, bool triangles) {
  return std::make_unique<FclFamily<CoalTraits>>(m, triangles);
}

}  // namespace mjcf_pdg::bench

#else

namespace mjcf_pdg::bench {

std::unique_ptr<Library> MakeCoal(const mjModel&, bool) { return nullptr; }

}  // namespace mjcf_pdg::bench

#endif
