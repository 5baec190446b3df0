// FCL and its fork Coal have the same classes under different names. This template asks both in the
// same way.
#ifndef MJCF_PDG_BENCH_LIBRARY_FCL_FAMILY_H_
#define MJCF_PDG_BENCH_LIBRARY_FCL_FAMILY_H_

#include <mujoco/mujoco.h>

#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "library/library.h"

namespace mjcf_pdg::bench {

// `Traits` has the library's types (Geometry, Sphere, Capsule, Ellipsoid, Cylinder, Box, Tree,
// Triangle, DistanceRequest, DistanceResult, CollisionRequest, CollisionResult), its name kName,
// and
//   std::unique_ptr<Geometry> MakeHull(const MeshArrays&);
//   Transform Pose(const mjData&, int geom);
//   DistanceRequest SignedRequest();                        with depths of overlaps
//   Eigen::Vector3d Normal(const DistanceResult&);          from geom 1 to geom 2
//   DistanceRequest TriangleRequest();
//   CollisionRequest FirstContact();                        one contact is enough
template <typename Traits>
class FclFamily : public Library {
 public:
  FclFamily(const mjModel& m, bool triangles) {
    for (int g = 0; g < m.ngeom; ++g) {
      shapes_.push_back(MakeShape(m, g));
      const bool tree = triangles && m.geom_type[g] == mjGEOM_MESH;
      trees_.push_back(tree ? MakeTree(MeshArrays(m, m.geom_dataid[g], false)) : nullptr);
    }
  }
  const char* name() const override { return Traits::kName; }

  bool Distance(const mjData& d, int geom1, int geom2, SignedGap& gap) override {
    if (!shapes_[geom1] || !shapes_[geom2]) return false;
    typename Traits::DistanceResult nearest;
    distance(shapes_[geom1].get(), Traits::Pose(d, geom1), shapes_[geom2].get(),
             Traits::Pose(d, geom2), Traits::SignedRequest(), nearest);
    gap.distance = nearest.min_distance;
    gap.p1 = nearest.nearest_points[0];
    gap.p2 = nearest.nearest_points[1];
    gap.n = Traits::Normal(nearest);
    return std::isfinite(gap.distance) && gap.n.allFinite();
  }
  std::optional<bool> Overlap(const mjData& d, int geom1, int geom2) override {
    if (!shapes_[geom1] || !shapes_[geom2]) return std::nullopt;
    typename Traits::CollisionResult crossing;
    collide(shapes_[geom1].get(), Traits::Pose(d, geom1), shapes_[geom2].get(),
            Traits::Pose(d, geom2), Traits::FirstContact(), crossing);
    return crossing.isCollision();
  }
  double TriangleDistance(const mjData& d, int geom1, int geom2, double cutoff) override {
    typename Traits::DistanceResult nearest;
    nearest.min_distance = cutoff;  // triangles that are not nearer are skipped
    distance(trees_[geom1].get(), Traits::Pose(d, geom1), trees_[geom2].get(),
             Traits::Pose(d, geom2), Traits::TriangleRequest(), nearest);
    return nearest.min_distance;
  }
  bool TrianglesCross(const mjData& d, int geom1, int geom2) override {
    typename Traits::CollisionResult crossing;
    collide(trees_[geom1].get(), Traits::Pose(d, geom1), trees_[geom2].get(),
            Traits::Pose(d, geom2), Traits::FirstContact(), crossing);
    return crossing.isCollision();
  }

 private:
  using Geometry = typename Traits::Geometry;
  using Tree = typename Traits::Tree;

  static std::unique_ptr<Geometry> MakeShape(const mjModel& m, int geom) {
    const double* size = m.geom_size + 3 * geom;
    switch (m.geom_type[geom]) {
      case mjGEOM_SPHERE:
        return std::make_unique<typename Traits::Sphere>(size[0]);
      case mjGEOM_CAPSULE:
        return std::make_unique<typename Traits::Capsule>(size[0], 2 * size[1]);
      case mjGEOM_ELLIPSOID:
        return std::make_unique<typename Traits::Ellipsoid>(size[0], size[1], size[2]);
      case mjGEOM_CYLINDER:
        return std::make_unique<typename Traits::Cylinder>(size[0], 2 * size[1]);
      case mjGEOM_BOX:
        return std::make_unique<typename Traits::Box>(2 * size[0], 2 * size[1], 2 * size[2]);
      case mjGEOM_MESH:
        return Traits::MakeHull(MeshArrays(m, m.geom_dataid[geom], true));
      default:
        return nullptr;
    }
  }

  static std::unique_ptr<Tree> MakeTree(const MeshArrays& mesh) {
    auto tree = std::make_unique<Tree>();
    std::vector<typename Traits::Triangle> triangles;
    for (const std::array<int, 3>& t : mesh.corners) triangles.emplace_back(t[0], t[1], t[2]);
    tree->beginModel();
    tree->addSubModel(mesh.vertices, triangles);
    tree->endModel();
    return tree;
  }

  std::vector<std::unique_ptr<Geometry>> shapes_;  // by geom; null if it is not convex
  std::vector<std::unique_ptr<Tree>> trees_;       // by geom; null without a mesh or `triangles`
};

}  // namespace mjcf_pdg::bench

#endif  // MJCF_PDG_BENCH_LIBRARY_FCL_FAMILY_H_
