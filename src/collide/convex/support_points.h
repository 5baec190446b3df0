// Support points of convex geoms, farthest along a direction: all that distances, depths and
// separating planes ask of them.
#ifndef MJCF_PDG_SRC_COLLIDE_CONVEX_SUPPORT_POINTS_H_
#define MJCF_PDG_SRC_COLLIDE_CONVEX_SUPPORT_POINTS_H_

#include <mujoco/mujoco.h>

#include <Eigen/Dense>
#include <span>
#include <vector>

#include "model/scene_tables.h"

namespace mjcf_pdg {

// What is taken off a round geom to get its core: its radius, 0 for other types [m].
double CoreRadius(const mjModel& model, int geom);

// Spheres, capsules, ellipsoids, cylinders, boxes and meshes, these as MuJoCo collides them: hulls.
// A sphere's core is its centre, a capsule's its segment; the geom exceeds it by a radius.
// Immutable after construction.
class SupportPoints {
 public:
  // Of the geoms of these pairs. Refers to the model.
  SupportPoints(const mjModel& model, const std::vector<KeptPair>& pairs);

  // False for planes, SDFs and height fields.
  bool Knows(int geom) const;
  // A point of the core that is farthest along `direction_G`, both in the frame of the geom, which
  // is one that Knows knows and in one of the pairs [m].
  Eigen::Vector3d Support(int geom, const Eigen::Vector3d& direction_G) const;
  // Of a mesh geom of the pairs: points whose hull it is, in its frame [m].
  std::span<const Eigen::Vector3f> HullPoints(int geom) const;

 private:
  struct Hull {
    int begin = 0, end = 0;  // vertices
    int starts = -1;         // its part of starts_; -1: without edges
  };
  struct Neighbour {
    Eigen::Vector3f p;
    int vertex = 0;
  };

  void AddHull(int mesh);
  int Climb(const Hull& hull, const Eigen::Vector3d& direction, int vertex) const;
  int LookAtAll(const Hull& hull, const Eigen::Vector3d& direction) const;

  const mjModel& model_;
  std::vector<Hull> hulls_;                // nmesh
  std::vector<Eigen::Vector3f> vertices_;  // of all hulls
  std::vector<int> first_neighbour_;       // of each vertex, and of one beyond the last
  std::vector<Neighbour> neighbours_;      // joined to it by an edge; counted from the hull's first
  std::vector<int> starts_;                // the farthest vertex along some direction of each cell
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_COLLIDE_CONVEX_SUPPORT_POINTS_H_
