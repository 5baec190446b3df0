#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include "library.h"
#include "model/kinematics.h"

namespace mjcf_pdg::bench {
namespace {

using Tree = fcl::BVHModel<fcl::OBBRSS<double>>;
using Geometry = fcl::CollisionGeometry<double>;

std::unique_ptr<Geometry> MakeHull(const MeshArrays& mesh) {
  auto faces = std::make_shared<std::vector<int>>();
  for (const std::array<int, 3>& t : mesh.corners)
    faces->insert(faces->end(), {3, t[0], t[1], t[2]});
  auto vertices = std::make_shared<const std::vector<Eigen::Vector3d>>(mesh.vertices);
  return std::make_unique<fcl::Convex<double>>(vertices, static_cast<int>(mesh.corners.size()),
                                               faces);
}

std::unique_ptr<Geometry> MakeGeometry(const mjModel& m, int geom) {
  const double* size = m.geom_size + 3 * geom;
  switch (m.geom_type[geom]) {
    case mjGEOM_SPHERE:
      return std::make_unique<fcl::Sphere<double>>(size[0]);
    case mjGEOM_CAPSULE:
      return std::make_unique<fcl::Capsule<double>>(size[0], 2 * size[1]);
    case mjGEOM_ELLIPSOID:
      return std::make_unique<fcl::Ellipsoid<double>>(size[0], size[1], size[2]);
    case mjGEOM_CYLINDER:
      return std::make_unique<fcl::Cylinder<double>>(size[0], 2 * size[1]);
    case mjGEOM_BOX:
      return std::make_unique<fcl::Box<double>>(2 * size[0], 2 * size[1], 2 * size[2]);
    case mjGEOM_MESH:
      return MakeHull(MeshArrays(m, m.geom_dataid[geom], true));
    default:
      return nullptr;
  }
}

std::unique_ptr<Tree> MakeTree(const MeshArrays& mesh) {
  auto tree = std::make_unique<Tree>();
  std::vector<fcl::Triangle> triangles;
  for (const std::array<int, 3>& t : mesh.corners) triangles.emplace_back(t[0], t[1], t[2]);
  tree->beginModel();
  tree->addSubModel(mesh.vertices, triangles);
  tree->endModel();
  return tree;
}

class Fcl : public Library {
 public:
  Fcl(const mjModel& m, bool triangles) {
    for (int g = 0; g < m.ngeom; ++g) {
      shapes_.push_back(MakeGeometry(m, g));
      const bool tree = triangles && m.geom_type[g] == mjGEOM_MESH;
      trees_.push_back(tree ? MakeTree(MeshArrays(m, m.geom_dataid[g], false)) : nullptr);
    }
  }
  const char* name() const override { return "FCL"; }

  // Its own tests of two primitives where it has them, else libccd's GJK and EPA.
  bool Distance(const mjData& d, int geom1, int geom2, SignedGap& gap) override {
    if (!shapes_[geom1] || !shapes_[geom2]) return false;
    fcl::DistanceRequest<double> wish(true, true);
    fcl::DistanceResult<double> nearest;
    fcl::distance(shapes_[geom1].get(), Pose(d, geom1), shapes_[geom2].get(), Pose(d, geom2), wish,
                  nearest);
    gap.distance = nearest.min_distance;
    gap.p1 = nearest.nearest_points[0];
    gap.p2 = nearest.nearest_points[1];
    const Eigen::Vector3d between = gap.p2 - gap.p1;
    gap.n = (gap.distance < 0.0 ? -1.0 : 1.0) * between.normalized();
    return std::isfinite(gap.distance) && gap.n.allFinite();
  }
  double TriangleDistance(const mjData& d, int geom1, int geom2, double cutoff) override {
    fcl::DistanceResult<double> nearest;
    nearest.min_distance = cutoff;  // what is not nearer is passed over
    fcl::distance(trees_[geom1].get(), Pose(d, geom1), trees_[geom2].get(), Pose(d, geom2),
                  fcl::DistanceRequest<double>(true), nearest);
    return nearest.min_distance;
  }
  bool TrianglesCross(const mjData& d, int geom1, int geom2) override {
    fcl::CollisionResult<double> crossing;
    fcl::collide(trees_[geom1].get(), Pose(d, geom1), trees_[geom2].get(), Pose(d, geom2),
                 fcl::CollisionRequest<double>(1), crossing);
    return crossing.isCollision();
  }

 private:
  static fcl::Transform3<double> Pose(const mjData& d, int geom) {
    fcl::Transform3<double> pose = fcl::Transform3<double>::Identity();
    pose.linear() = AsMatrix(d.geom_xmat + 9 * geom);
    pose.translation() = AsVector(d.geom_xpos + 3 * geom);
    return pose;
  }

  std::vector<std::unique_ptr<Geometry>> shapes_;  // per geom; null: not convex
  std::vector<std::unique_ptr<Tree>> trees_;
};

}  // namespace

std::unique_ptr<Library> MakeFcl(const mjModel& m, bool triangles) {
  return std::make_unique<Fcl>(m, triangles);
}

}  // namespace mjcf_pdg::bench
