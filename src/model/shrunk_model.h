// A copy of a scene's model in which what moves is smaller: more room for a planner.
#ifndef MJCF_PDG_SRC_MODEL_SHRUNK_MODEL_H_
#define MJCF_PDG_SRC_MODEL_SHRUNK_MODEL_H_

#include <mujoco/mujoco.h>

#include <memory>

#include "model/scene_tables.h"

namespace mjcf_pdg {

// Geoms on bodies that move are smaller by `share` (at least 0, less than 1) of their size, about
// their own frames' origins; where those are inside a convex geom, the smaller one lies in the
// larger. Planes, height fields and SDFs stay as they are, and so do geoms that tendons wrap around
// and meshes that a geom on a body at rest has, too. Masses and inertias stay, so that the norm is
// the same. Null if nothing becomes smaller.
std::shared_ptr<const mjModel> ShrunkModel(const SceneTables& tables, double share);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_MODEL_SHRUNK_MODEL_H_
