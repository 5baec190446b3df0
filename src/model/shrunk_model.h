// A copy of a scene's model in which what moves is smaller: more room for a planner.
#ifndef MJCF_PDG_SRC_MODEL_SHRUNK_MODEL_H_
#define MJCF_PDG_SRC_MODEL_SHRUNK_MODEL_H_

#include <mujoco/mujoco.h>

#include <memory>

#include "model/scene_tables.h"

namespace mjcf_pdg {

// What becomes smaller and keeps its centre: bodies, that of the sphere around their geoms
// (SceneTables::body_spheres), geoms, the origins of their frames, or how thick these are, the same
// origins.
enum class Shrunk { kBodies, kGeoms, kThickness };

// What moves is smaller by `share` (at least 0, less than 1) of its size. Of a geom's thickness,
// the shortest edge of its box along the axes of its frame, `share` is taken from each of the three
// edges, but not from one that is longer than both others: limbs stay as long as they are, so that
// what they are jointed to is where it was, and nothing passes between. Convex geoms that shrink
// about their own centres lie in the larger ones, but for meshes that become thinner. Planes,
// height fields and SDFs stay as they are, and so do geoms that tendons wrap around and meshes that
// a geom on a body at rest has, too. Joints stay where they are, and so do masses and inertias, so
// that the norm is the same. Null if nothing becomes smaller.
std::shared_ptr<const mjModel> ShrunkModel(const SceneTables& tables, double share, Shrunk what);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_MODEL_SHRUNK_MODEL_H_
