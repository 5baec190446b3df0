// Support functions of convex geoms: the point of a geom that is farthest along a direction. This
// is all that distances (ConvexDistance), depths and separating planes need to know of a geom.
#ifndef MJCF_PDG_SRC_COLLIDE_CONVEX_SUPPORT_POINTS_H_
#define MJCF_PDG_SRC_COLLIDE_CONVEX_SUPPORT_POINTS_H_

#include <mujoco/mujoco.h>

#include <Eigen/Dense>
#include <span>
#include <vector>

#include "model/scene_tables.h"

namespace mjcf_pdg {

// The core of a sphere is its centre, that of a capsule its axis segment; the geom is the set of
// points no farther from the core than this radius [m]. Other types are their own cores: 0.
double CoreRadius(const mjModel& model, int geom);

// For spheres, capsules, ellipsoids, cylinders, boxes and meshes; a mesh counts as its convex hull,
// as in MuJoCo. Immutable after construction, so threads may share it.
class SupportPoints {
 public:
  // Prepares the hulls of the mesh geoms in `pairs`. `model` must outlive this object.
  SupportPoints(const mjModel& model, const std::vector<KeptPair>& pairs);

  // True for the geom types above; false for planes, SDFs and height fields.
  bool Knows(int geom) const;
  // A point of the core that is farthest along `direction_G` (any length), both in the frame of the
  // geom [m]. Knows(geom) must hold, and a mesh geom must be in one of the pairs.
  Eigen::Vector3d Support(int geom, const Eigen::Vector3d& direction_G) const;
  // Points whose convex hull a mesh geom is, in its frame [m]. The geom must be in one of the
  // pairs. Valid as long as this object.
  std::span<const Eigen::Vector3f> HullPoints(int geom) const;

 private:
  // Vertices of a hull are numbered from 0; number k is vertices_[begin + k].
  struct Hull {
    int begin = 0, end = 0;
    int starts = -1;  // where its entries in starts_ begin; -1: small, without edges
  };
  // A vertex at the other end of an edge, with its position, so that climbing reads memory in
  // order.
  struct Neighbour {
    Eigen::Vector3f p;
    int vertex = 0;
  };

  void AddHull(int mesh);
  void AddStarts(Hull& hull);
  // The farthest vertex of a hull along the direction, by hill climbing from `vertex` (Climb) or by
  // looking at all vertices.
  int Climb(const Hull& hull, const Eigen::Vector3d& direction, int vertex) const;
  int LookAtAll(const Hull& hull, const Eigen::Vector3d& direction) const;

  const mjModel& model_;
  std::vector<Hull> hulls_;                // nmesh; empty for meshes that no pair needs
  std::vector<Eigen::Vector3f> vertices_;  // of all hulls
  // Entry v: where the neighbours of vertices_[v] begin in neighbours_. One more entry ends the
  // last.
  std::vector<int> first_neighbour_;
  std::vector<Neighbour> neighbours_;
  // Per hull with edges and cell of directions: the farthest vertex along the cell's middle, where
  // Climb starts.
  std::vector<int> starts_;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_COLLIDE_CONVEX_SUPPORT_POINTS_H_
