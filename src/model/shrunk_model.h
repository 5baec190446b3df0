// A copy of a scene's model in which what moves is smaller: more room for a planner.
#ifndef MJCF_PDG_SRC_MODEL_SHRUNK_MODEL_H_
#define MJCF_PDG_SRC_MODEL_SHRUNK_MODEL_H_

#include <mujoco/mujoco.h>

#include <memory>

#include "model/scene_tables.h"

namespace mjcf_pdg {

// What keeps its centre when it becomes smaller: a body, that is the centre of the sphere around
// its geoms (SceneTables::body_spheres), or each geom, its frame's origin.
enum class ShrunkAbout { kBodies, kGeoms };

// What moves is smaller by `share` (at least 0, less than 1) of its size. Convex geoms that shrink
// about their own centres lie in the larger ones. Planes, height fields and SDFs stay as they are,
// and so do geoms that tendons wrap around and meshes that a geom on a body at rest has, too.
// Joints stay where they are, and so do masses and inertias, so that the norm is the same. Null if
// nothing becomes smaller.
std::shared_ptr<const mjModel> ShrunkModel(const SceneTables& tables, double share,
                                           ShrunkAbout about);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_MODEL_SHRUNK_MODEL_H_
