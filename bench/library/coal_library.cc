#include "library.h"
#ifdef MJCF_PDG_HAVE_COAL

#include <coal/BVH/BVH_model.h>
#include <coal/collision.h>
#include <coal/distance.h>
#include <coal/shape/convex.h>
#include <coal/shape/geometric_shapes.h>

#include "model/kinematics.h"

namespace mjcf_pdg::bench {
namespace {

using Tree = coal::BVHModel<coal::OBBRSS>;

std::unique_ptr<coal::CollisionGeometry> MakeHull(const MeshArrays& mesh) {
  auto vertices = std::make_shared<std::vector<coal::Vec3s>>(mesh.vertices);
  auto triangles = std::make_shared<std::vector<coal::Triangle>>();
  for (const std::array<int, 3>& t : mesh.corners) triangles->emplace_back(t[0], t[1], t[2]);
  return std::make_unique<coal::Convex<coal::Triangle>>(
      vertices, static_cast<unsigned>(vertices->size()), triangles,
      static_cast<unsigned>(triangles->size()));
}

std::unique_ptr<coal::CollisionGeometry> MakeGeometry(const mjModel& m, int geom) {
  const double* size = m.geom_size + 3 * geom;
  switch (m.geom_type[geom]) {
    case mjGEOM_SPHERE:
      return std::make_unique<coal::Sphere>(size[0]);
    case mjGEOM_CAPSULE:
      return std::make_unique<coal::Capsule>(size[0], 2 * size[1]);
    case mjGEOM_ELLIPSOID:
      return std::make_unique<coal::Ellipsoid>(size[0], size[1], size[2]);
    case mjGEOM_CYLINDER:
      return std::make_unique<coal::Cylinder>(size[0], 2 * size[1]);
    case mjGEOM_BOX:
      return std::make_unique<coal::Box>(2 * size[0], 2 * size[1], 2 * size[2]);
    case mjGEOM_MESH:
      return MakeHull(MeshArrays(m, m.geom_dataid[geom], true));
    default:
      return nullptr;
  }
}

std::unique_ptr<Tree> MakeTree(const MeshArrays& mesh) {
  auto tree = std::make_unique<Tree>();
  std::vector<coal::Triangle> triangles;
  for (const std::array<int, 3>& t : mesh.corners) triangles.emplace_back(t[0], t[1], t[2]);
  tree->beginModel();
  tree->addSubModel(mesh.vertices, triangles);
  tree->endModel();
  return tree;
}

class Coal : public Library {
 public:
  Coal(const mjModel& m, bool triangles) {
    for (int g = 0; g < m.ngeom; ++g) {
      shapes_.push_back(MakeGeometry(m, g));
      const bool tree = triangles && m.geom_type[g] == mjGEOM_MESH;
      trees_.push_back(tree ? MakeTree(MeshArrays(m, m.geom_dataid[g], false)) : nullptr);
    }
  }
  const char* name() const override { return "Coal"; }

  bool Distance(const mjData& d, int geom1, int geom2, SignedGap& gap) override {
    if (!shapes_[geom1] || !shapes_[geom2]) return false;
    coal::DistanceResult nearest;
    coal::distance(shapes_[geom1].get(), Pose(d, geom1), shapes_[geom2].get(), Pose(d, geom2),
                   wish_, nearest);
    gap.distance = nearest.min_distance;
    gap.p1 = nearest.nearest_points[0];
    gap.p2 = nearest.nearest_points[1];
    gap.n = nearest.normal;
    return std::isfinite(gap.distance) && gap.n.allFinite();
  }
  double TriangleDistance(const mjData& d, int geom1, int geom2, double cutoff) override {
    coal::DistanceResult nearest;
    nearest.min_distance = cutoff;  // what is not nearer is passed over
    coal::distance(trees_[geom1].get(), Pose(d, geom1), trees_[geom2].get(), Pose(d, geom2), wish_,
                   nearest);
    return nearest.min_distance;
  }
  bool TrianglesCross(const mjData& d, int geom1, int geom2) override {
    coal::CollisionResult crossing;
    coal::collide(trees_[geom1].get(), Pose(d, geom1), trees_[geom2].get(), Pose(d, geom2),
                  coal::CollisionRequest(coal::CONTACT, 1), crossing);
    return crossing.isCollision();
  }

 private:
  static coal::Transform3s Pose(const mjData& d, int geom) {
    return {AsMatrix(d.geom_xmat + 9 * geom), AsVector(d.geom_xpos + 3 * geom)};
  }

  const coal::DistanceRequest wish_;
  std::vector<std::unique_ptr<coal::CollisionGeometry>> shapes_;  // per geom; null: not convex
  std::vector<std::unique_ptr<Tree>> trees_;
};

}  // namespace

std::unique_ptr<Library> MakeCoal(const mjModel& m, bool triangles) {
  return std::make_unique<Coal>(m, triangles);
}

}  // namespace mjcf_pdg::bench

#else

namespace mjcf_pdg::bench {

std::unique_ptr<Library> MakeCoal(const mjModel&, bool) { return nullptr; }

}  // namespace mjcf_pdg::bench

#endif
