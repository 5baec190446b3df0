// A copy of a scene's model in which what moves is smaller: more room for a planner.
#ifndef MJCF_PDG_SRC_MODEL_SHRUNK_MODEL_H_
#define MJCF_PDG_SRC_MODEL_SHRUNK_MODEL_H_

#include <mujoco/mujoco.h>

#include <memory>

#include "model/scene_tables.h"

namespace mjcf_pdg {

enum class Shrunk {
  kBodies,     // each body, about the centre of the sphere around its geoms (body_spheres)
  kGeoms,      // each geom, about the origin of its frame
  kThickness,  // each geom, about the same origin, but as long as it is
};

// What moves is smaller by `share` (at least 0, less than 1) of its size. By kThickness, `share` of
// the shortest edge of the geom's box, along the axes of its frame, is taken from each of the three
// edges, but not from one that is longer than both others: limbs stay as long as they are, so that
// what they are jointed to is where it was, and nothing passes between. Convex geoms that shrink
// about their own centres lie in the larger ones, but for meshes that become thinner. Planes,
// height fields and SDFs stay as they are, and so do geoms that tendons wrap around and meshes that
// a geom on a body at rest has, too. Joints stay where they are, and so do masses and inertias, so
// that the norm is the same. Null if nothing becomes smaller.
std::shared_ptr<const mjModel> ShrunkModel(const SceneTables& tables, double share, Shrunk what);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_MODEL_SHRUNK_MODEL_H_
