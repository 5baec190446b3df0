// The way out of a height field: the shortest translation, of a few, after which a geom overlaps
// nothing of the field.
//
// The overlap of a geom with one prism tells little: the shortest way out of a prism may lead into
// the next one. So the geom is moved out of one prism after the other along a given direction until
// it overlaps none: straight up; along normals of steep parts of the surface that it overlaps; out
// of the field's sides and base; and, where the length is what matters, along the normal of the
// contact at which the best way so far ends. Each length is an upper bound of the penetration
// depth, and for a convex field it is the depth.
#ifndef MJCF_PDG_SRC_COLLIDE_TERRAIN_WAY_OUT_H_
#define MJCF_PDG_SRC_COLLIDE_TERRAIN_WAY_OUT_H_

#include <vector>

#include "collide/terrain/on_terrain.h"

namespace mjcf_pdg {

// A translation by length · u [m]; u is a unit vector in the axes of OnTerrain.
struct Way {
  Vector3d u = Vector3d::UnitZ();
  double length = 0.0;
  Vector3d n = Vector3d::UnitZ();  // normal of the contact where it ends
};

// One per thread: it keeps its scratch.
class WayOut {
 public:
  // kRough: a few contacts will be measured where the way ends. kShortest: its length counts.
  enum class Effort { kRough, kShortest };
  // How exactly the way out of one prism is found [1, scene's size], and how long a way is not
  // measured but bounded [scene's size].
  struct Accuracy {
    double share = 0.0, gap = 0.0, far = 0.0;
  };
  // The geom should overlap the field; the length is 0 if it does not. `near` holds all prisms
  // within on.radius() of the core; what else is needed is added.
  Way Find(const OnTerrain& on, Effort effort, std::vector<NearPrism>& near);

 private:
  void CollectNormals(Effort effort, const std::vector<NearPrism>& near);
  bool Shorten(const OnTerrain& on, const Vector3d& u, double met, std::vector<NearPrism>& near,
               Way& best);
  void LeaveIfMet(const OnTerrain& on, const OnTerrain::WayPlanes& planes, NearPrism& one,
                  std::vector<NearPrism>& near, Way& way);
  static NearPrism* LeftLast(const OnTerrain& on, const OnTerrain::WayPlanes& planes,
                             double enough, std::vector<NearPrism>& near);

  std::vector<Vector3d> normals_;  // of the surface that the geom overlaps, no two alike
  Accuracy accuracy_;
};

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_COLLIDE_TERRAIN_WAY_OUT_H_
