// Which pairs of geoms MuJoCo's filters keep, and where each body's geoms can be.
#ifndef MJCF_PDG_SRC_MODEL_KEPT_PAIRS_H_
#define MJCF_PDG_SRC_MODEL_KEPT_PAIRS_H_

#include "model/scene_tables.h"

namespace mjcf_pdg {

// Fills pairs, body_pairs, body_spheres, has_contact_only_pairs from model, column_of_dof,
// body_moves and exact. Follows engine_collision_driver.c of MuJoCo 4.0: explicit <pair>s always
// count; dynamic pairs pass the contype/conaffinity, weld, parent-child and <exclude> filters.
void FillKeptPairs(SceneTables& tables);

}  // namespace mjcf_pdg

#endif  // MJCF_PDG_SRC_MODEL_KEPT_PAIRS_H_
